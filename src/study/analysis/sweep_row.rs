//! Row of a table that compares values of a setting, as a parameter sweep (`tomcom sweep`) prints it.

use serde::Serialize;

use super::trial_summary::SimulationSummary;

/// Numbers of errors and of presses of the human in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PressErrorCounts {
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of errors that follow from false beliefs; `None` where the participant's beliefs are not known.
    pub related: Option<u64>,
    /// Number of presses of the human.
    pub human_actions: u64,
}

/// Row of a parameter sweep: results of the trials with one combination of setting values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSweepRow {
    /// Values of the varied settings, by the setting's name; empty in the row without signals.
    pub settings: serde_json::Map<String, serde_json::Value>,
    /// Number of simulated trials with this combination of setting values.
    pub trials: u64,
    /// Errors per 100 presses of the human.
    pub errors_per_100: f64,
    /// Signals per 100 presses of the human.
    pub signals_per_100: f64,
    /// Reduction of the errors per 100 presses of the human compared with no signals: mean over the same trials.
    pub spared_per_100: Option<f64>,
    /// Standard error of the reduction `spared_per_100`.
    pub spared_error: Option<f64>,
    /// Mean number of errors in an error sequence; null without sequences.
    pub mean_sequence_length: Option<f64>,
    /// Median over served orders of the number of presses of both agents since the previously served order; null if no order was served.
    pub presses_per_order: Option<f64>,
    /// Errors that follow from false beliefs, per 100 presses of the human; null if the participants' beliefs are not
    /// known.
    pub related_per_100: Option<f64>,
    /// Reduction of the errors per 100 presses of the human compared with the first row with signals: mean over the
    /// same trials.
    pub fewer_than_first: Option<f64>,
    /// Standard error of the reduction `fewer_than_first`.
    pub fewer_error: Option<f64>,
    /// Reduction of the errors from false beliefs per 100 presses of the human compared with the first row with
    /// signals: mean over the same trials.
    pub related_fewer_than_first: Option<f64>,
    /// Standard error of the reduction `related_fewer_than_first`.
    pub related_fewer_error: Option<f64>,
}

/// The same trials simulated under two combinations of setting values, in the same order.
type PairedTrials<'a> = [&'a [PressErrorCounts]; 2];

impl ParameterSweepRow {
    /// The row for these setting values. `paired`: the same trials without and with signals. `with_first`: the same
    /// trials in the first row with signals, and in this row.
    pub fn new(
        settings: &[(&str, String)],
        figures: &SimulationSummary,
        paired: Option<PairedTrials>,
        with_first: Option<PairedTrials>,
    ) -> ParameterSweepRow {
        let errors = |trial: &PressErrorCounts| Some(trial.errors);
        let related = |trial: &PressErrorCounts| trial.related;
        let (spared_per_100, spared_error) = fewer(paired, errors);
        let (fewer_than_first, fewer_error) = fewer(with_first, errors);
        let (related_fewer_than_first, related_fewer_error) = fewer(with_first, related);
        ParameterSweepRow {
            settings: settings.iter().map(|(name, value)| (name.to_string(), value.as_str().into())).collect(),
            trials: figures.trials,
            errors_per_100: per_100(figures.errors, figures.human_actions),
            signals_per_100: per_100(figures.signals, figures.human_actions),
            spared_per_100,
            spared_error,
            mean_sequence_length: figures.beliefs.mean_sequence_length,
            presses_per_order: figures.presses_per_order,
            related_per_100: figures.beliefs.belief_related_errors.map(|errors| per_100(errors, figures.human_actions)),
            fewer_than_first,
            fewer_error,
            related_fewer_than_first,
            related_fewer_error,
        }
    }
}

fn per_100(number: u64, presses: u64) -> f64 {
    100.0 * number as f64 / presses.max(1) as f64
}

/// Mean reduction of a number per 100 presses of the human between paired trials (first minus second), and its standard
/// error.
fn fewer(
    paired: Option<PairedTrials>,
    number: impl Fn(&PressErrorCounts) -> Option<u64>,
) -> (Option<f64>, Option<f64>) {
    let rate = |trial: &PressErrorCounts| number(trial).map(|number| per_100(number, trial.human_actions));
    let Some([before, after]) = paired else { return (None, None) };
    let each = before.iter().zip(after).map(|(before, after)| Some(rate(before)? - rate(after)?));
    let Some(each) = each.collect::<Option<Vec<f64>>>().filter(|each| !each.is_empty()) else { return (None, None) };
    let count = each.len() as f64;
    let mean = each.iter().sum::<f64>() / count;
    let squares = each.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>();
    (Some(mean), (count > 1.0).then(|| (squares / (count - 1.0) / count).sqrt()))
}
