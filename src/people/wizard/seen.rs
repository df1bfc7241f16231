//! What an observer of kitchen and gaze can infer about the participant's knowledge, and which false beliefs explain a
//! press.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, DishId, Kitchen, LocationId, Recipes, State};

/// The kitchen as the participant last saw it, location by location.
#[derive(Clone, Debug)]
pub struct ParticipantSeenKitchen {
    pub state: State,
    /// Location on which the gaze rests, and the time at which the gaze arrived there.
    resting: Option<(LocationId, SessionTime)>,
}

impl ParticipantSeenKitchen {
    pub fn new(state: State) -> ParticipantSeenKitchen {
        ParticipantSeenKitchen { state, resting: None }
    }

    /// Updates the gaze location at the time `taken`; a location counts as read once the gaze has rested on it for `look_s`
    /// seconds. `truth` is the true state, if the location has not changed since.
    pub fn gaze(&mut self, taken: SessionTime, location: Option<LocationId>, truth: Option<State>, look_s: f64) {
        self.resting = location.map(|at| match self.resting {
            Some((before, since)) if before == at => (at, since),
            _ => (at, taken),
        });
        if let (Some((at, since)), Some(truth)) = (self.resting, truth)
            && taken.secs_since(since) >= look_s
        {
            self.told(at, truth);
        }
    }

    /// Marks the content of a location as known to the participant, who read it, saw it in a signal, or changed it.
    pub fn told(&mut self, location: LocationId, truth: State) {
        self.state.set_code(location, truth.code(location));
    }

    pub fn knows(&self, location: LocationId, truth: State) -> bool {
        self.state.code(location) == truth.code(location)
    }

    pub fn postpone(&mut self, by: SessionTime) {
        self.resting = self.resting.map(|(location, since)| (location, since + by));
    }
}

#[derive(Clone, Copy, Debug)]
pub struct ObservedPress {
    pub truth: State,
    pub seen: State,
    pub button: ButtonId,
}

/// Finds single false beliefs that explain the last press: the press would be useful if the participant held the
/// belief. Candidates are the last seen content of a location, and another version of a requested recipe. Of the
/// explanations, those that explain most of the presses are returned; an empty list if no single false belief explains
/// the last press.
pub fn explain(kitchen: &Kitchen, cost: &mut CostToGo, presses: &[ObservedPress]) -> Vec<SuspectedFalseBelief> {
    let Some(last) = presses.last() else { return Vec::new() };
    let places = kitchen.changed(last.seen, last.truth).map(SuspectedFalseBelief::Place);
    let recipes = kitchen.wanted(last.truth).flat_map(|(order, dish)| {
        kitchen.dish(dish).variants[1..].iter().map(move |&variant| SuspectedFalseBelief::Recipe(order, dish, variant))
    });
    let mut explains = |thought: SuspectedFalseBelief, press: &ObservedPress| {
        let (state, recipes) = believed(kitchen, thought, press.truth, press.seen);
        helps(kitchen, cost, state, &recipes, press.button)
    };
    let mut causes: Vec<(usize, SuspectedFalseBelief)> = Vec::new();
    for thought in places.chain(recipes) {
        if explains(thought, last) {
            causes.push((presses.iter().filter(|press| explains(thought, press)).count(), thought));
        }
    }
    let most = causes.iter().map(|(explained, _)| *explained).max();
    let mut best: Vec<SuspectedFalseBelief> =
        causes.into_iter().filter(|(explained, _)| Some(*explained) == most).map(|(_, thought)| thought).collect();
    // One signal corrects all false versions of a recipe.
    best.dedup_by_key(|thought| thought.location());
    // False beliefs about several locations together explain the press; only the first of these beliefs is returned.
    if best.is_empty() && helps(kitchen, cost, last.seen, &kitchen.true_recipes(), last.button) {
        best.extend(kitchen.changed(last.seen, last.truth).next().map(SuspectedFalseBelief::Place));
    }
    best
}

/// Whether a press seems useful to a person with this one false belief but does not reduce the true cost to go.
pub(crate) fn misleads(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    seen: &ParticipantSeenKitchen,
    truth: State,
    thought: SuspectedFalseBelief,
) -> bool {
    let (state, recalled) = believed(kitchen, thought, truth, seen.state);
    let recipes = kitchen.true_recipes();
    let mut presses = kitchen.button_ids(Agent::Human);
    presses
        .any(|button| helps(kitchen, cost, state, &recalled, button) && !helps(kitchen, cost, truth, &recipes, button))
}

fn believed(kitchen: &Kitchen, thought: SuspectedFalseBelief, truth: State, seen: State) -> (State, Recipes) {
    let (mut state, mut recipes) = (truth, kitchen.true_recipes());
    match thought {
        SuspectedFalseBelief::Place(location) => state.set_code(location, seen.code(location)),
        SuspectedFalseBelief::Recipe(_, dish, variant) => recipes.set(dish, variant),
        SuspectedFalseBelief::Guess(_) => {}
    }
    (state, recipes)
}

fn helps(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes, button: ButtonId) -> bool {
    let next = kitchen.press(state, recipes, Agent::Human, button);
    next.is_some_and(|next| cost.all_orders(next, recipes) < cost.all_orders(state, recipes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tomcom_core::kitchen::ContentId;

    #[test]
    fn a_look_at_what_has_changed_since_tells_nothing_of_the_present_content() {
        let (location, mut truth) = (LocationId(3), State::default());
        let mut seen = ParticipantSeenKitchen::new(truth);
        truth.set_content(location, ContentId(1));
        let at = SessionTime::from_secs_f64;
        seen.gaze(at(9.5), Some(location), None, 0.1);
        seen.gaze(at(9.7), Some(location), None, 0.1);
        assert!(!seen.knows(location, truth), "taken before the change");
        seen.gaze(at(10.01), Some(location), Some(truth), 0.1);
        assert!(seen.knows(location, truth), "the gaze still rests there");
    }
}

/// A false belief that the wizard suspects and wants to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SuspectedFalseBelief {
    Place(LocationId),
    /// A false belief about a recipe: the order, its dish, and the stack that the participant takes for the recipe.
    Recipe(LocationId, DishId, ContentId),
    /// A wrong guess of the wizard: a location that did not cause the error, but could plausibly have caused it.
    Guess(LocationId),
}

impl SuspectedFalseBelief {
    /// The location that a signal would be about if it corrected the false belief.
    pub fn location(self) -> LocationId {
        match self {
            SuspectedFalseBelief::Place(location)
            | SuspectedFalseBelief::Recipe(location, ..)
            | SuspectedFalseBelief::Guess(location) => location,
        }
    }
}
