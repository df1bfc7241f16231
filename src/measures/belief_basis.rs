//! How it is known what a participant believed.

use serde::{Deserialize, Serialize};

/// Source of the causes of errors, and of false beliefs; the most reliable first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefBasis {
    /// Recorded beliefs of a simulated participant.
    Recorded,
    /// Answers to probes; they tell false beliefs, not the causes of errors.
    Probes,
    /// Consensus of two raters for every error.
    Consensus,
    /// Codes of two raters for every error; an error is belief related if both coded a false belief.
    Raters,
    /// The assistant's estimate; insufficient for headline results.
    Estimate,
}

impl BeliefBasis {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            BeliefBasis::Recorded => "recorded",
            BeliefBasis::Probes => "probes",
            BeliefBasis::Consensus => "consensus",
            BeliefBasis::Raters => "raters",
            BeliefBasis::Estimate => "estimate",
        }
    }

    /// The source in words.
    pub fn words(self) -> &'static str {
        match self {
            BeliefBasis::Recorded => "the recorded beliefs of simulated participants",
            BeliefBasis::Probes => "the participants' answers to probes",
            BeliefBasis::Consensus => "the consensus of two raters",
            BeliefBasis::Raters => "the codes of two raters",
            BeliefBasis::Estimate => "the assistant's estimate",
        }
    }
}
