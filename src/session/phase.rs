//! Where a session's trial is.

use super::event::EndReason;

/// Where the trial is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Before the trial's start.
    Ready,
    Running,
    Paused,
    /// The trial is over.
    Over(EndReason),
    /// The session is over.
    Closed,
}
