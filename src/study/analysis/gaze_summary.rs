//! Gaze quality of a recording: numbers of samples, faults and losses, and results of the accuracy check.

use serde::Serialize;

use tomcom_core::base::text::count;
use tomcom_core::gaze::quality::{DroppedInputCounts, GazeFaultCounts};
use tomcom_session::Session;
use tomcom_session::gaze_samples::faults;

/// Gaze quality of a recording: numbers of samples, faults and losses, and measured accuracy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GazeQualitySummary {
    /// Number of recorded gaze samples.
    pub samples: u64,
    /// Number of recorded gaze samples outside the display or with a confidence below the threshold.
    pub unusable: u64,
    /// Number of recorded gaze samples that the belief filter does not use, by kind of fault.
    #[serde(flatten)]
    pub faults: GazeFaultCounts,
    /// Gaze input that was not recorded, by kind.
    #[serde(flatten)]
    pub dropped: DroppedInputCounts,
    /// Number of times that the tracker's clock was matched anew to the session's clock.
    pub clock_steps: u64,
    /// Number of fixations that the tracker found.
    pub fixations: u64,
    /// Number of blinks that the tracker found.
    pub blinks: u64,
    /// Number of times that the connection to the tracker was lost.
    pub losses: u64,
    /// Gaze accuracy in the last accepted accuracy check, in degrees, after correction if the correction is in use;
    /// null without a check.
    pub accuracy_deg: Option<f64>,
    /// Precision of the gaze in the last accepted accuracy check, in degrees.
    pub precision_deg: Option<f64>,
}

impl GazeQualitySummary {
    /// Gaze quality of a session up to its last event.
    pub fn from_session(session: &Session) -> GazeQualitySummary {
        let (gaze, tracker) = (&session.gaze, &session.tracker);
        let calibrated = session.calibrated.as_ref();
        GazeQualitySummary {
            samples: gaze.samples,
            unusable: gaze.unusable,
            faults: gaze.judge.counts,
            dropped: tracker.dropped,
            clock_steps: tracker.clock_steps,
            fixations: tracker.fixations,
            blinks: tracker.blinks,
            losses: tracker.losses,
            accuracy_deg: calibrated.map(|calibrated| calibrated.accuracy_deg()),
            precision_deg: calibrated.map(|calibrated| calibrated.found.precision_deg),
        }
    }
}

/// One line of text about faults of the gaze; `None` without faults.
pub fn describe(session: &Session) -> Option<String> {
    let kinds: Vec<String> = faults(session).iter().map(|(number, kind)| format!("{number} {kind}")).collect();
    let samples = count(session.gaze.samples, "sample", "samples");
    (!kinds.is_empty()).then(|| format!("gaze: {samples}; {}", kinds.join(", ")))
}
