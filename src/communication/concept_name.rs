//! The names of the communication concepts.

use serde::{Deserialize, Serialize};

/// What decides what the assistant says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConceptName {
    /// Theory of mind with communication planning: what saves more presses than a signal costs.
    #[default]
    TomCom,
    /// Theory of mind alone: what is believed wrong surely enough.
    Tom,
    /// Deviation based: after an error, the next good presses.
    Dev,
    /// Nothing is said.
    None,
}

impl ConceptName {
    /// All of them.
    pub const ALL: [ConceptName; 4] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev, ConceptName::None];

    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            ConceptName::TomCom => "tom-com",
            ConceptName::Tom => "tom",
            ConceptName::Dev => "dev",
            ConceptName::None => "none",
        }
    }

    /// As it is written in texts.
    pub fn title(self) -> &'static str {
        match self {
            ConceptName::TomCom => "ToM-Com",
            ConceptName::Tom => "ToM",
            ConceptName::Dev => "DEV",
            ConceptName::None => "no concept",
        }
    }
}
