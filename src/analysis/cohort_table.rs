//! The robustness table: how well estimate and assistant do with cohorts of simulated people to whom the assistant's
//! human model was not fitted. The belief estimate is judged on unassisted trials; the thresholds for flagging false
//! beliefs are chosen on trials with another seed. The assistant is judged by comparing the same trials without signals
//! and with signals that the assistant sends by itself.

use std::sync::Arc;

use serde::Serialize;

use super::likelihood::PressLogLikelihood;
use super::trial_bootstrap::interval;
use super::trial_summary::TrialSummary;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::measures::belief_detection::{FalseBeliefDetection, TrialBeliefs, aspect_groups};
use crate::measures::flags::{MOST_FALSE_FLAGS, chosen_thresholds};
use crate::mind::choice_parameters::ChoiceParameters;

/// Seed of the bootstrap's random numbers: the same trials give the same interval.
const SEED: u64 = 1;

/// Simulated trials of one cohort.
#[derive(Clone, Debug, Default)]
pub struct CohortTrials {
    /// Unassisted trials with another seed, on which the thresholds for flagging false beliefs are chosen.
    pub chosen_on: Vec<TrialBeliefs>,
    /// The judged trials without signals: the presses of each trial, and the trial's summary.
    pub unassisted: Vec<(TrialBeliefs, TrialSummary)>,
    /// Summaries of the judged trials, in the same order, repeated with signals that the assistant sends by itself.
    pub assisted: Vec<TrialSummary>,
}

/// Rates of errors, signals and served orders of one cohort, without signals or with the assistant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CohortRates {
    /// Errors per 100 presses of the human.
    pub errors_per_100: f64,
    /// Errors that follow from false beliefs, per 100 presses of the human.
    pub related_per_100: f64,
    /// Signals per 100 presses of the human.
    pub signals_per_100: f64,
    /// Orders served per minute of the trials.
    pub orders_per_minute: f64,
}

/// Row of the robustness table: results of one cohort. Values that cannot be computed are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CohortRow {
    /// Name of the cohort in the battery file.
    pub cohort: String,
    /// Number of trials on which the estimate and the assistant are judged.
    pub trials: u64,
    /// How well the belief estimate finds false beliefs of the participants in the unassisted trials.
    #[serde(flatten)]
    pub detection: FalseBeliefDetection,
    /// Log likelihood of the human's presses in the unassisted trials, under the model and two baselines.
    pub log_likelihood: PressLogLikelihood,
    /// Rates of errors, signals and served orders in the trials without signals.
    pub unassisted: CohortRates,
    /// Rates of errors, signals and served orders in the same trials with signals that the assistant sends by itself.
    pub assisted: CohortRates,
    /// Share by which the assistant lowers the rate of errors from false beliefs per press of the human; below 0 if the
    /// assistant raises the rate.
    pub saved: Option<f64>,
    /// 95 % interval of `saved`, by a bootstrap over pairs of trials; null also where a bootstrap sample has no error
    /// from a false belief.
    pub saved_interval: Option<[f64; 2]>,
}

/// Robustness of estimate and assistant for each cohort of simulated people: the output of `tomcom robustness`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobustnessTable {
    /// Seed of the judged trials.
    pub seed: u64,
    /// Seed of the trials on which the thresholds for flagging false beliefs were chosen.
    pub choose_seed: u64,
    /// One row per cohort, in the order of the battery file.
    pub cohorts: Vec<CohortRow>,
}

impl CohortRow {
    /// Computes the robustness table's row of one cohort from the cohort's trials.
    pub fn from_trials(kitchen: &Arc<Kitchen>, name: &str, trials: &CohortTrials) -> CohortRow {
        let thresholds = chosen_thresholds(&trials.chosen_on, &aspect_groups(kitchen));
        let (views, unassisted): (Vec<TrialBeliefs>, Vec<TrialSummary>) = trials.unassisted.iter().cloned().unzip();
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
            detection: FalseBeliefDetection::from_trials(kitchen, &views, thresholds),
            log_likelihood: PressLogLikelihood::from_trials(
                kitchen,
                &mut cost,
                &ChoiceParameters::default(),
                &views,
                SEED,
            ),
            unassisted: CohortRates::from_trials(&unassisted),
            assisted: CohortRates::from_trials(&trials.assisted),
            saved,
            // A bootstrap sample without errors has no errors to save; a table in which such a sample occurs has too
            // few trials for an interval.
            saved_interval: saved
                .map(|_| interval(&pairs, SEED, saved_share))
                .filter(|interval| interval.iter().all(|end| end.is_finite())),
        }
    }
}

/// Counts of errors from false beliefs, and of presses of the human, in one trial.
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

/// Share by which the rate of errors from false beliefs is lower in the second trials of the pairs than in the first.
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

/// Heading of the robustness table as text; the column of cohort names is `width` characters wide.
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

/// One row of the robustness table as text; the column of cohort names is `width` characters wide.
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

/// Width, in characters, of a table column that fits the longest of these names.
pub fn name_width<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or_default().max("cohort".len()) + 1
}

/// Explanation of the robustness table's columns, as text.
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
