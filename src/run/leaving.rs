//! Result of a live session, and the way in which the wizard left it.

use std::path::PathBuf;

use super::options::SessionStart;
use crate::analysis::exclusion_status::ExclusionStatus;
use crate::analysis::trial_summary::TrialSummary;
use crate::base::words::count;

/// How the wizard left a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeavingReason {
    /// The wizard ended the program.
    Quit,
    /// The wizard went on to the next recording of the series.
    Next,
    /// The wizard repeats the trial in a new recording.
    Redo,
}

/// Result of a live session: recording, summary, and how it was left.
#[derive(Clone, Debug)]
pub struct LiveOutcome {
    /// Folder of the recording.
    pub folder: PathBuf,
    /// How the wizard left the recording.
    pub leaving: LeavingReason,
    /// Summary of the trial.
    pub figures: TrialSummary,
    /// Whether the trial was aborted or excluded from the analysis.
    pub standing: ExclusionStatus,
    /// Start of the repeated trial, if the wizard asked for one.
    pub again: Option<SessionStart>,
}

impl LiveOutcome {
    /// The result of the live session as text.
    pub fn describe(&self) -> String {
        let folder = self.folder.display();
        let presses = count(self.figures.human_actions + self.figures.robot_actions, "press", "presses");
        let signals = count(self.figures.signals, "signal", "signals");
        let served = count(self.figures.served.len() as u64, "order", "orders");
        let standing = if self.standing.counts() {
            String::new()
        } else {
            format!("the recording is left out of the analysis: {}\n", self.standing.describe())
        };
        format!(
            "{presses} of human and robot, {signals}, {served} served\n{standing}recorded in {folder}\nlook at the \
             recording: tomcom replay {folder}, or in Rerun: tomcom review {folder}"
        )
    }
}
