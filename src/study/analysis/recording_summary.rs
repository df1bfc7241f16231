//! Summary of one recording: presses, errors, beliefs, signals, gaze.

use serde::Serialize;

use super::exclusion_status::ExclusionStatus;
use super::gaze_summary::{self, GazeQualitySummary};
use super::trial_summary::{FalseBeliefErrorSummary, TrialSummary};
use tomcom_core::base::text::count;
use tomcom_session::follower::SessionFollower;

/// Summary of one recording, as `tomcom replay RECORDING` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingSummary {
    /// Number of events in the recording.
    pub events: u64,
    /// Whether the recording lacks its end event although no session is writing to it.
    pub cut: bool,
    /// Whether the recording's session still runs, so that the summary is of the events so far.
    pub running: bool,
    /// Whether the trial was aborted or excluded from the analysis.
    #[serde(flatten)]
    pub standing: ExclusionStatus,
    /// Number of the human's presses in the trial.
    pub human_actions: u64,
    /// Number of the robot's presses in the trial.
    pub robot_actions: u64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of the human's presses that were races with the robot, which do not count as errors.
    pub races: u64,
    /// Errors that follow from false beliefs.
    #[serde(flatten)]
    pub beliefs: FalseBeliefErrorSummary,
    /// Number of signals that were shown to the participant.
    pub signals: u64,
    /// Whether the wizard saw the assistants' recommendations beside the signals that the wizard sent.
    pub unblinded: bool,
    /// Number of orders that were served in the trial.
    pub orders_served: u64,
    /// Duration of the trial by its own clock, in seconds.
    pub trial_s: f64,
    /// Gaze quality of the recording.
    pub gaze: GazeQualitySummary,
    /// Faults of the gaze stream in words; null without faults.
    #[serde(skip)]
    gaze_faults: Option<String>,
}

impl RecordingSummary {
    /// The summary of a recorded session that was followed to its end, with `events` events.
    pub fn from_follower(follower: &SessionFollower, events: u64, standing: ExclusionStatus) -> RecordingSummary {
        let trial = TrialSummary::from_follower(follower);
        RecordingSummary {
            events,
            cut: false,
            running: false,
            standing,
            human_actions: trial.human_actions,
            robot_actions: trial.robot_actions,
            errors: trial.errors,
            races: trial.races,
            beliefs: FalseBeliefErrorSummary::from_trials([&trial]),
            signals: trial.signals,
            unblinded: follower.session.unblinded,
            orders_served: trial.served.len() as u64,
            trial_s: trial.seconds,
            gaze: GazeQualitySummary::from_session(&follower.session),
            gaze_faults: gaze_summary::describe(&follower.session),
        }
    }

    /// The summary as text for the terminal.
    pub fn describe(&self) -> String {
        let cut = match (self.running, self.cut) {
            (true, _) => "; it is still running: --follow",
            (false, true) => "; it ends without its end event",
            (false, false) => "",
        };
        let standing = match self.standing.counts() {
            true => String::new(),
            false => format!("left out of the analysis: {}\n", self.standing.describe()),
        };
        let gaze = self.gaze_faults.as_ref().map_or(String::new(), |faults| format!("{faults}\n"));
        format!(
            "{standing}{}, {:.0} s of trial{cut}\n{} of the human ({}), {} of the robot, {}, {} served\n{}\n{gaze}",
            count(self.events, "event", "events"),
            self.trial_s,
            count(self.human_actions, "press", "presses"),
            count(self.errors, "error", "errors"),
            self.robot_actions,
            count(self.signals, "signal", "signals"),
            count(self.orders_served, "order", "orders"),
            self.beliefs.describe(self.errors)
        )
    }
}
