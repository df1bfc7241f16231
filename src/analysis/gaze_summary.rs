//! How the gaze of a recording was, in figures.

use serde::Serialize;

use crate::base::words::count;
use crate::gaze::quality::{DropCounts, FaultCounts};
use crate::session::Session;
use crate::session::gaze_samples::faults;

/// The gaze of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GazeSummary {
    /// Recorded samples.
    pub samples: u64,
    /// Of those, the ones beside the display or with too low a confidence.
    pub unusable: u64,
    /// Recorded and not read, by kind.
    #[serde(flatten)]
    pub faults: FaultCounts,
    /// Not recorded, by kind.
    #[serde(flatten)]
    pub dropped: DropCounts,
    pub fixations: u64,
    pub blinks: u64,
    /// How often the tracker's program was lost.
    pub losses: u64,
    /// The calibration that was accepted last, in degrees as the gaze is used; null: none was.
    pub accuracy_deg: Option<f64>,
    pub precision_deg: Option<f64>,
}

impl GazeSummary {
    pub fn from_session(session: &Session) -> GazeSummary {
        let (gaze, tracker) = (&session.gaze, &session.tracker);
        let calibrated = session.calibrated.as_ref();
        GazeSummary {
            samples: gaze.samples,
            unusable: gaze.unusable,
            faults: gaze.judge.counts,
            dropped: tracker.dropped,
            fixations: tracker.fixations,
            blinks: tracker.blinks,
            losses: tracker.losses,
            accuracy_deg: calibrated.map(|calibrated| calibrated.accuracy_deg()),
            precision_deg: calibrated.map(|calibrated| calibrated.found.precision_deg),
        }
    }
}

/// What was wrong with the gaze, in a line; none if nothing was.
pub fn describe(session: &Session) -> Option<String> {
    let kinds: Vec<String> = faults(session).iter().map(|(number, kind)| format!("{number} {kind}")).collect();
    let samples = count(session.gaze.samples, "sample", "samples");
    (!kinds.is_empty()).then(|| format!("gaze: {samples}; {}", kinds.join(", ")))
}
