//! The kinds of moments in a recording that a viewer can jump to.

/// What is looked for in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayLandmark {
    /// A press that was an error.
    Error,
    Signal,
    Marker,
    /// Something is believed wrong from here on, as it is estimated.
    FalseBelief,
}
