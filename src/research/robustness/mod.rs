//! Command `tomcom-research robustness`: simulates the cohorts of a battery in memory, for the table of robustness
//! ([`table`]).

pub mod battery;
pub mod report;
pub mod table;

use std::collections::BTreeMap;
use std::sync::Arc;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::detection::{EstimateBeforePress, TrialBeliefs};
use tomcom_session::engine::SessionEngine;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless;
use tomcom_session::settings::{Condition, SessionSpec};
use tomcom_session::{Event, Session, TimestampedEvent};
use tomcom_study::analysis::trial_summary::TrialSummary;
use tomcom_study::files::simulated_trials::settings_of_trial;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::parallel::WorkerPool;

use self::battery::{CohortBattery, CohortSpec};
use self::table::{CohortRow, CohortTrials, RobustnessTable};
use crate::beliefs::TrialBeliefCollector;

/// Request of `tomcom-research robustness`.
#[derive(Clone, Debug)]
pub struct RobustnessRequest {
    pub battery: CohortBattery,
    /// For each cohort, number of judged trials, and number of trials on which thresholds for flagging false beliefs
    /// are chosen.
    pub trials: u64,
    pub seed: u64,
    pub choose_seed: u64,
}

impl RobustnessRequest {
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
    let workers = WorkerPool::new(KeptCost::default);
    let items: Vec<(CohortPart, u64)> =
        PARTS.into_iter().flat_map(|part| (0..request.trials).map(move |trial| (part, trial))).collect();
    let of_cohort = |cohort: &CohortSpec| {
        let one = |kept: &mut KeptCost, (part, trial): &(CohortPart, u64)| {
            let spec = settings_of_trial(&settings(request, cohort, *part), *trial);
            let (events, follower) = simulate(&kitchen, spec.clone(), *trial, kept.take(&kitchen));
            let summary = TrialSummary::from_follower(&follower);
            let (views, cost) = match part {
                CohortPart::Assisted => (TrialBeliefs::default(), follower.cost),
                CohortPart::ChosenOn | CohortPart::Unassisted => views(spec, *trial, &events, follower),
            };
            kept.keep(&kitchen, cost);
            (views, summary)
        };
        let simulated = workers.each(&items, one, &done);
        let mut trials = CohortTrials::default();
        for ((part, _), (views, summary)) in items.iter().zip(simulated) {
            match part {
                CohortPart::ChosenOn => trials.chosen_on.push(views),
                CohortPart::Unassisted => {
                    trials.judged.push(views);
                    trials.unassisted.push(summary);
                }
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

/// Simulates a trial. Returns its events, and its follower, which has the cost to go whose cache the next trial reuses.
fn simulate(
    kitchen: &Arc<Kitchen>,
    spec: SessionSpec,
    trial: u64,
    cost: CostToGo,
) -> (Vec<TimestampedEvent>, SessionFollower) {
    let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, cost);
    let mut events = Vec::new();
    headless::run(&mut engine, |stamped| events.push(stamped.clone()));
    (events, engine.into_follower())
}

/// The human's presses of an unassisted trial, with the estimates that its events contain.
fn views(
    spec: SessionSpec,
    trial: u64,
    events: &[TimestampedEvent],
    followed: SessionFollower,
) -> (TrialBeliefs, CostToGo) {
    let estimates: BTreeMap<u64, EstimateBeforePress> = events
        .iter()
        .filter_map(|stamped| match &stamped.event {
            Event::BeliefEstimated(witness) => Some((witness.press, EstimateBeforePress::from_witness(witness))),
            _ => None,
        })
        .collect();
    let SessionFollower { session, judged, cost, .. } = followed;
    let observing = SessionFollower::new(Session::new(session.kitchen, spec, trial), cost);
    let mut observing = observing.without_causes().without_estimate();
    let mut views = TrialBeliefCollector::default();
    let mut judged = judged.iter().peekable();
    for stamped in events {
        let applied = observing.apply(stamped).expect("an engine's own events fit its session");
        let press = judged.next_if(|press| press.seq == stamped.seq);
        views.add(&observing.session, press, estimates.get(&stamped.seq).cloned(), stamped, &applied.change);
    }
    (views.trial, observing.cost)
}
