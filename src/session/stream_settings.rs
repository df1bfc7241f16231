//! Settings of streams in a session file: the Lab Streaming Layer (LSL) and the 3D viewer Rerun.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use crate::settings::SettingError;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LslSpec {
    /// Path of liblsl, relative to the session file; `None`: the one that the system has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub library: Option<String>,
    /// What the program sends.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outlets: Vec<LslOutlet>,
    /// The stream from which gaze is received, with `gaze = "lsl"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaze: Option<LslGazeSpec>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum LslOutlet {
    /// Every event except gaze and arm samples, each as a short text code.
    Markers,
    /// Every event except gaze and arm samples, each as JSON, as in the log.
    Events,
    /// Of both agents, with their effects.
    Presses,
    /// The estimated probability of the true value, for every state aspect.
    Beliefs,
    /// The estimated net benefit of every signal.
    NetBenefit,
    Gaze,
    /// The joint angles of the simulated arm.
    Arm,
}

named!(LslOutlet);

/// How a stream of gaze on the display is found (`None`: whatever it is), and the meaning of its channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LslGazeSpec {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Content type, such as "Gaze".
    #[serde(rename = "type", default, skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
    /// As its sender names it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_id: Option<String>,
    /// Name of the computer that offers it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub host: Option<String>,
    /// Channel: its label, or its number from 1; so for `y` and `confidence`.
    pub x: String,
    pub y: String,
    /// From 0 to 1; `None`: every sample counts as certain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<String>,
    #[serde(default)]
    pub unit: GazeUnit,
    /// Where the coordinates are 0, and the direction of y.
    #[serde(default)]
    pub origin: GazeOrigin,
    /// Width and height of the display in the unit. By default 1 and 1 for normalised coordinates, and the layout's
    /// size for metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeUnit {
    /// Fractions of the display.
    #[default]
    Normalised,
    Pixels,
    Metres,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeOrigin {
    /// y points down.
    #[default]
    TopLeft,
    /// y points up.
    BottomLeft,
    /// y points up.
    Centre,
}

impl LslGazeSpec {
    /// To fractions of the display, origin at the top left, for a display of `display_m` metres.
    pub fn to_display(&self, [x, y]: [f64; 2], display_m: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size.unwrap_or(match self.unit {
            GazeUnit::Metres => display_m,
            GazeUnit::Normalised | GazeUnit::Pixels => [1.0, 1.0],
        });
        let (x, y) = (x / width, y / height);
        match self.origin {
            GazeOrigin::TopLeft => [x, y],
            GazeOrigin::BottomLeft => [x, 1.0 - y],
            GazeOrigin::Centre => [0.5 + x, 0.5 - y],
        }
    }

    /// How messages call the stream: by its name, or else its type; and by its source and computer if they are set.
    pub fn title(&self) -> String {
        let title = match (&self.name, &self.content) {
            (Some(name), _) => format!("\"{name}\""),
            (None, Some(content)) => format!("of type \"{content}\""),
            (None, None) => "of any name".to_string(),
        };
        let source = self.source_id.as_ref().map(|source| format!(" of source_id \"{source}\""));
        let host = self.host.as_ref().map(|host| format!(" on {host}"));
        [Some(title), source, host].into_iter().flatten().collect()
    }

    fn check(&self) -> Result<(), SettingError> {
        let texts = [
            ("name", &self.name),
            ("type", &self.content),
            ("source_id", &self.source_id),
            ("host", &self.host),
            ("x", &Some(self.x.clone())),
            ("y", &Some(self.y.clone())),
            ("confidence", &self.confidence),
        ];
        for (key, text) in texts {
            if let Some(text) = text.as_ref().filter(|text| !is_name(text)) {
                let found = format!("{key} = {text:?}");
                let remedy = "1 to 100 signs on one line, without quotation marks";
                return Err(SettingError::new(format!("lsl.gaze.{key}"), found, remedy));
            }
        }
        if self.name.is_none() && self.content.is_none() && self.source_id.is_none() {
            let remedy =
                "name = \"…\" or type = \"Gaze\" under [lsl.gaze]: tomcom doctor lists the streams that there are";
            let found = "no name, type or source_id of a stream".to_string();
            return Err(SettingError::new("lsl.gaze", found, remedy));
        }
        if self.x == self.y {
            let remedy = "one channel for each coordinate";
            return Err(SettingError::new("lsl.gaze.y", format!("x = y = \"{}\"", self.x), remedy));
        }
        if self.unit == GazeUnit::Pixels && self.size.is_none() {
            let remedy = "size = [1920, 1080] under [lsl.gaze]: the display's pixels";
            return Err(SettingError::new("lsl.gaze.unit", "unit = \"pixels\", and no size".to_string(), remedy));
        }
        Ok(())
    }
}

/// In an LSL query, names stand in quotation marks.
fn is_name(text: &str) -> bool {
    let is_plain = |sign: char| !sign.is_control() && !matches!(sign, '\'' | '"');
    (1..=100).contains(&text.chars().count()) && text.chars().all(is_plain)
}

impl LslSpec {
    pub(crate) fn check(&self) -> Result<(), SettingError> {
        if let Some(library) = self.library.as_ref().filter(|path| path.trim().is_empty()) {
            let remedy = "the path of liblsl, or no library at all for the system's";
            return Err(SettingError::new("lsl.library", format!("library = {library:?}"), remedy));
        }
        let mut outlets = self.outlets.iter().enumerate();
        if let Some((_, twice)) = outlets.find(|(index, outlet)| self.outlets[..*index].contains(outlet)) {
            let found = format!("\"{}\" twice", twice.name());
            return Err(SettingError::new("lsl.outlets", found, "each stream once"));
        }
        self.gaze.as_ref().map_or(Ok(()), LslGazeSpec::check)
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RerunSpec {
    /// Whether viewers can connect while the session runs.
    pub live: bool,
    /// Whether the stream is also written to `recording.rrd` beside the log.
    pub record: bool,
    /// Where viewers connect; if its port is taken, one of the next ports is used.
    pub address: String,
}

impl Default for RerunSpec {
    fn default() -> Self {
        RerunSpec { live: true, record: true, address: "127.0.0.1:9876".to_string() }
    }
}

impl RerunSpec {
    /// Live or recorded.
    pub fn is_on(&self) -> bool {
        self.live || self.record
    }

    pub(crate) fn check(&self) -> Result<(), SettingError> {
        let is_address = self.address.rsplit_once(':').is_some_and(|(host, port)| {
            let is_host = !host.is_empty() && host.chars().all(|c| c.is_ascii_hexdigit() || "[].:".contains(c));
            is_host && port.parse::<u16>().is_ok_and(|port| port > 0)
        });
        let found = || format!("address = \"{}\"", self.address);
        let remedy =
            "an address of this machine and a port, such as \"127.0.0.1:9876\"; \"0.0.0.0:9876\" for all networks";
        if is_address { Ok(()) } else { Err(SettingError::new("rerun.address", found(), remedy)) }
    }
}
