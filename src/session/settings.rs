//! The settings of a session file, all together.

use core::net::{IpAddr, Ipv4Addr};
use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::plan::{PlanPosition, PlanSpec};
use crate::stream_settings::RerunSpec;
use crate::tracker::TrackerSpec;
use crate::wall_display::DisplaySpec;
use crate::{person_code, ranges};
use tomcom_core::base::number_range::OutOfRange;
use tomcom_core::communication::HighlightSet;
use tomcom_core::communication::settings::{AssistantSpec, ShadowMode};
use tomcom_core::kitchen::{Kitchen, LocationId, LocationKind};
use tomcom_core::mind::model::{HumanModel, HumanModelName};
use tomcom_people::participant::population::Population;
use tomcom_people::wizard::settings::{WizardKind, WizardSpec};

pub use crate::probes::ProbeSpec;
pub use crate::stream_settings::{GazeOrigin, GazeUnit, LslGazeSpec, LslOutlet, LslSpec};

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

impl SessionSpec {
    /// Parses the text of a session file. Missing settings get their defaults; other files to which the session file
    /// refers are not read.
    ///
    /// # Errors
    /// The text is not TOML, or a setting is unknown or invalid.
    pub fn from_toml(text: &str) -> Result<SessionSpec, SettingError> {
        let wrong = |error: toml::de::Error| SettingError::new("", error.to_string(), "settings of a session");
        let spec: SessionSpec = toml::from_str(text).map_err(wrong)?;
        spec.check().map(|()| spec)
    }
}

/// Error: an invalid setting in a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct SettingError {
    /// Dotted path of the setting, outermost table first; inner tables may be left out: "rerun.address".
    pub path: String,
    /// The invalid value that was found.
    pub found: String,
    /// Description of a valid value of the setting.
    pub remedy: Cow<'static, str>,
    /// Index of the invalid setting among several settings with the same path, from 0.
    pub nth: usize,
}

impl SettingError {
    /// An error in the first setting with this path.
    pub fn new(path: impl Into<String>, found: String, remedy: impl Into<Cow<'static, str>>) -> SettingError {
        SettingError { path: path.into(), found, remedy: remedy.into(), nth: 0 }
    }

    /// Name of the invalid setting without the tables in front.
    pub fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }
}

impl From<OutOfRange> for SettingError {
    fn from(error: OutOfRange) -> SettingError {
        SettingError::new(error.path, error.found, error.remedy)
    }
}

/// Whether a text is a valid code: 1 to 32 ASCII letters, digits, `-` and `_`. Such codes are safe in names of folders,
/// keys and tables.
pub fn is_code(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !text.is_empty() && text.len() <= 32 && text.chars().all(is_plain)
}

/// Who sends signals in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Unassisted condition: nobody sends signals to the human.
    None,
    /// Wizard condition: the wizard at the console sends signals.
    Wizard,
    /// Assistant condition: the assistant sends signals by itself.
    Assistant,
}

impl Condition {
    /// Name of the condition in logs, settings and tables.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}

const LOCALHOST: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

/// Settings of the participant and of the gaze source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParticipantSpec {
    /// Anonymous code of the participant, never a name.
    pub code: String,
    /// Whether a simulated participant or a person takes part, and by which input.
    pub kind: ParticipantKind,
    /// Source of the gaze samples.
    pub gaze: GazeSource,
    /// UDP and TCP port of the JSON gaze input.
    pub gaze_port: u16,
    /// Address at which the JSON gaze input listens; this computer's own (localhost) by default.
    pub gaze_listen: IpAddr,
    /// Addresses of other computers from which gaze is read; if empty, other computers need the pairing code.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gaze_from: Vec<IpAddr>,
    /// Addresses from which the JSON gaze input reads datagrams.
    pub gaze_senders: GazeSenders,
    /// Population from which simulated participants are drawn; `None` for the default population.
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
            gaze_listen: LOCALHOST,
            gaze_from: Vec::new(),
            gaze_senders: GazeSenders::First,
            population: None,
        }
    }
}

impl ParticipantSpec {
    /// Whether gaze samples come from the simulated participant.
    pub fn simulates_gaze(&self) -> bool {
        self.kind == ParticipantKind::Simulated && self.gaze == GazeSource::Simulated
    }
}

/// Who takes the human's part: a simulation or a person, and by which input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticipantKind {
    /// A simulated participant.
    Simulated,
    /// A person who presses keys at the keyboard of the console.
    Keyboard,
    /// A person at the wall display, which is a page in a browser.
    Display,
}

