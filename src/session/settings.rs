//! The settings of a session file.

use serde::{Deserialize, Serialize};

pub use super::condition::Condition;
pub use super::console_settings::{ConsoleSpec, MAX_NOTES, ThemeChoice, Visibility};
use super::display::DisplaySpec;
pub use super::participant_settings::{GazeSenders, GazeSource, ParticipantKind, ParticipantSpec};
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
    /// Seed of all random streams of the session.
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
    /// The wizard: a person, or a script.
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
    /// Path of a file with the parameters of the human model, relative to the session file; `None` for those in [`Self::human`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human_model: Option<String>,
    /// Parameters of the human model; in a recording, the parameters in use.
    #[serde(default)]
    pub human: HumanModel,
    /// Study plan with several participants and trials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanSpec>,
    /// Position of a recording in its plan; written by the program, not allowed in session files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<StepSpec>,
}

fn default_seed() -> u64 {
    1
}

/// Longest trial, in seconds.
const MAX_TRIAL_S: f64 = 86_400.0;

impl SessionSpec {
    /// Checks ranges, the participant's code, and settings that exclude each other.
    ///
    /// # Errors
    /// The first invalid setting.
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
    /// Whether the assistant computes recommendations: in the assistant condition, and with `shadow = "on"`.
    pub fn asks_assistant(&self) -> bool {
        self.trial.condition == Condition::Assistant || self.assistant.shadow == Shadow::On
    }

    /// Whether the signals come from a scripted wizard.
    pub fn scripts_wizard(&self) -> bool {
        self.trial.condition == Condition::Wizard && self.wizard.kind == WizardKind::Scripted
    }

    /// The condition without a person at the console: the wizard condition needs a scripted wizard, else it is unassisted.
    pub fn unattended(&self, condition: Condition) -> Condition {
        match condition {
            Condition::Wizard if self.wizard.kind == WizardKind::Person => Condition::None,
            condition => condition,
        }
    }
}

/// Condition and length of a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrialSpec {
    pub condition: Condition,
    /// Largest number of presses of both agents; the default is the paper's mean.
    pub presses: u32,
    pub seconds: f64,
    /// Number of served orders that also ends the trial, if set.
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
    /// Duration of a signal on the display, in seconds.
    pub shown_s: f64,
    /// Whether the human's own hand may be highlighted.
    pub own_hand: bool,
    /// Least time between two signals of the wizard, in seconds.
    pub cool_down_s: f64,
}

impl Default for SignalSpec {
    fn default() -> Self {
        SignalSpec { shown_s: 4.0, own_hand: false, cool_down_s: 0.5 }
    }
}
