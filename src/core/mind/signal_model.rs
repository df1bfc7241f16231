//! The comprehension of signals: whether a signal is noticed, when it is read, and whether it is understood.

use super::model_table::model_table;
use crate::kitchen::LocationKind;

/// Upper bound of probabilities that a signal is noticed where signals take time: a signal certain to be noticed could
/// not be missed.
const MOST_NOTICED: f64 = 0.999;

model_table! {
    /// The effect of a signal on the human.
    ///
    /// With `delay_s` = 0 a signal is believed at once with the probability `noticed`. Otherwise a signal is read while
    /// it stands on the display, and may be missed.
    SignalModel, GivenSignal {
        /// Probability that a signal is noticed. Where signals take time: that a signal which stands for long is
        /// noticed under unknown gaze.
        noticed: f64,
        /// Probability that a highlight is noticed, if it differs from that of a shown recipe.
        #[serde(skip_serializing_if = "Option::is_none")]
        highlight_noticed: Option<f64>,
        /// Mean time until somebody who notices a signal reads it, in seconds after its beginning; 0: signals are
        /// believed at once.
        delay_s: f64,
        /// Readings per second of a signal while the gaze is known to be at its place, at distance 0 and with full
        /// confidence.
        reading_rate_hz: f64,
        /// Probability that somebody who reads a signal takes it for any of the other values.
        misread: f64,
        /// Probability that the human presses what the display proposes because it is proposed. Nobody has measured
        /// this probability; 0.7 stands for a person who notices most proposals and makes most of them.
        follows: f64,
    }
}

impl SignalModel {
    /// Whether signals take time to be read, and can be missed; otherwise signals are believed at once.
    pub fn takes_time(&self) -> bool {
        self.delay_s > 0.0
    }

    /// Probability that a signal about a location of this kind is noticed.
    pub fn noticed_at(&self, kind: LocationKind) -> f64 {
        match kind {
            LocationKind::Order => self.noticed,
            _ => self.highlight_noticed.unwrap_or(self.noticed),
        }
    }

    /// Hazard that a signal is read under unknown gaze between two times since its beginning, in seconds, by somebody
    /// who notices it with the probability `noticed`: over all time, 1 - exp(-hazard) = `noticed`. Hazards of parts add
    /// up.
    pub fn reading_hazard(&self, noticed: f64, from_s: f64, until_s: f64) -> f64 {
        let waits = |time_s: f64| (-time_s.max(0.0) / self.delay_s).exp();
        -(-noticed.min(MOST_NOTICED)).ln_1p() * (waits(from_s) - waits(until_s)).max(0.0)
    }

    /// Distribution over the `values` values of an aspect that a reader takes a signal about it for; `truth` is the
    /// true value.
    pub fn understood(&self, truth: usize, values: usize) -> impl Iterator<Item = f64> + use<> {
        let misread = if values > 1 { self.misread } else { 0.0 };
        let each_other = misread / values.saturating_sub(1).max(1) as f64;
        (0..values).map(move |value| if value == truth { 1.0 - misread } else { each_other })
    }
}

/// Forecast of how a signal that is shown now will be read, which the planner assumes in its rollouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalReadingForecast {
    /// Probability that a recipe shown now is read and understood.
    pub recipe: f64,
    /// Probability that a highlight shown now is read and understood.
    pub highlight: f64,
    /// Time from the beginning of the signal until the participant reads it, in seconds.
    pub delay_s: f64,
}

impl Default for SignalReadingForecast {
    /// By default everybody believes a signal at once.
    fn default() -> Self {
        SignalReadingForecast { recipe: 1.0, highlight: 1.0, delay_s: 0.0 }
    }
}

impl SignalReadingForecast {
    /// Probability that a signal about a location of this kind is read and understood.
    pub fn probability(&self, kind: LocationKind) -> f64 {
        match kind {
            LocationKind::Order => self.recipe,
            _ => self.highlight,
        }
    }
}
