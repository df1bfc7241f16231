//! What comes next, whatever was recorded, cut or left.

use tomcom_session::plan::{
    NextRecording, ParticipantProgress, PlanRecording, RecordingOutcome, Study, WantedRecording,
};

use super::study;

/// What a recording of P01 might say of itself.
fn made(study: &Study, slot: usize, attempt: u32, outcome: RecordingOutcome) -> PlanRecording {
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt, instructed: slot > 0 });
    let recording = format!("2026-03-14-P01-{slot}{attempt}");
    let step = spec.step.expect("a step of the plan");
    PlanRecording {
        recording,
        code: spec.participant.code,
        recorded_as: None,
        step,
        consent: true,
        instructed: true,
        presses: 20,
        outcome,
    }
}

/// Recordings as slot, attempt and outcome, and what comes next.
fn check_next(recorded: &[(usize, u32, RecordingOutcome)], next: NextRecording) {
    let study = study(|_| ());
    let mut all: Vec<PlanRecording> =
        recorded.iter().map(|(slot, attempt, outcome)| made(&study, *slot, *attempt, outcome.clone())).collect();
    let progress =
        |all: &[PlanRecording]| ParticipantProgress::from_recordings(&study, 0, all).expect("recordings of the plan");
    assert_eq!(progress(&all).next, next, "{recorded:?}");
    all.reverse();
    assert_eq!(progress(&all).next, next, "in whatever order they are found");
    assert_eq!(
        ParticipantProgress::from_recordings(&study, 1, &all).expect("another one").next,
        NextRecording::Begin { slot: 0, attempt: 1 }
    );
}

#[test]
fn what_comes_next_follows_from_the_recordings_alone() {
    let done = RecordingOutcome::Complete;
    let void = || RecordingOutcome::Void { reason: "aborted".to_string() };
    let excluded = || RecordingOutcome::Excluded { reason: "tracker off".to_string() };
    let choose = |slot, attempt: u32| NextRecording::Choose {
        recording: format!("2026-03-14-P01-{slot}{}", attempt - 1),
        slot,
        attempt,
    };
    check_next(&[], NextRecording::Begin { slot: 0, attempt: 1 });
    check_next(&[(0, 1, void())], NextRecording::Begin { slot: 0, attempt: 2 });
    check_next(&[(0, 1, RecordingOutcome::Open)], choose(0, 2));
    check_next(&[(0, 1, void()), (0, 2, done.clone())], NextRecording::Begin { slot: 1, attempt: 1 });
    check_next(&[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open)], choose(1, 2));
    check_next(
        &[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open), (1, 2, void())],
        NextRecording::Begin { slot: 1, attempt: 3 },
    );
    check_next(
        &[(0, 1, done.clone()), (1, 1, RecordingOutcome::Open), (1, 2, done.clone())],
        NextRecording::Begin { slot: 2, attempt: 1 },
    );
    check_next(&[(0, 1, done.clone()), (1, 1, excluded())], NextRecording::Begin { slot: 2, attempt: 1 });
    check_next(&[(0, 1, done.clone()), (1, 1, excluded()), (1, 2, RecordingOutcome::Open)], choose(1, 3));
    check_next(&[(0, 1, done.clone()), (1, 1, done.clone()), (2, 1, done)], NextRecording::Finished);
}

#[test]
fn recordings_of_another_group_are_told_and_not_mixed_in() {
    let study = study(|_| ());
    let mut other = made(&study, 0, 1, RecordingOutcome::Complete);
    other.step.group = if other.step.group == "AB" { "BA" } else { "AB" }.to_string();
    let told = ParticipantProgress::from_recordings(&study, 0, &[other]).expect_err("another group");
    assert!(told.contains("2026-03-14-P01-01") && told.contains("AB") && told.contains("BA"), "{told}");
}
