//! The aims of a study: its primary outcome, and its margin of non-inferiority.

use serde::{Deserialize, Serialize};

/// The aims of a study, which are set before the study begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudyAims {
    /// The outcome that the analysis compares first between the conditions.
    pub outcome: PrimaryOutcome,
    /// Margin of non-inferiority: the assistant counts as not worse than the wizard if the ratio of their rates is
    /// below the margin.
    pub margin: f64,
}

impl Default for StudyAims {
    fn default() -> Self {
        StudyAims { outcome: PrimaryOutcome::Errors, margin: 1.25 }
    }
}

impl StudyAims {
    pub(super) fn are_default(&self) -> bool {
        *self == StudyAims::default()
    }
}

/// The primary outcome of a study: a number of events in a trial, compared as a rate per press of the human.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PrimaryOutcome {
    /// Primary outcome: all errors of the human.
    #[default]
    Errors,
    /// Primary outcome: errors that a false belief caused; for people these are known from two raters' codes.
    BeliefRelatedErrors,
    /// Primary outcome: error sequences (related errors); for people these are known from two raters' codes.
    Sequences,
}

impl PrimaryOutcome {
    /// Name of the primary outcome in texts.
    pub fn title(self) -> &'static str {
        match self {
            PrimaryOutcome::Errors => "errors",
            PrimaryOutcome::BeliefRelatedErrors => "belief related errors",
            PrimaryOutcome::Sequences => "sequences of related errors",
        }
    }
}
