//! A study: its plan with session settings and questionnaires, and the settings of each recording.

use serde::Serialize;

use crate::SessionSpec;
use crate::plan::{PhaseSpec, PlanPosition, PlanSpec, PracticeCriterion, StartingGroup};
use crate::protocol::ProtocolEvent;
use crate::questionnaire::Questionnaire;
use crate::settings::{ConsoleSpec, ParticipantKind, ParticipantSpec, WizardVisibility};
use crate::stream_settings::RerunSpec;
use crate::study_arm::StudyArm;
use crate::tracker::TrackerSpec;
use crate::tutorial::Tutorial;
use crate::wall_display::{AnswerDevice, DisplaySpec};
use tomcom_core::base::rng::mix;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::wizard::settings::WizardKind;

/// A planned trial in a participant's series (familiarisation or counted trial): it needs one complete recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedTrial {
    /// Number of the trial, from 1; `None` for the familiarisation.
    pub period: Option<u32>,
    /// The study arm of the trial.
    pub condition: StudyArm,
}

/// A study: its plan with session settings and questionnaires.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The plan from the session file.
    pub plan: PlanSpec,
    /// Questionnaires in the order of the plan.
    pub questionnaires: Vec<Questionnaire>,
    /// The participant's tutorial, if the plan has one.
    pub tutorial: Option<Tutorial>,
    /// Settings that all sessions of the study share.
    pub session: SessionSpec,
    /// A checksum of the plan, its questionnaires, kitchen, and all settings that can change a trial: recordings with
    /// another checksum belong to another study.
    pub digest: String,
}

/// Identifies a recording of a study that is to be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WantedRecording {
    /// Index of the participant in the plan.
    pub participant: usize,
    /// Index of the planned trial in the participant's series.
    pub slot: usize,
    /// Number of the attempt at this trial, from 1.
    pub attempt: u32,
    /// Whether the participant has completed the instruction.
    pub instructed: bool,
}

impl Study {
    /// The study of a session file, with the questionnaires of its plan in order, its tutorial, and the texts of the
    /// kitchen's files; `None` if the session file has no plan.
    pub fn new(
        session: &SessionSpec,
        questionnaires: Vec<Questionnaire>,
        tutorial: Option<Tutorial>,
        kitchen: [&str; 2],
    ) -> Option<Study> {
        let plan = session.plan.clone()?;
        let session = SessionSpec { plan: None, ..session.clone() };
        // Serialisation cannot fail, because all maps have string keys.
        let all = (&plan, &questionnaires, kitchen, what_can_change_a_trial(&session));
        let mut text = serde_json::to_string(&all).unwrap_or_default();
        // Without a tutorial, the digest stays as it was before there were tutorials.
        if let Some(tutorial) = &tutorial {
            text += &serde_json::to_string(tutorial).unwrap_or_default();
        }
        let digest = digest(&text);
        Some(Study { plan, questionnaires, tutorial, session, digest })
    }

    /// The starting group of the participant with this index in the plan.
    pub fn group(&self, participant: usize) -> StartingGroup {
        self.plan.group(self.session.seed, participant)
    }

    /// The event that the participant consented to the plan's text, at the display or at the console.
    pub fn consent_given(&self, on: AnswerDevice) -> ProtocolEvent {
        let (text, digest) = (self.plan.consent.clone(), digest(&self.plan.consent));
        ProtocolEvent::ConsentGiven { on, text, digest }
    }

    /// The planned trials of a participant, in order.
    pub fn slots(&self, participant: usize) -> Vec<PlannedTrial> {
        let practice = self.plan.familiarisation.as_ref().map(|practice| (None, practice.condition));
        let trials = self.group(participant).conditions.into_iter().enumerate();
        let trials = trials.map(|(index, condition)| (Some(index as u32 + 1), condition));
        practice.into_iter().chain(trials).map(|(period, condition)| PlannedTrial { period, condition }).collect()
    }

    /// The settings of a recording with people, and the number of the recording's trial.
    pub fn settings(&self, wanted: WantedRecording) -> (SessionSpec, u64) {
        let slots = self.slots(wanted.participant);
        let slot = slots[wanted.slot];
        let mut spec = self.session.clone();
        spec.participant.code = self.plan.code(wanted.participant);
        set_arm(&mut spec, slot.condition);
        let practice = self.plan.familiarisation.as_ref().filter(|_| slot.period.is_none());
        if let Some(practice) = practice {
            spec.trial.presses = practice.presses;
            spec.trial.seconds = practice.seconds;
            spec.trial.orders = Some(practice.orders);
        }
        spec.step = Some(PlanPosition {
            plan: self.plan.name.clone(),
            digest: self.digest.clone(),
            participant: wanted.participant as u32,
            group: self.group(wanted.participant).name,
            period: slot.period,
            periods: self.plan.conditions.len() as u32,
            arm: Some(slot.condition),
            aims: self.plan.aims,
            attempt: wanted.attempt,
            criterion: practice.map(|it| PracticeCriterion { orders: it.orders, error_rate: it.error_rate }),
            phases: self.phases(slot, wanted),
        });
        (spec, trial_number(wanted))
    }

