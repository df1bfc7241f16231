//! Whether a trial counts: aborted or excluded, or neither.

use serde::Serialize;

use crate::session::Session;

/// What was said about a trial. An analysis leaves out what does not count.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ExclusionStatus {
    /// Why it was aborted; null: it was not.
    pub aborted: Option<String>,
    /// Why it is excluded; null: it is not.
    pub excluded: Option<String>,
}

impl ExclusionStatus {
    /// As it was said at the console.
    pub fn at_console(session: &Session) -> ExclusionStatus {
        ExclusionStatus { aborted: session.aborted.clone(), excluded: session.excluded.clone() }
    }

    /// Whether the analysis takes it.
    pub fn counts(&self) -> bool {
        self.aborted.is_none() && self.excluded.is_none()
    }

    /// For people; empty for what counts.
    pub fn describe(&self) -> String {
        let said = |word: &str, reason: &Option<String>| reason.as_ref().map(|reason| format!("{word}: {reason}"));
        let both = [said("aborted", &self.aborted), said("excluded", &self.excluded)];
        both.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
