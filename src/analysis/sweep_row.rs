//! A row of the table in which values of a setting are compared.

use serde::Serialize;

use super::trial_summary::SimulationSummary;

/// Errors and presses of the human in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrialErrors {
    /// The human's presses that were errors.
    pub errors: u64,
    /// Presses of the human.
    pub human_actions: u64,
}

/// A row: the trials of one combination of values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepRow {
    /// What was set, by name; nothing in the row without signals.
    pub settings: serde_json::Map<String, serde_json::Value>,
    /// Number of trials.
    pub trials: u64,
    /// Errors per 100 presses of the human.
    pub errors_per_100: f64,
    /// Signals per 100 presses of the human.
    pub signals_per_100: f64,
    /// Errors per 100 presses of the human fewer than without signals: mean over the same trials.
    pub spared_per_100: Option<f64>,
    /// Standard error of that mean.
    pub spared_error: Option<f64>,
    /// Mean number of errors in an error sequence; null: there were none.
    pub mean_sequence_length: Option<f64>,
    /// Presses of both agents per served order; null: none was served.
    pub presses_per_order: Option<f64>,
}

impl SweepRow {
    /// The row of these settings. `paired`: the same trials without signals, and with them.
    pub fn new(
        settings: &[(&str, String)],
        figures: &SimulationSummary,
        paired: Option<[&[TrialErrors]; 2]>,
    ) -> SweepRow {
        let per_100 = |number: u64, presses: u64| 100.0 * number as f64 / presses.max(1) as f64;
        let rate = |trial: &TrialErrors| per_100(trial.errors, trial.human_actions);
        let spared: Vec<f64> = paired.map_or(Vec::new(), |[before, after]| {
            before.iter().zip(after).map(|(before, after)| rate(before) - rate(after)).collect()
        });
        let count = spared.len() as f64;
        let mean = (count > 0.0).then(|| spared.iter().sum::<f64>() / count);
        let squares = mean.map(|mean| spared.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>());
        SweepRow {
            settings: settings.iter().map(|(name, value)| (name.to_string(), value.as_str().into())).collect(),
            trials: figures.trials,
            errors_per_100: per_100(figures.errors, figures.human_actions),
            signals_per_100: per_100(figures.signals, figures.human_actions),
            spared_per_100: mean,
            spared_error: squares.filter(|_| count > 1.0).map(|squares| (squares / (count - 1.0) / count).sqrt()),
            mean_sequence_length: figures.beliefs.mean_sequence_length,
            presses_per_order: figures.presses_per_order,
        }
    }
}
