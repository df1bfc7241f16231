//! How a live session was left, and its result.

use std::path::PathBuf;

use super::options::SessionStart;
use crate::analysis::exclusion_status::ExclusionStatus;
use crate::analysis::trial_summary::TrialSummary;
use crate::base::words::count;

/// The wizard's way of leaving a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeavingReason {
    /// The program ends.
    Quit,
    /// Continue with the next recording of the series.
    Next,
    /// Repeat the trial in another recording.
    Redo,
}

/// Result of a live session.
#[derive(Clone, Debug)]
pub struct LiveOutcome {
    /// The folder of the recording.
    pub folder: PathBuf,
    /// Why the console was left.
    pub leaving: LeavingReason,
    /// The summary of the trial.
    pub figures: TrialSummary,
    /// Whether the trial counts in the analysis.
    pub standing: ExclusionStatus,
    /// Start of the repeated trial, if requested.
    pub again: Option<SessionStart>,
}

impl LiveOutcome {
    /// The result as text.
    pub fn describe(&self) -> String {
        let folder = self.folder.display();
        let presses = count(self.figures.human_actions + self.figures.robot_actions, "press", "presses");
        let signals = count(self.figures.signals, "signal", "signals");
        let served = count(self.figures.served.len() as u64, "order", "orders");
        let standing = if self.standing.counts() {
            String::new()
        } else {
            format!("left out of the analysis: {}\n", self.standing.describe())
        };
        format!(
            "{presses} of both, {signals}, {served} served\n{standing}recorded in {folder}\n\
             look at it again: tomcom replay {folder}, or in Rerun: tomcom review {folder}"
        )
    }
}
