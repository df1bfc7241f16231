//! Why a result is not known, in words: the same in the terminal and in the report.

use crate::effect::AssistanceEffect;
use crate::trial_statistics::{TrialStatistics, TrialTotals};
use tomcom_core::base::text;

pub(crate) const NO_PRESS: &str = "no press of the human";
pub(crate) const NO_ORDER: &str = "no order was served";
pub(crate) const NO_SIGNAL: &str = "no signal";
pub(crate) const NO_SHIFT: &str = "too few presses to shift the signals";
pub(crate) const NO_MATCH: &str = "no signal matches";
pub(crate) const NO_PLAN: &str = "recorded without a plan";
pub(crate) const CUT: &str = "the recording was cut";
pub(crate) const ONE_PRESS: &str = "fewer than two presses";
pub(crate) const NO_ANSWER: &str = "no answer";
pub(crate) const ONE_ANSWER: &str = "fewer than two answers";
pub(crate) const NO_KAPPA: &str = "kappa is not defined where both give one code only";
pub(crate) const TIMED_ARM: &str = "a timed arm feels nothing";
pub(crate) const NO_COUNTS: &str = "the negative binomial model did not converge";
pub(crate) const NO_CURVE: &str = "no value of the concept\u{2019}s parameter sends so many signals";
pub(crate) const NO_AREA: &str = "the concepts reach no common false positive rate";
pub(crate) const NOT_TWINNED: &str = "the trials have no twins without the signals";
pub(crate) const NOT_OFFLINE: &str = "the analysis of unassisted trials has no such sender, or was left out";
pub(crate) const ONE_KIND: &str = "answers of this kind are all right, or all wrong, or there are none";
pub(crate) const NO_VALUE: &str = "no answer names a value";
pub(crate) const UNCALIBRATED: &str = "no prediction between 0.05 and 0.95";
pub(crate) const NO_REFERENCE: &str = "no trials without signals to compare with, or no belief related error in them";
const NO_CAUSES: &str = "the causes of errors are not known of every trial";
const NO_ERROR: &str = "no error";
pub(crate) const NO_SEQUENCE: &str = "no sequence of errors";
const NOT_RECOVERED: &str = "no sequence was followed by a correct press";

/// A number for the terminal: "0.62", or "- (no signal)".
pub(crate) fn decimal(value: Option<f64>, digits: usize, why: &str) -> String {
    value.map_or_else(|| format!("- ({why})"), |value| format!("{value:.digits$}"))
}

pub(crate) fn percent(share: Option<f64>, why: &str) -> String {
    share.map_or_else(|| format!("- ({why})"), |share| text::percent(Some(share)))
}

fn unless_unknown(has_causes: bool, otherwise: &'static str) -> &'static str {
    if has_causes { otherwise } else { NO_CAUSES }
}

impl TrialTotals {
    /// Why the share of errors that are belief related is not known.
    pub(crate) fn why_no_share(&self) -> &'static str {
        unless_unknown(self.belief_related_errors.is_some(), NO_ERROR)
    }

    /// Why a rate of belief related errors or sequences, or their number, is not known.
    pub(crate) fn why_no_rate(&self) -> &'static str {
        unless_unknown(self.belief_related_errors.is_some(), NO_PRESS)
    }

    pub(crate) fn why_no_length(&self) -> &'static str {
        unless_unknown(self.belief_related_errors.is_some(), NO_SEQUENCE)
    }

    pub(crate) fn why_no_recovery(&self) -> &'static str {
        let why = if self.sequences == Some(0) { NO_SEQUENCE } else { NOT_RECOVERED };
        unless_unknown(self.belief_related_errors.is_some(), why)
    }
}

impl TrialStatistics {
    pub(crate) fn why_no_length(&self) -> &'static str {
        unless_unknown(self.beliefs.is_some(), NO_SEQUENCE)
    }
}

impl AssistanceEffect {
    /// Why a test of assistance is not there.
    pub(crate) fn why_no_test(&self) -> &'static str {
        match self.groups {
            [0, 0] => "no participant has the measure in one trial with assistance and one without",
            [0, _] | [_, 0] => "all participants have the same order of conditions",
            [1, 1] => "one participant with each order of conditions is too few",
            _ => "the values do not vary",
        }
    }
}
