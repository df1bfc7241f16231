//! Sources of knowledge about what a participant believed.

use serde::{Deserialize, Serialize};

/// The source from which an analysis takes causes of errors and false beliefs; the most reliable source first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefSource {
    /// Beliefs that a simulated participant recorded before each press.
    Recorded,
    /// Answers to freeze probes; the answers reveal false beliefs, but not the causes of errors.
    Probes,
    /// Consensus of two raters on the cause of every error.
    Consensus,
    /// Codes of two raters for the cause of every error; an error is belief related if both coded a false belief.
    Raters,
    /// The assistant's estimate of the participant's beliefs; the estimate is not sufficient for the main results of a
    /// study.
    Estimate,
}

impl BeliefSource {
    /// Name of the source of beliefs in tables.
    pub fn name(self) -> &'static str {
        match self {
            BeliefSource::Recorded => "recorded",
            BeliefSource::Probes => "probes",
            BeliefSource::Consensus => "consensus",
            BeliefSource::Raters => "raters",
            BeliefSource::Estimate => "estimate",
        }
    }

    /// The source of beliefs in words.
    pub fn words(self) -> &'static str {
        match self {
            BeliefSource::Recorded => "the recorded beliefs of simulated participants",
            BeliefSource::Probes => "the participants' answers to probes",
            BeliefSource::Consensus => "the consensus of two raters",
            BeliefSource::Raters => "the codes of two raters",
            BeliefSource::Estimate => "the assistant's estimate",
        }
    }
}
