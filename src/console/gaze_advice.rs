//! What to do with the result of a gaze accuracy check.

use tomcom_core::gaze::calibration::{GazeAccuracy, USABLE_DEG};

/// Action that the console proposes after a gaze accuracy check, which enter carries out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccuracyCheckAction {
    /// Accept the gaze with its measured offset subtracted from all samples.
    Corrected,
    /// Accept the gaze samples without a correction.
    AsItIs,
    /// Repeat the check: with and without correction the gaze is too inaccurate, or no accuracy was measured.
    Repeat,
}

impl AccuracyCheckAction {
    /// The proposed action for a measured gaze accuracy; without a measured accuracy, to repeat the check.
    pub fn for_result(found: Option<&GazeAccuracy>) -> AccuracyCheckAction {
        match found {
            Some(found) if found.accuracy_deg.min(found.corrected_deg) > USABLE_DEG => AccuracyCheckAction::Repeat,
            Some(found) if found.corrected_deg < found.accuracy_deg => AccuracyCheckAction::Corrected,
            Some(_) => AccuracyCheckAction::AsItIs,
            None => AccuracyCheckAction::Repeat,
        }
    }
}
