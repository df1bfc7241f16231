//! The result of one preflight check (before a trial): verdict, finding and remedy.

use serde::{Deserialize, Serialize};

/// Verdict of a preflight check (a check before a trial).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreflightVerdict {
    /// The preflight check found nothing wrong.
    Ok,
    /// The checked part (such as the eye tracker) is usable with limitations.
    Warning,
    /// The checked part (such as the eye tracker) is not usable.
    Failed,
}

/// Result of a preflight check before a trial or a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreflightCheck {
    /// What the preflight check is about: "display", "disk".
    pub name: String,
    /// The verdict of the preflight check.
    pub verdict: PreflightVerdict,
    /// What the preflight check found, in words.
    pub found: String,
    /// What the wizard can do about the finding; `None` if the verdict is ok.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
}

impl PreflightCheck {
    /// A preflight check with its result; a check with the verdict ok gets no remedy.
    pub fn new(
        name: &str,
        verdict: PreflightVerdict,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> PreflightCheck {
        let remedy = (verdict != PreflightVerdict::Ok).then(|| remedy.into());
        PreflightCheck { name: name.to_string(), verdict, found: found.into(), remedy }
    }

    /// A preflight check with the verdict ok and this finding.
    pub fn ok(name: &str, found: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Ok, found, "")
    }
}
