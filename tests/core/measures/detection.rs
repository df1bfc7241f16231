//! How well an estimate finds false beliefs: areas under the curve, calibration, thresholds.

use tomcom_core::base::maths::regularized_incomplete_beta;
use tomcom_core::kitchen::{ButtonId, Kitchen};
use tomcom_core::measures::detection::{
    BeliefsBeforePress, Calibration, EstimateBeforePress, FalseBeliefDetection, TrialBeliefs, aspect_groups, auc,
};
use tomcom_core::measures::flags::{FlagThresholds, ThresholdChoice, ThresholdSource, chosen_thresholds};
use tomcom_core::mind::{AspectEstimate, RecordedEstimate};

use super::aspect;
use crate::files::kitchen;

#[test]
fn the_area_under_the_roc_counts_pairs_in_order_and_ties_as_half() {
    let check = |cases: &[f64], others: &[f64], expected: Option<f64>| {
        let scored: Vec<(f64, bool)> =
            cases.iter().map(|&score| (score, true)).chain(others.iter().map(|&score| (score, false))).collect();
        assert_eq!(auc(&scored), expected, "{cases:?} against {others:?}");
    };
    check(&[0.9, 0.8], &[0.1, 0.2, 0.3], Some(1.0));
    check(&[0.1], &[0.9], Some(0.0));
    check(&[0.5, 0.5], &[0.5], Some(0.5));
    // Pairs in order: 0.9 beats all three; 0.4 beats 0.1, ties with 0.4, loses to 0.6: 4.5 of 6.
    check(&[0.4, 0.9], &[0.1, 0.4, 0.6], Some(0.75));
    check(&[], &[0.5], None);
    check(&[0.5], &[], None);
}

#[test]
fn the_calibration_error_weighs_bins_by_their_predictions() {
    let predictions = [(0.62, true), (0.68, false), (0.15, false), (0.01, true), (0.99, false)];
    let found = Calibration::from_predictions(predictions, [0.0, 0.95], 19);
    // Bins of 0.05: 0.62 in one, 0.68 in another, 0.15 (on the edge) in a third, 0.01 in the first; 0.99 is out of range.
    assert!((found.ece.expect("predictions") - (0.38 + 0.68 + 0.15 + 0.99) / 4.0).abs() < 1e-12, "{found:?}");
    let found = Calibration::from_predictions(predictions, [0.05, 0.95], 2);
    // From 0.05 to 0.5: 0.15, none true; from 0.5 to 0.95: 0.62 and 0.68, half of them true.
    assert!((found.ece.expect("predictions") - (0.15 + 2.0 * 0.15) / 3.0).abs() < 1e-12, "{found:?}");
    assert_eq!(Calibration::from_predictions([(0.99, true)], [0.05, 0.95], 10).ece, None);
}

/// A trial about the pot and a recipe: letters of the pot, then of the recipe, then the estimates in tenths.
/// `.` is believed right, `w` wrong, `E` wrong and the reason of an error.
fn trial(kitchen: &Kitchen, text: [&str; 4]) -> TrialBeliefs {
    let aspects = ["cooking_pot", "recipe of crab maki"].map(|name| aspect(kitchen, name));
    let letters: Vec<Vec<char>> = text.iter().map(|letters| letters.chars().collect()).collect();
    let press = |index: usize| {
        let (mut held, mut p_false) = (vec![0.9; kitchen.aspects.len()], vec![0.0; kitchen.aspects.len()]);
        let mut errs_about = Vec::new();
        for (group, aspect) in aspects.into_iter().enumerate() {
            if letters[group][index] != '.' {
                held[aspect.index()] = 0.2;
            }
            if letters[group][index] == 'E' {
                errs_about.push(aspect);
            }
            let tenths = letters[group + 2][index].to_digit(10).expect("a digit");
            p_false[aspect.index()] = f64::from(tenths) / 10.0;
        }
        BeliefsBeforePress {
            state: kitchen.empty_state(),
            button: ButtonId(0),
            held: Some(held),
            estimate: Some(EstimateBeforePress { p_false, log_p: -1.0 }),
            unseen_change: vec![false; kitchen.locations.len()],
            since_change_s: vec![None; kitchen.locations.len()],
            errs_about,
        }
    };
    (0..letters[0].len()).map(press).collect()
}

/// A trial judged with the thresholds that are best on this trial.
fn judged_on_itself(kitchen: &Kitchen, trial: TrialBeliefs) -> FalseBeliefDetection {
    let trials = [trial];
    let best = chosen_thresholds(&trials, &aspect_groups(kitchen)).map(ThresholdChoice::Given);
    FalseBeliefDetection::from_trials(kitchen, &trials, best)
}

