//! How a live session was left, and what came of it.

use std::path::PathBuf;

use super::options::SessionStart;
use crate::analysis::exclusion_status::ExclusionStatus;
use crate::analysis::trial_summary::TrialSummary;
use crate::base::words::count;

/// How the wizard left a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeavingReason {
    /// The program ends.
    Quit,
    /// What comes next in the series begins.
    Next,
    /// The trial is done again, in another recording.
    Redo,
}

/// What came of a live session.
#[derive(Clone, Debug)]
pub struct LiveOutcome {
    /// The folder of the recording.
    pub folder: PathBuf,
    pub leaving: LeavingReason,
    pub figures: TrialSummary,
    pub standing: ExclusionStatus,
    /// What its trial is done again with, if that was asked for.
    pub again: Option<SessionStart>,
}

impl LiveOutcome {
    /// What came of it, for people.
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
