//! How far a plan is, from what the recordings say of themselves, and from nothing else: whatever was killed when, the
//! next step follows from what is there.

use serde::Serialize;

use super::planned_study::{Slot, Study, WantedRecording};
use super::step::StepSpec;

/// How a recording ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RecordingOutcome {
    /// Everything was done that it is for.
    Complete,
    /// It was cut, or left before everything was done: it can be continued.
    Open,
    /// It is over, is left out of the analysis, and is not done again: its place in the series was had.
    Excluded { reason: String },
    /// It is over and does not count: it has to be done again.
    Void { reason: String },
}

/// What a recording of a plan says of itself, all its parts together.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRecording {
    /// The name of its last folder.
    pub recording: String,
    /// The participant's code.
    pub code: String,
    pub step: StepSpec,
    /// The participant agreed to be recorded.
    pub consent: bool,
    /// The participant went through the instruction, if there is one.
    pub instructed: bool,
    /// The presses of both agents in its trial.
    pub presses: u32,
    pub outcome: RecordingOutcome,
}

/// What comes next for a participant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum NextRecording {
    /// A new recording.
    Begin {
        slot: usize,
        attempt: u32,
    },
    /// This recording is open: it is continued, or done again as this attempt.
    Choose {
        recording: String,
        slot: usize,
        attempt: u32,
    },
    Finished,
}

impl NextRecording {
    /// The place in the series, from 0; after it, when everything is done.
    pub fn slot(&self) -> Option<usize> {
        match self {
            NextRecording::Begin { slot, .. } | NextRecording::Choose { slot, .. } => Some(*slot),
            NextRecording::Finished => None,
        }
    }
}

/// A place of the series with what was made for it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlotProgress {
    #[serde(flatten)]
    pub slot: Slot,
    pub is_done: bool,
    /// The attempts in turn: recording, and how it ended.
    pub recordings: Vec<Attempt>,
}

/// One attempt at a place of the series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attempt {
    pub recording: String,
    /// 1 the first.
    pub attempt: u32,
    pub presses: u32,
    pub outcome: RecordingOutcome,
    /// It was recorded under another version of the plan.
    pub other_version: bool,
}

/// How far a participant is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Progress {
    pub code: String,
    /// The place in the plan, from 0.
    #[serde(skip)]
    pub participant: usize,
    pub group: String,
    pub consent: bool,
    #[serde(skip)]
    pub instructed: bool,
    pub steps: Vec<SlotProgress>,
    pub next: NextRecording,
}

impl Progress {
    /// The progress of a participant; `made` holds the recordings of the plan, in any order.
    ///
    /// # Errors
    /// In words: a recording that this plan would not have asked for.
    pub fn from_recordings(study: &Study, participant: usize, made: &[PlanRecording]) -> Result<Progress, String> {
        let code = study.plan.code(participant);
        let group = study.group(participant).name;
        let own: Vec<&PlanRecording> = made.iter().filter(|made| made.code == code).collect();
        if let Some(other) = own.iter().find(|made| made.step.group != group) {
            let (recording, recorded) = (&other.recording, &other.step.group);
            return Err(format!("{code} was in group {recorded} in {recording}, and is in {group} now"));
        }
        let slots = study.slots(participant);
        let steps: Vec<SlotProgress> =
            slots.iter().map(|slot| SlotProgress::from_recordings(study, *slot, &own)).collect();
        let next =
            steps.iter().enumerate().find_map(|(index, stand)| stand.next(index)).unwrap_or(NextRecording::Finished);
        let consent = own.iter().any(|made| made.consent);
        let instructed = own.iter().any(|made| made.instructed);
        Ok(Progress { code, participant, group, consent, instructed, steps, next })
    }

    /// The recording that is to be made anew at a place.
    pub fn wanted(&self, slot: usize, attempt: u32) -> WantedRecording {
        WantedRecording { participant: self.participant, slot, attempt, instructed: self.instructed }
    }

    /// What comes next is this place again, whatever was made for it.
    pub fn redo(&mut self, slot: Option<usize>) {
        if let Some((slot, stand)) = slot.and_then(|slot| Some((slot, self.steps.get(slot)?))) {
            self.next = NextRecording::Begin { slot, attempt: stand.attempts() + 1 };
        }
    }

    /// How many places of the series are filled.
    pub fn done(&self) -> usize {
        self.steps.iter().filter(|stand| stand.is_done).count()
    }
}

impl SlotProgress {
    fn from_recordings(study: &Study, slot: Slot, own: &[&PlanRecording]) -> SlotProgress {
        let mut here: Vec<&PlanRecording> =
            own.iter().filter(|made| made.step.period == slot.period).copied().collect();
        here.sort_by(|a, b| (a.step.attempt, &a.recording).cmp(&(b.step.attempt, &b.recording)));
        let attempt = |made: &&PlanRecording| Attempt {
            recording: made.recording.clone(),
            attempt: made.step.attempt,
            presses: made.presses,
            outcome: made.outcome.clone(),
            other_version: made.step.digest != study.digest,
        };
        // A later attempt was asked for by somebody who knew the earlier ones.
        let is_done = here
            .last()
            .is_some_and(|made| matches!(made.outcome, RecordingOutcome::Complete | RecordingOutcome::Excluded { .. }));
        SlotProgress { slot, is_done, recordings: here.iter().map(attempt).collect() }
    }

    /// The number of the last attempt.
    fn attempts(&self) -> u32 {
        self.recordings.last().map_or(0, |last| last.attempt)
    }

    /// What has to be done here; nothing if it is done.
    fn next(&self, slot: usize) -> Option<NextRecording> {
        let attempt = self.attempts() + 1;
        match self.recordings.last() {
            _ if self.is_done => None,
            Some(last) if last.outcome == RecordingOutcome::Open => {
                Some(NextRecording::Choose { recording: last.recording.clone(), slot, attempt })
            }
            _ => Some(NextRecording::Begin { slot, attempt }),
        }
    }
}
