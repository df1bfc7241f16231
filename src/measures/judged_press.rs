//! A press of the human with what the measures say of it.

use super::attribution::Cause;
use super::errors::PressVerdict;
use crate::base::time::SessionTime;

/// A press of the human during the trial, what it was worth, and why. The nth of them is the nth press of the human on
/// the session's timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedPress {
    pub seq: u64,
    pub time: SessionTime,
    pub verdict: PressVerdict,
    /// Whether it is known what the human believed.
    pub belief_known: bool,
    /// Why it was an error; `None` for what was none, and where the belief is not known.
    pub cause: Option<Cause>,
}
