//! The effect of assistance, against values of other programs.

use tomcom_study::effect::{effect, left_out_in_words, pairs};
use tomcom_study::facts::RecordingFacts;
use tomcom_study::figures::StudySummary;
use tomcom_study::pass::describe;
use tomcom_study::report;
use tomcom_study::statistics::{hodges_lehmann, permutation_p};
use tomcom_study::tables::trials::HEADLINE;
use tomcom_study::trial_statistics::{DetailTotals, TrialStatistics, arrange};

use super::{near, summary, trial, trials};
use crate::support::*;

/// Unequal groups, with ties; the figures are those of afex 1.2-1 (type III), pingouin 0.7.0 and SciPy 1.17.1.
#[test]
fn the_assistance_effect_is_that_of_other_programs() {
    let trials = trials(&[[24, 12], [30, 16], [18, 16], [40, 22], [22, 10]], &[[20, 18], [16, 16], [28, 20], [24, 24]]);
    let found = effect(HEADLINE, pairs(&trials, HEADLINE), 1);
    assert_eq!((found.groups, &found.left_out[..]), ([5, 4], &[][..]));
    let test = found.assistance().expect("a test");
    near(test.f, 7.070008537626539);
    near((test.p * 1e6).round(), 32517.0);
    // With the weights of the groups' sizes it would be 19.739: that mixes assistance into the period.
    let period = found.by_period.within.expect("a test");
    near((period.f * 1e6).round(), 16_973_655.0);
    near((period.p * 1e6).round(), 4460.0);
    near((period.partial_eta_sq * 1e6).round(), 708_013.0);
    assert_eq!((period.n, period.df), (9, [1.0, 7.0]));
    let between = found.by_period.between.expect("a test");
    near((between.f * 1e6).round(), 4843.0);
    let pearson = found.pearson.expect("a correlation");
    near(pearson.r, 0.7088637838665972);
    near(pearson.p, 0.03251668103330254);
    near(found.permutation_p.expect("a p"), 0.047619047619047616);
    near(found.hedges_g.expect("an effect"), 1.5854907169007093);
    // Half the shift.
    near(found.reduction.expect("an estimate").estimate, 0.0275);
    // The paper's coding tests the same, also of groups of unequal size.
    near(found.by_condition.within.expect("a test").f, test.f);
    near(found.by_condition.interaction.expect("a test").f, period.f);
}

/// Values that differ by the group alone, 10 and 3 of 20: the period has no effect, however unequal the groups are.
#[test]
fn the_period_does_not_contain_the_assistance_where_groups_are_unequal() {
    let noise = |index: u64| (index * 7 + 3) % 5;
    let second: Vec<[u64; 2]> = (0..10).map(|index| [30 + noise(index), 20 + noise(index + 1)]).collect();
    let first: Vec<[u64; 2]> = (0..10).map(|index| [20 + noise(index), 30 + noise(index + 1)]).collect();
    let mut trials = trials(&second, &first);
    // With ten each, the period's effect is that of the noise; dropping seven of one group must not make one.
    let period = |trials: &[TrialStatistics]| {
        let found = effect(HEADLINE, pairs(trials, HEADLINE), 1);
        (found.by_period.within.expect("a test").p, found)
    };
    assert!(period(&trials).0 > 0.5);
    for trial in trials.iter_mut().filter(|trial| trial.participant.starts_with('B') && trial.period == Some(2)) {
        if trial.participant.as_str() >= "B3" {
            trial.left_out = Some("excluded: the tracker slipped".to_string());
        }
    }
    let (p, found) = period(&trials);
    assert!(p > 0.05, "p of the period {p}");
    assert_eq!((found.groups, found.assistance().expect("a test").n), ([10, 3], 13));
    let codes: Vec<&str> = found.left_out.iter().map(|one| one.participant.as_str()).collect();
    assert_eq!(codes, ["B3", "B4", "B5", "B6", "B7", "B8", "B9"]);
    let words = "B3, B4, B5, B6, B7, B8, B9 (trial 2 does not count (excluded: the tracker slipped))";
    assert_eq!(left_out_in_words(&found.left_out).as_deref(), Some(words));
    // In the printed summary and in the report, too.
    let summary = summary(&trials);
    let text = describe(&summary);
    assert!(text.contains("13 participants: 10 assisted in the second trial, 3 in the first; left out: B3"), "{text}");
    let page = report::page(&summary, &trials, &RecordingFacts::default(), &[]);
    assert!(page.contains("Left out of the tests of errors per press of the human") && page.contains(words), "{page}");
    assert!(page.contains("secondary: in 13 participants "), "{page}");
}

