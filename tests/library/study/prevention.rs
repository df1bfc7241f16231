//! Errors that communications would have prevented or did prevent, useless signals, and concepts compared.

use tomcom_study::live_arms::live_arms;
use tomcom_study::prevention::{
    FalseBeliefGroundTruth, HypotheticalSignal, PressGroundTruth, PreventionCounts, TrialGroundTruth,
};
use tomcom_study::roc::{ConceptPreventionCounts, ConceptTotals, compare};
use tomcom_study::trial_statistics::{SignalSenderWithParameter, TrialStatistics};

use super::{at, near, trial};
use crate::support::*;

/// Ten presses, a second apart. Aspect 0 is believed wrong from 2.5 to 7.5 s and causes the errors at presses 3, 4 and 6; aspect 1
/// is believed wrong from 3.5 s to 5.5 s and causes the error at press 5; aspect 2 is believed wrong from 8.5 s and does no harm.
/// Press 9 is a slip.
fn truth() -> TrialGroundTruth {
    let about = |index: usize| match index {
        3 | 4 | 6 => vec![AspectId(0)],
        5 => vec![AspectId(1)],
        _ => Vec::new(),
    };
    let press = |index: usize| {
        let aspects = about(index);
        PressGroundTruth { time: at(index as f64), error: index == 9 || !aspects.is_empty(), aspects }
    };
    let false_belief = |aspect: u8, began: f64, ended: Option<f64>| FalseBeliefGroundTruth {
        aspect: AspectId(aspect),
        began: at(began),
        ended: ended.map(at),
        harmful: aspect < 2,
    };
    TrialGroundTruth {
        presses: (0..10).map(press).collect(),
        false_beliefs: vec![
            false_belief(0, 2.5, Some(7.5)),
            false_belief(1, 3.5, Some(5.5)),
            false_belief(2, 8.5, None),
        ],
        knows_harmless: true,
    }
}

fn sent(seconds: f64, aspects: &[u8]) -> HypotheticalSignal {
    let aspects = aspects.iter().map(|&aspect| AspectId(aspect)).collect();
    HypotheticalSignal { time: at(seconds), press: seconds as usize + 1, aspects }
}

/// Counts of signals: prevented errors, useless signals, of these inside of episodes, presses right after one, harmless ones.
fn counted(sent: &[HypotheticalSignal]) -> [u64; 5] {
    let count = truth().count_signals(sent);
    assert_eq!((count.signals, count.contents), (sent.len() as u64, sent.len() as u64));
    [
        count.prevented,
        count.useless,
        count.false_inside,
        count.false_presses,
        count.harmless.expect("harmless ones are known"),
    ]
}

#[test]
fn a_signal_prevents_the_later_errors_of_its_own_aspect_and_no_others() {
    let silent =
        PreventionCounts { presses: 10, related: 4, outside: 5, harmless: Some(0), ..PreventionCounts::default() };
    assert_eq!(truth().count_signals(&[]), silent);
    // Before the first error all three of aspect 0, and not the one of aspect 1 in between.
    assert_eq!(counted(&[sent(2.6, &[0])]), [3, 0, 0, 0, 0]);
    assert_eq!(counted(&[sent(3.0, &[0])]), [2, 0, 0, 0, 0]);
    assert_eq!(counted(&[sent(5.2, &[0])]), [1, 0, 0, 0, 0]);
    assert_eq!(counted(&[sent(3.6, &[1])]), [1, 0, 0, 0, 0]);
    // A signal about an order and its recipe tells both aspects.
    assert_eq!(counted(&[sent(3.6, &[0, 1])]), [3, 0, 0, 0, 0]);
}

