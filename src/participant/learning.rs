//! What the participant learns from its own presses, whether they had an effect or not.

use super::beliefs::ParticipantBeliefs;
use crate::kitchen::{Agent, AspectId, ButtonAction, ButtonId, Kitchen, LocationId, State};

/// Belief in what one has done oneself.
const DONE: f64 = 0.97;
/// So much rather than the own hand another place is blamed.
const FELT: f64 = 0.3;
/// What is left of values that an outcome speaks against.
const SPOKEN_AGAINST: f64 = 0.04;

/// The press that the person means to have made had an effect, or none. True if that was a surprise.
pub fn learn(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, effective: bool) -> bool {
    let (state, recipes) = beliefs.point(kitchen);
    let expected = kitchen.press(state, &recipes, Agent::Human, button);
    match (expected, effective) {
        (Some(next), true) => carry_out(kitchen, beliefs, button, next),
        (None, true) => make_sense(kitchen, beliefs, button),
        (Some(_), false) => blame(kitchen, beliefs, state, button),
        (None, false) => {}
    }
    expected.is_some() != effective
}

/// It went as expected: everything involved is as the rules say, as surely as it was known before.
fn carry_out(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, next: State) {
    let places = kitchen.involved(Agent::Human, button);
    let sure = places.iter().map(|&place| beliefs.certainty(AspectId::of_location(place))).fold(DONE, f64::min);
    for place in places {
        settle(kitchen, beliefs, place, next, sure);
    }
}

fn settle(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, place: LocationId, state: State, sure: f64) {
    let aspect = AspectId::of_location(place);
    if let Some(value) = kitchen.aspects[aspect.index()].index_of(state.code(place)) {
        beliefs.settle(aspect, value, sure);
    }
}

/// Something happened that should not have been possible: what is certain all the same is taken over, the rest is open.
fn make_sense(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId) {
    let hand = kitchen.hands[Agent::Human.index()];
    let (mut state, _) = beliefs.point(kitchen);
    match kitchen.button(Agent::Human, button).action {
        ButtonAction::Take(item) => {
            state.set_content(hand, item);
            settle(kitchen, beliefs, hand, state, DONE);
        }
        ButtonAction::Trash => {
            state.set_content(hand, crate::kitchen::ContentId::EMPTY);
            settle(kitchen, beliefs, hand, state, DONE);
        }
        ButtonAction::Serve(order) => {
            state.set_content(kitchen.plate, crate::kitchen::ContentId::EMPTY);
            state.set_order(order, crate::kitchen::OrderContent::Served);
            settle(kitchen, beliefs, kitchen.plate, state, DONE);
            settle(kitchen, beliefs, order, state, DONE);
        }
        ButtonAction::Use(_) | ButtonAction::Process(_) => {
            for place in kitchen.involved(Agent::Human, button) {
                let aspect = AspectId::of_location(place);
                let open = vec![1.0; beliefs.distribution(aspect).len()];
                beliefs.mix(aspect, &open, 0.6);
            }
        }
    }
}

/// Nothing happened though something should have: the least certain of the places involved must be otherwise.
fn blame(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, state: State, button: ButtonId) {
    if matches!(kitchen.button(Agent::Human, button).action, ButtonAction::Serve(_)) {
        // What stands on the plate is plain to see: it is the recipe that comes into doubt, see `Memory::doubt`.
        return;
    }
    let recipes = kitchen.true_recipes();
    let mut places = kitchen.involved(Agent::Human, button);
    // What one holds one feels.
    let hand = kitchen.hands[Agent::Human.index()];
    let trust = |place| beliefs.certainty(AspectId::of_location(place)) + if place == hand { FELT } else { 0.0 };
    places.sort_by(|&a, &b| trust(a).total_cmp(&trust(b)));
    let Some(&place) = places.first() else { return };
    let aspect = AspectId::of_location(place);
    let would_work = |value: usize| {
        let mut other = state;
        other.set_code(place, kitchen.aspects[aspect.index()].values[value]);
        kitchen.press(other, &recipes, Agent::Human, button).is_some()
    };
    beliefs.weigh(aspect, |value| if would_work(value) { SPOKEN_AGAINST } else { 1.0 });
}
