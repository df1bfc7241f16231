//! Landmarks of a recording: kinds of events to which a replay can jump.

/// Kind of event in a recording to which a replay can jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayLandmark {
    /// The human made an erroneous press.
    Error,
    /// The participant's display began to show a signal.
    Signal,
    /// The wizard set a marker.
    Marker,
    /// A false belief about a state aspect began in the belief estimate.
    FalseBelief,
}

impl ReplayLandmark {
    /// The kind of landmark in words.
    pub fn name(self) -> &'static str {
        match self {
            ReplayLandmark::Error => "error",
            ReplayLandmark::Signal => "signal",
            ReplayLandmark::Marker => "note",
            ReplayLandmark::FalseBelief => "false belief",
        }
    }
}
