//! A study: its plan with session settings and questionnaires, the settings of each recording, and the progress of
//! participants, which follows from the recordings alone, so that the next step is correct after a crash at any time.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::Serialize;
use serde_json::{Value, json};

use crate::header::RecordedFile;
use crate::plan::{PhaseSpec, PlanPosition, PlanSpec, PracticeCriterion, StartingGroup, TUTORIAL_ALONE};
use crate::protocol::ProtocolEvent;
use crate::questionnaire::Questionnaire;
use crate::settings::{GazeSource, ParticipantKind, WizardVisibility};
use crate::study_arm::StudyArm;
use crate::tutorial::Tutorial;
use crate::wall_display::AnswerDevice;
use crate::{LogHeader, SessionSpec};
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

    /// After which a planned trial ends, of both agents.
    fn presses(&self, slot: PlannedTrial) -> u32 {
        let practice = self.plan.familiarisation.as_ref().filter(|_| slot.period.is_none());
        practice.map_or(self.session.trial.presses, |practice| practice.presses)
    }

    /// Of a recording with people, and the number of its trial.
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

    /// What somebody who reads the plan may not expect of it: questionnaires that are not asked after every trial, and texts
    /// in another language than that of the participant's display.
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
        remarks
    }

    /// What has changed since a recording of the plan that has another digest. `kitchen`: layout and recipes as they are now.
    pub fn changed_since(&self, recorded: &LogHeader, kitchen: [&RecordedFile; 2]) -> Vec<PlanDifference> {
        let files = [(&recorded.layout, kitchen[0]), (&recorded.recipes, kitchen[1])].into_iter();
        let mut changed: Vec<PlanDifference> = files
            .filter(|(before, now)| before.text != now.text)
            .map(|(_, now)| PlanDifference::text(now.path.trim_start_matches("../").to_string()))
            .collect();
        let Some(step) = &recorded.session.step else { return changed };
        let participant = step.participant as usize;
        let slot = self.slots(participant).iter().position(|slot| slot.period == step.period);
        if let Some(slot) = slot.filter(|_| participant < self.plan.codes().len()) {
            let wanted = WantedRecording { participant, slot, attempt: step.attempt, instructed: false };
            // Only live sessions have a time at which they were started.
            let (spec, _) = match (&recorded.started, step.period) {
                (None, Some(period)) => self.simulated(participant, period),
                _ => self.settings(wanted),
            };
            let without_step = |spec: &SessionSpec| SessionSpec { step: None, ..spec.clone() };
            changed.extend(differences(&without_step(&recorded.session), &without_step(&spec)));
            if let Some(now) = &spec.step {
                changed.extend(step.differences(now));
            }
        }
        if changed.is_empty() {
            changed.push(PlanDifference::text(UNRECORDED.to_string()));
        }
        changed
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

/// What cannot change a trial: addresses, viewers, appearance and texts of the wizard's console. Who takes part in a
/// recording and which device its gaze comes from are no part of the plan either: both are chosen at the start of a
/// recording and written to its header. The model's parameters are in `human`, and the layout's text stands beside the
/// settings.
const CANNOT_CHANGE_A_TRIAL: [&str; 28] = [
    "layout",
    "human_model",
    "participant.code",
    "participant.kind",
    "participant.gaze",
    "participant.gaze_port",
    "participant.gaze_listen",
    "participant.gaze_from",
    "participant.gaze_senders",
    "participant.button_box",
    "tracker.address",
    "tracker.port",
    "tracker.record",
    "tracker.file",
    "tracker.file_start_s",
    "tracker.missing_confidence",
    "tracker.gaps",
    "console.ascii",
    "console.theme",
    "console.click_sends",
    "console.keys",
    "console.notes",
    "console.reasons",
    "console.bell",
    "display.listen",
    "display.port",
    "rerun",
    "video",
];

/// The settings that can change a trial, by their path. A switch that is off, as by default, is left out: a new one
/// leaves the digests of all plans as they are.
fn what_can_change_a_trial(session: &SessionSpec) -> BTreeMap<String, Value> {
    let by_path = |session: &SessionSpec| {
        let mut values = BTreeMap::new();
        collect(serde_json::to_value(session).unwrap_or_default(), "", &mut values);
        values
    };
    let default = toml::from_str(r#"layout = """#).map(|spec| by_path(&spec)).unwrap_or_default();
    let is_off = |value: &Value| matches!(value, Value::Null | Value::Bool(false));
    let mut values = by_path(session);
    values.retain(|path, value| !is_off(value) || default.get(path) != Some(&*value));
    values
}

/// A setting, or a text, that is not the same in two versions of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanDifference {
    /// Its dotted path in the session file ("trial.presses"), or what it is in words, and its index among settings with
    /// this path.
    pub path: String,
    pub nth: usize,
    /// Before and now, each as JSON; `None` where it is not set, both of a text that is only named.
    pub values: [Option<Value>; 2],
}

/// What may have changed where a recording shows no difference.
const UNRECORDED: &str = "something that this recording does not show: participants, block, consent or questionnaires under [plan], or \
                          what another trial begins or ends with";
/// Longest value that a message has in full, in characters, and most differences.
const LONGEST_VALUE: usize = 60;
const MOST_NAMED: usize = 8;

impl PlanDifference {
    fn text(path: String) -> PlanDifference {
        PlanDifference { path, nth: 0, values: [None, None] }
    }

    /// The values as text; of long ones, from where they differ.
    fn told(&self) -> [Option<String>; 2] {
        let texts = self.values.each_ref().map(|value| value.as_ref().map(Value::to_string));
        let [before, now] = texts.each_ref().map(|text| text.as_deref().unwrap_or_default());
        let same = before.chars().zip(now.chars()).take_while(|(before, now)| before == now).count();
        let is_long = [before, now].iter().any(|text| text.chars().count() > LONGEST_VALUE);
        let start = if is_long { same.saturating_sub(LONGEST_VALUE / 4) } else { 0 };
        let part = |text: String| {
            let shown: String = text.chars().skip(start).take(LONGEST_VALUE).collect();
            let goes_on = text.chars().count() > start + LONGEST_VALUE;
            [if start > 0 { "…" } else { "" }, &shown, if goes_on { "…" } else { "" }].concat()
        };
        texts.map(|text| text.map(part))
    }

    /// As it was, if now comes before.
    pub fn reversed(self) -> PlanDifference {
        let [before, now] = self.values;
        PlanDifference { values: [now, before], ..self }
    }

    /// The setting before, and now, as a line of its table: "presses = 40", "no presses".
    pub fn settings(&self) -> [String; 2] {
        let key = self.path.rsplit('.').next().unwrap_or(&self.path);
        self.told().map(|value| value.map_or_else(|| format!("no {key}"), |value| format!("{key} = {value}")))
    }
}

impl fmt::Display for PlanDifference {
    /// "trial.presses from 20 to 40", "recipes/sushi.toml".
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.told() {
            [None, None] => write!(out, "{}", self.path),
            told => {
                let [before, now] = told.map(|value| value.unwrap_or("not set".to_string()));
                write!(out, "{} from {before} to {now}", self.path)
            }
        }
    }
}