#[test]
fn a_signal_is_useful_only_as_the_first_about_an_episode_with_an_error_to_follow() {
    // Repeated.
    assert_eq!(counted(&[sent(3.0, &[0]), sent(4.0, &[0])]), [2, 1, 1, 1, 0]);
    // First about aspect 1, though aspect 0 was told before.
    assert_eq!(counted(&[sent(3.0, &[0]), sent(4.0, &[0, 1])]), [3, 0, 0, 0, 0]);
    // After the last error, but while the belief is still false.
    assert_eq!(counted(&[sent(6.5, &[0])]), [0, 1, 1, 1, 0]);
    // Before the belief was false, outside of episodes.
    assert_eq!(counted(&[sent(0.5, &[0])]), [0, 1, 0, 1, 0]);
    // Afterwards; the belief is right again.
    assert_eq!(counted(&[sent(8.2, &[0])]), [0, 1, 0, 1, 0]);
    // About something that is believed right, during an episode.
    assert_eq!(counted(&[sent(4.0, &[3])]), [0, 1, 1, 1, 0]);
    // About what is believed wrong and does no harm; after the last press no press follows.
    assert_eq!(counted(&[sent(8.6, &[2])]), [0, 1, 0, 1, 1]);
    assert_eq!(counted(&[sent(9.6, &[2])]), [0, 1, 0, 0, 1]);
    // Two useless signals before the same press are two signals and one press.
    assert_eq!(counted(&[sent(0.2, &[0]), sent(0.4, &[1])]), [0, 2, 0, 1, 0]);
    let count = truth().count_signals(&[sent(3.0, &[0]), sent(4.0, &[0])]);
    let rates = count.rates().expect("presses and errors");
    assert_eq!((rates.fpr, rates.tpr, rates.signals_per_100), (0.1, 0.5, 20.0));
    assert_eq!(count.useless_share(), Some(0.5));
    assert_eq!(truth().count_signals(&[]).useless_share(), None, "no signals, no share");
}

#[test]
fn the_lead_of_a_signal_is_the_time_until_the_first_error_that_it_prevents() {
    let lead = |signals: &[HypotheticalSignal]| truth().count_signals(signals).lead_s();
    near(lead(&[sent(2.6, &[0])]).expect("useful"), 0.4);
    // The second is useless, and has no lead.
    near(lead(&[sent(2.6, &[0]), sent(4.0, &[0])]).expect("one useful"), 0.4);
    assert_eq!(lead(&[sent(6.5, &[0])]), None, "after the last error");
    assert_eq!(lead(&[]), None);
}

#[test]
fn a_proposal_is_one_interruption_and_useless_if_no_press_that_it_spares_is_an_error() {
    let counts: Vec<[u64; 4]> = (1..=3)
        .map(|k| truth().count_proposals(k))
        .map(|count| [count.signals, count.contents, count.prevented, count.useless])
        .collect();
    // k = 1: at 3 (sparing 4), at 5 (sparing 6), at 9, which no press follows. k = 2: at 3 (4, 5), at 6 (7, 8: no error), at 9.
    // k = 3: at 3 (4, 5, 6), at 9.
    assert_eq!(counts, [[3, 3, 2, 1], [3, 6, 2, 2], [2, 6, 3, 1]]);
    // A spared slip is no false positive.
    let slips = TrialGroundTruth {
        presses: [true, true, false]
            .map(|error| PressGroundTruth { time: at(0.0), error, aspects: Vec::new() })
            .to_vec(),
        false_beliefs: Vec::new(),
        knows_harmless: true,
    };
    let count = slips.count_proposals(1);
    assert_eq!((count.signals, count.prevented, count.useless), (1, 0, 0));
}

#[test]
fn concepts_are_compared_where_they_say_equally_much() {
    let swept = |concept, parameter, signals, prevented, useless| ConceptPreventionCounts {
        concept,
        parameter,
        count: PreventionCounts {
            presses: 100,
            signals,
            related: 10,
            prevented,
            useless,
            ..PreventionCounts::default()
        },
    };
    let participant = vec![
        swept(ConceptName::TomCom, 1.0, 4, 5, 2),
        swept(ConceptName::TomCom, 0.5, 8, 7, 10),
        swept(ConceptName::Tom, 0.9, 8, 4, 10),
        swept(ConceptName::Tom, 0.4, 16, 6, 20),
        swept(ConceptName::Dev, 1.0, 10, 2, 20),
    ];
    let mut totals = ConceptTotals::default();
    ["P1", "P2"].into_iter().for_each(|code| totals.add(code, &participant));
    let found = compare(&totals, 1);
    assert_eq!((found.participants, found.trials), (2, 2));
    near(found.common_fpr.expect("a range"), 0.1);
    let at_equal = |concept: usize| -> Vec<f64> {
        found.concepts[concept].at_equal_signals.iter().map(|one| one.value.expect("a value")).collect()
    };
    // Straight lines from silence to the first point and from point to point.
    for (found, wanted) in at_equal(0).into_iter().zip([0.25, 0.5, 0.6, 0.7]) {
        near(found, wanted);
    }
    for (found, wanted) in at_equal(2).into_iter().zip([0.04, 0.08, 0.12, 0.16]) {
        near(found, wanted);
    }
    // Useless shares: a half at 4 signals, from there to 10 of 8; the share of the straight line.
    let useless: Vec<f64> =
        found.concepts[0].useless_at_equal_signals.iter().map(|one| one.value.expect("a share")).collect();
    for (found, wanted) in useless.into_iter().zip([0.5, 0.5, 1.0, 1.25]) {
        near(found, wanted);
    }
    // From (0, 0) over (0.02, 0.5) to (0.1, 0.7).
    near(found.concepts[0].auc.expect("an area"), (0.5 * 0.02 * 0.5 + 0.08 * 0.6) / 0.1);
    // Two equal participants leave no doubt.
    let banded = found.concepts[0].behind_first[1];
    assert_eq!((banded.low, banded.high), (banded.value, banded.value));
}

