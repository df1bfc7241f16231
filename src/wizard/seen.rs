//! What the participant has seen, as far as somebody can tell who sees kitchen and gaze; and which false belief would
//! explain a press.

use super::{Kitchen, Thought};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, DishId, LocationId, Recipes, State};

/// The kitchen as the participant last saw it, place by place.
#[derive(Clone, Debug)]
pub struct Seen {
    pub state: State,
    /// Where the gaze rests, and since when.
    resting: Option<(LocationId, SessionTime)>,
}

impl Seen {
    pub fn new(state: State) -> Seen {
        Seen { state, resting: None }
    }

    /// The gaze is on a place, or on none; it has read the place after `look_s` seconds.
    pub fn gaze(&mut self, now: SessionTime, location: Option<LocationId>, truth: State, look_s: f64) {
        self.resting = location.map(|at| match self.resting {
            Some((before, since)) if before == at => (at, since),
            _ => (at, now),
        });
        if let Some((at, since)) = self.resting
            && now.secs_since(since) >= look_s
        {
            self.told(at, truth);
        }
    }

    /// A place is known: it was read, shown, or changed by the participant's own hand.
    pub fn told(&mut self, location: LocationId, truth: State) {
        self.state.set_code(location, truth.code(location));
    }

    /// Whether the participant knows what is at a place.
    pub fn knows(&self, location: LocationId, truth: State) -> bool {
        self.state.code(location) == truth.code(location)
    }

    /// A pause: everything is later.
    pub fn postpone(&mut self, by: SessionTime) {
        self.resting = self.resting.map(|(location, since)| (location, since + by));
    }
}

/// Which single false belief would make this press a good one: a place that is held for what it was when it was last
/// seen, or else another version of a wanted recipe. Nothing, if the press would help nobody who believes any of that.
pub fn explain(kitchen: &Kitchen, cost: &mut CostToGo, seen: &Seen, truth: State, button: ButtonId) -> Option<Thought> {
    let recipes = kitchen.true_recipes();
    for location in kitchen.changed(seen.state, truth) {
        let mut believed = truth;
        believed.set_code(location, seen.state.code(location));
        if helps(kitchen, cost, believed, &recipes, button) {
            return Some(Thought::Place(location));
        }
    }
    let wanted: Vec<(LocationId, DishId)> = kitchen.wanted(truth).collect();
    for (order, dish) in wanted {
        for &variant in &kitchen.dish(dish).variants[1..] {
            let mut recalled = recipes;
            recalled.set(dish, variant);
            if helps(kitchen, cost, truth, &recalled, button) {
                return Some(Thought::Recipe(order, dish));
            }
        }
    }
    // Several places together: the first of them is a beginning.
    let several = helps(kitchen, cost, seen.state, &recipes, button);
    several.then(|| kitchen.changed(seen.state, truth).next()).flatten().map(Thought::Place)
}

/// Whether somebody who knows everything but this place would now press what does not help.
pub fn misleads(kitchen: &Kitchen, cost: &mut CostToGo, seen: &Seen, truth: State, location: LocationId) -> bool {
    let recipes = kitchen.true_recipes();
    let mut believed = truth;
    believed.set_code(location, seen.state.code(location));
    let mut presses = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| ButtonId(index as u8));
    presses.any(|button| {
        helps(kitchen, cost, believed, &recipes, button) && !helps(kitchen, cost, truth, &recipes, button)
    })
}

/// Whether a press of the human brings the end nearer, if everything is as `state` and `recipes` say.
fn helps(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes, button: ButtonId) -> bool {
    let next = kitchen.press(state, recipes, Agent::Human, button);
    next.is_some_and(|next| cost.all_orders(next, recipes) < cost.all_orders(state, recipes))
}
