//! Landmarks of a recording: kinds of events to which a replay can jump.

/// Kind of event in a recording to which a replay can jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayLandmark {
    /// The human's press was an error.
    Error,
    /// A signal was shown to the participant.
    Signal,
    /// A marker that the wizard set.
    Marker,
    /// A false belief began in the belief estimate.
    FalseBelief,
}

impl ReplayLandmark {
    /// The kind of landmark in words.
    pub fn name(self) -> &'static str {
        match self {
            ReplayLandmark::Error => "error",
            ReplayLandmark::Signal => "signal",
            ReplayLandmark::Marker => "marker",
            ReplayLandmark::FalseBelief => "false belief",
        }
    }
}
