//! Whether analyses count a trial, or leave it out because it was aborted or excluded.

use serde::Serialize;

use tomcom_session::{Session, TrialPhase};

/// Whether a trial was aborted or excluded; an analysis leaves out aborted and excluded trials.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ExclusionStatus {
    /// Reason for aborting the trial; null if the trial was not aborted.
    pub aborted: Option<String>,
    /// Reason for excluding the trial; null if the trial is not excluded.
    pub excluded: Option<String>,
}

impl ExclusionStatus {
    /// The exclusion status that the wizard set at the console during the session.
    pub fn at_console(session: &Session) -> ExclusionStatus {
        ExclusionStatus { aborted: session.aborted.clone(), excluded: session.excluded.clone() }
    }

    /// Whether analyses include the trial: it was neither aborted nor excluded.
    pub fn counts(&self) -> bool {
        self.aborted.is_none() && self.excluded.is_none()
    }

    /// Why analyses leave out the trial of a session that was read as far as it is recorded, in words; `None` for a trial
    /// that counts. `is_running`: a program is still recording the session.
    pub fn left_out(self, session: &Session, is_running: bool) -> Option<String> {
        let is_over = matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed);
        match self {
            ExclusionStatus { aborted: Some(reason), .. } => Some(format!("aborted: {reason}")),
            ExclusionStatus { excluded: Some(reason), .. } => Some(format!("excluded: {reason}")),
            _ if !is_over && is_running => Some("running: its trial is not over".to_string()),
            _ if !is_over => Some("cut before the trial's end".to_string()),
            _ if session.presses == [0, 0] => Some("no press in it".to_string()),
            _ => None,
        }
    }

    /// The exclusion status as text; empty for a trial that counts.
    pub fn describe(&self) -> String {
        let said = |word: &str, reason: &Option<String>| reason.as_ref().map(|reason| format!("{word}: {reason}"));
        let both = [said("aborted", &self.aborted), said("excluded", &self.excluded)];
        both.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
