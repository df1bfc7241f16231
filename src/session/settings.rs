//! What a session file asks for.

use serde::{Deserialize, Serialize};

use super::display::DisplaySpec;
use super::plan::{PlanSpec, StepSpec};
pub use super::robot::{ArmKind, RobotSpec};
use super::stream::RerunSpec;
use super::tracker::TrackerSpec;
use crate::communication::settings::{AssistantSpec, Shadow};
use crate::mind::model::HumanModel;
use crate::participant::population::Population;
use crate::wizard::settings::{WizardKind, WizardSpec};

/// A session file: who takes part, under which condition, and for how long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionSpec {
    /// The layout file, relative to the session file.
    pub layout: String,
    /// Everything random in the session follows from it.
    #[serde(default = "default_seed")]
    pub seed: u64,
    #[serde(default)]
    pub trial: TrialSpec,
    #[serde(default)]
    pub participant: ParticipantSpec,
    #[serde(default, skip_serializing_if = "TrackerSpec::is_default")]
    pub tracker: TrackerSpec,
    #[serde(default)]
    pub robot: RobotSpec,
    /// Who the wizard is: a person, or a script.
    #[serde(default, skip_serializing_if = "WizardSpec::is_default")]
    pub wizard: WizardSpec,
    #[serde(default)]
    pub signals: SignalSpec,
    #[serde(default)]
    pub assistant: AssistantSpec,
    #[serde(default)]
    pub console: ConsoleSpec,
    #[serde(default)]
    pub display: DisplaySpec,
    #[serde(default)]
    pub rerun: RerunSpec,
    /// The file with the parameters of the human model, relative to the session file; none: those in [`Self::human`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human_model: Option<String>,
    /// The parameters of the human model; in a recording those that were in force.
    #[serde(default)]
    pub human: HumanModel,
    /// A study of many participants, with several trials each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanSpec>,
    /// The place of a recording in its plan: written by the program, and in no session file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<StepSpec>,
}

fn default_seed() -> u64 {
    1
}

/// No trial is longer, in seconds.
const MAX_TRIAL_S: f64 = 86_400.0;

/// A setting that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct SettingError {
    /// The setting with the tables around it, from outside; tables in between may be left out: "rerun.address".
    pub path: String,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: &'static str,
    /// Which of the settings of that path it is; 0 is the first.
    pub nth: usize,
}

impl SettingError {
    /// An error about the first setting of that path.
    pub fn new(path: impl Into<String>, found: String, remedy: &'static str) -> SettingError {
        SettingError { path: path.into(), found, remedy, nth: 0 }
    }

    /// The setting without the tables around it.
    pub fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }
}

