//! Progress of a study plan, computed from the recordings alone, so that the next step is correct after a crash at any time.

use serde::Serialize;

use super::planned_study::{Slot, Study, WantedRecording};
use super::step::StepSpec;

/// Outcome of a recording of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RecordingOutcome {
    /// Complete: all its phases are done.
    Complete,
    /// Unfinished: cut off or left early; it can be continued.
    Open,
    /// Finished and excluded from the analysis, but not repeated.
    Excluded {
        /// Why it is left out.
        reason: String,
    },
    /// Finished and invalid: it must be repeated.
    Void {
        /// Why it does not count.
        reason: String,
    },
}

/// Facts about a recording of a plan, all its parts together.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRecording {
    /// The name of its last folder.
    pub recording: String,
    /// The participant's code.
    pub code: String,
    /// Its place in the plan.
    pub step: StepSpec,
    /// Whether the participant consented.
    pub consent: bool,
    /// Whether the participant completed the instruction, if there is one.
    pub instructed: bool,
    /// The presses of both agents in its trial.
    pub presses: u32,
    /// How it ended.
    pub outcome: RecordingOutcome,
}

/// The next recording of a participant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum NextRecording {
    /// A new recording.
    Begin {
        /// The index of the place in the series that it is for.
        slot: usize,
        /// Which attempt at that place it is, counted from 1.
        attempt: u32,
    },
    /// An unfinished recording, which is continued or repeated as this attempt.
    Choose {
        /// The name of the open recording's folder.
        recording: String,
        /// The index of its place in the series.
        slot: usize,
        /// The attempt that doing it again would be, counted from 1.
        attempt: u32,
    },
    /// Nothing: the participant has had everything.
    Finished,
}

impl NextRecording {
    /// Index of the slot; `None` when all slots are done.
    pub fn slot(&self) -> Option<usize> {
        match self {
            NextRecording::Begin { slot, .. } | NextRecording::Choose { slot, .. } => Some(*slot),
            NextRecording::Finished => None,
        }
    }
}

/// A slot of the series with its attempts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlotProgress {
    /// The place.
    #[serde(flatten)]
    pub slot: Slot,
    /// A recording fills it.
    pub is_done: bool,
    /// Attempts in order.
    pub recordings: Vec<Attempt>,
}

/// One attempt at a slot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attempt {
    /// The name of the recording's last folder.
    pub recording: String,
    /// Number of the attempt, from 1.
    pub attempt: u32,
    /// Presses of both agents in its trial.
    pub presses: u32,
    /// How it ended.
    pub outcome: RecordingOutcome,
    /// Whether it was recorded under another version of the plan.
    pub other_version: bool,
}

/// Progress of one participant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// The participant's code.
    pub code: String,
    /// Index of the participant in the plan.
    #[serde(skip)]
    pub participant: usize,
    /// The name of the starting group.
    pub group: String,
    /// The participant agreed to be recorded.
    pub consent: bool,
    /// The participant went through the instruction, if there is one.
    #[serde(skip)]
    pub instructed: bool,
    /// The places of the series, in their order.
    pub steps: Vec<SlotProgress>,
    /// What comes next.
    pub next: NextRecording,
}

impl Progress {
    /// Progress of a participant; `made` holds all recordings of the plan in any order.
    ///
    /// # Errors
    /// A recording that does not belong to this plan, in words.
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

    /// The recording that a new attempt at a slot needs.
    pub fn wanted(&self, slot: usize, attempt: u32) -> WantedRecording {
        WantedRecording { participant: self.participant, slot, attempt, instructed: self.instructed }
    }

    /// Makes a slot the next one, even if it is done.
    pub fn redo(&mut self, slot: Option<usize>) {
        if let Some((slot, stand)) = slot.and_then(|slot| Some((slot, self.steps.get(slot)?))) {
            self.next = NextRecording::Begin { slot, attempt: stand.attempts() + 1 };
        }
    }

    /// Number of completed slots.
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
        // A later attempt replaces earlier ones, since the experimenter asked for it.
        let is_done = here
            .last()
            .is_some_and(|made| matches!(made.outcome, RecordingOutcome::Complete | RecordingOutcome::Excluded { .. }));
        SlotProgress { slot, is_done, recordings: here.iter().map(attempt).collect() }
    }

    /// The number of the last attempt.
    fn attempts(&self) -> u32 {
        self.recordings.last().map_or(0, |last| last.attempt)
    }

    /// The recording that this slot still needs; `None` if it is done.
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
