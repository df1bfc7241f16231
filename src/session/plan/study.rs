//! A study: its plan with session settings and questionnaires, the settings of each recording, and the progress of
//! participants, which follows from the recordings alone, so that the next step is correct after a crash at any time.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::SessionSpec;
use crate::plan::difference::what_can_change_a_trial;
use crate::plan::{
    FamiliarisationSpec, PhaseSpec, PlanPosition, PlanSpec, PracticeCriterion, StartingGroup, TUTORIAL_ALONE,
};
use crate::protocol::ProtocolEvent;
use crate::questionnaire::Questionnaire;
use crate::settings::{GazeSource, ParticipantKind, WizardVisibility};
use crate::study_arm::StudyArm;
use crate::tutorial::Tutorial;
use crate::wall_display::AnswerDevice;
use tomcom_core::base::rng::mix;
use tomcom_core::base::text::count;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::wizard::WizardKind;

/// It needs one complete recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PlannedTrial {
    /// From 1; `None` for the familiarisation.
    pub period: Option<u32>,
    pub condition: StudyArm,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    pub plan: PlanSpec,
    /// In the order of the plan.
    pub questionnaires: Vec<Questionnaire>,
    pub tutorial: Option<Tutorial>,
    /// Settings that all sessions of the study share.
    pub session: SessionSpec,
    /// Of the plan, its questionnaires, kitchen, and all settings that can change a trial: recordings with another
    /// digest belong to another study.
    pub digest: String,
}

/// A recording of a study that is to be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WantedRecording {
    /// Index in the plan.
    pub participant: usize,
    /// Index of the planned trial in the participant's series.
    pub slot: usize,
    /// From 1.
    pub attempt: u32,
    /// Whether the participant has completed the instruction.
    pub instructed: bool,
}

impl Study {
    /// `None` if the session file has no plan. `kitchen`: the texts of the kitchen's files.
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

    pub fn group(&self, participant: usize) -> StartingGroup {
        self.plan.group(self.session.seed, participant)
    }

    pub fn consent_given(&self, on: AnswerDevice) -> ProtocolEvent {
        let (text, digest) = (self.plan.consent.clone(), digest(&self.plan.consent));
        ProtocolEvent::ConsentGiven { on, text, digest }
    }

    pub fn slots(&self, participant: usize) -> Vec<PlannedTrial> {
        let practice = self.plan.familiarisation.as_ref().map(|practice| (None, practice.condition));
        let trials = self.group(participant).conditions.into_iter().enumerate();
        let trials = trials.map(|(index, condition)| (Some(index as u32 + 1), condition));
        practice.into_iter().chain(trials).map(|(period, condition)| PlannedTrial { period, condition }).collect()
    }

    /// Settings of the familiarisation, if the planned trial is one.
    fn practice(&self, slot: PlannedTrial) -> Option<&FamiliarisationSpec> {
        self.plan.familiarisation.as_ref().filter(|_| slot.period.is_none())
    }

