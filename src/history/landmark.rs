//! Landmarks: kinds of events in a recording to which a replay can jump.

/// Kind of a landmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayLandmark {
    /// A press that was an error.
    Error,
    /// A signal was shown.
    Signal,
    /// The wizard set a marker.
    Marker,
    /// Start of a false belief in the estimate.
    FalseBelief,
}
