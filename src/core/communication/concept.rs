//! The interface of communication concepts, the rules by which an assistant sends signals. A concept advises a wizard,
//! gives advice afterwards for a recording, or sends signals by itself.
//!
//! The wizard is not a concept: a person's signals are in the log, and the signals of concepts are compared with them.

use std::fmt;

pub use super::concept_name::ConceptName;
use super::recommendation::Recommendation;
use super::signal::Signal;
use super::situation::Situation;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;

/// The input of a concept at a time at which the concept decides which signal to send, if any.
#[derive(Clone, Copy, Debug)]
pub struct DecisionPoint<'a> {
    /// Sequence number of the event that led to the decision.
    pub seq: u64,
    /// Session time of the event that led to the decision.
    pub time: SessionTime,
    /// Number of presses of both agents so far, which seeds the concept's random stream.
    pub presses: u32,
    /// True state, estimated belief and the robot's intent at the time of the decision.
    pub situation: Situation<'a>,
    /// The signals that may be sent at this time, after the rule against repeated signals.
    pub signals: &'a [Signal],
    /// Sequence number of the human's last press, if that press was an error.
    pub error: Option<u64>,
}

/// A communication concept: the rule by which an assistant sends signals. The concept's answer depends on the decision
/// point and the settings only; caches change computing time, never results.
pub trait Concept: fmt::Debug + Send {
    /// The recommendation at a decision point: the best signal, if any, all options, and the reason.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation;

    /// Works ahead after a decision point: fills the caches with what the decision points after the likeliest next
    /// presses will need, as long as `proceed` returns true. Recommendations stay the same, but come sooner.
    fn work_ahead(&mut self, _cost: &mut CostToGo, _moment: &DecisionPoint, _proceed: &mut dyn FnMut() -> bool) {}
}
