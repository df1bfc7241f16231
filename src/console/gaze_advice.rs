//! What the result of a gaze check advises.

use crate::gaze::calibration::{GazeAccuracy, USABLE_DEG};

/// What enter does with a result: what is best for the gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationAdvice {
    /// Accept the gaze with its measured offset taken away.
    Corrected,
    /// Accept the gaze as it is.
    AsItIs,
    /// Both are too far off, or nothing was found.
    Repeat,
}

impl CalibrationAdvice {
    /// Of what was found.
    pub fn for_result(found: Option<&GazeAccuracy>) -> CalibrationAdvice {
        match found {
            Some(found) if found.accuracy_deg.min(found.corrected_deg) > USABLE_DEG => CalibrationAdvice::Repeat,
            Some(found) if found.corrected_deg < found.accuracy_deg => CalibrationAdvice::Corrected,
            Some(_) => CalibrationAdvice::AsItIs,
            None => CalibrationAdvice::Repeat,
        }
    }
}
