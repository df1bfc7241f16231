//! State of a wizard training at the console: the task, and feedback on each signal.

use super::notice::NoticeLevel;
use tomcom_core::base::time::SessionTime;

/// Content of the wizard training's panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainingPanel {
    /// Task and scoring rules of the training, as paragraphs; shown until there is feedback.
    pub task: Vec<String>,
    /// Feedback on signals and on missed signals, oldest first.
    pub feedback: Vec<TrainingFeedback>,
    /// Score of the training so far: "2 hit, 1 missed, 3 wrong".
    pub score: String,
    /// Whether the wizard training has started.
    pub begun: bool,
}

/// Feedback on a signal that the trainee sent or missed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFeedback {
    /// Time of the feedback on the trial's clock.
    pub clock: SessionTime,
    /// Severity, which selects the style in which the feedback is drawn.
    pub level: NoticeLevel,
    /// Text of the feedback on a signal, in one line.
    pub text: String,
}
