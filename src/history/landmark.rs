//! Landmarks of a recording: kinds of events to which a replay can jump.

/// Kind of event in a recording to which a replay can jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayLandmark {
    /// A press that was an error.
    Error,
    /// A signal was shown to the participant.
    Signal,
    /// A marker that the wizard set.
    Marker,
    /// Start of a false belief in the estimate.
    FalseBelief,
}
