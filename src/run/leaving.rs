//! Result of a live session, and the way in which the wizard left it.

use std::path::PathBuf;

use super::options::SessionStart;
use tomcom_core::base::text::count;
use tomcom_session::Session;
use tomcom_study::analysis::recording_summary::ExclusionStatus;
use tomcom_study::analysis::trial_summary::TrialSummary;

/// How the wizard left a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeavingReason {
    Quit,
    Next,
    /// The wizard repeats the trial in a new recording.
    Redo,
}

/// How far the participant came in a tutorial that the recording ended with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TutorialProgress {
    pub done: u64,
    pub steps: u64,
    pub presses: u64,
    pub wrong_answers: u64,
}

impl TutorialProgress {
    /// How far the participant came in the session's tutorial; `None` in a session that is in another phase.
    pub fn from_session(session: &Session) -> Option<TutorialProgress> {
        let (tutorial, state) = session.tutorial()?;
        Some(TutorialProgress {
            done: state.done.iter().filter(|is_done| **is_done).count() as u64,
            steps: tutorial.steps.len() as u64,
            presses: u64::from(state.pressed),
            wrong_answers: state.wrong_answers.iter().copied().map(u64::from).sum(),
        })
    }

    fn describe(self) -> String {
        let TutorialProgress { done, steps, presses, wrong_answers } = self;
        let presses = count(presses, "press", "presses");
        format!(
            "tutorial: {done} of {steps} steps done, {presses}, {}",
            count(wrong_answers, "wrong answer", "wrong answers")
        )
    }
}

/// Result of a live session: its recording, its summary, and how the wizard left it.
#[derive(Clone, Debug)]
pub struct LiveOutcome {
    /// `None` if nothing happened, so that the recording was removed.
    pub folder: Option<PathBuf>,
    pub leaving: LeavingReason,
    pub figures: TrialSummary,
    /// How far the participant came, if the session was left in a tutorial.
    pub tutorial: Option<TutorialProgress>,
    /// Whether the trial was aborted or excluded from the analysis.
    pub standing: ExclusionStatus,
    /// What the repetition of the trial starts from, if the wizard asked for one.
    pub again: Option<SessionStart>,
}

impl LiveOutcome {
    pub fn describe(&self) -> String {
        let Some(folder) = &self.folder else { return "nothing was recorded: no trial was begun".to_string() };
        // A further part has the absolute path of its recording.
        let here = std::env::current_dir().ok();
        let folder = here.and_then(|here| folder.strip_prefix(here).ok()).unwrap_or(folder).display();
        let presses = count(self.figures.human_actions + self.figures.robot_actions, "press", "presses");
        let signals = count(self.figures.signals, "signal", "signals");
        let served = count(self.figures.served.len() as u64, "order", "orders");
        let trial = || format!("{presses} of human and robot, {signals}, {served} served");
        let reached = self.tutorial.map_or_else(trial, TutorialProgress::describe);
        let standing = if self.standing.counts() {
            String::new()
        } else {
            format!("the recording is left out of the analysis: {}\n", self.standing.describe())
        };
        format!(
            "{reached}\n{standing}recorded in {folder}\n\
             {}",
            ways_to_look("the recording", &folder.to_string())
        )
    }
}

/// The commands that show a recording, in words; each command stands on a line of its own, to be copied.
pub(super) fn ways_to_look(what: &str, folder: &str) -> String {
    format!("look at {what}:\n  tomcom replay {folder}\nin Rerun:\n  tomcom review {folder}")
}