    /// The settings of a simulated trial of the study, and the trial's number. A simulated trial has no instruction and
    /// no questionnaire; without a scripted wizard, the wizard conditions are unassisted.
    pub fn simulated(&self, participant: usize, period: u32) -> (SessionSpec, u64) {
        let slots = self.slots(participant);
        let slot = slots.iter().position(|slot| slot.period == Some(period)).unwrap_or(0);
        let (mut spec, trial) = self.settings(WantedRecording { participant, slot, attempt: 1, instructed: true });
        spec.trial.condition = spec.unattended(spec.trial.condition);
        let saw_advice = spec.script_reads_offers();
        let arm = StudyArm::from_settings(spec.trial.condition, spec.assistant.concept, saw_advice);
        if let Some(step) = &mut spec.step {
            step.phases = vec![PhaseSpec::Trial];
            step.arm = Some(arm);
        }
        (spec, trial)
    }

    /// The settings of a recording that has only the tutorial; `None` if the study has no tutorial.
    pub fn tutorial_alone(&self, code: &str) -> Option<SessionSpec> {
        let phases = vec![PhaseSpec::Tutorial { tutorial: self.tutorial.clone()? }];
        let mut spec = self.session.clone();
        spec.participant.code = code.to_string();
        spec.step = Some(PlanPosition {
            plan: format!("{}-tutorial", self.plan.name),
            digest: self.digest.clone(),
            participant: 0,
            group: String::new(),
            period: None,
            periods: 0,
            arm: None,
            aims: self.plan.aims,
            attempt: 1,
            criterion: None,
            phases,
        });
        Some(spec)
    }

    fn phases(&self, slot: PlannedTrial, wanted: WantedRecording) -> Vec<PhaseSpec> {
        let mut phases = Vec::new();
        if !wanted.instructed && !self.plan.instruction.is_empty() {
            phases.push(PhaseSpec::Instruction { steps: self.plan.instruction.clone() });
        }
        // The tutorial is shown on the participant's display only, not to a participant at the keyboard of the console.
        let is_there = !wanted.instructed && self.session.participant.kind == ParticipantKind::Display;
        if let Some(tutorial) = self.tutorial.as_ref().filter(|_| is_there) {
            phases.push(PhaseSpec::Tutorial { tutorial: tutorial.clone() });
        }
        let Some(period) = slot.period else {
            phases.push(PhaseSpec::Familiarisation);
            return phases;
        };
        let asked = || self.plan.questionnaire.iter().zip(&self.questionnaires);
        let is_first = period == 1;
        let before = asked().filter(|(when, _)| is_first && when.before).filter_map(|(_, asked)| asked.before_trials());
        phases.extend(before.map(|questionnaire| PhaseSpec::Questionnaire { questionnaire }));
        phases.push(PhaseSpec::Trial);
        let after = asked().filter(|(when, _)| when.is_asked_after(period));
        let after = after.filter_map(|(_, asked)| asked.after(slot.condition.condition()));
        phases.extend(after.map(|questionnaire| PhaseSpec::Questionnaire { questionnaire }));
        if period as usize == self.plan.conditions.len() && !self.plan.debriefing.is_empty() {
            phases.push(PhaseSpec::Debriefing { steps: self.plan.debriefing.clone() });
        }
        phases
    }
}

/// Sets the settings of a trial to those of its study arm.
fn set_arm(spec: &mut SessionSpec, arm: StudyArm) {
    spec.trial.condition = arm.condition();
    if let Some(concept) = arm.concept() {
        spec.assistant.concept = concept;
    }
    match arm {
        StudyArm::WizardWithAdvice => {
            spec.console.visibility = WizardVisibility::Recommendation;
            spec.assistant.shadow = ShadowMode::On;
            if spec.wizard.kind == WizardKind::Scripted {
                spec.wizard.offers.get_or_insert_default();
            }
        }
        StudyArm::Wizard => spec.wizard.offers = None,
        StudyArm::None | StudyArm::TomCom | StudyArm::Tom | StudyArm::Dev => {}
    }
}

/// The session settings without those that cannot change a trial: addresses, viewers, appearance and texts of the
/// wizard's console. Who takes part in a recording and which device its gaze comes from are not part of the plan
/// either; both are chosen at the start of a recording and written to its header.
fn what_can_change_a_trial(session: &SessionSpec) -> SessionSpec {
    let ParticipantSpec { population, .. } = session.participant.clone();
    let TrackerSpec { surface, corners, distance_m, .. } = session.tracker.clone();
    let (tracker, display) = (TrackerSpec::default(), DisplaySpec::default());
    SessionSpec {
        participant: ParticipantSpec { population, ..ParticipantSpec::default() },
        tracker: TrackerSpec { surface, corners, distance_m, ..tracker },
        console: ConsoleSpec { visibility: session.console.visibility, ..ConsoleSpec::default() },
        display: DisplaySpec { listen: display.listen, port: display.port, ..session.display.clone() },
        rerun: RerunSpec::default(),
        // The model's parameters are in `human`, and the layout's text is passed beside the settings.
        human_model: None,
        layout: String::new(),
        ..session.clone()
    }
}

/// A unique trial number for every recording of a plan; its decimal digits encode participant, planned trial and
/// attempt.
fn trial_number(wanted: WantedRecording) -> u64 {
    (wanted.participant as u64 + 1) * 1_000_000 + wanted.slot as u64 * 10_000 + u64::from(wanted.attempt)
}

/// A digest of a text, as sixteen hexadecimal digits.
fn digest(text: &str) -> String {
    let sum = text.bytes().fold(text.len() as u64, |sum, byte| mix(sum ^ u64::from(byte)));
    format!("{sum:016x}")
}

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
