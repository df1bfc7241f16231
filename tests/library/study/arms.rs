//! The comparison of any number of arms, held against published examples and against what was put into simulated counts.

use rand_distr::{Distribution, Gamma, Normal, Poisson};
use tomcom_session::plan::StudyAims;
use tomcom_study::arm_comparison::{compare_arms, holm};
use tomcom_study::effect::LeftOutParticipant;
use tomcom_study::mixed_models::{CountObservation, LinearMixedModel, MixedModelMeasurement, NegativeBinomialModel};
use tomcom_study::trial_statistics::TrialStatistics;

use super::in_arm;
use crate::support::*;

fn is_close(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within * wanted.abs().max(1e-12), "{found} instead of {wanted}");
}

/// Yield of dyestuff from six batches (Davies and Goldsmith 1972, table 6.1), with the estimates of lme4 1.1-31 and lmerTest 3.1-3.
#[test]
fn the_linear_model_finds_the_variances_of_the_dyestuff_batches() {
    const YIELD: [[f64; 5]; 6] = [
        [1545.0, 1440.0, 1440.0, 1520.0, 1580.0],
        [1540.0, 1555.0, 1490.0, 1560.0, 1495.0],
        [1595.0, 1550.0, 1605.0, 1510.0, 1560.0],
        [1445.0, 1440.0, 1595.0, 1465.0, 1545.0],
        [1595.0, 1630.0, 1515.0, 1635.0, 1625.0],
        [1520.0, 1455.0, 1450.0, 1480.0, 1445.0],
    ];
    let rows = YIELD.iter().enumerate().flat_map(|(participant, values)| {
        values.iter().map(move |&value| MixedModelMeasurement { participant, effects: vec![1.0], value })
    });
    let model = LinearMixedModel::fit(&rows.collect::<Vec<_>>()).expect("a fit");
    is_close(model.between, 1764.05, 1e-6);
    is_close(model.within, 2451.25, 1e-6);
    let mean = model.contrast(&[1.0]).expect("the mean");
    is_close(mean.estimate, 1527.5, 1e-9);
    is_close(mean.standard_error, 19.383_412_18, 1e-6);
    is_close(mean.df, 5.0, 1e-5);
}

/// Cases of contagious bovine pleuropneumonia in fifteen herds over four periods (Lesnoff et al. 2004): of each herd the cases and
/// the animals in its periods.
const CATTLE: [&[[u64; 2]]; 15] = [
    &[[2, 14], [3, 12], [4, 9], [0, 5]],
    &[[3, 22], [1, 18], [1, 21]],
    &[[8, 22], [2, 16], [0, 16], [2, 20]],
    &[[2, 10], [0, 10], [2, 9], [0, 6]],
    &[[5, 18], [0, 25], [0, 24], [1, 4]],
    &[[3, 17], [0, 17], [0, 18], [1, 20]],
    &[[8, 16], [1, 10], [3, 9], [0, 5]],
    &[[12, 34]],
    &[[2, 9], [0, 6], [0, 8], [0, 6]],
    &[[1, 22], [1, 22], [0, 18], [2, 22]],
    &[[0, 25], [5, 27], [3, 22], [1, 22]],
    &[[2, 10], [1, 8], [0, 6], [0, 5]],
    &[[1, 21], [2, 24], [0, 19], [0, 23]],
    &[[11, 19], [0, 2], [0, 3], [0, 2]],
    &[[1, 19], [1, 15], [1, 15], [0, 15]],
];

/// Herd, cases, animals and period of each row.
fn cattle() -> Vec<[u64; 4]> {
    let of_herd = |(periods, herd): (&'static &[[u64; 2]], u64)| {
        periods.iter().zip(1..).map(move |(&[cases, animals], period)| [herd, cases, animals, period])
    };
    CATTLE.iter().zip(1..).flat_map(of_herd).collect()
}

fn effects(period: u64) -> Vec<f64> {
    let is = |holds: bool| f64::from(u8::from(holds));
    vec![1.0, is(period == 2), is(period == 3), is(period == 4)]
}

