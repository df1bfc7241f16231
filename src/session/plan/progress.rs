//! Progress of participants through a study plan, computed from the recordings alone, so that the next step is correct
//! after a crash at any time.

use serde::Serialize;

use super::planned_study::{PlannedTrial, Study, WantedRecording};
use super::step::PlanPosition;
use crate::study_arm::StudyArm;

/// State of a recording of a plan: complete, open, excluded or void.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RecordingOutcome {
    /// The recording is complete: all its phases are done.
    Complete,
    /// The recording is unfinished: cut off or left early, so that it can be continued.
    Open,
    /// A program is making the recording at present.
    Running,
    /// The recording is finished and excluded from the analysis, but not repeated.
    Excluded {
        /// Why the recording is excluded.
        reason: String,
    },
    /// The recording is finished and invalid: it must be repeated.
    Void {
        /// Why the recording is invalid.
        reason: String,
    },
}

/// Facts about one recording of a study plan, over all its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRecording {
    /// Name of the recording's folder; the last part's, if the recording has several.
    pub recording: String,
    /// The participant's code.
    pub code: String,
    /// The participant's code in the log, if it was corrected afterwards.
    pub recorded_as: Option<String>,
    /// Position of the recording in the study plan; of a corrected recording, that of the other participant.
    pub step: PlanPosition,
    /// Whether the participant consented to being recorded.
    pub consent: bool,
    /// Whether the participant completed the instruction, if there is one.
    pub instructed: bool,
    /// Number of presses of both agents in the trial.
    pub presses: u32,
    /// Whether the recording is complete, open, excluded or void.
    pub outcome: RecordingOutcome,
}

/// The recording that a participant of a study needs next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum NextRecording {
    /// A new recording begins at a planned trial.
    Begin {
        /// The index of the planned trial in the participant's series.
        slot: usize,
        /// The number of the attempt at this trial, counted from 1.
        attempt: u32,
    },
    /// There is an unfinished recording: the experimenter continues it, or repeats its trial as a new attempt.
    Choose {
        /// Name of the unfinished recording's folder.
        recording: String,
        /// The index of the planned trial in the participant's series.
        slot: usize,
        /// The number of the new attempt if the trial is repeated, counted from 1.
        attempt: u32,
    },
    /// A program is making this recording at present.
    Running {
        /// Name of the folder of the recording that is being made.
        recording: String,
        /// The index of the planned trial in the participant's series.
        slot: usize,
    },
    /// No recording is needed: the participant has completed the series.
    Finished,
}

impl NextRecording {
    /// Index of the planned trial that comes next; `None` when all trials are done.
    pub fn slot(&self) -> Option<usize> {
        match self {
            NextRecording::Begin { slot, .. }
            | NextRecording::Choose { slot, .. }
            | NextRecording::Running { slot, .. } => Some(*slot),
            NextRecording::Finished => None,
        }
    }
}

/// A planned trial of a participant's series, with the attempts at it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedTrialProgress {
    /// The planned trial of the participant's series.
    #[serde(flatten)]
    pub slot: PlannedTrial,
    /// Whether the planned trial has a valid recording.
    pub is_done: bool,
    /// The attempts at the planned trial, in order.
    pub recordings: Vec<TrialAttempt>,
}

/// One attempt at a planned trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrialAttempt {
    /// The name of the attempt's recording folder; the last part's, if the recording has several.
    pub recording: String,
    /// Number of this attempt at the planned trial, from 1.
    pub attempt: u32,
    /// Number of presses of both agents in the attempt's trial.
    pub presses: u32,
    /// Whether the attempt's recording is complete, open, excluded or void.
    pub outcome: RecordingOutcome,
    /// Whether the attempt was recorded under another version of the plan.
    pub other_version: bool,
    /// The participant's code in the attempt's log, if it was corrected afterwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_as: Option<String>,
    /// The study arm in which the attempt was carried out, if it is not that of the plan for this participant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_arm: Option<StudyArm>,
}

/// Progress of one participant through the study plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParticipantProgress {
    /// The participant's code.
    pub code: String,
    /// Index of the participant in the plan.
    #[serde(skip)]
    pub participant: usize,
    /// Name of the participant's starting group.
    pub group: String,
    /// Whether the participant consented to being recorded.
    pub consent: bool,
    /// Whether the participant completed the instruction, if there is one.
    #[serde(skip)]
    pub instructed: bool,
    /// The planned trials of the participant's series, in order, with their attempts.
    pub steps: Vec<PlannedTrialProgress>,
    /// The recording that the participant needs next.
    pub next: NextRecording,
}

