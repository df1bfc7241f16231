//! Trials of the plan that have no recording.

use tomcom_study::frozen_plan::{PlaceInPlan, RecordedPlan};
use tomcom_study::planned_trial::{MissingTrials, in_words, missing_trials};

/// A recording of a participant, by index in the plan, and its trial; `None` for practice. `periods` trials are planned.
fn recording(plan: &str, participant: u32, period: Option<u32>, periods: u32) -> RecordedPlan {
    RecordedPlan {
        participant: format!("P{:02}", participant + 1),
        plan: Some((plan.to_string(), format!("digest of {plan}"))),
        place: Some(PlaceInPlan { participant: Some(participant), period, periods }),
    }
}

fn trials(participants: std::ops::Range<u32>) -> Vec<RecordedPlan> {
    participants.flat_map(|index| (1..=2).map(move |period| recording("short", index, Some(period), 2))).collect()
}

#[test]
fn a_whole_study_misses_nothing_and_a_lost_recording_is_named() {
    let mut all = trials(0..4);
    assert_eq!((missing_trials(&all), in_words(&[])), (Vec::new(), None));
    all.remove(3);
    let missing = missing_trials(&all);
    let second = |trials: &[u32]| MissingTrials {
        plan: "short".to_string(),
        participant: Some(2),
        code: Some("P02".to_string()),
        trials: trials.to_vec(),
    };
    assert_eq!(missing, [second(&[2])]);
    assert_eq!(in_words(&missing).as_deref(), Some("1 trial of the plan has no recording: P02 trial 2"));
    // Practice is no trial; a trial that was done twice is one.
    all.retain(|one| one.participant != "P02");
    all.push(recording("short", 1, None, 2));
    all.extend(trials(3..4));
    assert_eq!(missing_trials(&all), [second(&[1, 2])]);
}

#[test]
fn participants_without_a_recording_are_found_before_the_last_and_plans_are_told_apart() {
    let mut all = trials(2..3);
    all.push(recording("other", 0, Some(3), 3));
    all.push(RecordedPlan { participant: "P01".to_string(), plan: None, place: None });
    // A tutorial alone has no trials.
    all.push(recording("short-tutorial", 0, None, 0));
    let missing = missing_trials(&all);
    assert_eq!(
        in_words(&missing).as_deref(),
        Some(
            "6 trials of the plan have no recording: P01 trials 1, 2; participant 1 trials 1, 2; participant 2 trials 1, 2"
        )
    );
    assert_eq!((missing[0].plan.as_str(), missing[1].plan.as_str(), &missing[1].code), ("other", "short", &None));
    let words = in_words(&missing_trials(&trials(20..21))).expect("missing");
    assert!(words.starts_with("40 trials of the plan have no recording: participant 1 trials 1, 2; "), "{words}");
    assert!(words.ends_with("participant 8 trials 1, 2; and of 12 more participants"), "{words}");
}

#[test]
fn a_recording_whose_code_was_corrected_is_of_the_participant_who_has_the_code() {
    // The second participant's first trial was that of the third one, whose second trial is there, too.
    let corrected = |code: &str, period: u32| RecordedPlan {
        participant: code.to_string(),
        place: Some(PlaceInPlan { participant: None, period: Some(period), periods: 2 }),
        ..recording("short", 1, Some(period), 2)
    };
    let mut all = trials(0..1);
    all.extend([corrected("P03", 1), recording("short", 1, Some(2), 2), recording("short", 2, Some(2), 2)]);
    let missing = missing_trials(&all);
    assert_eq!(in_words(&missing).as_deref(), Some("1 trial of the plan has no recording: P02 trial 1"));
    all.push(corrected("P09", 2));
    let missing = missing_trials(&all);
    assert_eq!(in_words(&missing).as_deref(), Some("2 trials of the plan have no recording: P02 trial 1; P09 trial 1"));
    assert_eq!(missing[1].participant, None, "its number in the plan is not known");
}