#[test]
fn flags_catch_an_episode_between_its_beginning_and_the_third_error() {
    let kitchen = kitchen("sushi");
    let check = |text: [&str; 4], episodes: u64, caught: Option<f64>, false_flags: f64| {
        let trials = [trial(&kitchen, text)];
        let thresholds = FlagThresholds { locations: 0.5, recipes: 0.3 };
        let flags =
            FalseBeliefDetection::from_trials(&kitchen, &trials, Some(ThresholdChoice::Given(thresholds))).flags;
        assert_eq!((flags.episodes, flags.flagged_before_third_error), (Some(episodes), caught), "{text:?}");
        let rate = 20.0 * false_flags / text[0].len() as f64;
        assert!((flags.false_flags_per_20_actions.expect("a rate") - rate).abs() < 1e-12, "{text:?}: {flags:?}");
    };
    // One error makes no episode of two; a flag before the belief is false is a false one; one that stays is raised once.
    check([".wE..", ".....", "08800", "00000"], 0, None, 0.0);
    check(["..EE.", ".....", "88880", "00000"], 1, Some(1.0), 1.0);
    check(["..EE.", ".....", "88000", "00000"], 1, Some(0.0), 1.0);
    // Before the third error counts, from then on not.
    check(["EEEw.", ".....", "00800", "00000"], 1, Some(1.0), 0.0);
    check(["EEEw.", ".....", "00080", "00000"], 1, Some(0.0), 0.0);
    // Without a third error, until it is over; each group has its own threshold.
    check(["EEww.", "EwwE.", "00040", "00400"], 2, Some(0.5), 0.0);
    // A flag that was right and stays too long is not raised again; one that comes back is.
    check(["EE...", ".....", "88808", "00000"], 1, Some(1.0), 1.0);
}

#[test]
fn thresholds_are_chosen_that_catch_most_within_what_is_allowed() {
    let kitchen = kitchen("sushi");
    let quiet = ".".repeat(60);
    let zero = "0".repeat(60);
    let text = [&format!("{quiet}EEw."), &format!("{quiet}...."), &format!("{zero}0702"), &format!("{zero}0000")];
    let found = judged_on_itself(&kitchen, trial(&kitchen, text.map(String::as_str)));
    let flags = &found.flags;
    assert_eq!((flags.episodes, flags.flagged_before_third_error), (Some(1), Some(1.0)), "{flags:?}");
    assert_eq!(
        flags.false_flags_per_20_actions,
        Some(0.0),
        "of the thresholds that catch it the one without false flags"
    );
    let thresholds = flags.thresholds.expect("thresholds");
    assert!(thresholds.locations > 0.2 && thresholds.locations <= 0.7, "{thresholds:?}");
    // Of the pairs of a press and a location three were wrong, at 0, 0.7 and 0; all others are at 0 but one at 0.2.
    let others = (64 * kitchen.locations.len() - 3) as f64;
    let area = (others + 0.5 * (others - 1.0) + 0.5 * (others - 1.0)) / (3.0 * others);
    assert!((found.auc_locations.expect("an area") - area).abs() < 1e-12, "{:?} or {area}", found.auc_locations);
    let of_pot = (61.0 + 0.5 * 60.0 + 0.5 * 60.0) / (3.0 * 61.0);
    assert!((found.auc_mean_of_aspects.expect("an area") - of_pot).abs() < 1e-12, "{found:?}");
    assert_eq!((found.auc, found.auc_recipes), (found.auc_locations, None));
    assert_eq!(found.auc_baseline, Some(0.5), "nothing ever changed unseen");
    assert_eq!(found.auc_recency, Some(0.5), "nobody else ever changed anything");
}

#[test]
fn what_may_be_flagged_wrongly_is_a_share_of_the_time_of_all_aspects_together() {
    let kitchen = kitchen("sushi");
    let of = |doubted: usize| {
        let (right, known) = (".".repeat(64), "0".repeat(66));
        let estimates = format!("{}{}33", "0".repeat(64 - doubted), "3".repeat(doubted));
        let text = [&format!("{right}.."), &format!("{right}EE"), &known, &estimates];
        judged_on_itself(&kitchen, trial(&kitchen, text.map(String::as_str))).flags
    };
    // 66 presses and 16 aspects: 1,056 pairs, of which 52 may be flagged wrongly; of the recipes' alone 5 % were 19.
    assert_eq!(of(40).flagged_before_third_error, Some(1.0));
    assert_eq!(of(60).flagged_before_third_error, Some(0.0));
}