    /// Of a recording with people, and the number of its trial.
    pub fn settings(&self, wanted: WantedRecording) -> (SessionSpec, u64) {
        let slots = self.slots(wanted.participant);
        let slot = slots[wanted.slot];
        let mut spec = self.session.clone();
        spec.participant.code = self.plan.code(wanted.participant);
        set_arm(&mut spec, slot.condition);
        let practice = self.practice(slot);
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

    /// Of a simulated trial, and its number. In a plan for people, simulated ones with simulated gaze take their part. The
    /// trial has no instruction and no questionnaire; without a scripted wizard, the wizard conditions are unassisted.
    pub fn simulated(&self, participant: usize, period: u32) -> (SessionSpec, u64) {
        let slots = self.slots(participant);
        let slot = slots.iter().position(|slot| slot.period == Some(period)).unwrap_or(0);
        let (mut spec, trial) = self.settings(WantedRecording { participant, slot, attempt: 1, instructed: true });
        if spec.participant.kind != ParticipantKind::Simulated {
            (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Simulated, GazeSource::Simulated);
            spec.participant.button_box = None;
        }
        spec.trial.condition = spec.unattended(spec.trial.condition);
        let saw_advice = spec.script_reads_offers();
        let arm = StudyArm::from_settings(spec.trial.condition, spec.assistant.concept.name(), saw_advice);
        if let Some(step) = &mut spec.step {
            step.phases = vec![PhaseSpec::Trial];
            step.arm = Some(arm);
        }
        (spec, trial)
    }

    /// `None` if the study has no tutorial.
    pub fn tutorial_alone(&self, code: &str) -> Option<SessionSpec> {
        let phases = vec![PhaseSpec::Tutorial { tutorial: self.tutorial.clone()? }];
        let mut spec = self.session.clone();
        spec.participant.code = code.to_string();
        spec.step = Some(PlanPosition {
            plan: format!("{}{TUTORIAL_ALONE}", self.plan.name),
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

    /// What somebody who reads the plan may not expect of it: questionnaires that are not asked after every trial, texts in
    /// another language than that of the participant's display, and a tutorial that is left out.
    pub fn remarks(&self) -> Vec<String> {
        let trials = self.plan.conditions.len() as u32;
        let mut remarks = Vec::new();
        for (when, asked) in self.plan.questionnaire.iter().zip(&self.questionnaires) {
            let after: Vec<String> =
                (1..=trials).filter(|period| when.is_asked_after(*period)).map(|period| period.to_string()).collect();
            if !when.before && after.len() < trials as usize {
                let all = count(trials, "trial", "trials");
                remarks.push(format!(
                    "the questionnaire \"{}\" is asked after trial {} of {all} only",
                    asked.name,
                    after.join(" and ")
                ));
            }
        }
        let language = self.session.display.code();
        let texts =
            self.questionnaires.iter().map(|asked| (format!("the questionnaire \"{}\"", asked.name), &asked.language));
        let tutorial = self.tutorial.iter().map(|tutorial| ("the tutorial".to_string(), &tutorial.language));
        let others: Vec<String> = texts
            .chain(tutorial)
            .filter(|(_, of)| *of != language)
            .map(|(what, of)| format!("{what} ({of})"))
            .collect();
        if !others.is_empty() {
            remarks.push(format!("the display's language is \"{language}\", but not that of {}", others.join(", ")));
        }
        if self.tutorial.is_some() && self.session.participant.kind != ParticipantKind::Display {
            remarks.push("the tutorial is left out, since only the participant's display shows it".to_string());
        }
        remarks
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

fn set_arm(spec: &mut SessionSpec, arm: StudyArm) {
    spec.trial.condition = arm.condition();
    // The file's settings name the program of an external concept.
    if let Some(concept) = arm.concept().filter(|concept| *concept != ConceptName::External) {
        spec.assistant.concept = concept.into();
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
        _ => {}
    }
}

/// Unique to a recording of a plan; its decimal digits encode participant, planned trial and attempt.
fn trial_number(wanted: WantedRecording) -> u64 {
    (wanted.participant as u64 + 1) * 1_000_000 + wanted.slot as u64 * 10_000 + u64::from(wanted.attempt)
}

/// Sixteen hexadecimal digits.
fn digest(text: &str) -> String {
    let sum = text.bytes().fold(text.len() as u64, |sum, byte| mix(sum ^ u64::from(byte)));
    format!("{sum:016x}")
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RecordingOutcome {
    /// All its phases are done.
    Complete,
    /// Cut off or left early, so that it can be continued.
    Open,
    /// A program is making it at present.
    Running,
    /// Finished and excluded from the analysis, but not repeated.
    Excluded { reason: String },
    /// Finished and invalid: it must be repeated.
    Void { reason: String },
}

/// Facts about one recording, over all its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRecording {
    /// Name of its folder; of several parts, the last one's.
    pub recording: String,
    pub code: String,
    /// The code in the log, if it was corrected afterwards.
    pub recorded_as: Option<String>,
    pub kind: ParticipantKind,
    /// Of a corrected recording, that of the other participant.
    pub step: PlanPosition,
    pub consent: bool,
    pub instructed: bool,
    /// Of both agents in the trial, while it ran.
    pub presses: u32,
    pub stand: PhaseStand,
    /// Why the practice criterion was waived, if it was.
    pub waived: Option<String>,
    /// Why the recording is left out of the analysis, whatever else is true of it.
    pub excluded: Option<String>,
    /// Names of the questionnaires before the trial whose answers are final.
    pub answered: BTreeSet<String>,
    pub outcome: RecordingOutcome,
}

/// How far a recording is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PhaseStand {
    /// Number of the last phase that was begun, from 1; 0: none was.
    pub phase: usize,
    pub trial_over: bool,
    /// Whether the wizard ended the trial, before its presses and its time.
    pub ended_by_wizard: bool,
    /// Items of the last phase's questionnaire that were answered or skipped.
    pub items: usize,
}

impl PlanRecording {
    /// Where the recording ended: "the trial is over after 20 of 20 presses; of the questionnaire "Workload" 1 of 4 items
    /// are answered". `planned`: the presses after which the trial ends.
    fn ended_where(&self, planned: u32) -> String {
        let presses = format!("{} of {planned} presses", self.presses);
        let trial = match (self.stand.trial_over, self.presses) {
            (true, _) => format!("the trial is over after {presses}"),
            (false, 0) => "the trial has no press".to_string(),
            (false, _) => format!("the trial has {presses}"),
        };
        let phase = self.stand.phase.checked_sub(1).and_then(|index| self.step.phases.get(index));
        let within = match phase {
            None | Some(PhaseSpec::Trial | PhaseSpec::Familiarisation) => return trial,
            Some(PhaseSpec::Instruction { .. }) => "the instruction is not done".to_string(),
            Some(PhaseSpec::Tutorial { .. }) => "the tutorial is not done".to_string(),
            Some(PhaseSpec::Debriefing { .. }) => "the debriefing is not done".to_string(),
            Some(PhaseSpec::Questionnaire { questionnaire }) => {
                let (title, items) = (&questionnaire.title, questionnaire.items.len());
                format!("of the questionnaire \"{title}\" {} of {items} items are answered", self.stand.items)
            }
        };
        format!("{trial}; {within}")
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum NextRecording {
    Begin {
        /// Index of the planned trial in the participant's series.
        slot: usize,
        /// From 1.
        attempt: u32,
    },
    /// It is unfinished: the experimenter continues it, or repeats its trial as a new attempt.
    Choose {
        recording: String,
        slot: usize,
        /// If the trial is repeated.
        attempt: u32,
    },
    /// A program is making it at present.
    Running { recording: String, slot: usize },
    /// The participant has completed the series.
    Finished,
}

impl NextRecording {
    /// `None` when all trials are done.
    pub fn slot(&self) -> Option<usize> {
        match self {
            NextRecording::Begin { slot, .. }
            | NextRecording::Choose { slot, .. }
            | NextRecording::Running { slot, .. } => Some(*slot),
            NextRecording::Finished => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedTrialProgress {
    #[serde(flatten)]
    pub slot: PlannedTrial,
    /// Whether it has a valid recording.
    pub is_done: bool,
    /// In order.
    pub recordings: Vec<TrialAttempt>,
}

/// A recording of a planned trial; [`PlanRecording`] and [`PhaseStand`] say what the fields mean.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrialAttempt {
    pub recording: String,
    pub attempt: u32,
    pub presses: u32,
    pub trial_over: bool,
    pub ended_by_wizard: bool,
    /// How far the recording is, in words.
    #[serde(skip)]
    pub ended_where: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub waived: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excluded: Option<String>,
    pub outcome: RecordingOutcome,
    /// Whether the program played the participant.
    pub simulated: bool,
    /// Whether it was recorded under another version of the plan.
    pub other_version: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_as: Option<String>,
    /// If it is not that of the plan for this participant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_arm: Option<StudyArm>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParticipantProgress {
    pub code: String,
    /// Index in the plan.
    #[serde(skip)]
    pub participant: usize,
    /// In the participant's last recording, if it is not that of the session file.
    #[serde(skip)]
    pub kind: Option<ParticipantKind>,
    pub group: String,
    pub consent: bool,
    #[serde(skip)]
    pub instructed: bool,
    /// Names of the questionnaires before the trials that the participant has answered, whatever became of the trial.
    #[serde(skip)]
    pub answered: BTreeSet<String>,
    pub steps: Vec<PlannedTrialProgress>,
    pub next: NextRecording,
}

impl ParticipantProgress {
    /// `made`: all recordings of the plan, in any order. The error names one that does not belong to it.
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
        let kind = own.last().map(|made| made.kind).filter(|kind| *kind != study.session.participant.kind);
        let consent = own.iter().any(|made| made.consent);
        let instructed = own.iter().any(|made| made.instructed);
        let answered = own.iter().flat_map(|made| made.answered.iter().cloned()).collect();
        Ok(ParticipantProgress { code, participant, kind, group, consent, instructed, answered, steps, next })
    }

    /// Settings of a recording with the participant, and the number of its trial. What is asked once before the trials is
    /// not asked again.
    pub fn settings(&self, study: &Study, slot: usize, attempt: u32) -> (SessionSpec, u64) {
        let (participant, instructed) = (self.participant, self.instructed);
        let (mut spec, trial) = study.settings(WantedRecording { participant, slot, attempt, instructed });
        if let Some(step) = &mut spec.step {
            let of_trial = step.phases.iter().position(|phase| *phase == PhaseSpec::Trial).unwrap_or(0);
            let is_open = |phase: &PhaseSpec| match phase {
                PhaseSpec::Questionnaire { questionnaire } => !self.answered.contains(&questionnaire.name),
                _ => true,
            };
            let after = step.phases.split_off(of_trial);
            step.phases.retain(is_open);
            step.phases.extend(after);
        }
        (spec, trial)
    }

    /// Makes this planned trial the next one, even if it is done.
    pub fn redo(&mut self, slot: Option<usize>) {
        if let Some((slot, stand)) = slot.and_then(|slot| Some((slot, self.steps.get(slot)?))) {
            self.next = NextRecording::Begin { slot, attempt: stand.attempts() + 1 };
        }
    }

    /// The trials that are done, but with a recording that is excluded, and that recording: they are repeated only if the
    /// experimenter asks for it.
    pub fn excluded(&self) -> impl Iterator<Item = (usize, &TrialAttempt)> {
        let last = self.steps.iter().enumerate().filter_map(|(slot, stand)| Some((slot, stand.recordings.last()?)));
        last.filter(|(_, last)| matches!(last.outcome, RecordingOutcome::Excluded { .. }))
    }

    /// Whether a trial, practice aside, is complete and not excluded.
    pub fn has_counting_trial(&self) -> bool {
        let mut trials = self.steps.iter().filter(|stand| stand.slot.period.is_some());
        trials.any(|stand| stand.recordings.last().is_some_and(|last| last.outcome == RecordingOutcome::Complete))
    }

    /// Number of completed trials.
    pub fn done(&self) -> usize {
        self.steps.iter().filter(|stand| stand.is_done).count()
    }
}

impl PlannedTrialProgress {
    fn from_recordings(study: &Study, slot: PlannedTrial, own: &[&PlanRecording]) -> PlannedTrialProgress {
        let mut here: Vec<&PlanRecording> =
            own.iter().filter(|made| made.step.period == slot.period).copied().collect();
        here.sort_by(|a, b| (a.step.attempt, &a.recording).cmp(&(b.step.attempt, &b.recording)));
        let planned = study.practice(slot).map_or(study.session.trial.presses, |practice| practice.presses);
        let attempt = |made: &&PlanRecording| TrialAttempt {
            recording: made.recording.clone(),
            attempt: made.step.attempt,
            presses: made.presses,
            trial_over: made.stand.trial_over,
            ended_by_wizard: made.stand.ended_by_wizard,
            ended_where: made.ended_where(planned),
            waived: made.waived.clone(),
            excluded: made.excluded.clone(),
            outcome: made.outcome.clone(),
            simulated: made.kind == ParticipantKind::Simulated,
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

    /// Number of the last attempt.
    fn attempts(&self) -> u32 {
        self.recordings.last().map_or(0, |last| last.attempt)
    }

    /// `None` if the trial is done.
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
