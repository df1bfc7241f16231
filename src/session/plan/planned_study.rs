//! A study: its plan with session settings and questionnaires, and the settings of each recording.

use serde::Serialize;

use super::groups::StartingGroup;
use super::plan_spec::PlanSpec;
use super::questionnaire::Questionnaire;
use super::step::{PhaseSpec, PlanPosition, PracticeCriterion};
use super::tutorial::Tutorial;
use crate::protocol_event::ProtocolEvent;
use crate::settings::{ConsoleSpec, ParticipantKind, ParticipantSpec, SessionSpec, WizardVisibility};
use crate::stream_settings::RerunSpec;
use crate::study_arm::StudyArm;
use crate::tracker::TrackerSpec;
use crate::wall_display::{AnswerDevice, DisplaySpec};
use tomcom_core::base::rng::mix;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::wizard::WizardKind;

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
