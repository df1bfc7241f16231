//! The settings of a session file, all together.

use serde::{Deserialize, Serialize};

pub use super::condition::Condition;
pub use super::console_settings::{ColourTheme, ConsoleSpec, MAX_NOTES, WizardVisibility};
pub use super::lsl_settings::{GazeOrigin, GazeUnit, LslGazeSpec, LslOutlet, LslSpec};
pub use super::participant_settings::{GazeSenders, GazeSource, ParticipantKind, ParticipantSpec};
use super::person_code;
use super::plan::{PlanPosition, PlanSpec};
pub use super::probe_settings::ProbeSpec;
use super::ranges;
pub use super::robot_settings::{ArmKind, RobotSpec};
pub use super::setting_checks::{SettingError, is_code};
use super::stream_settings::RerunSpec;
use super::tracker::TrackerSpec;
use super::wall_display::DisplaySpec;
use tomcom_core::communication::HighlightSet;
use tomcom_core::communication::settings::{AssistantSpec, ShadowMode};
use tomcom_core::kitchen::{Kitchen, LocationId, LocationKind};
use tomcom_core::mind::model::{HumanModel, HumanModelName};
use tomcom_people::participant::population::Population;
use tomcom_people::wizard::{WizardKind, WizardSpec};

/// The settings of a session file: who takes part, under which condition, and for how long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionSpec {
    /// Path of the layout file, relative to the session file.
    pub layout: String,
    /// Seed of all random streams of the session.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// When a trial ends, and under which condition it runs.
    #[serde(default)]
    pub trial: TrialSpec,
    /// The participant (person or simulation), and the source of gaze.
    #[serde(default)]
    pub participant: ParticipantSpec,
    /// Settings of the eye tracker.
    #[serde(default)]
    pub tracker: TrackerSpec,
    /// Settings of the robot's arm and its timing.
    #[serde(default)]
    pub robot: RobotSpec,
    /// Settings of the wizard: a person, or a script.
    #[serde(default)]
    pub wizard: WizardSpec,
    /// How long signals are shown, and which are allowed.
    #[serde(default)]
    pub signals: SignalSpec,
    /// Settings of the assistant that recommends or sends signals.
    #[serde(default)]
    pub assistant: AssistantSpec,
    /// Settings of the wizard's console.
    #[serde(default)]
    pub console: ConsoleSpec,
    /// Settings of the participant's display.
    #[serde(default)]
    pub display: DisplaySpec,
    /// Settings of freeze probes; `None`: the task never stands still for questions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probes: Option<ProbeSpec>,
    /// Settings of the stream to Rerun's viewers.
    #[serde(default)]
    pub rerun: RerunSpec,
    /// Settings of the Lab Streaming Layer; `None`: nothing is sent or received.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lsl: Option<LslSpec>,
    /// Path of a file with the parameters of the human model, relative to the session file; `None`: the parameters are
    /// in
    /// [`Self::human`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human_model: Option<String>,
    /// Parameters of the assistant's human model; in a recording, the parameters in use.
    #[serde(default)]
    pub human: HumanModel,
    /// Study plan with several participants and trials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanSpec>,
    /// Position of a recording in its plan; written by the program, not allowed in session files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<PlanPosition>,
}

fn default_seed() -> u64 {
    1
}

impl SessionSpec {
    /// Checks ranges of the settings, the participant's code, and settings that exclude each other.
    ///
    /// # Errors
    /// An error names the first invalid setting.
    pub fn check(&self) -> Result<(), SettingError> {
        ranges::check_session(self)?;
        let code = &self.participant.code;
        if let Some(fault) = person_code::fault(code) {
            return Err(SettingError::new(
                "participant.code",
                format!("code = \"{code}\": {fault}"),
                person_code::REMEDY,
            ));
        }
        if let Some(plan) = &self.plan {
            plan.check()?;
            if self.wizard.kind == WizardKind::Person {
                plan.check_visibility(self.console.visibility)?;
            }
        }
        if self.participant.gaze == GazeSource::Simulated && self.participant.kind != ParticipantKind::Simulated {
            let found = "gaze = \"simulated\" of a participant who is not simulated".to_string();
            let remedy = "gaze = \"mouse\", \"pupil\", \"file\", \"json\", \"lsl\" or \"none\"";
            return Err(SettingError::new("participant.gaze", found, remedy));
        }
        self.tracker.check(self.participant.gaze)?;
        self.console.check()?;
        self.display.check()?;
        self.rerun.check()?;
        self.check_lsl()?;
        if let Some(probes) = &self.probes {
            probes.check(self.trial.seconds)?;
        }
        let population = self.participant.population.as_ref().and_then(Population::fault);
        match self.human.fault().or(population) {
            Some((path, found, remedy)) => Err(SettingError::new(path, found, remedy)),
            None => Ok(()),
        }
    }
}