/// Two participants with two trials each: a participant's trials are in one half, whatever their order.
#[test]
fn thresholds_are_judged_on_the_other_half_of_the_participants() {
    let kitchen = kitchen("sushi");
    let zero = "0".repeat(64);
    let one = |doubted: &str, estimates: &str| {
        let quiet = ".".repeat(60);
        let text = [&format!("{quiet}EEw."), &".".repeat(64), &format!("{doubted:0<60}{estimates}"), &zero];
        trial(&kitchen, text.map(String::as_str))
    };
    // The first participant's episodes are found from 0.7 on, and right beliefs are doubted with 0.3; the second's from 0.2 on.
    let (high, low) = (one("0333", "0700"), one("", "0200"));
    let flags = |trials: &[TrialBeliefs], choice: ThresholdChoice| {
        FalseBeliefDetection::from_trials(&kitchen, trials, Some(choice)).flags
    };
    let judge = |judged: &TrialBeliefs, chosen_on: &TrialBeliefs| {
        let best = chosen_thresholds(&[chosen_on.clone(), chosen_on.clone()], &aspect_groups(&kitchen));
        let found = flags(&[judged.clone(), judged.clone()], ThresholdChoice::Given(best.expect("known")));
        assert_eq!(found.thresholds_from, Some(ThresholdSource::OtherRecordings));
        found.flagged_before_third_error.expect("episodes")
    };
    let wanted = (judge(&high, &low) + judge(&low, &high)) / 2.0;
    assert_eq!((judge(&low, &low), judge(&low, &high)), (1.0, 0.0), "a threshold that suits the one misses the other");
    for (trials, participants) in [
        ([high.clone(), high.clone(), low.clone(), low.clone()], [0, 0, 1, 1]),
        ([high.clone(), low.clone(), high.clone(), low.clone()], [0, 1, 0, 1]),
        ([low.clone(), high.clone(), high.clone(), low.clone()], [7, 3, 3, 7]),
    ] {
        let found = flags(&trials, ThresholdChoice::CrossFitted(&participants));
        assert_eq!(found.thresholds_from, Some(ThresholdSource::OtherHalf));
        assert_eq!((found.episodes, found.flagged_before_third_error), (Some(4), Some(wanted)), "{participants:?}");
    }
    // One participant with two trials: what is chosen on the one is not judged on the other.
    let found = flags(&[high, low], ThresholdChoice::CrossFitted(&[0, 0]));
    assert_eq!(found.thresholds_from, Some(ThresholdSource::OneParticipant));
    assert_eq!((found.episodes, found.flagged_before_third_error), (Some(2), None));
    assert_eq!((found.false_flags_per_20_actions, found.wrongly_flagged), (None, None));
    assert!(found.thresholds.is_some());
}

#[test]
fn calibration_judges_the_probability_that_the_belief_in_the_truth_is_below_one_half() {
    // I_.5 by closed forms: symmetric parameters, a = 1 or b = 1, and whole numbers (a sum of binomials).
    let check = |a: f64, b: f64, wanted: f64| {
        let found = regularized_incomplete_beta(0.5, a, b);
        // ln Gamma(10,000) is about 82,000, so its last digits are worth 1e-11.
        assert!((found - wanted).abs() < 1e-10, "I_.5({a}, {b}) = {found}, not {wanted}");
    };
    for symmetric in [0.001, 0.3, 1.0, 7.5, 5000.0] {
        check(symmetric, symmetric, 0.5);
    }
    for exponent in [0.01_f64, 0.5, 2.0, 30.0] {
        check(exponent, 1.0, 0.5_f64.powf(exponent));
        check(1.0, exponent, 1.0 - 0.5_f64.powf(exponent));
    }
    check(2.0, 3.0, 11.0 / 16.0);
    check(5.0, 3.0, 29.0 / 128.0);
    check(0.5, 1.5, 0.5 + 1.0 / std::f64::consts::PI);
    check(0.0, 2.0, 1.0);
    check(2.0, 0.0, 0.0);
    // Somebody who holds one value for certain, the truth with probability 0.7: alphas near 0. The expected belief beside the truth
    // is 0.3 at every precision; the probability of a false belief is 0.3 only here, and near 0 if the belief itself is 0.7.
    let witness = |precision: f64| RecordedEstimate {
        press: 1,
        log_p: -1.0,
        effective: 64.0,
        aspects: vec![AspectEstimate {
            aspect: "cooking_pot".to_string(),
            believes: "empty".to_string(),
            p_truth: 0.7,
            precision,
            values: [("empty".to_string(), 0.7)].into(),
        }],
    };
    let view = |precision: f64| EstimateBeforePress::from_witness(&witness(precision));
    assert!((view(0.001).p_false[0] - 0.3).abs() < 1e-3, "{:?}", view(0.001));
    assert!(view(200.0).p_false[0] < 1e-6, "{:?}", view(200.0));
}
