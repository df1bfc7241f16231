//! Inference of the human's belief under whatever may come. The plain reference, and exact computation: src/research.

mod laws;
mod signals;
mod unknown_gaze;

use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, LocationId, OrderContent, State};
use tomcom_core::mind::dirichlet::{Dirichlet, LEAST_MEAN, PRECISIONS};
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::{HumanModel, LookingModel, PAPER_2021};
use tomcom_core::mind::observation::{Observation, ObservedEvidence};

use crate::files::kitchen;

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

/// A filter at work, with the kitchen as it truly is.
struct Bench {
    kitchen: Arc<Kitchen>,
    filter: BeliefFilter,
    cost: CostToGo,
    state: State,
}

impl Bench {
    fn new(name: &str, model: HumanModel) -> Bench {
        Bench::seeded(name, model, 3)
    }

    fn seeded(name: &str, model: HumanModel, seed: u64) -> Bench {
        let kitchen = kitchen(name);
        let state = kitchen.empty_state();
        Bench::started(kitchen, state, model, seed)
    }

    /// A trial that starts with this state.
    fn started(kitchen: Arc<Kitchen>, state: State, model: HumanModel, seed: u64) -> Bench {
        let filter = BeliefFilter::new(kitchen.clone(), model, seed);
        let mut bench = Bench { cost: CostToGo::new(kitchen.clone()), kitchen, filter, state };
        bench.observe(0.0, ObservedEvidence::Started { state });
        bench
    }

    fn observe(&mut self, seconds: f64, what: ObservedEvidence) {
        self.filter.observe(&Observation { time: at(seconds), what }, &mut self.cost);
    }

    fn location(&self, name: &str) -> LocationId {
        self.kitchen.location_named(name).expect("a location")
    }

    fn aspect(&self, name: &str) -> AspectId {
        self.kitchen.aspect_named(name).expect("an aspect")
    }

    /// The expected probability of a value.
    fn p(&self, aspect: &str, label: &str) -> f64 {
        let aspect = self.aspect(aspect);
        let value = self.kitchen.aspects[aspect.index()].labels.iter().position(|other| other == label);
        self.filter.belief().aspect(aspect).mean()[value.expect("a value")]
    }

    fn order(&mut self, seconds: f64, order: &str, dish: &str) {
        let dish = self.kitchen.dish_named(dish).expect("a dish");
        self.state.set_order(self.location(order), OrderContent::Dish(dish));
        self.observe(seconds, ObservedEvidence::Displayed { state: self.state });
    }

    fn press(&mut self, seconds: f64, agent: Agent, name: &str) {
        let button = self.kitchen.button_named(agent, name).expect("a button");
        let press = self.kitchen.try_press(self.state, agent, button);
        self.state = press.after;
        self.observe(seconds, ObservedEvidence::Pressed(press));
    }

    /// Looks at the middle of a location for some time, `hz` samples a second.
    fn look(&mut self, from_s: f64, seconds: f64, name: &str, hz: f64) {
        let [x, y] = self.kitchen.location(self.location(name)).display.centre();
        self.gaze(from_s, seconds, GazeSample::new(x, y, 1.0), hz);
    }

    /// The same sample for some time, `hz` times a second.
    fn gaze(&mut self, from_s: f64, seconds: f64, sample: GazeSample, hz: f64) {
        for step in 0..(seconds * hz).round() as u32 {
            let time = from_s + f64::from(step) / hz;
            self.observe(time, ObservedEvidence::Gaze { sample, taken: at(time) });
        }
    }

    fn check(&self, story: &str) {
        for (aspect, of_aspect) in self.kitchen.aspects.iter().zip(&self.filter.belief().aspects) {
            check_proper(of_aspect, &format!("{story}: {}", aspect.name));
        }
        if let Some(evidence) = self.filter.evidence() {
            assert!(evidence.log_p.is_finite() && evidence.log_p <= 0.0, "{story}: {evidence:?}");
            assert!(evidence.effective >= 1.0 - 1e-9, "{story}: {evidence:?}");
        }
    }
}

/// A human who looks at nothing while the gaze is unknown, and believes signals at once.
fn looks_at_nothing() -> HumanModel {
    let looking = LookingModel { looks_hz: 0.0, other_looks_hz: 0.0, capture: 0.0, ..LookingModel::default() };
    HumanModel { looking, signal: PAPER_2021.signal, ..HumanModel::default() }
}

/// Holds a Dirichlet against what every one must be.
fn check_proper(dirichlet: &Dirichlet, story: &str) {
    let sum: f64 = dirichlet.mean().iter().sum();
    assert!((sum - 1.0).abs() < 1e-9, "{story}: the mean sums to {sum}");
    let least = dirichlet.mean().iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least >= 0.1 * LEAST_MEAN, "{story}: a value has {least}");
    let precision = dirichlet.precision();
    assert!((PRECISIONS[0]..=PRECISIONS[1]).contains(&precision), "{story}: precision {precision}");
}

/// Any contents of all locations.
fn any_state(kitchen: &Kitchen, random: &mut Stream) -> State {
    let mut state = kitchen.empty_state();
    for (index, aspect) in kitchen.aspects[..kitchen.locations.len()].iter().enumerate() {
        state.set_code(LocationId(index as u8), aspect.values[random.random_range(0..aspect.values.len())]);
    }
    state
}

/// Numbers that no tracker should send, among usual ones.
fn any_number(random: &mut Stream) -> f64 {
    match random.random_range(0..8) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -1e300,
        3 => random.random::<f64>() * 4.0 - 2.0,
        _ => random.random::<f64>(),
    }
}
