//! What a session file asks for.

use serde::{Deserialize, Serialize};

pub use super::condition::Condition;
pub use super::console_settings::{ConsoleSpec, MAX_NOTES, ThemeChoice, Visibility};
use super::display::DisplaySpec;
pub use super::participant_settings::{GazeSource, ParticipantKind, ParticipantSpec};
use super::plan::{PlanSpec, StepSpec};
pub use super::robot_settings::{ArmKind, RobotSpec};
pub use super::setting_checks::{SettingError, is_code};
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