impl SessionSpec {
    /// Checks what the types do not: ranges, the participant's code, and settings that exclude each other.
    ///
    /// # Errors
    /// The first setting that cannot be.
    pub fn check(&self) -> Result<(), SettingError> {
        let above_0 = |table: &str, key: &str, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(SettingError::new(format!("{table}.{key}"), format!("{key} = {value}"), "a number above 0")),
        };
        if self.trial.presses == 0 {
            return Err(SettingError::new(
                "trial.presses".to_string(),
                "presses = 0".to_string(),
                "a whole number above 0",
            ));
        }
        above_0("trial", "seconds", self.trial.seconds)?;
        if self.trial.seconds > MAX_TRIAL_S {
            let found = format!("seconds = {}", self.trial.seconds);
            return Err(SettingError::new("trial.seconds", found, "at most 86400, a day"));
        }
        above_0("robot", "press_s", self.robot.press_s)?;
        above_0("signals", "shown_s", self.signals.shown_s)?;
        if !(0.0..=2.0).contains(&self.robot.press_spread) {
            let found = format!("press_spread = {}", self.robot.press_spread);
            return Err(SettingError::new("robot.press_spread", found, "a number from 0 to 2"));
        }
        if self.trial.orders == Some(0) {
            let found = "orders = 0".to_string();
            return Err(SettingError::new("trial.orders", found, "a number above 0"));
        }
        if let Some(plan) = &self.plan {
            plan.check()?;
        }
        let code = &self.participant.code;
        if !is_code(code) {
            let found = format!("code = \"{code}\"");
            let remedy = "a code of 1 to 32 letters, digits, - and _, such as \"P07\"; never a name";
            return Err(SettingError::new("participant.code", found, remedy));
        }
        if self.participant.gaze == GazeSource::Simulated && self.participant.kind != ParticipantKind::Simulated {
            let found = "gaze = \"simulated\" of a participant who is not simulated".to_string();
            let remedy = "gaze = \"mouse\", \"pupil\", \"file\", \"json\" or \"none\"";
            return Err(SettingError::new("participant.gaze", found, remedy));
        }
        if !(0.0..=60.0).contains(&self.signals.cool_down_s) {
            let found = format!("cool_down_s = {}", self.signals.cool_down_s);
            return Err(SettingError::new("signals.cool_down_s", found, "seconds from 0 (none) to 60"));
        }
        self.tracker.check(self.participant.gaze)?;
        self.console.check()?;
        self.display.check()?;
        self.rerun.check()?;
        let of = |table: &str, (key, found, remedy): (&str, String, &'static str)| {
            Err(SettingError::new(format!("{table}.{key}"), found, remedy))
        };
        let population = self.participant.population.as_ref().and_then(Population::fault);
        let parts = [
            ("human", self.human.fault()),
            ("assistant", self.assistant.fault()),
            ("wizard", self.wizard.fault()),
            ("population", population),
        ];
        match parts.into_iter().find_map(|(table, fault)| Some((table, fault?))) {
            Some((table, fault)) => of(table, fault),
            None => Ok(()),
        }
    }
}

/// Whether a text is short and simple enough to name a participant, a plan, an item: in folders, keys and tables.
pub fn is_code(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !text.is_empty() && text.len() <= 32 && text.chars().all(is_plain)
}

impl SessionSpec {
    /// Whether the assistant is asked: where it acts, and as a shadow beside whoever does.
    pub fn asks_assistant(&self) -> bool {
        self.trial.condition == Condition::Assistant || self.assistant.shadow == Shadow::On
    }

    /// Whether the signals come from a scripted wizard.
    pub fn scripts_wizard(&self) -> bool {
        self.trial.condition == Condition::Wizard && self.wizard.kind == WizardKind::Scripted
    }

    /// Who sends signals where no person is at the console: a wizard only if it is scripted.
    pub fn unattended(&self, condition: Condition) -> Condition {
        match condition {
            Condition::Wizard if self.wizard.kind == WizardKind::Person => Condition::None,
            condition => condition,
        }
    }
}

/// When a trial ends, and who sends signals in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrialSpec {
    pub condition: Condition,
    /// Presses of both agents; the default is the mean of the paper.
    pub presses: u32,
    pub seconds: f64,
    /// It ends when so many orders are served, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orders: Option<u32>,
}

impl Default for TrialSpec {
    fn default() -> Self {
        TrialSpec { condition: Condition::Wizard, presses: 304, seconds: 900.0, orders: None }
    }
}

/// Who sends signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Nobody: the unassisted condition.
    None,
    /// The person at the console.
    Wizard,
    /// The assistant by itself.
    Assistant,
}

impl Condition {
    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}

/// The participant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParticipantSpec {
    /// A code, never a name.
    pub code: String,
    pub kind: ParticipantKind,
    pub gaze: GazeSource,
    /// Where the JSON gaze input listens, on localhost.
    pub gaze_port: u16,
    /// From what population simulated participants are drawn; none: the program's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<Population>,
}

impl Default for ParticipantSpec {
    fn default() -> Self {
        let code = "P01".to_string();
        ParticipantSpec {
            code,
            kind: ParticipantKind::Simulated,
            gaze: GazeSource::Simulated,
            gaze_port: 50021,
            population: None,
        }
    }
}

