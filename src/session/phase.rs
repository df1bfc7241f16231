//! Phase of a session's trial: ready, running, paused or over.

use super::event::TrialEndReason;

/// Phase of a session's trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialPhase {
    /// The trial has not started.
    Ready,
    /// The trial is running: its clock goes.
    Running,
    /// The trial is paused: its clock stands still.
    Paused,
    /// The trial has ended; the reason says why.
    Over(TrialEndReason),
    /// The session has ended, and its recording is closed.
    Closed,
}
