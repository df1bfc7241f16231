//! `tomcom fit RECORDING...`: the human model's parameters under which the recorded presses are likeliest.
//!
//! Maximum likelihood: the sum over all presses of ln p(press | estimate before it). The simplex method comes near it on a
//! scale without bounds; the filter's random numbers are the same at every try. What is left of chance makes the likelihood a
//! little rough, and the best try a lucky one: so a quadratic surface is laid through tries all around it, wide enough to
//! stand out from that. Its maximum is the result, its curvature, the observed information, gives the standard errors.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use serde::Serialize;

use super::parallel;
use super::replay::{OneKitchen, Replay};
use crate::base::minimise::minimise;
use crate::base::surface::{points, surface};
use crate::base::words::count;
use crate::edge::files::FileResult;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::fitting::{Likelihood, Parameter, likelihood};
use crate::mind::model::HumanModel;
use crate::mind::observation::Observation;

/// First steps of the search, on the scale of the parameters.
const FIRST_STEP: f64 = 0.4;
/// The search is done when the tries around the best one differ by less, in nats: about as much as is left of chance.
const TOLERANCE_NATS: f64 = 0.3;
/// The surface around the best try reaches as far as costs so many nats, about: so far that chance hardly matters; …
const SURFACE_NATS: [f64; 2] = [2.0, 12.0];
/// … beginning with this step, on the scale of the parameters, and no further than that.
const SURFACE_STEP: [f64; 2] = [0.2, 1.6];
/// Half the width of an interval of 95 %, in standard errors.
const HALF_WIDTH: f64 = 1.96;

/// What to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub parameters: Vec<Parameter>,
    /// Where to begin; what is not fitted stays as it is here.
    pub start: HumanModel,
    /// The search ends after so many tries.
    pub most_tries: usize,
}

impl Plan {
    /// About how often the likelihood is asked for at most, search and surface.
    pub fn most(&self) -> usize {
        let count = self.parameters.len();
        self.most_tries + 4 * count + points(count)
    }
}

/// What `tomcom fit` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    pub recordings: u64,
    /// Presses of the human.
    pub human_actions: u64,
    /// Log likelihood per press, in nats, with the parameters from before, and with those that were found.
    pub log_likelihood_before: f64,
    pub log_likelihood: f64,
    pub tries: u64,
    /// Whether the search came to its end before the tries were used up.
    pub converged: bool,
    pub parameters: Vec<Fitted>,
    /// All parameters, with those that were found.
    #[serde(skip)]
    pub model: HumanModel,
}

/// A parameter that was fitted. Error and interval are null where the likelihood is not curved in every direction (the
/// recordings do not tell), and where the search did not come to its end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitted {
    pub name: &'static str,
    pub unit: &'static str,
    pub before: f64,
    pub value: f64,
    pub standard_error: Option<f64>,
    /// 95 %, symmetric on the scale on which it was fitted.
    pub interval: Option<[f64; 2]>,
}

/// The trials of one kitchen.
#[derive(Clone, Debug)]
pub struct Trials {
    pub kitchen: Arc<Kitchen>,
    /// The seed of the filter, and what was observed.
    pub observations: Vec<(u64, Vec<Observation>)>,
}

impl Trials {
    /// Reads recordings.
    ///
    /// # Errors
    /// A recording that cannot be read or applied, or one of another kitchen.
    pub fn read(recordings: &[PathBuf]) -> FileResult<Trials> {
        let (mut one_kitchen, mut observations) = (OneKitchen::default(), Vec::new());
        for recording in recordings {
            let mut replay = Replay::open(recording)?;
            one_kitchen.admit(recording, &replay.session().kitchen)?;
            observations.push((replay.session().spec.seed, replay.observations()?));
        }
        Ok(Trials { kitchen: one_kitchen.kitchen()?, observations })
    }
}

/// Likelihoods of all trials, on all processors. The sum does not depend on how many there are.
struct Judge<'a> {
    trials: &'a Trials,
    /// What threads remember of costs to go between tries.
    costs: Mutex<Vec<CostToGo>>,
}