#[test]
fn both_models_agree_with_lmertest_and_glmmtmb_on_herds_of_unequal_size() {
    let measured = |[herd, cases, animals, period]: [u64; 4]| MixedModelMeasurement {
        participant: herd as usize - 1,
        effects: effects(period),
        value: ((cases as f64 + 0.5) / animals as f64).ln(),
    };
    let model = LinearMixedModel::fit(&cattle().into_iter().map(measured).collect::<Vec<_>>()).expect("a fit");
    is_close(model.between, 0.143_495_999_1, 1e-4);
    is_close(model.within, 0.640_833_436_0, 1e-4);
    // Estimate, standard error, degrees of freedom, p.
    let wanted = [
        [-1.682_833_127_7, 0.228_667_070_2, 47.606_835_71, 2.171_784e-9],
        [-0.614_735_772_2, 0.298_419_746_8, 39.647_369_30, 4.600_787_3e-2],
        [-0.800_343_234_3, 0.298_419_746_8, 39.647_369_30, 1.061_775_7e-2],
        [-0.697_670_731_6, 0.305_036_112_3, 40.106_997_98, 2.753_794_2e-2],
    ];
    for (index, [estimate, standard_error, df, p]) in wanted.into_iter().enumerate() {
        let weights: Vec<f64> = (0..4).map(|other| f64::from(u8::from(other == index))).collect();
        let found = model.contrast(&weights).expect("a contrast");
        assert!((found.estimate - estimate).abs() < 1e-3 * standard_error, "{index}: {found:?}");
        is_close(found.standard_error, standard_error, 1e-3);
        is_close(found.df, df, 1e-3);
        assert!((found.p - p).abs() < 1e-3 * p.max(1e-3), "{index}: {found:?}");
    }
    let counted = |[herd, count, animals, period]: [u64; 4]| CountObservation {
        participant: herd as usize - 1,
        effects: effects(period),
        count,
        exposure: animals as f64,
    };
    let model = NegativeBinomialModel::fit(&cattle().into_iter().map(counted).collect::<Vec<_>>()).expect("a fit");
    is_close(model.log_likelihood, -87.407_068_596_5, 1e-6);
    is_close(model.between_sd, 0.196_765_355_6, 5e-3);
    is_close(model.size, 2.247_871_7, 5e-3);
    let wanted = [
        [-1.532_737_687, 0.234_154_561_5],
        [-1.003_214_538, 0.385_756_291_6],
        [-1.036_679_563, 0.398_481_314_2],
        [-1.579_245_045, 0.498_993_049_9],
    ];
    for (index, [estimate, standard_error]) in wanted.into_iter().enumerate() {
        let weights: Vec<f64> = (0..4).map(|other| f64::from(u8::from(other == index))).collect();
        let found = model.contrast(&weights).expect("a contrast");
        assert!((found.estimate - estimate).abs() < 1e-3 * standard_error, "{index}: {found:?}");
        is_close(found.standard_error, standard_error, 1e-3);
    }
}

/// The example of Holm's correction: four tests, of which the two least p values stay below .05.
#[test]
fn holms_correction_keeps_the_order_and_never_exceeds_one() {
    let found = holm(&[0.01, 0.04, 0.03, 0.005]);
    for (found, wanted) in found.into_iter().zip([0.03, 0.06, 0.06, 0.02]) {
        is_close(found, wanted, 1e-12);
    }
    assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
    assert_eq!(holm(&[]), Vec::<f64>::new());
}

/// A study whose participants differ, get better from trial to trial, and err in runs; the arms' rates are multiplied by `ratios`.
fn simulated(arms: &[StudyArm], ratios: &[f64], participants: usize, seed: u64) -> Vec<TrialStatistics> {
    let mut random = stream(seed, "study of arms", 0);
    let talent = Normal::new(0.0, 0.3).expect("a spread");
    let runs = Gamma::new(6.0, 1.0 / 6.0).expect("a shape");
    let mut trials = Vec::new();
    for participant in 0..participants {
        let own = f64::exp(talent.sample(&mut random));
        let start = random.random_range(0..arms.len());
        for period in 0..arms.len() {
            let index = (period + start) % arms.len();
            let presses = random.random_range(120..180);
            let rate = 0.12 * own * ratios[index] * 0.9_f64.powi(period as i32);
            let mean = rate * presses as f64 * runs.sample(&mut random);
            let errors = Poisson::new(mean).expect("a mean").sample(&mut random) as u64;
            let trial = in_arm(format!("P{participant:02}"), period as u32 + 1, arms[index], errors);
            trials.push(TrialStatistics { human_presses: presses, ..trial });
        }
    }
    trials
}

const FOUR: [StudyArm; 4] = [StudyArm::None, StudyArm::Wizard, StudyArm::TomCom, StudyArm::Tom];