impl ParticipantSpec {
    /// Whether the gaze samples come from the simulated participant.
    pub fn simulates_gaze(&self) -> bool {
        self.kind == ParticipantKind::Simulated && self.gaze == GazeSource::Simulated
    }
}

/// Who plays the human's part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticipantKind {
    Simulated,
    /// Somebody at the keyboard of the console.
    Keyboard,
    /// Somebody at the wall display, a page in a browser.
    Display,
}

/// Where gaze samples come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSource {
    Simulated,
    /// The mouse pointer over the kitchen: the console's, or the display's if the participant is there.
    Mouse,
    /// Pupil Core, through Pupil Capture's network API.
    Pupil,
    /// A recorded file: Pupil Player's export, or a recording of this program.
    File,
    /// Newline separated JSON over TCP and UDP on localhost.
    Json,
    /// No gaze at all.
    None,
}

/// The communication signals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SignalSpec {
    /// How long a signal is shown, in seconds.
    pub shown_s: f64,
    /// Whether the human's own hand may be highlighted.
    pub own_hand: bool,
    /// From one signal of the wizard to the next there are at least so many seconds.
    pub cool_down_s: f64,
}

impl Default for SignalSpec {
    fn default() -> Self {
        SignalSpec { shown_s: 4.0, own_hand: false, cool_down_s: 0.5 }
    }
}

/// The console.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConsoleSpec {
    pub visibility: Visibility,
    /// Draw with ASCII signs only, for terminals and fonts without the others.
    pub ascii: bool,
    /// For which background the colours are.
    pub theme: ThemeChoice,
    /// The key file, relative to the session file; without one the keys are those of program and layout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<String>,
    /// The notes of the markers, so that no text has to be typed while the trial runs: key 1 is the first.
    pub notes: Vec<String>,
    /// Why a trial is aborted or excluded: what the console offers.
    pub reasons: Vec<String>,
}

/// The console has so many keys for notes.
pub const MAX_NOTES: usize = 5;
/// No list of reasons is longer.
const MAX_REASONS: usize = 20;
/// No preset text is longer, in characters.
const MAX_PRESET: usize = 40;

impl Default for ConsoleSpec {
    fn default() -> Self {
        let texts = |texts: [&str; 5]| texts.map(str::to_string).to_vec();
        ConsoleSpec {
            visibility: Visibility::Recommendation,
            ascii: false,
            theme: ThemeChoice::Auto,
            keys: None,
            notes: texts(["wrong recipe", "overlooked a change", "slip", "waits for the robot", "look at this later"]),
            reasons: texts([
                "participant stopped",
                "technical failure",
                "wizard's mistake",
                "instructions not understood",
                "interrupted",
            ]),
        }
    }
}

impl ConsoleSpec {
    fn check(&self) -> Result<(), SettingError> {
        let wrong = |key: &str, texts: &[String], most: usize, remedy| {
            let is_text = |text: &String| {
                let length = text.chars().count();
                (1..=MAX_PRESET).contains(&length) && text.trim() == text && !text.chars().any(char::is_control)
            };
            let is_wrong = texts.is_empty() || texts.len() > most || !texts.iter().all(is_text);
            is_wrong.then(|| SettingError::new(format!("console.{key}"), format!("{key} = {texts:?}"), remedy))
        };
        let notes = "1 to 5 texts of 1 to 40 characters, each on one line";
        let reasons = "1 to 20 texts of 1 to 40 characters, each on one line";
        let found = wrong("notes", &self.notes, MAX_NOTES, notes);
        found.or_else(|| wrong("reasons", &self.reasons, MAX_REASONS, reasons)).map_or(Ok(()), Err)
    }
}

/// For which background of the terminal the colours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThemeChoice {
    /// The one that the terminal says it has; dark, if it does not say.
    Auto,
    Dark,
    Light,
}

/// How much the wizard sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Visibility {
    /// Kitchen and gaze, as the paper's wizard had.
    State,
    /// The estimated belief too.
    Belief,
    /// Everything.
    Recommendation,
}