/// A trial of 200 presses of the human in an arm, with this number of belief related errors and signals.
fn acting((arm, parameter): (StudyArm, f64), participant: &str, related: u64, signals: u64) -> TrialStatistics {
    let acting = SignalSenderWithParameter::from_settings(arm, parameter);
    let mut trial = TrialStatistics {
        acting,
        signals,
        signal_contents: 2 * signals,
        ..trial(participant, 1, arm.condition(), related)
    };
    let beliefs = trial.beliefs.as_mut().expect("beliefs");
    (beliefs.errors, beliefs.lengths) = (related, vec![related as u32]);
    trial
}

#[test]
fn arms_are_compared_over_the_trials_that_all_of_them_have() {
    let none = (StudyArm::None, 1.5);
    let tom_com = (StudyArm::TomCom, 1.5);
    let tom = (StudyArm::Tom, 0.5);
    let trials = [
        acting(tom, "S001", 5, 40),
        acting(tom, "S002", 5, 60),
        acting(tom_com, "S001", 10, 6),
        acting(tom_com, "S002", 6, 4),
        acting(none, "S001", 20, 0),
        acting(none, "S002", 12, 0),
        // Not in the other arms.
        acting(none, "S003", 90, 0),
    ];
    let all: Vec<&TrialStatistics> = trials.iter().collect();
    let found = live_arms(&all, &[]);
    let names: Vec<(&str, Option<f64>, u64)> =
        found.iter().map(|one| (one.arm.concept, one.arm.parameter, one.trials)).collect();
    assert_eq!(names, [("none", None, 2), ("tom-com", Some(1.5), 2), ("tom", Some(0.5), 2)]);
    let per_100 = |one: usize| found[one].belief_related_per_100.expect("errors");
    near(per_100(0), 8.0);
    near(per_100(1), 4.0);
    near(found[1].prevented.expect("an arm without signals"), 0.5);
    near(found[1].interruptions_per_100.expect("presses"), 2.5);
    near(found[2].interruptions_per_100.expect("presses"), 25.0);
    near(found[2].contents_per_100.expect("presses"), 50.0);
    assert_eq!((found[1].useless_per_100, found[0].useless_share), (None, None), "nobody judged, or no signals");
    near(found[0].useless_per_100.expect("no signals, none useless"), 0.0);
    assert_eq!((found[0].prevented, found[1].prevented_offline), (None, None));
    near(found[0].mean_sequence_length.expect("sequences"), 16.0);
    assert_eq!(found[0].orders, 24);
    near(found[0].orders_per_minute.expect("seconds"), 1.8);
}

#[test]
fn useless_signals_count_where_every_trial_with_signals_was_judged() {
    let arm = |useful: [Option<u64>; 2]| {
        let none = [("S001", 20), ("S002", 12)].map(|(code, related)| acting((StudyArm::None, 1.5), code, related, 0));
        let acted = [("S001", useful[0]), ("S002", useful[1])].map(|(code, useful_signals)| TrialStatistics {
            useful_signals,
            ..acting((StudyArm::TomCom, 1.5), code, 5, 8)
        });
        live_arms(&none.iter().chain(&acted).collect::<Vec<_>>(), &[]).remove(1)
    };
    let judged = arm([Some(6), Some(4)]);
    near(judged.useless_per_100.expect("judged"), 1.5);
    near(judged.useless_share.expect("signals"), 6.0 / 16.0);
    let unknown = arm([Some(6), None]);
    assert_eq!((unknown.useless_per_100, unknown.useless_share), (None, None));
}

#[test]
fn one_arm_or_arms_without_common_trials_are_not_compared() {
    let none = acting((StudyArm::None, 1.5), "S001", 20, 0);
    let tom = acting((StudyArm::Tom, 0.5), "S002", 5, 40);
    assert!(live_arms(&[&none, &none], &[]).is_empty());
    assert!(live_arms(&[&none, &tom], &[]).is_empty());
    // DEV by the number of presses that it proposes.
    let dev = SignalSenderWithParameter::from_settings(StudyArm::Dev, 3.0);
    assert_eq!((dev.concept, dev.parameter), ("dev", Some(3.0)));
}
