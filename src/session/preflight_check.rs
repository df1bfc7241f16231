//! The result of one preflight check: verdict, finding and remedy.

use serde::{Deserialize, Serialize};

/// Verdict of a preflight check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreflightVerdict {
    /// All is well.
    Ok,
    /// Usable with limitations.
    Warning,
    /// Not usable.
    Failed,
}

/// Result of a preflight check before a trial or a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreflightCheck {
    /// What was looked at: "display", "disk".
    pub name: String,
    /// How it was found.
    pub verdict: PreflightVerdict,
    /// What was found, in words.
    pub found: String,
    /// Remedy, unless the verdict is ok.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
}

impl PreflightCheck {
    /// A check with its result; an ok one needs no remedy and gets none.
    pub fn new(
        name: &str,
        verdict: PreflightVerdict,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> PreflightCheck {
        let remedy = (verdict != PreflightVerdict::Ok).then(|| remedy.into());
        PreflightCheck { name: name.to_string(), verdict, found: found.into(), remedy }
    }

    /// A check with the verdict ok.
    pub fn ok(name: &str, found: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Ok, found, "")
    }
}
