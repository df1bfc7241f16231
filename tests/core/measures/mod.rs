//! Measures: why presses were errors, which errors belong together, and for how long a belief was false.

mod attribution;
mod choices;
mod detection;
mod matching;
mod sequences;
mod wizard;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{AspectId, DishId, Kitchen, OrderContent, State};
use tomcom_core::mind::belief::Belief;

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

fn aspect(kitchen: &Kitchen, name: &str) -> AspectId {
    let index = kitchen.aspects.iter().position(|aspect| aspect.name == name);
    AspectId(index.unwrap_or_else(|| panic!("no aspect {name}")) as u8)
}

fn dish(kitchen: &Kitchen, name: &str) -> DishId {
    DishId(kitchen.dishes.iter().position(|dish| dish.name == name).expect("a dish") as u8)
}

/// Places and orders given as "name: content".
fn state(kitchen: &Kitchen, there: &[&str]) -> State {
    let mut state = kitchen.empty_state();
    for (name, content) in there.iter().filter_map(|one| one.split_once(": ")) {
        let location = kitchen.location_named(name).expect("a location");
        match kitchen.orders.contains(&location) {
            true => state.set_order(location, OrderContent::Dish(dish(kitchen, content))),
            false => state.set_content(location, kitchen.content_named(content).expect("a content")),
        }
    }
    state
}

/// Everything as it is but what is given as "aspect: value", each believed to `sure`; what is left is spread evenly.
fn belief(kitchen: &Kitchen, state: State, falsely: &[&str], sure: f64) -> Belief {
    let mut belief = Belief::of_truth(kitchen, state);
    for index in 0..kitchen.aspects.len() {
        let (id, one) = (AspectId(index as u8), &kitchen.aspects[index]);
        let held = falsely.iter().filter_map(|told| told.split_once(": ")).find(|(name, _)| *name == one.name);
        let value = match held {
            Some((name, label)) => {
                let value = one.labels.iter().position(|other| other == label);
                value.unwrap_or_else(|| panic!("{label} is no value of {name}: {:?}", one.labels))
            }
            None => kitchen.true_value(state, id),
        };
        let mut weights = vec![(1.0 - sure) / (one.labels.len() - 1) as f64; one.labels.len()];
        weights[value] = sure;
        belief.set(id, &weights);
    }
    belief
}
