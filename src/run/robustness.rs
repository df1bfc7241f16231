//! Command `tomcom robustness`: simulates the cohorts of a battery in memory, for [`crate::analysis::cohort_table`].

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use super::engine::SessionEngine;
use super::headless;
use super::kept_cost::KeptCost;
use super::parallel::WorkerPool;
use super::simulate::settings_of_trial;
use crate::analysis::belief_check::TrialBeliefCollector;
use crate::analysis::cohort_table::{ADAPTING, CohortRow, CohortTrials, RobustnessTable, USUAL};
use crate::analysis::follower::SessionFollower;
use crate::analysis::trial_summary::TrialSummary;
use crate::edge::battery_file::CohortBattery;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::measures::belief_detection::{BeliefsBeforePress, EstimateBeforePress, TrialBeliefs};
use crate::mind::model::AdaptationSettings;
use crate::session::battery::CohortSpec;
use crate::session::settings::{Condition, SessionSpec};
use crate::session::{Event, Session, TimestampedEvent};

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
    /// Whether an estimate that adapts its parameters to the person is judged, too.
    pub adaptation: bool,
}

impl RobustnessRequest {
    /// Total number of trials that have to be simulated.
    pub fn all_trials(&self) -> u64 {
        self.parts().count() as u64 * self.trials * self.battery.cohorts.len() as u64
    }

    fn parts(&self) -> impl Iterator<Item = CohortPart> {
        PARTS.into_iter().filter(|part| self.adaptation || *part != CohortPart::Assisted(Adaptation::On))
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
    Assisted(Adaptation),
}

/// Whether the estimate adapts its parameters to the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Adaptation {
    Off,
    On,
}

const PARTS: [CohortPart; 4] = [
    CohortPart::Assisted(Adaptation::On),
    CohortPart::Assisted(Adaptation::Off),
    CohortPart::Unassisted,
    CohortPart::ChosenOn,
];

/// The presses of one trial, by the usual estimate and by one that adapts.
type BothViews = (TrialBeliefs, Option<TrialBeliefs>);

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
        request.parts().flat_map(|part| (0..request.trials).map(move |trial| (part, trial))).collect();
    let of_cohort = |cohort: &CohortSpec| {
        let one = |kept: &mut KeptCost, (part, trial): &(CohortPart, u64)| {
            let spec = settings_of_trial(&settings(request, cohort, *part), *trial);
            let (events, follower) = simulate(&kitchen, spec.clone(), *trial, kept.take(&kitchen));
            let summary = TrialSummary::from_follower(&follower);
            let (views, cost) = match part {
                CohortPart::Assisted(_) => ((TrialBeliefs::default(), None), follower.cost),
                CohortPart::ChosenOn | CohortPart::Unassisted => {
                    views(request.adaptation, spec, *trial, &events, follower)
                }
            };
            kept.keep(&kitchen, cost);
            (views, summary)
        };
        let simulated = workers.each(&items, one, &done);
        let mut trials = CohortTrials::default();
        for ((part, _), (views, summary)) in items.iter().zip(simulated) {
            match part {
                CohortPart::ChosenOn => push(&mut trials.chosen_on, views),
                CohortPart::Unassisted => {
                    push(&mut trials.judged, views);
                    trials.unassisted.push(summary);
                }
                CohortPart::Assisted(Adaptation::Off) => trials.assisted[USUAL].push(summary),
                CohortPart::Assisted(Adaptation::On) => trials.assisted[ADAPTING].push(summary),
            }
        }
        let row = CohortRow::from_trials(&kitchen, cohort.name.get_ref(), &trials);
        finished(&row);
        row
    };
    let cohorts = request.battery.cohorts.iter().map(of_cohort).collect();
    RobustnessTable { seed: request.seed, choose_seed: request.choose_seed, cohorts }
}

/// Adds the presses of one trial, by the usual and, where there is one, by the adapting estimate.
fn push(trials: &mut [Vec<TrialBeliefs>; 2], (usual, adapting): BothViews) {
    trials[USUAL].push(usual);
    trials[ADAPTING].extend(adapting);
}

/// Settings of a cohort's trials that are simulated for this purpose.
fn settings(request: &RobustnessRequest, cohort: &CohortSpec, part: CohortPart) -> SessionSpec {
    let (condition, seed) = match part {
        CohortPart::ChosenOn => (Condition::None, request.choose_seed),
        CohortPart::Unassisted => (Condition::None, request.seed),
        CohortPart::Assisted(_) => (Condition::Assistant, request.seed),
    };
    let mut spec = SessionSpec { seed, ..cohort.settings(&request.battery.session.spec, condition) };
    spec.human.adapt = match part {
        CohortPart::Assisted(Adaptation::On) => AdaptationSettings::ALL,
        _ => AdaptationSettings::default(),
    };
    spec
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
    let keep = |stamped: &TimestampedEvent| {
        events.push(stamped.clone());
        Ok::<(), Infallible>(())
    };
    headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
    (events, engine.into_follower())
}

/// The human's presses of an unassisted trial, by the usual estimate, which is in its events, and if asked by an adapting
/// filter that observes the same events: without signals the estimate has no influence on a trial.
fn views(
    adaptation: bool,
    mut spec: SessionSpec,
    trial: u64,
    events: &[TimestampedEvent],
    followed: SessionFollower,
) -> (BothViews, CostToGo) {
    let usual: BTreeMap<u64, EstimateBeforePress> = events
        .iter()
        .filter_map(|stamped| match &stamped.event {
            Event::BeliefEstimated(witness) => Some((witness.press, EstimateBeforePress::from_witness(witness))),
            _ => None,
        })
        .collect();
    spec.human.adapt = AdaptationSettings::ALL;
    let SessionFollower { session, judged, cost, .. } = followed;
    let kitchen = session.kitchen;
    let observing = SessionFollower::new(Session::new(kitchen.clone(), spec, trial), cost).without_causes();
    let mut observing = if adaptation { observing } else { observing.without_estimate() };
    let (mut views, mut adapted) = (TrialBeliefCollector::default(), Vec::new());
    let mut judged = judged.iter().peekable();
    for stamped in events {
        let applied = observing.apply(stamped).expect("an engine's own events fit its session");
        let press = judged.next_if(|press| press.seq == stamped.seq);
        views.add(&observing.session, press, usual.get(&stamped.seq).cloned(), stamped, &applied.change);
        if press.is_some() {
            let estimated = observing.estimated.as_ref();
            adapted.push(estimated.map(|one| EstimateBeforePress::from_witness(&one.witness(&kitchen))));
        }
    }
    let adapted = adaptation.then(|| {
        let adapted = views.trial.iter().cloned().zip(adapted);
        adapted.map(|(view, estimate)| BeliefsBeforePress { estimate, ..view }).collect()
    });
    ((views.trial, adapted), observing.cost)
}
