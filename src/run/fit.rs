//! `tomcom fit RECORDING...`: reads recordings, and computes their likelihood on all processors for
//! [`crate::analysis::fitting`].

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use super::parallel;
use super::replay::{Replay, SameKitchen, each_once};
use crate::analysis::fitting::{self, FitPlan, FitSummary, FittedRecordings};
use crate::edge::file_error::FileResult;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::fitting::{Likelihood, likelihood};
use crate::mind::model::HumanModel;
use crate::mind::observation::Observation;

/// The trials of one kitchen.
#[derive(Clone, Debug)]
pub struct FitTrials {
    pub kitchen: Arc<Kitchen>,
    /// The parameters of the human model that stand in the first recording.
    pub model: HumanModel,
    /// Whether others stand in another one.
    pub differ: bool,
    /// The seed of the filter, and what was observed.
    pub observations: Vec<(u64, Vec<Observation>)>,
}

impl FitTrials {
    /// Reads recordings.
    ///
    /// # Errors
    /// A recording that cannot be read or applied, or one of another kitchen.
    pub fn read(recordings: &[PathBuf]) -> FileResult<FitTrials> {
        each_once(recordings)?;
        let (mut one_kitchen, mut observations, mut models) = (SameKitchen::default(), Vec::new(), Vec::new());
        for recording in recordings {
            let mut replay = Replay::open(recording)?;
            one_kitchen.admit(recording, &replay.session().kitchen)?;
            models.push(replay.session().spec.human.clone());
            observations.push((replay.session().seed(), replay.observations()?));
        }
        let kitchen = one_kitchen.kitchen()?;
        let differ = models.windows(2).any(|pair| pair[0] != pair[1]);
        Ok(FitTrials { kitchen, model: models.into_iter().next().unwrap_or_default(), differ, observations })
    }
}

/// Likelihoods of all trials, on all processors. The sum does not depend on how many there are.
struct Judge<'a> {
    trials: &'a FitTrials,
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
pub fn fit(trials: &FitTrials, plan: &FitPlan, tried: impl Fn()) -> FitSummary {
    let judge = Judge { trials, costs: Mutex::new(Vec::new()) };
    let number = trials.observations.len() as u64;
    let recordings = FittedRecordings { number, model: &trials.model, differ: trials.differ };
    fitting::fit(recordings, plan, |model| judge.likelihood(model), tried)
}