/// Source of gaze samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSource {
    /// Gaze comes from the eyes of the simulated participant.
    Simulated,
    /// Gaze is the mouse pointer: over the console's kitchen, or over the display if the participant plays there.
    Mouse,
    /// Gaze comes from the eye tracker Pupil Core, through Pupil Capture's network API.
    Pupil,
    /// Gaze comes from a recorded file: Pupil Player's export, or a recording of this program.
    File,
    /// Gaze comes as newline separated JSON over TCP or UDP (network) from another program.
    Json,
    /// Gaze comes from a stream of the Lab Streaming Layer.
    Lsl,
    /// There are no gaze samples at all.
    None,
}

/// Addresses from which the JSON gaze input accepts datagrams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSenders {
    /// Only the address that sent the first gaze sample is accepted, until it has been silent for 5 s.
    First,
    /// Gaze datagrams from every address are accepted.
    Any,
}

/// Settings of the wizard's console.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConsoleSpec {
    /// How much the wizard sees: kitchen, estimated belief, recommendations.
    pub visibility: WizardVisibility,
    /// Draw with ASCII characters only, for terminals and fonts without others.
    pub ascii: bool,
    /// Colour theme of the console: for a dark or a light terminal background.
    pub theme: ColourTheme,
    /// Whether a mouse click on a signal or on the offer sends the signal at once, without a question.
    pub click_sends: bool,
    /// Path of the file with the wizard's key bindings, relative to the session file; without a path the default keys
    /// apply.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<String>,
    /// Preset texts for the wizard's markers (time marks with a note): key 1 sets a marker with the first text.
    pub notes: Vec<String>,
    /// Preset reasons for aborting or excluding a trial.
    pub reasons: Vec<String>,
}

/// Largest number of preset notes for the wizard's markers (keys 1 to 5).
pub const MAX_NOTES: usize = 5;
/// Largest number of preset reasons for aborting or excluding a trial.
const MAX_REASONS: usize = 20;
/// Largest length of a preset note or reason, in characters.
const MAX_PRESET: usize = 40;

impl Default for ConsoleSpec {
    fn default() -> Self {
        let texts = |texts: [&str; 5]| texts.map(str::to_string).to_vec();
        ConsoleSpec {
            visibility: WizardVisibility::Recommendation,
            ascii: false,
            theme: ColourTheme::Auto,
            click_sends: false,
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
    pub(crate) fn check(&self) -> Result<(), SettingError> {
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

/// Colour theme of the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColourTheme {
    /// Colours that fit the terminal's background; colours for a dark one if the terminal does not report its
    /// background.
    Auto,
    /// Colours for a dark terminal background.
    Dark,
    /// Colours for a light terminal background.
    Light,
}

/// Amount of information on the wizard's console.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WizardVisibility {
    /// The wizard sees kitchen and gaze only, as in the paper.
    State,
    /// The wizard sees kitchen, gaze and estimated belief.
    Belief,
    /// The wizard sees kitchen, gaze, estimated belief and recommendations.
    Recommendation,
}

impl WizardVisibility {
    /// Name of the wizard's visibility level in files.
    pub fn name(self) -> &'static str {
        match self {
            WizardVisibility::State => "state",
            WizardVisibility::Belief => "belief",
            WizardVisibility::Recommendation => "recommendation",
        }
    }

    /// Words for what the wizard sees at this visibility level.
    pub fn title(self) -> &'static str {
        match self {
            WizardVisibility::State => "kitchen and gaze",
            WizardVisibility::Belief => "kitchen, gaze and the estimated belief",
            WizardVisibility::Recommendation => {
                "kitchen, gaze, the estimated belief and the assistant's recommendation"
            }
        }
    }
}

/// Kind of the robot's arm: timed (presses take a drawn duration), or simulated with physics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// The timed arm: presses have a random duration; the arm's motion is only displayed.
    #[default]
    Timed,
    /// The arm in the physics simulation: a simulated UR5 presses buttons by contact; the UR5 slows near the human's
    /// hand and stops on contact with the hand.
    Physics,
}

impl ArmKind {
    /// Name of the robot's arm in files.
    pub fn name(self) -> &'static str {
        match self {
            ArmKind::Timed => "timed",
            ArmKind::Physics => "physics",
        }
    }
}

/// Settings of the robot: its arm, the duration of its presses, and its initiative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSpec {
    /// Kind of the arm.
    pub arm: ArmKind,
    /// Timed arm: median duration of a press, in seconds.
    pub press_s: f64,
    /// Timed arm: standard deviation of the logarithm of a press's duration.
    pub press_spread: f64,
    /// Time without a press of the human after which the robot takes the initiative, in seconds.
    pub initiative_s: f64,
}

impl Default for RobotSpec {
    fn default() -> Self {
        RobotSpec { arm: ArmKind::Timed, press_s: 2.4, press_spread: 0.15, initiative_s: 6.0 }
    }
}
