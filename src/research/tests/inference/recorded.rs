//! The fast filter against the plain reference on recorded steps.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, LocationId, Press};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::mind::model::SignalModel;
use tomcom_research::reference::ReferenceFilter;

use super::observed::recorded;
use super::world::distance;
use crate::files::kitchen;

fn means(belief: &DirichletBelief) -> Vec<Vec<f64>> {
    belief.aspects.iter().map(|aspect| aspect.mean().to_vec()).collect()
}

/// The mean over the aspects of the total variation between two estimates' means.
fn mean_distance(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let each = one.iter().zip(other).map(|(a, b)| distance(std::slice::from_ref(a), std::slice::from_ref(b)));
    each.sum::<f64>() / one.len() as f64
}

#[test]
fn the_fast_filter_and_the_reference_agree_on_recorded_steps() {
    agree(HumanModel::default(), |_| true, |same| same);
}

#[test]
fn they_agree_without_gaze() {
    agree(HumanModel::default(), |what| !matches!(what, ObservedEvidence::Gaze { .. }), |same| same);
}

/// A human who reads signals in time.
fn reads_in_time() -> HumanModel {
    let signal = SignalModel {
        noticed: 0.8,
        highlight_noticed: Some(0.6),
        delay_s: 1.0,
        misread: 0.05,
        ..SignalModel::default()
    };
    HumanModel { signal, ..HumanModel::default() }
}

#[test]
fn they_agree_where_signals_take_time() {
    agree(reads_in_time(), |_| true, with_signals);
}

#[test]
fn they_agree_without_gaze_where_signals_take_time() {
    agree(reads_in_time(), |what| !matches!(what, ObservedEvidence::Gaze { .. }), with_signals);
}

/// After every third press of the human a signal is shown for up to four seconds: about an order, a place, in turn.
fn with_signals(observations: Vec<Observation>) -> Vec<Observation> {
    let is_own = |what: &ObservedEvidence| matches!(what, ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }));
    let own = observations.iter().filter(|one| is_own(&one.what)).step_by(3);
    let signals = own.enumerate().flat_map(|(number, one)| {
        let location = LocationId([0, 5, 1, 6, 0, 4][number % 6]);
        let after = |seconds: f64| one.time + SessionTime::from_secs_f64(seconds);
        [
            Observation { time: after(0.1), what: ObservedEvidence::Told { location } },
            Observation { time: after(4.1), what: ObservedEvidence::EndedSignal },
        ]
    });
    let mut all = [observations.clone(), signals.collect()].concat();
    all.sort_by_key(|one| one.time);
    all
}

/// What a filter has after a press: the means of its estimate, and the log likelihood if it was a press of the human.
struct Step {
    means: Vec<Vec<f64>>,
    log_p: Option<f64>,
}

/// The steps of a filter that observes a recording. `after` observes, and returns the estimate and the log likelihood of
/// the human's last press if it is told that this is a step.
fn steps(
    observations: &[Observation],
    mut after: impl FnMut(&Observation, bool) -> Option<(DirichletBelief, Option<f64>)>,
) -> Vec<Step> {
    let step = |observation: &Observation| {
        let pressed = match observation.what {
            ObservedEvidence::Pressed(Press { agent, .. }) => Some(agent),
            _ => None,
        };
        let (belief, log_p) = after(observation, pressed.is_some())?;
        Some(Step { means: means(&belief), log_p: log_p.filter(|_| pressed == Some(Agent::Human)) })
    };
    observations.iter().filter_map(step).collect()
}

/// How far two filters are apart on the same recording: the mean over steps and aspects of the total variation, and the
/// difference of the log likelihoods per press of the human.
fn apart(one: &[Step], other: &[Step]) -> [f64; 2] {
    let pairs = || one.iter().zip(other);
    let distance = pairs().map(|(a, b)| mean_distance(&a.means, &b.means)).sum::<f64>() / one.len() as f64;
    let differences: Vec<f64> = pairs().filter_map(|(a, b)| Some(a.log_p? - b.log_p?)).collect();
    [distance, differences.iter().sum::<f64>().abs() / differences.len() as f64]
}

/// Holds the two against each other on recorded steps, as far as they are `kept` and with what is `added`. The fast
/// filter may be no further from the reference than 0.05 and 0.15 nats a press, or than the reference is from itself with
/// other random numbers: after a press that the model holds unlikely few particles of the reference are left, and it is
/// uncertain itself.
fn agree(
    mut model: HumanModel,
    kept: impl Fn(&ObservedEvidence) -> bool,
    added: impl Fn(Vec<Observation>) -> Vec<Observation>,
) {
    // Many samples, so that the two are compared and not their chances.
    (model.inference.beliefs, model.inference.predictions) = (1024, 256);
    for layout in ["sushi", "burger"] {
        let kitchen = kitchen(layout);
        let mut observations = recorded(&kitchen, 21, 45);
        observations.retain(|observation| kept(&observation.what));
        let observations = added(observations);
        let mut cost = CostToGo::new(kitchen.clone());
        let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 1);
        let fast = steps(&observations, |observation, is_step| {
            filter.observe(observation, &mut cost);
            is_step.then(|| (filter.belief().clone(), filter.evidence().map(|evidence| evidence.log_p)))
        });
        let mut reference = |seed: u64| {
            let mut filter = ReferenceFilter::new(kitchen.clone(), model.clone(), seed);
            steps(&observations, |observation, is_step| {
                filter.observe(observation, &mut cost);
                is_step.then(|| (filter.belief(), filter.log_p()))
            })
        };
        let plain = reference(1);
        let found = apart(&fast, &plain);
        println!("{layout}: {} steps, apart by {:.4}, and {:.3} nats a press", plain.len(), found[0], found[1]);
        if found[0] > 0.05 || found[1] > 0.15 {
            let of_itself = apart(&reference(2), &plain);
            println!("{layout}: the reference from itself {:.4}, and {:.3} nats a press", of_itself[0], of_itself[1]);
            assert!(
                found[0] <= of_itself[0].max(0.05) && found[1] <= of_itself[1].max(0.15),
                "{found:?}, {of_itself:?}"
            );
        }
    }
}