impl Judge<'_> {
    fn likelihood(&self, model: &HumanModel) -> Likelihood {
        let kitchen = &self.trials.kitchen;
        let of_trial = |(seed, observations): &(u64, Vec<Observation>)| {
            let kept = lock(&self.costs).pop();
            let mut cost = kept.unwrap_or_else(|| CostToGo::new(kitchen.clone()));
            let found = likelihood(kitchen, model, *seed, observations, &mut cost);
            lock(&self.costs).push(cost);
            found
        };
        let found = parallel::each(&self.trials.observations, of_trial, || {});
        let add = |sum: Likelihood, one: &Likelihood| Likelihood {
            presses: sum.presses + one.presses,
            log_p: sum.log_p + one.log_p,
        };
        found.iter().fold(Likelihood::default(), add)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Fits the parameters of a plan to trials. `tried` is called after each try.
pub fn fit(trials: &Trials, plan: &Plan, tried: impl Fn()) -> Fit {
    let judge = Judge { trials, costs: Mutex::new(Vec::new()) };
    let with = |at: &[f64]| {
        let mut model = plan.start.clone();
        plan.parameters.iter().zip(at).for_each(|(parameter, &scaled)| {
            parameter.set(&mut model, parameter.from_scale(scaled));
        });
        model
    };
    let loss = |at: &[f64]| {
        let model = with(at);
        // Where the model cannot be, it cannot be best.
        let loss = if model.fault().is_some() { f64::INFINITY } else { -judge.likelihood(&model).log_p };
        tried();
        loss
    };
    let start: Vec<f64> = plan.parameters.iter().map(|one| one.to_scale(one.get(&plan.start))).collect();
    let steps = vec![FIRST_STEP; start.len()];
    let before = judge.likelihood(&plan.start);
    let best = minimise(loss, &start, &steps, TOLERANCE_NATS, plan.most_tries);
    // Away from the maximum, curvature says nothing of errors.
    let around = || surface(loss, &best.at, &telling_steps(loss, &best.at, best.value));
    let surface = best.converged.then(around).flatten();
    let at = surface.as_ref().map_or(&best.at, |surface| &surface.at);
    let log_p = judge.likelihood(&with(at)).log_p;
    let presses = before.presses.max(1) as f64;
    let fitted = |(index, &parameter): (usize, &Parameter)| {
        let value = parameter.from_scale(at[index]);
        let error = surface.as_ref().map(|surface| surface.covariance[index][index].sqrt());
        Fitted {
            name: parameter.name(),
            unit: parameter.unit(),
            before: parameter.get(&plan.start),
            value,
            standard_error: error.map(|error| parameter.error_of(value, error)),
            interval: error
                .map(|error| [-HALF_WIDTH, HALF_WIDTH].map(|width| parameter.from_scale(at[index] + width * error))),
        }
    };
    Fit {
        recordings: trials.observations.len() as u64,
        human_actions: before.presses,
        log_likelihood_before: before.log_p / presses,
        log_likelihood: log_p / presses,
        tries: best.evaluations as u64,
        converged: best.converged,
        parameters: plan.parameters.iter().enumerate().map(fitted).collect(),
        model: with(at),
    }
}

/// Steps along each parameter, from a minimum, that cost enough to stand out from chance.
fn telling_steps(mut loss: impl FnMut(&[f64]) -> f64, at: &[f64], least: f64) -> Vec<f64> {
    let mut step_of = |index: usize| {
        let mut step = SURFACE_STEP[0];
        loop {
            let mut beside = |by: f64| {
                let mut at = at.to_vec();
                at[index] += by;
                loss(&at)
            };
            let rise = (beside(step) + beside(-step)) / 2.0 - least;
            if rise < SURFACE_NATS[0] && step < SURFACE_STEP[1] {
                step *= 2.0;
            } else if rise > SURFACE_NATS[1] && step > SURFACE_STEP[0] / 8.0 {
                step /= 2.0;
            } else {
                return step;
            }
        }
    };
    (0..at.len()).map(&mut step_of).collect()
}

/// What stands above the parameters in a file.
pub fn comment(fit: &Fit) -> String {
    let values = fit.parameters.iter().map(|one| match one.standard_error {
        Some(error) => format!("{} = {:.4}, standard error {error:.4}", one.name, one.value),
        None => format!("{} = {:.4}, which the recordings do not tell surely", one.name, one.value),
    });
    let values: Vec<String> = values.collect();
    format!(
        "Parameters of the human model, fitted to {} with {} of the human:\n{}",
        count(fit.recordings, "recording", "recordings"),
        count(fit.human_actions, "press", "presses"),
        values.join("\n")
    )
}

/// The figures for people.
pub fn describe(fit: &Fit) -> String {
    let mut text = format!(
        "{}, {} of the human: log likelihood per press {:.4}, before {:.4}, after {}{}\n\n{:<24}{:>10}{:>12}{:>10}{:>22}\n",
        count(fit.recordings, "recording", "recordings"),
        count(fit.human_actions, "press", "presses"),
        fit.log_likelihood,
        fit.log_likelihood_before,
        count(fit.tries, "try", "tries"),
        if fit.converged { "" } else { "; the search did not come to its end" },
        "parameter",
        "before",
        "fitted",
        "error",
        "95 %",
    );
    for one in &fit.parameters {
        let error = one.standard_error.map_or("-".to_string(), |error| format!("{error:.4}"));
        let interval = one.interval.map_or("-".to_string(), |[from, to]| format!("{from:.4} to {to:.4}"));
        let name = format!("{} ({})", one.name, one.unit);
        text.push_str(&format!("{name:<24}{:>10.4}{:>12.4}{error:>10}{interval:>22}\n", one.before, one.value));
    }
    text
}
