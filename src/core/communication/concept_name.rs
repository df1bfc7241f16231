//! The names of the communication concepts.

use serde::{Deserialize, Serialize};

/// Name of a communication concept (the rule by which an assistant sends signals).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConceptName {
    /// ToM-Com, theory of mind with communication planning: sends signals that save more presses than they cost.
    #[default]
    TomCom,
    /// ToM, theory of mind without planning: sends signals about aspects with a large expected belief deviation.
    Tom,
    /// DEV, deviation based: proposes the next good presses after an error.
    Dev,
    /// No concept: the assistant sends no signals.
    None,
}

impl ConceptName {
    /// All communication concepts.
    pub const ALL: [ConceptName; 4] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev, ConceptName::None];

    /// Name of the communication concept in files.
    pub fn name(self) -> &'static str {
        match self {
            ConceptName::TomCom => "tom-com",
            ConceptName::Tom => "tom",
            ConceptName::Dev => "dev",
            ConceptName::None => "none",
        }
    }

    /// Name of the communication concept in texts.
    pub fn title(self) -> &'static str {
        match self {
            ConceptName::TomCom => "ToM-Com",
            ConceptName::Tom => "ToM",
            ConceptName::Dev => "DEV",
            ConceptName::None => "no concept",
        }
    }
}
