//! The settings of a session file, and the errors of invalid ones.

use core::net::{IpAddr, Ipv4Addr};
use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::film::VideoSpec;
use crate::plan::{PlanPosition, PlanSpec};
use crate::stream_settings::RerunSpec;
use crate::study_arm::StudyArm;
use crate::tracker::TrackerSpec;
use crate::wall_display::DisplaySpec;
use crate::{person_code, probes, ranges};
use tomcom_core::base::number_range::OutOfRange;
use tomcom_core::base::text::did_you_mean;
use tomcom_core::communication::HighlightSet;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::{AssistantSpec, ConceptSpec, ExternalMind, ShadowMode};
use tomcom_core::kitchen::{Kitchen, LocationId, LocationKind};
use tomcom_core::mind::model::{HumanModel, HumanModelName};
use tomcom_people::participant::population::Population;
use tomcom_people::wizard::{WizardKind, WizardSpec};

pub use crate::probe_settings::ProbeSpec;
pub use crate::stream_settings::{GazeOrigin, GazeUnit, LslGazeSpec, LslOutlet, LslSpec};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionSpec {
    /// Path of the layout file, relative to the session file.
    pub layout: String,
    /// Of all random streams.
    #[serde(default = "default_seed")]
    pub seed: u64,
    #[serde(default)]
    pub trial: TrialSpec,
    #[serde(default)]
    pub participant: ParticipantSpec,
    #[serde(default)]
    pub tracker: TrackerSpec,
    #[serde(default)]
    pub robot: RobotSpec,
    #[serde(default)]
    pub wizard: WizardSpec,
    #[serde(default)]
    pub signals: SignalSpec,
    #[serde(default)]
    pub assistant: AssistantSpec,
    #[serde(default)]
    pub console: ConsoleSpec,
    #[serde(default)]
    pub display: DisplaySpec,
    /// `None`: the task never stands still for questions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probes: Option<ProbeSpec>,
    #[serde(default)]
    pub rerun: RerunSpec,
    /// `None`: nothing is filmed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub video: Option<VideoSpec>,
    /// Lab Streaming Layer; `None`: nothing is sent or received.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lsl: Option<LslSpec>,
    /// File with the parameters of the human model, relative to the session file; `None`: they are in [`Self::human`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human_model: Option<String>,
    /// The assistant's human model; in a recording, the parameters in use.
    #[serde(default)]
    pub human: HumanModel,
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
    /// Missing settings get their defaults; other files to which the session file refers are not read.
    pub fn from_toml(text: &str) -> Result<SessionSpec, SettingError> {
        let wrong = |error: toml::de::Error| SettingError::new("", error.to_string(), "settings of a session");
        let spec: SessionSpec = toml::from_str(text).map_err(wrong)?;
        spec.check().map(|()| spec)
    }

    /// Ranges, the participant's code, and settings that exclude each other.
    pub fn check(&self) -> Result<(), SettingError> {
        ranges::check_session(self)?;
        let code = &self.participant.code;
        if let Some(fault) = person_code::fault(code) {
            let found = format!("code = \"{code}\": {fault}");
            return Err(SettingError::new("participant.code", found, person_code::REMEDY));
        }
        self.check_external_participant()?;
        if let ConceptSpec::External(mind) = &self.assistant.concept
            && mind.external.trim().is_empty()
        {
            let remedy = "the command line of a program, such as \"python my_agent.py\"";
            return Err(SettingError::new("assistant.concept.external", "external = \"\"".to_string(), remedy));
        }
        if let Some(plan) = &self.plan {
            plan.check()?;
            let is_external = plan.conditions.contains(&StudyArm::External);
            if is_external && self.assistant.concept != ConceptName::External {
                let found = "the condition \"external\", and no external concept".to_string();
                let remedy = "[assistant] with concept = { external = \"COMMAND\" }";
                return Err(SettingError::new("plan.conditions", found, remedy));
            }
            if self.wizard.kind == WizardKind::Person {
                plan.check_visibility(self.console.visibility)?;
            }
        }
        if self.participant.gaze == GazeSource::Simulated && self.participant.kind != ParticipantKind::Simulated {
            let found = "gaze = \"simulated\" of a participant who is not simulated".to_string();
            let remedy = "gaze = \"mouse\", \"pupil\", \"file\", \"json\", \"lsl\" or \"none\"";
            return Err(SettingError::new("participant.gaze", found, remedy));
        }
        self.participant.check_button_box()?;
        self.tracker.check(self.participant.gaze)?;
        self.console.check()?;
        self.display.check()?;
        self.rerun.check()?;
        self.check_lsl()?;
        self.video.as_ref().map_or(Ok(()), VideoSpec::check)?;
        if let Some(probes) = probes::of_trial(self) {
            probes.check(self.trial.seconds)?;
        }
        let population = self.participant.population.as_ref().and_then(Population::fault);
        match self.human.fault().or(population) {
            Some((path, found, remedy)) => Err(SettingError::new(path, found, remedy)),
            None => Ok(()),
        }
    }

    fn check_external_participant(&self) -> Result<(), SettingError> {
        let ParticipantSpec { kind, gaze, external, .. } = &self.participant;
        let remedy = "kind = \"external\", external = \"COMMAND\" and gaze = \"none\" together";
        let wrong = |found: &str| Err(SettingError::new("participant.external", found.to_string(), remedy));
        match (*kind == ParticipantKind::External, external.as_deref().map(str::trim)) {
            (false, None) => Ok(()),
            (true, None | Some("")) => wrong("an external participant without a program"),
            (false, Some(_)) => wrong("a program, and a participant who is not external"),
            // A program has no eyes that could be followed.
            (true, Some(_)) if *gaze != GazeSource::None => wrong("an external participant with gaze"),
            (true, Some(_)) => Ok(()),
        }
    }

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

    /// The locations that signals may highlight: by default all shared places and the robot's hand, with the human
    /// model of the paper those that the paper names.
    pub fn highlights(&self, kitchen: &Kitchen) -> HighlightSet {
        match (&self.signals.highlights, self.human.model) {
            (Some(names), _) => HighlightSet::named(kitchen, names.iter().map(String::as_str)),
            (None, HumanModelName::Paper2021) => HighlightSet::of_paper(kitchen),
            (None, HumanModelName::Plain) => HighlightSet::usual(kitchen),
        }
    }

    /// The kitchen must have what these settings name.
    pub fn check_kitchen(&self, kitchen: &Kitchen) -> Result<(), SettingError> {
        let usual = HighlightSet::usual(kitchen);
        let can_be = |id: LocationId| usual.holds(id) && kitchen.location(id).kind != LocationKind::Order;
        let named = self.signals.highlights.as_deref().unwrap_or_default();
        let wrong = |what: String, remedy: String| {
            Err(SettingError::new("signals.highlights", format!("highlights = {named:?}, {what}"), remedy))
        };
        if let Some(name) = named.iter().find(|name| !kitchen.location_named(name).is_some_and(can_be)) {
            let places = kitchen.location_ids().filter(|&id| can_be(id));
            let places: Vec<&str> = places.map(|id| &*kitchen.location(id).name).collect();
            let near = did_you_mean(name, &places);
            return wrong(format!("and {name} cannot be highlighted{near}"), format!("some of: {}", places.join(", ")));
        }
        if let Some(name) = named.iter().enumerate().find(|(index, name)| named[..*index].contains(name)) {
            return wrong(format!("with {} twice", name.1), "each place once".to_string());
        }
        self.probes.as_ref().map_or(Ok(()), |probes| probes.check_kitchen(kitchen))
    }

    /// The external concept, if the session has one and asks it.
    pub fn external_concept(&self) -> Option<&ExternalMind> {
        match &self.assistant.concept {
            ConceptSpec::External(mind) if self.asks_assistant() => Some(mind),
            _ => None,
        }
    }

    /// Whether a program of other people takes part.
    pub fn has_external_mind(&self) -> bool {
        self.external_concept().is_some() || self.participant.kind == ParticipantKind::External
    }

    /// In the assistant condition, and with `shadow = "on"`.
    pub fn asks_assistant(&self) -> bool {
        self.trial.condition == Condition::Assistant || self.assistant.shadow == ShadowMode::On
    }

    pub(crate) fn scripts_wizard(&self) -> bool {
        self.trial.condition == Condition::Wizard && self.wizard.kind == WizardKind::Scripted
    }

    /// Offers are made, and the session shows recommendations.
    pub fn script_reads_offers(&self) -> bool {
        let is_shown = self.asks_assistant() && self.console.visibility == WizardVisibility::Recommendation;
        self.scripts_wizard() && self.wizard.offers.is_some() && is_shown
    }

    /// Whether the mouse pointer over the console stands for the gaze.
    pub fn is_gaze_of_console_mouse(&self) -> bool {
        self.participant.gaze == GazeSource::Mouse && self.participant.kind != ParticipantKind::Display
    }

    /// In a run without a person at the console, a wizard condition without a scripted wizard becomes unassisted.
    pub fn unattended(&self, condition: Condition) -> Condition {
        match condition {
            Condition::Wizard if self.wizard.kind == WizardKind::Person => Condition::None,
            condition => condition,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrialSpec {
    pub condition: Condition,
    /// Of both agents, at which the trial ends; the default is the paper's mean.
    pub presses: u32,
    /// Longest duration, on the trial's clock, which stands still in pauses.
    pub seconds: f64,
    /// Served orders at which the trial ends, if set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orders: Option<u32>,
    /// Least time between two presses of a person, on the trial's clock; earlier presses are recorded but do not count.
    /// Simulated participants have the pace of their population instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pace_s: Option<f64>,
}

impl Default for TrialSpec {
    fn default() -> Self {
        TrialSpec { condition: Condition::Wizard, presses: 304, seconds: 900.0, orders: None, pace_s: None }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SignalSpec {
    pub shown_s: f64,
    /// Locations that signals may highlight; `None`: see [`SessionSpec::highlights`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highlights: Option<Vec<String>>,
    /// Least time between two signals of the wizard.
    pub cool_down_s: f64,
}

impl Default for SignalSpec {
    fn default() -> Self {
        SignalSpec { shown_s: 4.0, highlights: None, cool_down_s: 0.5 }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct SettingError {
    /// Dotted, outermost table first; inner tables may be left out: "rerun.address".
    pub path: String,
    pub found: String,
    pub remedy: Cow<'static, str>,
    /// Index among settings with the same path, from 0.
    pub nth: usize,
}

impl SettingError {
    /// In the first setting with this path.
    pub fn new(path: impl Into<String>, found: String, remedy: impl Into<Cow<'static, str>>) -> SettingError {
        SettingError { path: path.into(), found, remedy: remedy.into(), nth: 0 }
    }

    /// Name without the tables in front.
    pub fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }
}

impl From<OutOfRange> for SettingError {
    fn from(error: OutOfRange) -> SettingError {
        SettingError::new(error.path, error.found, error.remedy)
    }
}

/// 1 to 32 ASCII letters, digits, `-` and `_`: safe in names of folders, keys and tables.
pub fn is_code(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !text.is_empty() && text.len() <= 32 && text.chars().all(is_plain)
}

/// Who sends signals in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Condition {
    None,
    Wizard,
    Assistant,
}

named!(Condition, ParticipantKind, WizardVisibility, ArmKind);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParticipantSpec {
    /// Anonymous, never a name.
    pub code: String,
    pub kind: ParticipantKind,
    pub gaze: GazeSource,
    /// UDP and TCP port of the JSON gaze input.
    pub gaze_port: u16,
    /// Where the JSON gaze input listens; localhost by default.
    pub gaze_listen: IpAddr,
    /// Other computers from which gaze is read; if empty, they need the pairing code.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gaze_from: Vec<IpAddr>,
    pub gaze_senders: GazeSenders,
    /// Path of the serial line of a person's button box: "/dev/ttyACM0".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub button_box: Option<String>,
    /// Command line or address of an external participant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub external: Option<String>,
    /// `None` for the default population.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<Population>,
}

impl Default for ParticipantSpec {
    fn default() -> Self {
        ParticipantSpec {
            code: "P01".to_string(),
            kind: ParticipantKind::Simulated,
            gaze: GazeSource::Simulated,
            gaze_port: 50021,
            gaze_listen: IpAddr::V4(Ipv4Addr::LOCALHOST),
            gaze_from: Vec::new(),
            gaze_senders: GazeSenders::First,
            button_box: None,
            external: None,
            population: None,
        }
    }
}

impl ParticipantSpec {
    fn check_button_box(&self) -> Result<(), SettingError> {
        let Some(path) = &self.button_box else { return Ok(()) };
        let wrong = |found, remedy: &'static str| Err(SettingError::new("participant.button_box", found, remedy));
        if path.trim().is_empty() || path.chars().any(char::is_control) {
            return wrong(format!("button_box = {path:?}"), "the path of its serial line, such as \"/dev/ttyACM0\"");
        }
        match self.kind {
            ParticipantKind::Keyboard | ParticipantKind::Display => Ok(()),
            ParticipantKind::Simulated | ParticipantKind::External => wrong(
                "a button box of a participant who has no hands".to_string(),
                "kind = \"display\" or \"keyboard\"; or no button_box",
            ),
        }
    }

    pub(crate) fn simulates_gaze(&self) -> bool {
        self.kind == ParticipantKind::Simulated && self.gaze == GazeSource::Simulated
    }
}

/// Who takes the human's part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ParticipantKind {
    Simulated,
    /// A person at the keyboard of the console.
    Keyboard,
    /// A person at the wall display, which is a page in a browser.
    Display,
    /// An external participant: the program that [`ParticipantSpec::external`] names.
    External,
}

impl ParticipantKind {
    pub fn words(self) -> &'static str {
        match self {
            ParticipantKind::Simulated => "simulated participant",
            ParticipantKind::Keyboard => "person at the keyboard",
            ParticipantKind::Display => "person at the display",
            ParticipantKind::External => "external participant",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSource {
    /// The eyes of the simulated participant.
    Simulated,
    /// The mouse pointer: over the console's kitchen, or over the display if the participant plays there.
    Mouse,
    /// Pupil Core, through Pupil Capture's network API.
    Pupil,
    /// Pupil Player's export, or a recording of this program.
    File,
    /// Newline separated JSON over TCP or UDP.
    Json,
    /// A stream of the Lab Streaming Layer.
    Lsl,
    None,
}

/// What the program calls a source of gaze.
#[derive(Clone, Copy, Debug)]
pub struct GazeSourceEntry {
    /// Name in files, on the command line and at the console.
    pub name: &'static str,
    /// Name in the methods of a report.
    pub title: &'static str,
    /// What it is, for lists of choices.
    pub about: &'static str,
}

impl GazeSource {
    pub const ALL: [GazeSource; 7] = [
        GazeSource::Simulated,
        GazeSource::Mouse,
        GazeSource::Pupil,
        GazeSource::File,
        GazeSource::Json,
        GazeSource::Lsl,
        GazeSource::None,
    ];

    /// The table of gaze sources.
    pub const fn entry(self) -> GazeSourceEntry {
        let (name, title, about) = match self {
            GazeSource::Simulated => ("simulated", "simulated eyes", "The simulated participant's gaze"),
            GazeSource::Mouse => (
                "mouse",
                "the mouse pointer in place of gaze",
                "The mouse pointer over the kitchen, at the console or on the wall display",
            ),
            GazeSource::Pupil => {
                ("pupil", "Pupil Core", "The eye tracker Pupil Core, through the program Pupil Capture")
            }
            GazeSource::File => ("file", "recorded gaze", "Recorded gaze from the file that --gaze-file names"),
            GazeSource::Json => {
                ("json", "an eye tracker that sends JSON lines", "Gaze samples as lines of JSON over TCP or UDP")
            }
            GazeSource::Lsl => (
                "lsl",
                "an eye tracker in the Lab Streaming Layer",
                "A stream of the Lab Streaming Layer: see [lsl.gaze] in the session file",
            ),
            GazeSource::None => ("none", "no gaze", "No gaze"),
        };
        GazeSourceEntry { name, title, about }
    }
}

/// From whom the JSON gaze input accepts datagrams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSenders {
    /// Only the address that sent the first gaze sample, until it has been silent for 5 s.
    First,
    Any,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConsoleSpec {
    pub visibility: WizardVisibility,
    /// For terminals and fonts without other characters.
    pub ascii: bool,
    pub theme: ColourTheme,
    /// Whether a click on a signal or on the offer sends the signal at once, without a question.
    pub click_sends: bool,
    /// File with the wizard's key bindings, relative to the session file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<String>,
    /// Preset texts for the wizard's markers: key 1 sets a marker with the first one.
    pub notes: Vec<String>,
    /// Preset reasons for aborting or excluding a trial.
    pub reasons: Vec<String>,
    /// When the terminal's bell rings.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bell: Vec<BellOccasion>,
}

/// An occasion for which the console's bell can be switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BellOccasion {
    /// An offer opens that the wizard sees.
    Offer,
    /// In a trial, gaze stops coming.
    Gaze,
    /// In a trial, the participant's page or button box is lost.
    Display,
    /// A camera is lost.
    Film,
}

/// Keys 1 to 5.
pub const MAX_NOTES: usize = 5;
const MAX_REASONS: usize = 20;
/// In characters.
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
            bell: Vec::new(),
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColourTheme {
    /// By the terminal's background; as for a dark one if the terminal does not report it.
    Auto,
    Dark,
    Light,
}

/// How much the wizard's console shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum WizardVisibility {
    /// Kitchen and gaze only, as in the paper.
    State,
    /// Also the estimated belief.
    Belief,
    /// Also the recommendations.
    Recommendation,
}

impl WizardVisibility {
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

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ArmKind {
    /// Presses have a random duration; the arm's motion is only displayed.
    #[default]
    Timed,
    /// A simulated UR5 presses buttons by contact; it slows near the human's hand and stops on contact with it.
    Physics,
    /// A real UR5, whose controller is at this address; in files `{ ur = "192.168.1.10" }`.
    Ur(IpAddr),
}

impl ArmKind {
    /// Whether it has joints and touches what it presses, simulated or real.
    pub fn has_joints(self) -> bool {
        self != ArmKind::Timed
    }

    pub fn is_real(self) -> bool {
        matches!(self, ArmKind::Ur(_))
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSpec {
    pub arm: ArmKind,
    /// Timed arm: median duration of a press. Real arm: what is expected of it.
    pub press_s: f64,
    /// Timed arm: standard deviation of the logarithm of a press's duration.
    pub press_spread: f64,
    /// Time without a press of the human after which the robot takes the initiative.
    pub initiative_s: f64,
    /// Real arm: the share of its full speed with which it moves; `None` is [`RobotSpec::SPEED`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
}

impl RobotSpec {
    /// Share of a real arm's full speed, unless the session says another.
    pub const SPEED: f64 = 0.5;
}

impl Default for RobotSpec {
    fn default() -> Self {
        RobotSpec { arm: ArmKind::Timed, press_s: 2.4, press_spread: 0.15, initiative_s: 6.0, speed: None }
    }
}
