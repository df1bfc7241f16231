//! `tomcom fit RECORDING...`: reads recordings, and computes their likelihood on all processors for
//! [`crate::analysis::fitting`].

use std::path::PathBuf;
use std::sync::Arc;

use super::parallel::WorkerPool;
use super::replay::{Replay, SameKitchen, each_once};
use crate::analysis::fitting::{self, FitPlan, FitSummary, FittedRecordings};
use crate::edge::file_error::FileResult;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::fitting::{Likelihood, likelihood};
use crate::mind::model::HumanModel;
use crate::mind::observation::Observation;

/// The trials of a fit, all of one kitchen.
#[derive(Clone, Debug)]
pub struct FitTrials {
    /// The kitchen of all these trials.
    pub kitchen: Arc<Kitchen>,
    /// Human model in the header of the first recording.
    pub model: HumanModel,
    /// Whether another recording has a different human model.
    pub differ: bool,
    /// Seed of the filter and observations of each trial.
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

/// Fits the parameters of a plan to trials. `tried` is called after each evaluation.
pub fn fit(trials: &FitTrials, plan: &FitPlan, tried: impl Fn()) -> FitSummary {
    let kitchen = &trials.kitchen;
    // The threads' caches of costs to go are kept between evaluations.
    let pool = WorkerPool::new(|| CostToGo::new(kitchen.clone()));
    let of_all = |model: &HumanModel| {
        let of_trial = |cost: &mut CostToGo, (seed, observations): &(u64, Vec<Observation>)| {
            likelihood(kitchen, model, *seed, observations, cost)
        };
        // Summed in the order of the trials, so the sum does not depend on the number of threads.
        let found = pool.each(&trials.observations, of_trial, || {});
        found.into_iter().fold(Likelihood::default(), |sum, one| Likelihood {
            presses: sum.presses + one.presses,
            log_p: sum.log_p + one.log_p,
        })
    };
    let number = trials.observations.len() as u64;
    let recordings = FittedRecordings { number, model: &trials.model, differ: trials.differ };
    fitting::fit(recordings, plan, of_all, tried)
}
