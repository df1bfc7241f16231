//! The comprehension of signals: whether a signal is noticed, when it is read, and whether it is understood.

use serde::{Deserialize, Serialize};

use crate::kitchen::LocationKind;

/// Probabilities of having been noticed are at most this where signals take time: what is certain could not be missed.
const MOST_NOTICED: f64 = 0.999;

/// The effect of a signal on the human.
///
/// With `delay_s` = 0 a signal is believed at once with the probability `noticed`: so recordings have it whose header lacks the key. Otherwise
/// it is read while it stands on the display, and may be missed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SignalModel {
    /// Probability that a signal is noticed. Where signals take time, that of a signal that stands for long, under unknown gaze.
    pub noticed: f64,
    /// The same of a highlight, where it is not that of a recipe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highlight_noticed: Option<f64>,
    /// Mean time from the beginning of a signal until who notices it reads it, in seconds; 0: it is believed at once.
    #[serde(skip_serializing_if = "is_zero")]
    pub delay_s: f64,
    /// Readings a second of a signal while the gaze is known to be at its place, at distance 0 and full confidence.
    #[serde(skip_serializing_if = "is_usual_reading")]
    pub reading_rate_hz: f64,
    /// Probability that a signal that is read is taken for any of the other values.
    #[serde(skip_serializing_if = "is_zero")]
    pub misread: f64,
    /// Number of signals that `noticed` counts for, when the estimate learns how often this person notices signals; 0: it does not.
    #[serde(skip_serializing_if = "is_zero")]
    pub noticed_precision: f64,
    /// Probability that the human presses what the display proposes because it is proposed. Nobody has measured it; the default stands for
    /// a person who notices most proposals and makes most of those.
    #[serde(skip_serializing_if = "is_usual_following")]
    pub follows: f64,
}

/// The default of [`SignalModel::follows`]. Files and headers leave it out.
const FOLLOWS: f64 = 0.7;
/// The default of [`SignalModel::reading_rate_hz`]. Files and headers leave it out.
const READING_RATE_HZ: f64 = 3.0;

fn is_usual_following(follows: &f64) -> bool {
    *follows == FOLLOWS
}

fn is_usual_reading(rate_hz: &f64) -> bool {
    *rate_hz == READING_RATE_HZ
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Default for SignalModel {
    fn default() -> Self {
        SignalModel {
            noticed: 1.0,
            highlight_noticed: None,
            delay_s: 0.0,
            reading_rate_hz: READING_RATE_HZ,
            misread: 0.0,
            noticed_precision: 0.0,
            follows: FOLLOWS,
        }
    }
}

impl SignalModel {
    /// Whether signals take time to be read, and can be missed; else they are believed at once.
    pub fn takes_time(&self) -> bool {
        self.delay_s > 0.0
    }

    /// Expected probability that a signal about a location of this kind is noticed, once `read` of `shown` signals have been read: the mean
    /// of a Beta distribution with the precision `noticed_precision` before, the same evidence for both kinds of signals.
    pub fn expected_noticed(&self, kind: LocationKind, read: f64, shown: f64) -> f64 {
        let before = match kind {
            LocationKind::Order => self.noticed,
            _ => self.highlight_noticed.unwrap_or(self.noticed),
        };
        match self.noticed_precision > 0.0 {
            true => (self.noticed_precision * before + read) / (self.noticed_precision + shown),
            false => before,
        }
    }

    /// Hazard of being read under unknown gaze between two times since the beginning of the signal, in seconds, by somebody who notices it with
    /// the probability `noticed`: over all time, 1 - exp(-hazard) = `noticed`. Hazards of parts add up.
    pub fn reading_hazard(&self, noticed: f64, from_s: f64, until_s: f64) -> f64 {
        let waits = |time_s: f64| (-time_s.max(0.0) / self.delay_s).exp();
        -(-noticed.min(MOST_NOTICED)).ln_1p() * (waits(from_s) - waits(until_s)).max(0.0)
    }

    /// Distribution of the value that a reader takes an aspect with `values` values for whose true value is `truth`.
    pub fn understood(&self, truth: usize, values: usize) -> impl Iterator<Item = f64> + use<> {
        let misread = if values > 1 { self.misread } else { 0.0 };
        let each_other = misread / values.saturating_sub(1).max(1) as f64;
        (0..values).map(move |value| if value == truth { 1.0 - misread } else { each_other })
    }
}

/// How a signal that is shown now will be read: what the planner assumes in its rollouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalForecast {
    /// Probability that a shown recipe is read and understood.
    pub recipe: f64,
    /// The same of a highlight.
    pub highlight: f64,
    /// Time from the beginning of the signal until it is read, in seconds.
    pub delay_s: f64,
}

impl Default for SignalForecast {
    /// A signal is believed at once, by everybody.
    fn default() -> Self {
        SignalForecast { recipe: 1.0, highlight: 1.0, delay_s: 0.0 }
    }
}

impl SignalForecast {
    /// Probability that a signal about a location of this kind is read and understood.
    pub fn probability(&self, kind: LocationKind) -> f64 {
        match kind {
            LocationKind::Order => self.recipe,
            _ => self.highlight,
        }
    }
}
