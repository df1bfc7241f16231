//! The interface of the communication concepts: each advises beside a wizard, answers for a recording, or acts by itself.
//!
//! The wizard is what they are compared with, and no concept: what a person did stands in the log.

use std::fmt;

pub use super::concept_name::ConceptName;
use super::recommendation::Recommendation;
use super::signal::Signal;
use super::situation::Situation;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;

/// A moment at which something could be said.
#[derive(Clone, Copy, Debug)]
pub struct DecisionPoint<'a> {
    /// The number and the time of the event that brought it about.
    pub seq: u64,
    pub time: SessionTime,
    /// Presses of both agents so far. Chance follows from their number, so that nothing else that is recorded changes it.
    pub presses: u32,
    pub situation: Situation<'a>,
    /// What may be said; what is no use saying again is not among it.
    pub signals: &'a [Signal],
    /// The number of the human's last press, if that was an error.
    pub error: Option<u64>,
}

/// A way to decide what to say and when. The answer follows from the moment and the settings alone; what is remembered from
/// one moment to the next changes the time that it takes, and nothing else.
pub trait Concept: fmt::Debug + Send {
    /// What to say now, if anything, what else could be said, and why.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation;
}