impl SessionSpec {
    /// Checks the settings of the Lab Streaming Layer, and that a gaze stream is set if gaze comes from the layer.
    fn check_lsl(&self) -> Result<(), SettingError> {
        if self.participant.gaze == GazeSource::Lsl && self.lsl.as_ref().is_none_or(|lsl| lsl.gaze.is_none()) {
            let found = "gaze = \"lsl\", and no stream".to_string();
            let remedy =
                "[lsl.gaze] with the stream's name and channels, such as name = \"tracker\", x = \"x\", y = \"y\"";
            return Err(SettingError::new("participant.gaze", found, remedy));
        }
        self.lsl.as_ref().map_or(Ok(()), LslSpec::check)
    }

    /// Whether the session needs the library of the Lab Streaming Layer.
    pub fn uses_lsl(&self) -> bool {
        let sends = self.lsl.as_ref().is_some_and(|lsl| !lsl.outlets.is_empty());
        sends || self.participant.gaze == GazeSource::Lsl
    }

    /// The locations that signals may highlight. By default all shared places and the robot's hand, and with the human
    /// model of the paper those that the paper names.
    pub fn highlights(&self, kitchen: &Kitchen) -> HighlightSet {
        match (&self.signals.highlights, self.human.model) {
            (Some(names), _) => HighlightSet::named(kitchen, names.iter().map(String::as_str)),
            (None, HumanModelName::Paper2021) => HighlightSet::of_paper(kitchen),
            (None, HumanModelName::Plain) => HighlightSet::usual(kitchen),
        }
    }

    /// Checks that the kitchen has what these settings name.
    ///
    /// # Errors
    /// The first setting that does not fit the kitchen.
    pub fn check_kitchen(&self, kitchen: &Kitchen) -> Result<(), SettingError> {
        let usual = HighlightSet::usual(kitchen);
        let can_be = |id: LocationId| usual.holds(id) && kitchen.location(id).kind != LocationKind::Order;
        let named = self.signals.highlights.as_deref().unwrap_or_default();
        let wrong = |what: String, remedy: String| {
            Err(SettingError::new("signals.highlights", format!("highlights = {named:?}, {what}"), remedy))
        };
        if let Some(name) = named.iter().find(|name| !kitchen.location_named(name).is_some_and(can_be)) {
            let places = (0..kitchen.locations.len()).map(|index| LocationId(index as u8)).filter(|&id| can_be(id));
            let places: Vec<&str> = places.map(|id| &*kitchen.location(id).name).collect();
            return wrong(format!("and {name} cannot be highlighted"), format!("some of: {}", places.join(", ")));
        }
        if let Some(name) = named.iter().enumerate().find(|(index, name)| named[..*index].contains(name)) {
            return wrong(format!("with {} twice", name.1), "each place once".to_string());
        }
        self.probes.as_ref().map_or(Ok(()), |probes| probes.check_kitchen(kitchen))
    }

    /// Whether the assistant computes recommendations: in the assistant condition, and with `shadow = "on"`.
    pub fn asks_assistant(&self) -> bool {
        self.trial.condition == Condition::Assistant || self.assistant.shadow == ShadowMode::On
    }

    /// Whether the signals come from a scripted wizard.
    pub fn scripts_wizard(&self) -> bool {
        self.trial.condition == Condition::Wizard && self.wizard.kind == WizardKind::Scripted
    }

    /// Whether a scripted wizard reads the assistant's offers: offers are made, and the session shows recommendations.
    pub fn script_reads_offers(&self) -> bool {
        let is_shown = self.asks_assistant() && self.console.visibility == WizardVisibility::Recommendation;
        self.scripts_wizard() && self.wizard.offers.is_some() && is_shown
    }

    /// The condition in a run without a person at the console: a wizard condition without a scripted wizard becomes
    /// unassisted.
    pub fn unattended(&self, condition: Condition) -> Condition {
        match condition {
            Condition::Wizard if self.wizard.kind == WizardKind::Person => Condition::None,
            condition => condition,
        }
    }
}

/// Condition of a trial, and when it ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrialSpec {
    /// The trial's condition: who may send signals.
    pub condition: Condition,
    /// Number of presses of both agents at which the trial ends; the default is the paper's mean.
    pub presses: u32,
    /// The longest duration of the trial in seconds of the trial's clock, which stands still in pauses.
    pub seconds: f64,
    /// Number of served orders at which the trial ends, if set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orders: Option<u32>,
    /// Least time between two presses of a person, in seconds of the trial's clock; earlier presses are recorded but do
    /// not count. Simulated participants have the pace of their population instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pace_s: Option<f64>,
}

impl Default for TrialSpec {
    fn default() -> Self {
        TrialSpec { condition: Condition::Wizard, presses: 304, seconds: 900.0, orders: None, pace_s: None }
    }
}

/// Settings of the signals to the participant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SignalSpec {
    /// Time for which a signal is shown on the display, in seconds.
    pub shown_s: f64,
    /// Names of the locations that signals may highlight; `None`: those of the human model (see
    /// [`SessionSpec::highlights`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highlights: Option<Vec<String>>,
    /// Least time between two signals of the wizard, in seconds.
    pub cool_down_s: f64,
}

impl Default for SignalSpec {
    fn default() -> Self {
        SignalSpec { shown_s: 4.0, highlights: None, cool_down_s: 0.5 }
    }
}