/// A crossover of 14 in which the wizard of one trial was shown what the assistants would send.
#[test]
fn an_unblinded_trial_counts_in_the_planned_arm_and_is_listed() {
    let second: Vec<[u64; 2]> = (0..7).map(|index| [24 + index, 12 + index % 3]).collect();
    let mut trials = trials(&second, &second);
    let planned = summary(&trials);
    assert!(planned.deviations.is_empty() && planned.as_carried_out.is_none());
    let unblinded = trials.iter_mut().find(|trial| trial.planned_arm == StudyArm::Wizard).expect("a trial");
    (unblinded.study_arm, unblinded.wizard_saw_advice) = (StudyArm::WizardWithAdvice, true);
    let recording = unblinded.recording.clone();
    let found = summary(&trials);
    assert!(found.anova.is_some() && found.pearson.is_some() && found.permutation_p.is_some());
    assert_eq!((&found.anova, &found.pearson, &found.effects), (&planned.anova, &planned.pearson, &planned.effects));
    assert_eq!((&found.arms, &found.conditions), (&planned.arms, &planned.conditions));
    let [deviation] = &found.deviations[..] else { panic!("{:?}", found.deviations) };
    assert_eq!((&deviation.recording, deviation.unblinded), (&recording, true));
    assert_eq!((deviation.planned, deviation.carried_out), (StudyArm::Wizard, StudyArm::WizardWithAdvice));
    // Beside it, by what was done: three arms, for which there is no paired test.
    let carried_out = found.as_carried_out.as_ref().expect("a deviation");
    assert_eq!(carried_out.conditions.iter().map(|one| one.trials).collect::<Vec<_>>(), [14, 13, 1]);
    assert!(carried_out.effects.iter().all(|effect| !effect.has_pairs()));
    assert_eq!(carried_out.arms.as_ref().expect("a comparison").arms.len(), 3);
    let words = format!(
        "{recording}: planned wizard, carried out wizard with advice, since the wizard was shown what the assistants would send"
    );
    let text = describe(&found);
    assert!(text.contains(&format!("counted in the planned condition: {words}\n")), "{text}");
    assert!(text.contains("by the conditions as carried out:\n"), "{text}");
    let page = report::page(&found, &trials, &RecordingFacts::default(), &[]);
    assert!(page.contains("Does assistance help?") && page.contains("Deviations from the plan"), "{page}");
    assert!(page.contains(&words), "{page}");
}

#[test]
fn what_is_missing_leaves_the_participant_out_of_the_pairs_and_nothing_is_invented() {
    let mut trials = trials(&[[24, 12], [30, 16]], &[[20, 18], [16, 16]]);
    trials[0].left_out = Some("excluded: the tracker slipped".to_string());
    let paired = pairs(&trials, HEADLINE);
    assert_eq!((paired.pairs.len(), paired.left_out.len()), (3, 1));
    assert_eq!(paired.left_out[0].reason, "trial 1 does not count (excluded: the tracker slipped)");
    let figures = summary(&trials);
    assert_eq!((figures.trials, figures.participants, figures.left_out.len()), (7, 4, 1));
    // A second trial that was done again counts as it was done the last time.
    let mut again = trial("A1", 2, Condition::Wizard, 2);
    again.recording = "A1-2-again".to_string();
    trials.push(again);
    arrange(&mut trials);
    let pair = pairs(&trials, HEADLINE).pairs.into_iter().find(|pair| pair.participant == "A1").expect("a pair");
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

#[test]
fn trials_with_different_human_models_are_told() {
    let told = |trials: &[TrialStatistics]| {
        let figures = summary(trials);
        describe(&figures)
    };
    let mut trials = trials(&[[8, 4]], &[[3, 9]]);
    assert!(!told(&trials).contains("models of the human"), "{}", told(&trials));
    trials[0].human_model = "paper-2021".to_string();
    let wanted = "the assistant had different models of the human: 1 trial with paper-2021, 3 trials with plain\n";
    assert!(told(&trials).contains(wanted), "{}", told(&trials));
}
