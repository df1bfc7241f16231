//! The robustness table: what estimate and assistant are worth with cohorts of simulated people whom the assistant's model of the human
//! was not fitted to. The estimate is judged on unassisted trials, with thresholds of flags from trials of another seed; the
//! assistant by the same trials without it and with it acting by itself.

use std::sync::Arc;

use serde::Serialize;

use super::likelihood::LogLikelihood;
use super::trial_bootstrap::interval;
use super::trial_summary::TrialSummary;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::measures::belief_detection::{Detection, TrialView, aspect_groups};
use crate::measures::flags::{MOST_FALSE_FLAGS, chosen_thresholds};
use crate::mind::choice_parameters::DecisionModel;

/// The seed of the bootstrap: the same trials give the same interval.
const SEED: u64 = 1;

/// The trials of a cohort.
#[derive(Clone, Debug, Default)]
pub struct CohortTrials {
    /// Unassisted trials of another seed, on which the thresholds of flags are chosen.
    pub chosen_on: Vec<TrialView>,
    /// The trials that are judged, without signals: their presses and their summaries.
    pub unassisted: Vec<(TrialView, TrialSummary)>,
    /// The same trials with the assistant acting by itself, in the same order.
    pub assisted: Vec<TrialSummary>,
}

/// What a cohort did without signals, and with the assistant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CohortRates {
    /// Errors per 100 presses of the human.
    pub errors_per_100: f64,
    /// Belief related errors per 100 presses of the human.
    pub related_per_100: f64,
    /// Signals per 100 presses of the human.
    pub signals_per_100: f64,
    /// Orders served per minute.
    pub orders_per_minute: f64,
}

/// A row of the table: one cohort. What cannot be computed is null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CohortRow {
    /// The cohort's name.
    pub cohort: String,
    /// Number of judged trials.
    pub trials: u64,
    /// How well the estimate finds false beliefs in the unassisted trials.
    #[serde(flatten)]
    pub detection: Detection,
    /// Log likelihood of the presses in the unassisted trials.
    pub log_likelihood: LogLikelihood,
    /// The trials without signals.
    pub unassisted: CohortRates,
    /// The same trials with the assistant acting by itself.
    pub assisted: CohortRates,
    /// Share of the belief related errors per press of the human that the assistant saves; below 0: there are more with it.
    pub saved: Option<f64>,
    /// 95 % interval of that share, by a bootstrap over pairs of trials; null also where some samples of trials have no such error.
    pub saved_interval: Option<[f64; 2]>,
}

/// The output of `tomcom robustness`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobustnessTable {
    /// Seed of the judged trials.
    pub seed: u64,
    /// Seed of the trials on which thresholds were chosen.
    pub choose_seed: u64,
    /// The cohorts, in the order of the battery.
    pub cohorts: Vec<CohortRow>,
}

impl CohortRow {
    /// Judges the trials of a cohort.
    pub fn from_trials(kitchen: &Arc<Kitchen>, name: &str, trials: &CohortTrials) -> CohortRow {
        let thresholds = chosen_thresholds(&trials.chosen_on, &aspect_groups(kitchen));
        let (views, unassisted): (Vec<TrialView>, Vec<TrialSummary>) = trials.unassisted.iter().cloned().unzip();
        let pairs: Vec<[RelatedErrors; 2]> = unassisted
            .iter()
            .zip(&trials.assisted)
            .map(|(without, with)| [RelatedErrors::from_trial(without), RelatedErrors::from_trial(with)])
            .collect();
        let saved = Some(saved_share(&pairs)).filter(|share| share.is_finite());
        let mut cost = CostToGo::new(kitchen.clone());
        CohortRow {
            cohort: name.to_string(),
            trials: pairs.len() as u64,
            detection: Detection::from_trials(kitchen, &views, thresholds),
            log_likelihood: LogLikelihood::from_trials(kitchen, &mut cost, &DecisionModel::default(), &views, SEED),
            unassisted: CohortRates::from_trials(&unassisted),
            assisted: CohortRates::from_trials(&trials.assisted),
            saved,
            // Resampled trials without an error leave nothing to save: such a table has too few trials for an interval.
            saved_interval: saved
                .map(|_| interval(&pairs, SEED, saved_share))
                .filter(|interval| interval.iter().all(|end| end.is_finite())),
        }
    }
}

/// Belief related errors and presses of the human in one trial.
#[derive(Clone, Copy, Debug, Default)]
struct RelatedErrors {
    errors: u64,
    presses: u64,
}

impl RelatedErrors {
    fn from_trial(trial: &TrialSummary) -> RelatedErrors {
        let errors = trial.beliefs.as_ref().map_or(0, |beliefs| beliefs.related);
        RelatedErrors { errors, presses: trial.human_actions }
    }
}

