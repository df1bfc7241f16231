//! Wizard training at the console: the task, and feedback on each signal.

use super::notice::NoticeLevel;
use crate::base::time::SessionTime;

/// Content of the training panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainingPanel {
    /// Task and scoring rules, as paragraphs; shown until there is feedback.
    pub task: Vec<String>,
    /// Feedback on signals and omissions, the oldest first.
    pub feedback: Vec<TrainingFeedback>,
    /// The score so far: "2 hit, 1 missed, 3 wrong".
    pub score: String,
    /// Whether the training has started.
    pub begun: bool,
}

/// Feedback on a signal or on an omission.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFeedback {
    /// Time on the trial's clock.
    pub clock: SessionTime,
    /// How it is drawn.
    pub level: NoticeLevel,
    /// The line.
    pub text: String,
}
