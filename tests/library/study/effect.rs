//! The effect of assistance, against values of other programs.

use tomcom::session::settings::Condition;
use tomcom::study::detail_totals::DetailTotals;
use tomcom::study::effect::{effect, pairs};
use tomcom::study::facts::RecordingFacts;
use tomcom::study::figures::StudySummary;
use tomcom::study::statistics::{hodges_lehmann, mixed_anova, permutation_p};
use tomcom::study::tables::trials::HEADLINE;
use tomcom::study::trial_statistics::arrange;

use super::{near, trial, trials};

/// Unequal groups, with ties; the figures are those of pingouin 0.7.0 and SciPy 1.17.1.
#[test]
fn the_assistance_effect_is_that_of_other_programs() {
    let trials = trials(&[[24, 12], [30, 16], [18, 16], [40, 22], [22, 10]], &[[20, 18], [16, 16], [28, 20], [24, 24]]);
    let found = effect(HEADLINE, &pairs(&trials, HEADLINE), 1);
    assert_eq!(found.groups, [5, 4]);
    let test = found.assistance().expect("a test");
    near(test.f, 7.070008537626539);
    near((test.p * 1e6).round(), 32517.0);
    near((found.by_period.within.expect("a test").f * 1e6).round(), 19738993.0);
    let pearson = found.pearson.expect("a correlation");
    near(pearson.r, 0.7088637838665972);
    near(pearson.p, 0.03251668103330254);
    near(found.permutation_p.expect("a p"), 0.047619047619047616);
    near(found.hedges_g.expect("an effect"), 1.5854907169007093);
    // Half the shift.
    near(found.reduction.expect("an estimate").estimate, 0.0275);
    // Of groups of equal size the paper's coding tests the same.
    let equal: Vec<(usize, [f64; 2])> =
        pairs(&trials, HEADLINE)[1..].iter().map(|p| (usize::from(p.assisted_second), p.values)).collect();
    let turned: Vec<(usize, [f64; 2])> =
        equal.iter().map(|&(group, [a, b])| (group, if group == 1 { [a, b] } else { [b, a] })).collect();
    near(mixed_anova(&turned).within.expect("a test").f, mixed_anova(&equal).interaction.expect("a test").f);
}

#[test]
fn what_is_missing_leaves_the_participant_out_of_the_pairs_and_nothing_is_invented() {
    let mut trials = trials(&[[24, 12], [30, 16]], &[[20, 18], [16, 16]]);
    trials[0].left_out = Some("excluded: the tracker slipped".to_string());
    assert_eq!(pairs(&trials, HEADLINE).len(), 3);
    let figures = StudySummary::from_trials(&trials, DetailTotals::default(), &RecordingFacts::default(), 0);
    assert_eq!((figures.trials, figures.participants, figures.left_out.len()), (7, 4, 1));
    // A second trial that was done again counts as it was done the last time.
    let mut again = trial("A1", 2, Condition::Wizard, 2);
    again.recording = "A1-2-again".to_string();
    trials.push(again);
    arrange(&mut trials);
    let pair = pairs(&trials, HEADLINE).into_iter().find(|pair| pair.participant == "A1").expect("a pair");
    near(pair.values[1], 0.01);
    let nobody = StudySummary::from_trials(&[], DetailTotals::default(), &RecordingFacts::default(), 0);
    assert!(nobody.anova.is_none() && nobody.pearson.is_none() && nobody.permutation_p.is_none());
    assert!(nobody.totals.error_rate.is_none() && nobody.totals.belief_related_share.is_none());
    assert_eq!((permutation_p(&[], &[1.0], 1), hodges_lehmann(&[], &[1.0], 0.95)), (None, None));
}

/// The interval leaves out as many differences as P(U <= u) allows: of groups of 5 and 4, U is 0 or 1 in 2 of 126 orders,
/// and at most 2 in 4 of them.
#[test]
fn the_interval_of_the_shift_follows_from_the_distribution_of_u() {
    let (a, b) = ([1.0, 2.0, 4.0, 8.0, 16.0], [0.0, 0.5, 0.25, 0.125]);
    let mut differences: Vec<f64> = a.iter().flat_map(|a| b.iter().map(move |b| a - b)).collect();
    differences.sort_by(f64::total_cmp);
    let found = hodges_lehmann(&a, &b, 0.95).expect("an interval");
    near(found.level, 1.0 - 2.0 * 2.0 / 126.0);
    assert_eq!((found.low, found.high), (differences[1], differences[18]));
}

/// Groups of 250 have the exact distribution of U, larger ones its normal approximation: the interval must not jump.
#[test]
fn large_groups_have_nearly_the_interval_of_the_exact_distribution() {
    let interval = |size: usize| {
        let values: Vec<f64> = (0..size).map(|value| value as f64 / size as f64).collect();
        hodges_lehmann(&values, &values, 0.95).expect("an interval")
    };
    let [exact, approximate] = [250, 251].map(interval);
    for found in [exact, approximate] {
        near(found.low, -found.high);
        assert!((found.level - 0.95).abs() < 1e-4, "covers {}", found.level);
    }
    assert!((exact.high - approximate.high).abs() < 0.005, "{} and {}", exact.high, approximate.high);
    assert!(exact.high > 0.04 && exact.high < 0.06, "1.96 standard errors are 0.0507, found {}", exact.high);
}
