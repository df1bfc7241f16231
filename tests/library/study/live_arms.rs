//! Concepts that acted by themselves on the same seeds.

use tomcom_session::study_arm::StudyArm;
use tomcom_study::live_arms::live_arms;
use tomcom_study::trial_statistics::SignalSenderWithParameter;
use tomcom_study::trial_statistics::TrialStatistics;

use super::{near, trial};

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
