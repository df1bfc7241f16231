//! Phase of a session's trial.

use super::event::EndReason;

/// Phase of the trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Before the trial's start.
    Ready,
    /// The trial runs.
    Running,
    /// The trial's clock stands still.
    Paused,
    /// The trial is over.
    Over(EndReason),
    /// The session is over.
    Closed,
}
