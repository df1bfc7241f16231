//! The fast filter against the plain reference on recorded steps.

use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, Kitchen, LocationId, Press};
use tomcom::mind::dirichlet::DirichletBelief;
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::{AdaptationSettings, HumanModel};
use tomcom::mind::observation::{Observation, ObservedEvidence};
use tomcom::mind::reference::ReferenceFilter;
use tomcom::mind::signal_model::SignalModel;

use super::observed::recorded;
use super::world::{distance, kitchen};

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

#[test]
fn they_agree_where_waiting_is_evidence() {
    let mut model = HumanModel::default();
    model.inference.waiting = true;
    agree(model, |_| true, with_waits);
}

#[test]
fn they_agree_where_the_lapse_is_learned() {
    let mut model = HumanModel::default();
    model.adapt.lapse = true;
    agree(model, |_| true, |same| same);
}

#[test]
fn they_agree_where_lapse_and_attention_are_learned() {
    let model = HumanModel { adapt: AdaptationSettings::ALL, ..HumanModel::default() };
    agree(model, |_| true, |same| same);
}

#[test]
fn they_agree_without_gaze_where_the_attention_is_learned() {
    let mut model = reads_in_time();
    model.adapt.attention = true;
    agree(model, |what| !matches!(what, ObservedEvidence::Gaze { .. }), with_signals);
}

#[test]
fn they_agree_where_people_consider_one_order() {
    agree(considers_one_order(), |_| true, |same| same);
}

#[test]
fn they_agree_without_gaze_where_people_consider_one_order() {
    agree(considers_one_order(), |what| !matches!(what, ObservedEvidence::Gaze { .. }), |same| same);
}

/// A human who mostly considers one order.
fn considers_one_order() -> HumanModel {
    let mut model = HumanModel::default();
    model.decision.one_order = 0.8;
    model
}

/// A human who reads signals in time.
fn reads_in_time() -> HumanModel {
    let signal = SignalModel {
        noticed: 0.8,
        highlight_noticed: Some(0.6),
        delay_s: 1.0,
        misread: 0.05,
        noticed_precision: 4.0,
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

/// After every third press of the human, a second later, it has waited for longer than usual.
fn with_waits(observations: Vec<Observation>) -> Vec<Observation> {
    let is_own = |what: &ObservedEvidence| matches!(what, ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }));
    let own = observations.iter().filter(|one| is_own(&one.what)).step_by(3);
    let waits: Vec<Observation> = own
        .map(|one| Observation {
            time: one.time + SessionTime::from_secs_f64(1.0),
            what: ObservedEvidence::Waited { longer: 0.2 },
        })
        .collect();
    let mut all = [observations, waits].concat();
    all.sort_by_key(|one| one.time);
    all
}

/// Sums over the steps of a recording: how far the fast filter is from the reference, and how far the reference is from
/// itself with other random numbers. After a press that the model holds unlikely few particles of the reference are
/// left, and it is uncertain itself.
#[derive(Default)]
struct FilterDifference {
    /// Number of steps: presses and waits.
    steps: u32,
    /// Sum over the steps of the mean total variation over aspects between fast filter and reference, and between the
    /// two runs of the reference.
    apart: [f64; 2],
    /// Log likelihood of the human's presses by the fast filter and the two runs of the reference, and number of these
    /// presses.
    log_p: [f64; 3],
    presses: u32,
}

impl FilterDifference {
    fn follow(&mut self, kitchen: &Arc<Kitchen>, model: &HumanModel, observations: &[Observation]) {
        let mut cost = CostToGo::new(kitchen.clone());
        let mut fast = BeliefFilter::new(kitchen.clone(), model.clone(), 1);
        let mut references = [1, 2].map(|seed| ReferenceFilter::new(kitchen.clone(), model.clone(), seed));
        for observation in observations {
            fast.observe(observation, &mut cost);
            references.iter_mut().for_each(|reference| reference.observe(observation, &mut cost));
            let pressed = match observation.what {
                ObservedEvidence::Waited { .. } => None,
                ObservedEvidence::Pressed(Press { agent, .. }) => Some(agent),
                _ => continue,
            };
            let [one, other] = references.each_ref().map(|reference| means(&reference.belief()));
            self.apart[0] += mean_distance(&means(fast.belief()), &one);
            self.apart[1] += mean_distance(&other, &one);
            self.steps += 1;
            let plain = references.each_ref().map(|reference| reference.log_p());
            if let (Some(Agent::Human), Some(evidence), [Some(one), Some(other)]) = (pressed, fast.evidence(), plain) {
                let more = [evidence.log_p, one, other];
                self.log_p.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
                self.presses += 1;
            }
        }
    }
}

/// Holds the two against each other on recorded steps, as far as they are `kept` and with what is `added`. The fast
/// filter may be no further from the reference than 0.05, or than the reference is from itself.
fn agree(
    model: HumanModel,
    kept: impl Fn(&ObservedEvidence) -> bool,
    added: impl Fn(Vec<Observation>) -> Vec<Observation>,
) {
    // Many samples, so that the two are compared and not their chances.
    let mut model = model;
    (model.inference.beliefs, model.inference.predictions) = (1024, 256);
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = kitchen(layout);
        let mut found = FilterDifference::default();
        let mut observations = recorded(&kitchen, 21, 45);
        observations.retain(|observation| kept(&observation.what));
        found.follow(&kitchen, &model, &added(observations));
        let FilterDifference { steps, apart, log_p, presses } = found;
        let [mean, of_itself] = apart.map(|sum| sum / f64::from(steps));
        let [of_fast, of_reference, again] = log_p.map(|sum| sum / f64::from(presses));
        println!(
            "{layout}: {steps} steps, total variation between fast and reference {mean:.4} in the mean over aspects and \
             steps, between two runs of the reference {of_itself:.4}; log likelihood per press {of_fast:.3}, and \
             {of_reference:.3} and {again:.3}"
        );
        assert!(mean <= of_itself.max(0.05), "{layout}: {mean}, of itself {of_itself}");
        let uncertain = (of_reference - again).abs();
        assert!((of_fast - of_reference).abs() <= uncertain.max(0.15), "{layout}: {log_p:?}");
    }
}
