//! The robustness table: how well estimate and assistant do with cohorts of simulated people to whom the assistant's
//! human model was not fitted. The belief estimate is judged on unassisted trials; the thresholds for flagging false
//! beliefs are chosen on trials with another seed. The assistant is judged by comparing the same trials without signals
//! and with signals that the assistant sends by itself.

use std::sync::Arc;

use serde::Serialize;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::detection::DetectionScores;
use tomcom_core::measures::detection::{FalseBeliefDetection, TrialBeliefs, aspect_groups};
use tomcom_core::measures::flags::{ThresholdChoice, chosen_thresholds};
use tomcom_core::mind::choice::ChoiceParameters;
use tomcom_study::analysis::likelihood::PressLogLikelihood;
use tomcom_study::analysis::trial_summary::TrialSummary;
use tomcom_study::statistics::intervals;

/// Seed of the bootstrap's random numbers: the same trials give the same interval.
const SEED: u64 = 1;

#[derive(Clone, Debug, Default)]
pub struct CohortTrials {
    /// Unassisted trials with another seed, on which the thresholds for flagging false beliefs are chosen.
    pub chosen_on: Vec<TrialBeliefs>,
    pub judged: Vec<TrialBeliefs>,
    pub unassisted: Vec<TrialSummary>,
    /// Summaries of the judged trials, in the same order, repeated with signals that the assistant sends by itself.
    pub assisted: Vec<TrialSummary>,
}

/// Rates of errors, signals and served orders of one cohort, without signals or with the assistant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CohortRates {
    pub errors_per_100: f64,
    pub related_per_100: f64,
    pub signals_per_100: f64,
    pub orders_per_minute: f64,
}

/// Results of one cohort: a row of the robustness table. Values that cannot be computed are null. An interval is one of
/// 95 %, by a bootstrap over trials; it is null also where resamples leave its value unknown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CohortRow {
    pub cohort: String,
    /// Number of trials on which the estimate and the assistant are judged.
    pub trials: u64,
    pub unassisted: CohortRates,
    #[serde(flatten)]
    pub detection: FalseBeliefDetection,
    pub auc_locations_interval: Option<[f64; 2]>,
    pub auc_recipes_interval: Option<[f64; 2]>,
    pub ece_interval: Option<[f64; 2]>,
    /// Log likelihood of the human's presses in the unassisted trials, under the model and two baselines.
    pub log_likelihood: PressLogLikelihood,
    /// Rates of errors, signals and served orders in the trials with signals that the assistant sends by itself.
    pub assisted: CohortRates,
    /// Share by which the assistant lowers the rate of errors from false beliefs per press of the human; below 0 if the
    /// assistant raises the rate.
    pub saved: Option<f64>,
    pub saved_interval: Option<[f64; 2]>,
}

/// Robustness of estimate and assistant for each cohort of simulated people: the output of `tomcom-research robustness`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobustnessTable {
    pub seed: u64,
    pub choose_seed: u64,
    pub cohorts: Vec<CohortRow>,
}

/// Number of measures with intervals: areas of locations and recipes, calibration error, share of saved errors.
const MEASURES: usize = 4;

impl CohortRow {
    /// Computes the results of one cohort from the cohort's trials.
    pub fn from_trials(kitchen: &Arc<Kitchen>, name: &str, trials: &CohortTrials) -> CohortRow {
        let count = trials.unassisted.len();
        let pairs = trials.unassisted.iter().zip(&trials.assisted);
        let pairs: Vec<[RelatedErrors; 2]> =
            pairs.map(|(without, with)| [without, with].map(RelatedErrors::from_trial)).collect();
        let scores = DetectionScores::from_trials(kitchen, &trials.judged);
        let measured = |times: &[f64]| measures(&scores, &pairs, times);
        let indices: Vec<usize> = (0..count).collect();
        let ends: [[f64; 2]; MEASURES] = intervals(&indices, SEED, |drawn| measured(&occurrences(drawn, count)));
        let values = measured(&vec![1.0; count]);
        // A resample without false beliefs, or without errors, leaves a measure unknown: trials of which more than a few
        // resamples are like that are too few for an interval.
        let interval = |measure: usize| {
            let is_known = values[measure].is_finite();
            Some(ends[measure]).filter(|ends| is_known && ends.iter().all(|end| end.is_finite()))
        };
        let [auc_locations_interval, auc_recipes_interval, ece_interval, saved_interval] =
            std::array::from_fn(interval);
        let thresholds = chosen_thresholds(&trials.chosen_on, &aspect_groups(kitchen)).map(ThresholdChoice::Given);
        // Every trial of a cohort is of another participant.
        let participants: Vec<usize> = (0..trials.judged.len()).collect();
        let mut cost = CostToGo::new(kitchen.clone());
        let choice = ChoiceParameters::default();
        CohortRow {
            cohort: name.to_string(),
            trials: count as u64,
            unassisted: CohortRates::from_trials(&trials.unassisted),
            detection: FalseBeliefDetection::from_trials(kitchen, &trials.judged, thresholds),
            auc_locations_interval,
            auc_recipes_interval,
            ece_interval,
            log_likelihood: PressLogLikelihood::from_trials(
                kitchen,
                &mut cost,
                &choice,
                &trials.judged,
                &participants,
                SEED,
            ),
            assisted: CohortRates::from_trials(&trials.assisted),
            saved: Some(values[MEASURES - 1]).filter(|share| share.is_finite()),
            saved_interval,
        }
    }
}

/// How often each of `count` trials occurs in a resample.
fn occurrences(drawn: &[usize], count: usize) -> Vec<f64> {
    let mut times = vec![0.0; count];
    drawn.iter().for_each(|&trial| times[trial] += 1.0);
    times
}

/// The measures with intervals where each trial occurs `times` times; NaN where a measure is unknown.
fn measures(scores: &DetectionScores, pairs: &[[RelatedErrors; 2]], times: &[f64]) -> [f64; MEASURES] {
    let found = scores.resampled(times);
    let [locations, recipes, ece] =
        [found.auc_locations, found.auc_recipes, found.ece].map(|value| value.unwrap_or(f64::NAN));
    [locations, recipes, ece, saved_share(pairs, times)]
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

/// Share by which the rate of errors from false beliefs is lower in the second trials of the pairs than in the first,
/// where each pair occurs `times` times.
fn saved_share(pairs: &[[RelatedErrors; 2]], times: &[f64]) -> f64 {
    let rate = |which: usize| {
        let sum = |count: fn(&RelatedErrors) -> u64| {
            pairs.iter().zip(times).map(|(pair, times)| times * count(&pair[which]) as f64).sum::<f64>()
        };
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
