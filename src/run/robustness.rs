//! Command `tomcom robustness`: simulates the cohorts of a battery in memory, for [`crate::analysis::cohort_table`].

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use super::engine::SessionEngine;
use super::headless;
use super::parallel::WorkerPool;
use super::simulate::settings_of_trial;
use crate::analysis::belief_check::TrialBeliefCollector;
use crate::analysis::cohort_table::{CohortRow, CohortTrials, RobustnessTable};
use crate::analysis::trial_summary::TrialSummary;
use crate::edge::battery_file::CohortBattery;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::measures::belief_detection::{EstimateBeforePress, TrialBeliefs};
use crate::session::battery::CohortSpec;
use crate::session::settings::{Condition, SessionSpec};
use crate::session::{Event, Session, TimestampedEvent, apply};

/// Request of `tomcom robustness`.
#[derive(Clone, Debug)]
pub struct RobustnessRequest {
    /// The battery file (cohorts of simulated people), with the session file that it names.
    pub battery: CohortBattery,
    /// For each cohort, number of judged trials, and number of trials on which thresholds for flagging false beliefs
    /// are chosen.
    pub trials: u64,
    /// Seed of the trials on which estimate and assistant are judged.
    pub seed: u64,
    /// Seed of the trials on which the thresholds for flagging false beliefs are chosen.
    pub choose_seed: u64,
}

impl RobustnessRequest {
    /// Total number of trials that have to be simulated.
    pub fn all_trials(&self) -> u64 {
        PARTS.len() as u64 * self.trials * self.battery.cohorts.len() as u64
    }
}

/// Purpose for which a cohort's trial is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CohortPart {
    /// The trial has no signals, and serves to choose the thresholds for flagging false beliefs.
    ChosenOn,
    /// The trial has no signals, and serves to judge the belief estimate.
    Unassisted,
    /// The trial has signals that the assistant sends by itself, and serves to judge the assistant.
    Assisted,
}

const PARTS: [CohortPart; 3] = [CohortPart::Assisted, CohortPart::Unassisted, CohortPart::ChosenOn];

/// Simulates all cohorts on all processors, and judges estimate and assistant. `done` is called after each trial,
/// `finished` after each cohort.
pub fn measure(
    request: &RobustnessRequest,
    done: impl Fn() + Sync,
    mut finished: impl FnMut(&CohortRow),
) -> RobustnessTable {
    let kitchen = Arc::new(request.battery.session.kitchen.kitchen.clone());
    let workers = WorkerPool::new(|| Some(CostToGo::new(kitchen.clone())));
    let items: Vec<(CohortPart, u64)> =
        PARTS.into_iter().flat_map(|part| (0..request.trials).map(move |trial| (part, trial))).collect();
    let of_cohort = |cohort: &CohortSpec| {
        let one = |cost: &mut Option<CostToGo>, (part, trial): &(CohortPart, u64)| {
            let own = cost.take().unwrap_or_else(|| CostToGo::new(kitchen.clone()));
            let spec = settings(request, cohort, *part);
            let (views, summary, own) = simulate(&kitchen, settings_of_trial(&spec, *trial), *trial, own);
            *cost = Some(own);
            (views, summary)
        };
        let simulated = workers.each(&items, one, &done);
        let mut trials = CohortTrials::default();
        for ((part, _), (views, summary)) in items.iter().zip(simulated) {
            match part {
                CohortPart::ChosenOn => trials.chosen_on.push(views),
                CohortPart::Unassisted => trials.unassisted.push((views, summary)),
                CohortPart::Assisted => trials.assisted.push(summary),
            }
        }
        let row = CohortRow::from_trials(&kitchen, cohort.name.get_ref(), &trials);
        finished(&row);
        row
    };
    let cohorts = request.battery.cohorts.iter().map(of_cohort).collect();
    RobustnessTable { seed: request.seed, choose_seed: request.choose_seed, cohorts }
}

/// Settings of a cohort's trials that are simulated for this purpose.
fn settings(request: &RobustnessRequest, cohort: &CohortSpec, part: CohortPart) -> SessionSpec {
    let (condition, seed) = match part {
        CohortPart::ChosenOn => (Condition::None, request.choose_seed),
        CohortPart::Unassisted => (Condition::None, request.seed),
        CohortPart::Assisted => (Condition::Assistant, request.seed),
    };
    SessionSpec { seed, ..cohort.settings(&request.battery.session.spec, condition) }
}

/// Simulates a trial. Returns its human presses, its summary, and the cost to go, whose cache the next trial reuses.
fn simulate(
    kitchen: &Arc<Kitchen>,
    spec: SessionSpec,
    trial: u64,
    cost: CostToGo,
) -> (TrialBeliefs, TrialSummary, CostToGo) {
    let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), trial, cost);
    let mut events = Vec::new();
    let keep = |stamped: &TimestampedEvent| {
        events.push(stamped.clone());
        Ok::<(), Infallible>(())
    };
    headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
    let follower = engine.into_follower();
    let summary = TrialSummary::from_follower(&follower);
    let estimates: BTreeMap<u64, EstimateBeforePress> = events
        .iter()
        .filter_map(|stamped| match &stamped.event {
            Event::BeliefEstimated(witness) => Some((witness.press, EstimateBeforePress::from_witness(witness))),
            _ => None,
        })
        .collect();
    // The session is run through once more to collect presses and the gaze baseline; the estimate comes from the
    // recorded events.
    let (mut session, mut views) = (Session::new(kitchen.clone(), spec, trial), TrialBeliefCollector::default());
    let mut judged = follower.judged.iter().peekable();
    for stamped in &events {
        let applied = apply(&mut session, stamped).expect("an engine's own events fit its session");
        let press = judged.next_if(|press| press.seq == stamped.seq);
        views.add(&session, press, estimates.get(&stamped.seq).cloned(), stamped, &applied.change);
    }
    (views.trial, summary, follower.cost)
}