#[test]
fn the_rates_that_were_put_in_come_out() {
    const STUDIES: usize = 20;
    let [none, wizard, com, tom] = FOUR;
    let pairs = [(wizard, none), (com, none), (tom, none), (com, wizard), (tom, wizard)];
    let ratios = [0.6, 0.6, 0.8, 1.0, 0.8 / 0.6];
    let (mut linear, mut counted, mut covered) = (vec![Vec::new(); 5], vec![Vec::new(); 5], 0);
    for seed in 0..STUDIES as u64 {
        let trials = simulated(&FOUR, &[1.0, 0.6, 0.6, 0.8], 40, seed);
        let found = compare_arms(&trials).expect("a comparison");
        assert_eq!((found.participants, found.trials, found.with_carry_over.len()), (40, 160, 5));
        assert!(found.contrasts.iter().map(|one| (one.arm, one.against)).eq(pairs));
        let counts = found.negative_binomial.expect("a model of counts");
        for (index, ratio) in ratios.into_iter().enumerate() {
            let (one, count) = (&found.contrasts[index], &counts.contrasts[index]);
            assert!(one.p_holm >= one.contrast.p && count.p_holm >= count.contrast.p);
            covered += usize::from(one.interval[0] < ratio && ratio < one.interval[1]);
            linear[index].push(one.contrast.estimate);
            counted[index].push(count.contrast.estimate);
        }
    }
    for (index, ratio) in ratios.into_iter().enumerate() {
        for estimates in [&linear[index], &counted[index]] {
            let mean = estimates.iter().sum::<f64>() / STUDIES as f64;
            let variance = estimates.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (STUDIES - 1) as f64;
            let distance = (mean - f64::ln(ratio)).abs() / (variance / STUDIES as f64).sqrt();
            assert!(distance < 4.0, "{:?}: {} instead of {ratio}", pairs[index], mean.exp());
        }
    }
    // Of 100 intervals of 95 %, at least 88 hold the truth in all but one of several hundred such tests.
    assert!(covered >= 88, "{covered} of 100 intervals hold the truth");
}

/// Two assistants of which one is as good as the wizard, and one is worse by a third.
#[test]
fn an_assistant_is_not_worse_only_if_its_interval_says_so() {
    let trials = simulated(&FOUR, &[1.0, 0.6, 0.55, 0.8], 200, 77);
    let found = compare_arms(&trials).expect("a comparison");
    let holds: Vec<(StudyArm, bool)> = found.non_inferiority.iter().map(|one| (one.arm, one.holds)).collect();
    assert_eq!(holds, [(StudyArm::TomCom, true), (StudyArm::Tom, false)]);
    for one in &found.non_inferiority {
        assert_eq!(one.holds, one.p < 0.025, "{one:?}");
    }
    let strict: Vec<TrialStatistics> = trials
        .into_iter()
        .map(|trial| TrialStatistics { aims: Some(StudyAims { margin: 1.01, ..StudyAims::default() }), ..trial })
        .collect();
    let strict = compare_arms(&strict).expect("a comparison");
    assert_eq!(strict.non_inferiority[0].margin, 1.01, "the plan says what is not worse");
}

#[test]
fn a_repeated_trial_counts_once_and_one_arm_is_no_comparison() {
    let mut trials = simulated(&FOUR[..2], &[1.0, 0.5], 6, 3);
    let before = compare_arms(&trials).expect("a comparison");
    let spoilt = TrialStatistics { errors: 90, ..trials[0].clone() };
    trials.insert(0, spoilt);
    assert_eq!(compare_arms(&trials), Some(before), "the last attempt at a trial counts");
    let alone = simulated(&FOUR[..1], &[1.0], 6, 3);
    assert_eq!(compare_arms(&alone), None);
}

/// Of nine participants one has no trial that counts; of another one, only one counts, which the model uses.
#[test]
fn participants_whom_the_comparison_leaves_out_are_named() {
    let mut trials = simulated(&FOUR[..2], &[1.0, 0.5], 9, 5);
    let name = trials[4].participant.clone();
    for trial in &mut trials[4..7] {
        trial.recording = format!("{}-{}", trial.participant, trial.period.expect("a number"));
        trial.left_out = Some("excluded: ill".to_string());
    }
    let found = compare_arms(&trials).expect("a comparison");
    assert_eq!((found.participants, found.trials), (8, 15));
    let reason = format!("{name}-1: does not count (excluded: ill); {name}-2: does not count (excluded: ill)");
    assert_eq!(found.left_out, [LeftOutParticipant { participant: name, reason }]);
}

#[test]
fn the_letters_of_groups_are_told() {
    let mut trials = simulated(&FOUR[..3], &[1.0; 3], 12, 9703);
    for trial in &mut trials {
        let period = trial.period.expect("a trial");
        // A stands for the plan's first condition.
        let index = FOUR.iter().position(|arm| *arm == trial.planned_arm).expect("an arm") as u32;
        let first = (index + 4 - period) % 3;
        trial.group = Some((0..3).map(|place| ["A", "B", "C"][((first + place) % 3) as usize]).collect());
    }
    let found = compare_arms(&trials).expect("a comparison").groups;
    assert_eq!(found.iter().map(|one| one.participants).sum::<usize>(), 12);
    for one in &found {
        let arm = |letter: char| FOUR[letter as usize - 'A' as usize];
        assert!(one.order.iter().copied().eq(one.group.chars().map(|letter| Some(arm(letter)))), "{one:?}");
    }
    let told: Vec<String> = found.iter().map(|one| one.describe()).collect();
    assert!(told.iter().any(|one| one.starts_with("BCA: wizard, ToM-Com, unassisted (")), "{told:?}");
}
