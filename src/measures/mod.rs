//! Measures of what the human does, used live and in the analysis.

pub mod attribution;
pub mod beliefs;
pub mod coding;
pub mod detection;
pub mod errors;
pub mod flags;
pub mod likelihood;
pub mod matching;
pub mod sequences;
pub mod wizard;

use crate::base::time::SessionTime;

/// A press of the human during the trial, what it was worth, and why. The nth of them is the nth press of the human on
/// the session's timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedPress {
    pub seq: u64,
    pub time: SessionTime,
    pub verdict: errors::PressVerdict,
    /// Whether it is known what the human believed.
    pub belief_known: bool,
    /// Why it was an error; `None` for what was none, and where the belief is not known.
    pub cause: Option<attribution::Cause>,
}

/// The median; of an even number the mean of the middle two; none of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        length if length % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}
