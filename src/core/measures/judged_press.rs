//! A press of the human with the judgement whether it was an error, and with the error's cause.

use super::attribution::ErrorCause;
use super::errors::PressVerdict;
use crate::base::time::SessionTime;
use crate::kitchen::State;

/// A press of the human with the judgement whether it was an error. The nth judged press is the nth press of the human
/// on the session's timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedPress {
    /// Sequence number of the press event in the log.
    pub seq: u64,
    /// Session time of the press.
    pub time: SessionTime,
    /// State of the kitchen before the press.
    pub before: State,
    /// The regret of the press, and whether it was an error.
    pub verdict: PressVerdict,
    /// Whether the human's belief before the press is known.
    pub belief_known: bool,
    /// Cause of an error; `None` if the press was no error or the human's belief is not known.
    pub cause: Option<ErrorCause>,
}
