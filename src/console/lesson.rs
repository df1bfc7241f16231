//! A wizard's training at the console: what is asked, and what each signal was.

use super::notice::NoticeLevel;
use crate::base::time::SessionTime;

/// What the console shows of a training.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainingPanel {
    /// What is to be done and what counts, in paragraphs: shown until there is feedback.
    pub task: Vec<String>,
    /// What each signal was and what was missed, the oldest first.
    pub feedback: Vec<TrainingFeedback>,
    /// The score so far: "2 hit, 1 missed, 3 wrong".
    pub score: String,
    /// It has been started.
    pub begun: bool,
}

/// What a signal was, or what was missed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFeedback {
    /// On the trial's clock.
    pub clock: SessionTime,
    pub level: NoticeLevel,
    pub text: String,
}
