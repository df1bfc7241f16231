//! Which orders the human of each explicit belief considers: all, or one.

use rand::RngExt;

use super::person::Particle;
use crate::base::rng::Stream;
use crate::kitchen::{Kitchen, State};
use crate::mind::filter::order_focus::RETURNING;
use crate::mind::model::HumanModel;

/// Draws for every belief which orders the human considers: with the probability `one_order` of the model one of several
/// orders, else all.
pub fn begin(kitchen: &Kitchen, model: &HumanModel, people: &mut [Particle], random: &mut Stream) {
    let one_order = model.decision.one_order;
    if one_order > 0.0 {
        people.iter_mut().for_each(|person| choose(kitchen, one_order, person, random));
    }
}

/// Lets a share of the humans choose anew, as at every press of theirs.
pub fn turn_at_press(kitchen: &Kitchen, model: &HumanModel, people: &mut [Particle], random: &mut Stream) {
    let one_order = model.decision.one_order;
    for person in people.iter_mut().filter(|_| one_order > 0.0) {
        if random.random::<f64>() < RETURNING {
            choose(kitchen, one_order, person, random);
        }
    }
}

/// Lets those humans choose anew who consider only an order that differs between two states.
pub fn turn_from_changed(
    kitchen: &Kitchen,
    model: &HumanModel,
    people: &mut [Particle],
    [before, after]: [State; 2],
    random: &mut Stream,
) {
    for person in people {
        if person.focus.is_some_and(|order| before.code(order) != after.code(order)) {
            choose(kitchen, model.decision.one_order, person, random);
        }
    }
}

fn choose(kitchen: &Kitchen, one_order: f64, person: &mut Particle, random: &mut Stream) {
    let is_on_one = kitchen.orders.len() > 1 && random.random::<f64>() < one_order;
    person.focus = is_on_one.then(|| kitchen.orders[random.random_range(0..kitchen.orders.len())]);
}