/// By which share the rate of belief related errors is lower in the second trials of pairs than in the first.
fn saved_share(pairs: &[[RelatedErrors; 2]]) -> f64 {
    let rate = |which: usize| {
        let sum = |count: fn(&RelatedErrors) -> u64| pairs.iter().map(|pair| count(&pair[which])).sum::<u64>() as f64;
        sum(|trial| trial.errors) / sum(|trial| trial.presses)
    };
    1.0 - rate(1) / rate(0)
}

impl CohortRates {
    fn from_trials(trials: &[TrialSummary]) -> CohortRates {
        let sum = |count: fn(&TrialSummary) -> u64| trials.iter().map(count).sum::<u64>() as f64;
        let per_100 = |number: f64| 100.0 * number / sum(|trial| trial.human_actions).max(1.0);
        let minutes = trials.iter().map(|trial| trial.seconds).sum::<f64>() / 60.0;
        CohortRates {
            errors_per_100: per_100(sum(|trial| trial.errors)),
            related_per_100: per_100(sum(|trial| RelatedErrors::from_trial(trial).errors)),
            signals_per_100: per_100(sum(|trial| trial.signals)),
            orders_per_minute: sum(|trial| trial.served.len() as u64) / minutes.max(f64::MIN_POSITIVE),
        }
    }
}

/// The heading of the table as text, with the cohorts' names in so many columns.
pub fn heading(width: usize) -> String {
    let columns = |first: &str, names: [&str; 11]| {
        let [places, recipes, ece, flagged, false_flags, gain, without, with, saved, signals, orders] = names;
        let line = format!(
            "{first:<width$}{places:>7}{recipes:>8}{ece:>6}{flagged:>12}{false_flags:>6}{gain:>6}{without:>8}{with:>6}{saved:>16}\
             {signals:>8}{orders:>12}"
        );
        line.trim_end().to_string()
    };
    let above = ["ROC", "ROC", "", "", "false", "", "errors", "", "", "signals", ""];
    let below =
        ["places", "recipes", "ECE", "flagged", "flags", "gain", "without", "with", "saved, %", "/100", "orders/min"];
    format!("{}\n{}\n", columns("", above), columns("cohort", below))
}

/// One row of the table as text, with the cohort's name in so many columns.
pub fn describe_row(row: &CohortRow, width: usize) -> String {
    let number = |value: Option<f64>, digits: usize| value.map_or("-".to_string(), |value| format!("{value:.digits$}"));
    let (found, flags) = (&row.detection, &row.detection.flags);
    let flagged = match (flags.flagged_before_third_error, flags.episodes) {
        (Some(share), Some(episodes)) => format!("{share:.2} of {episodes}"),
        _ => "-".to_string(),
    };
    let saved = match (row.saved, row.saved_interval) {
        (Some(share), Some([from, to])) => {
            format!("{:.0} ({:.0} to {:.0})", 100.0 * share, 100.0 * from, 100.0 * to)
        }
        (Some(share), None) => format!("{:.0}", 100.0 * share),
        (None, _) => "-".to_string(),
    };
    let orders = [&row.unassisted, &row.assisted].map(|rates| format!("{:.2}", rates.orders_per_minute)).join(", ");
    format!(
        "{:<width$}{:>7}{:>8}{:>6}{:>12}{:>6}{:>6}{:>8}{:>6}{saved:>16}{:>8}{orders:>12}\n",
        row.cohort,
        number(found.auc_locations, 3),
        number(found.auc_recipes, 3),
        number(found.ece, 3),
        flagged,
        number(flags.false_flags_per_20_actions, 2),
        number(row.log_likelihood.gain, 2),
        number(Some(row.unassisted.related_per_100), 1),
        number(Some(row.assisted.related_per_100), 1),
        number(Some(row.assisted.signals_per_100), 1),
    )
}

/// Number of columns for the longest of these names.
pub fn name_width<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or_default().max("cohort".len()) + 1
}

/// What the columns of the table mean, as text.
pub fn legend(table: &RobustnessTable) -> String {
    format!(
        "\n{} trials of seed {} for each cohort without signals, and the same with the assistant acting by itself; thresholds of \
         flags from as many trials of seed {}.\n\
         ROC: area under the curve, how well the estimate before each unassisted press finds false beliefs.\n\
         ECE: expected calibration error, how far its predicted probabilities of a false belief are off.\n\
         flagged: false belief episodes of two or more errors that are flagged before the third; the thresholds allow \
         {MOST_FALSE_FLAGS} false flags per 20 presses of the human.\n\
         gain: log likelihood per press beyond that of a human who knows everything, in nats.\n\
         errors, signals: belief related errors without and with the assistant, and signals, per 100 presses of the human.\n\
         saved: by how much fewer errors there are with the assistant (95 % interval by drawing pairs of trials).\n\
         orders/min: orders served a minute, without and with the assistant.\n",
        table.cohorts.first().map_or(0, |row| row.trials),
        table.seed,
        table.choose_seed,
    )
}
