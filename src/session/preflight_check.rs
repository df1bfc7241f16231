//! One thing that is looked at before a trial or a session: its verdict, and how to mend it.

use serde::{Deserialize, Serialize};

/// How something was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreflightVerdict {
    Ok,
    /// It works, but less well.
    Warning,
    /// It does not work so.
    Failed,
}

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreflightCheck {
    pub name: String,
    pub verdict: PreflightVerdict,
    pub found: String,
    /// How to mend it, unless it is ok.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
}

impl PreflightCheck {
    pub fn new(
        name: &str,
        verdict: PreflightVerdict,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> PreflightCheck {
        let remedy = (verdict != PreflightVerdict::Ok).then(|| remedy.into());
        PreflightCheck { name: name.to_string(), verdict, found: found.into(), remedy }
    }

    /// Something that is as it should be.
    pub fn ok(name: &str, found: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Ok, found, "")
    }
}
