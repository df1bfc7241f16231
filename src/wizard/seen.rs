//! What the participant has seen, as far as somebody can tell who sees kitchen and gaze; and which false belief would
//! explain a press.

use super::thought::Thought;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, Kitchen, LocationId, Recipes, State};

/// The kitchen as the participant last saw it, place by place.
#[derive(Clone, Debug)]
pub struct SeenKitchen {
    pub state: State,
    /// Where the gaze rests, and since when.
    resting: Option<(LocationId, SessionTime)>,
}

impl SeenKitchen {
    pub fn new(state: State) -> SeenKitchen {
        SeenKitchen { state, resting: None }
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

/// A press of the participant, with what was true then, and what had been seen of it.
#[derive(Clone, Copy, Debug)]
pub struct ObservedPress {
    pub truth: State,
    pub seen: State,
    pub button: ButtonId,
}

/// Which single false beliefs would make the last of these presses a good one: a place that is held for what it was when it was
/// last seen, or another version of a wanted recipe; of these, those that explain most of the presses. Nothing, if the press
/// would help nobody who believes any of that.
pub fn explain(kitchen: &Kitchen, cost: &mut CostToGo, presses: &[ObservedPress]) -> Vec<Thought> {
    let Some(last) = presses.last() else { return Vec::new() };
    let places = kitchen.changed(last.seen, last.truth).map(Thought::Place);
    let recipes = kitchen.wanted(last.truth).flat_map(|(order, dish)| {
        kitchen.dish(dish).variants[1..].iter().map(move |&variant| Thought::Recipe(order, dish, variant))
    });
    let mut explains = |thought: Thought, press: &ObservedPress| {
        let (state, recipes) = believed(kitchen, thought, press.truth, press.seen);
        helps(kitchen, cost, state, &recipes, press.button)
    };
    let mut causes: Vec<(usize, Thought)> = Vec::new();
    for thought in places.chain(recipes) {
        if explains(thought, last) {
            causes.push((presses.iter().filter(|press| explains(thought, press)).count(), thought));
        }
    }
    let most = causes.iter().map(|(explained, _)| *explained).max();
    let mut best: Vec<Thought> =
        causes.into_iter().filter(|(explained, _)| Some(*explained) == most).map(|(_, thought)| thought).collect();
    // Several versions of a recipe are told by the same signal.
    best.dedup_by_key(|thought| thought.location());
    // Several places together: the first of them is a beginning.
    if best.is_empty() && helps(kitchen, cost, last.seen, &kitchen.true_recipes(), last.button) {
        best.extend(kitchen.changed(last.seen, last.truth).next().map(Thought::Place));
    }
    best
}

/// Whether somebody who knows everything but this would now press what does not help.
pub fn misleads(kitchen: &Kitchen, cost: &mut CostToGo, seen: &SeenKitchen, truth: State, thought: Thought) -> bool {
    let (state, recalled) = believed(kitchen, thought, truth, seen.state);
    let recipes = kitchen.true_recipes();
    let mut presses = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| ButtonId(index as u8));
    presses
        .any(|button| helps(kitchen, cost, state, &recalled, button) && !helps(kitchen, cost, truth, &recipes, button))
}

/// What somebody believes who is wrong about this alone.
fn believed(kitchen: &Kitchen, thought: Thought, truth: State, seen: State) -> (State, Recipes) {
    let (mut state, mut recipes) = (truth, kitchen.true_recipes());
    match thought {
        Thought::Place(location) => state.set_code(location, seen.code(location)),
        Thought::Recipe(_, dish, variant) => recipes.set(dish, variant),
        Thought::Guess(_) => {}
    }
    (state, recipes)
}

/// Whether a press of the human brings the end nearer, if everything is as `state` and `recipes` say.
fn helps(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes, button: ButtonId) -> bool {
    let next = kitchen.press(state, recipes, Agent::Human, button);
    next.is_some_and(|next| cost.all_orders(next, recipes) < cost.all_orders(state, recipes))
}
