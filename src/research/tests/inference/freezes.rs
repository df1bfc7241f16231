//! Freeze probes: filter and plain reference let all of their times stand still while the task does.

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, DishId, OrderContent};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::mind::model::SignalModel;
use tomcom_research::reference::ReferenceFilter;

use crate::files::kitchen;

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

/// The estimates of filter and reference, by aspect and value, after a trial in which a signal stands on the display,
/// the gaze is lost, and the robot takes rice; with a freeze of this duration 0.2 s after the gaze was lost.
fn estimates(freeze_s: f64) -> [Vec<Vec<f64>>; 2] {
    let kitchen = kitchen("sushi");
    let mut cost = CostToGo::new(kitchen.clone());
    let signal = SignalModel { noticed: 0.8, delay_s: 1.0, ..SignalModel::default() };
    let mut model = HumanModel { signal, ..HumanModel::default() };
    // Forgetting shows in a few seconds.
    model.transition.recipe_half_life_s = 20.0;
    let dish = kitchen.dishes.iter().position(|dish| dish.name == "shrimp nigiri").expect("a dish");
    let mut state = kitchen.empty_state();
    state.set_order(kitchen.orders[0], OrderContent::Dish(DishId(dish as u8)));
    let rice = kitchen.button_named(Agent::Robot, "take rice").expect("a button");
    let press = kitchen.try_press(state, Agent::Robot, rice);
    let pot = kitchen.location_named("cooking_pot").expect("a location");
    let [x, y] = kitchen.location(pot).display.centre();
    let gaze = |seconds: f64| {
        let sample = GazeSample { x, y, confidence: 1.0, device_ns: None, taken_ns: None };
        (seconds, ObservedEvidence::Gaze { sample, taken: at(seconds) })
    };
    let mut story = vec![(0.0, ObservedEvidence::Started { state }), (0.5, ObservedEvidence::Pressed(press))];
    story.extend((0..60).map(|step| gaze(0.5 + f64::from(step) / 60.0)));
    story.push((1.5, ObservedEvidence::Told { location: kitchen.orders[0] }));
    if freeze_s > 0.0 {
        story.push((2.0, ObservedEvidence::Frozen));
        story.push((2.0 + freeze_s, ObservedEvidence::Thawed { by: at(freeze_s), asked: 0, teaches: 0.0 }));
    }
    story.push((2.6 + freeze_s, ObservedEvidence::EndedSignal));
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 12_401);
    model.inference.beliefs = 8000;
    let mut reference = ReferenceFilter::new(kitchen.clone(), model, 12_401);
    for (seconds, what) in story {
        let observation = Observation { time: at(seconds), what };
        filter.observe(&observation, &mut cost);
        reference.observe(&observation, &mut cost);
    }
    let means = |belief: &DirichletBelief| belief.aspects.iter().map(|aspect| aspect.mean().to_vec()).collect();
    [means(filter.belief()), means(&reference.belief())]
}

/// The largest difference between two estimates' probabilities.
fn apart(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn filter_and_reference_stand_still_in_a_freeze() {
    let [filter, reference] = estimates(0.0);
    let [frozen_filter, frozen_reference] = estimates(25.0);
    let [of_filter, of_reference] = [apart(&filter, &frozen_filter), apart(&reference, &frozen_reference)];
    let [without, with] = [apart(&filter, &reference), apart(&frozen_filter, &frozen_reference)];
    println!("by the freeze: {of_filter:.5}, reference {of_reference:.4}; apart {without:.4}, frozen {with:.4}");
    assert!(of_filter < 1e-6, "{of_filter}");
    // The reference draws its beliefs, 8000 of them.
    assert!(of_reference < 0.025 && without < 0.025 && with < 0.025, "{of_reference} {without} {with}");
}