/// In one line; of many, the first.
pub fn listed(changed: &[PlanDifference]) -> String {
    let named: Vec<String> = changed.iter().take(MOST_NAMED).map(PlanDifference::to_string).collect();
    let more = changed.len().saturating_sub(MOST_NAMED);
    named.join("; ") + &if more == 0 { String::new() } else { format!("; and {more} more") }
}

/// The settings that differ and can change a trial.
pub fn differences(before: &SessionSpec, now: &SessionSpec) -> Vec<PlanDifference> {
    let values = [before, now].map(what_can_change_a_trial);
    let wholes = [before, now].map(|spec| serde_json::to_value(spec).unwrap_or_default());
    let paths: BTreeSet<&String> = values.iter().flat_map(BTreeMap::keys).collect();
    let mut found: Vec<PlanDifference> = Vec::new();
    for path in paths.into_iter().filter(|path| values[0].get(*path) != values[1].get(*path)) {
        // A list is one setting, and the numbers of lists are no part of a path in the session file.
        let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        let mut parts: Vec<&str> = path.split('.').collect();
        while parts.pop_if(|part| is_number(&&**part)).is_some() {}
        let (numbers, names): (Vec<&str>, Vec<&str>) = parts.iter().partition(|part| is_number(part));
        let nth = numbers.first().and_then(|number| number.parse().ok()).unwrap_or(0);
        let value = |whole: &Value| whole.pointer(&format!("/{}", parts.join("/"))).filter(|it| !it.is_null()).cloned();
        let one = PlanDifference { path: names.join("."), nth, values: wholes.each_ref().map(value) };
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

impl PlanPosition {
    /// What is not as in the same recording under the plan of `now`.
    fn differences(&self, now: &PlanPosition) -> Vec<PlanDifference> {
        let settings = |step: &PlanPosition| {
            let told = step.phases.iter().filter_map(PhaseSpec::told).collect();
            let own = json!({
                "the starting group": step.group, "the number of conditions": step.periods,
                "plan.aims": step.aims, "plan.familiarisation": step.criterion,
            });
            let mut values = BTreeMap::new();
            collect(own, "", &mut values);
            (values, told)
        };
        let ((mut before, told_before), (mut after, told_now)): ((_, BTreeMap<_, _>), (_, BTreeMap<_, _>)) =
            (settings(self), settings(now));
        let mut found = Vec::new();
        // A recording has only what was told around its own trial, so what only the plan has is no difference.
        for (path, value) in told_before {
            match told_now.get(&path) {
                None => found.push(PlanDifference::text(format!("{path}, which is left out"))),
                Some(now) => {
                    collect(value, &path, &mut before);
                    collect(now.clone(), &path, &mut after);
                }
            }
        }
        let paths: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
        let differs = paths.into_iter().filter(|path| before.get(*path) != after.get(*path));
        let value =
            |values: &BTreeMap<String, Value>, path: &str| values.get(path).filter(|value| !value.is_null()).cloned();
        let one = |path: &String| PlanDifference {
            path: path.clone(),
            nth: 0,
            values: [value(&before, path), value(&after, path)],
        };
        found.extend(differs.map(one).filter(|one| one.values.iter().any(Option::is_some)));
        found
    }
}

impl PhaseSpec {
    /// What participants are told, taught or asked in it, and by which name.
    fn told(&self) -> Option<(String, Value)> {
        match self {
            PhaseSpec::Instruction { steps } => Some(("plan.instruction".to_string(), json!(steps))),
            PhaseSpec::Debriefing { steps } => Some(("plan.debriefing".to_string(), json!(steps))),
            PhaseSpec::Tutorial { tutorial } => Some(("tutorial".to_string(), json!(tutorial))),
            PhaseSpec::Questionnaire { questionnaire } => {
                Some((format!("questionnaire {}", questionnaire.name), json!(questionnaire)))
            }
            PhaseSpec::Familiarisation | PhaseSpec::Trial => None,
        }
    }
}

fn collect(value: Value, path: &str, values: &mut BTreeMap<String, Value>) {
    let below = |name: &str| if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
    match value {
        _ if CANNOT_CHANGE_A_TRIAL.contains(&path) => {}
        Value::Object(fields) => fields.into_iter().for_each(|(name, value)| collect(value, &below(&name), values)),
        Value::Array(items) => {
            items.into_iter().enumerate().for_each(|(at, item)| collect(item, &below(&at.to_string()), values));
        }
        value => drop(values.insert(path.to_string(), value)),
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

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrialAttempt {
    /// Name of its folder; of several parts, the last one's.
    pub recording: String,
    pub attempt: u32,
    /// Of both agents in the trial, while it ran.
    pub presses: u32,
    pub trial_over: bool,
    /// Whether the wizard ended the trial, before its presses and its time.
    pub ended_by_wizard: bool,
    /// How far the recording is, in words.
    #[serde(skip)]
    pub ended_where: String,
    /// Why the practice criterion was waived, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub waived: Option<String>,
    /// Why the recording is left out of the analysis, whatever else is true of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excluded: Option<String>,
    pub outcome: RecordingOutcome,
    /// Whether it was recorded under another version of the plan.
    pub other_version: bool,
    /// The code in the log, if it was corrected afterwards.
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
        let consent = own.iter().any(|made| made.consent);
        let instructed = own.iter().any(|made| made.instructed);
        let answered = own.iter().flat_map(|made| made.answered.iter().cloned()).collect();
        Ok(ParticipantProgress { code, participant, group, consent, instructed, answered, steps, next })
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
        let attempt = |made: &&PlanRecording| TrialAttempt {
            recording: made.recording.clone(),
            attempt: made.step.attempt,
            presses: made.presses,
            trial_over: made.stand.trial_over,
            ended_by_wizard: made.stand.ended_by_wizard,
            ended_where: made.ended_where(study.presses(slot)),
            waived: made.waived.clone(),
            excluded: made.excluded.clone(),
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
