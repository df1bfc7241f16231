//! Measures of the human's behaviour, beliefs and signals, used live and in the analysis.

pub mod attribution;
pub mod detection;
pub mod errors;
pub mod flags;
pub mod matching;
pub mod raters;
pub mod sequences;
pub mod wizard_performance;

pub use errors::JudgedPress;

/// The median of the numbers: for an even count the mean of the two middle numbers; `None` for an empty list.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        length if length % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}