impl ParticipantProgress {
    /// Progress of a participant through the plan; `made` contains all recordings of the plan in any order.
    ///
    /// # Errors
    /// A recording that does not belong to this plan, named in words.
    pub fn from_recordings(
        study: &Study,
        participant: usize,
        made: &[PlanRecording],
    ) -> Result<ParticipantProgress, String> {
        let code = study.plan.code(participant);
        let group = study.group(participant).name;
        let own: Vec<&PlanRecording> = made.iter().filter(|made| made.code == code).collect();
        // A recording whose code was corrected has the group of the participant for whom it was begun.
        if let Some(other) = own.iter().find(|made| made.recorded_as.is_none() && made.step.group != group) {
            let (recording, recorded) = (&other.recording, &other.step.group);
            return Err(format!("{code} was in group {recorded} in {recording}, and is in {group} now"));
        }
        let slots = study.slots(participant);
        let steps: Vec<PlannedTrialProgress> =
            slots.iter().map(|slot| PlannedTrialProgress::from_recordings(study, *slot, &own)).collect();
        let next =
            steps.iter().enumerate().find_map(|(index, stand)| stand.next(index)).unwrap_or(NextRecording::Finished);
        let consent = own.iter().any(|made| made.consent);
        let instructed = own.iter().any(|made| made.instructed);
        Ok(ParticipantProgress { code, participant, group, consent, instructed, steps, next })
    }

    /// Identifies the recording to make for a new attempt at a planned trial.
    pub fn wanted(&self, slot: usize, attempt: u32) -> WantedRecording {
        WantedRecording { participant: self.participant, slot, attempt, instructed: self.instructed }
    }

    /// Makes this planned trial the participant's next one, even if the trial is done.
    pub fn redo(&mut self, slot: Option<usize>) {
        if let Some((slot, stand)) = slot.and_then(|slot| Some((slot, self.steps.get(slot)?))) {
            self.next = NextRecording::Begin { slot, attempt: stand.attempts() + 1 };
        }
    }

    /// Number of completed trials of the participant's series.
    pub fn done(&self) -> usize {
        self.steps.iter().filter(|stand| stand.is_done).count()
    }
}

impl PlannedTrialProgress {
    fn from_recordings(study: &Study, slot: PlannedTrial, own: &[&PlanRecording]) -> PlannedTrialProgress {
        let mut here: Vec<&PlanRecording> =
            own.iter().filter(|made| made.step.period == slot.period).copied().collect();
        here.sort_by(|a, b| (a.step.attempt, &a.recording).cmp(&(b.step.attempt, &b.recording)));
        let attempt = |made: &&PlanRecording| TrialAttempt {
            recording: made.recording.clone(),
            attempt: made.step.attempt,
            presses: made.presses,
            outcome: made.outcome.clone(),
            other_version: made.step.digest != study.digest,
            recorded_as: made.recorded_as.clone(),
            other_arm: made.step.arm.filter(|arm| made.recorded_as.is_some() && *arm != slot.condition),
        };
        // A later attempt at a planned trial replaces earlier ones, since the experimenter asked for the repetition.
        let is_done = here
            .last()
            .is_some_and(|made| matches!(made.outcome, RecordingOutcome::Complete | RecordingOutcome::Excluded { .. }));
        PlannedTrialProgress { slot, is_done, recordings: here.iter().map(attempt).collect() }
    }

    /// The number of the last attempt at the planned trial.
    fn attempts(&self) -> u32 {
        self.recordings.last().map_or(0, |last| last.attempt)
    }

    /// The recording that this planned trial still needs; `None` if the trial is done.
    fn next(&self, slot: usize) -> Option<NextRecording> {
        let attempt = self.attempts() + 1;
        match self.recordings.last() {
            _ if self.is_done => None,
            Some(last) if last.outcome == RecordingOutcome::Open => {
                Some(NextRecording::Choose { recording: last.recording.clone(), slot, attempt })
            }
            Some(last) if last.outcome == RecordingOutcome::Running => {
                Some(NextRecording::Running { recording: last.recording.clone(), slot })
            }
            _ => Some(NextRecording::Begin { slot, attempt }),
        }
    }
}
