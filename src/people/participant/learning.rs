//! Belief changes of the simulated participant after the participant's own effective and ineffective presses.

use super::true_beliefs::ParticipantBeliefs;
use tomcom_core::kitchen::{Agent, AspectId, ButtonAction, ButtonId, Kitchen, LocationId, State, World};

/// Probability that the simulated participant gives to the expected result of an own effective press.
const ACTED_CERTAINTY: f64 = 0.97;
/// Certainty that the participant gains about the own hand's content when explaining an ineffective press, because
/// people feel what they hold.
const FELT_CERTAINTY: f64 = 0.3;
/// Factor on the probability of values with which the ineffective press would have had an effect.
const CONTRADICTED_FACTOR: f64 = 0.04;

/// Updates the participant's beliefs after an own press, effective or not. Returns true if the press's effect
/// contradicted the beliefs.
pub fn learn(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, effective: bool) -> bool {
    let World { state, recipes } = beliefs.point(kitchen);
    let expected = kitchen.press(state, &recipes, Agent::Human, button);
    match (expected, effective) {
        (Some(next), true) => carry_out(kitchen, beliefs, button, next),
        (None, true) => make_sense(kitchen, beliefs, button),
        (Some(_), false) => blame(kitchen, beliefs, state, button),
        (None, false) => {}
    }
    expected.is_some() != effective
}

/// Adopts an expected effect of a press: the locations involved take the values that the rules predict, with the
/// certainty before the press.
fn carry_out(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, next: State) {
    let places = kitchen.involved(Agent::Human, button);
    let sure =
        places.iter().map(|&place| beliefs.certainty(AspectId::of_location(place))).fold(ACTED_CERTAINTY, f64::min);
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

/// Explains an unexpected effect of a press: values that the effect implies are adopted, other values at the locations
/// involved become uncertain.
fn make_sense(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId) {
    let hand = kitchen.hands[Agent::Human.index()];
    let World { mut state, .. } = beliefs.point(kitchen);
    match kitchen.button(Agent::Human, button).action {
        ButtonAction::Take(item) => {
            state.set_content(hand, item);
            settle(kitchen, beliefs, hand, state, ACTED_CERTAINTY);
        }
        ButtonAction::Trash => {
            state.set_content(hand, tomcom_core::kitchen::ContentId::EMPTY);
            settle(kitchen, beliefs, hand, state, ACTED_CERTAINTY);
        }
        ButtonAction::Serve(order) => {
            state.set_content(kitchen.plate, tomcom_core::kitchen::ContentId::EMPTY);
            state.set_order(order, tomcom_core::kitchen::OrderContent::Served);
            settle(kitchen, beliefs, kitchen.plate, state, ACTED_CERTAINTY);
            settle(kitchen, beliefs, order, state, ACTED_CERTAINTY);
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

/// Explains an unexpected lack of effect: the belief about the least certain of the press's locations is weakened.
fn blame(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, state: State, button: ButtonId) {
    if matches!(kitchen.button(Agent::Human, button).action, ButtonAction::Serve(_)) {
        // The participant sees the plate's content, so the recipe is doubted instead; see `RecipeMemory::doubt`.
        return;
    }
    let recipes = kitchen.true_recipes();
    let mut places = kitchen.involved(Agent::Human, button);
    // The participant feels what the own hand holds, so this belief is hardly doubted.
    let hand = kitchen.hands[Agent::Human.index()];
    let trust =
        |place| beliefs.certainty(AspectId::of_location(place)) + if place == hand { FELT_CERTAINTY } else { 0.0 };
    places.sort_by(|&a, &b| trust(a).total_cmp(&trust(b)));
    let Some(&place) = places.first() else { return };
    let aspect = AspectId::of_location(place);
    let would_work = |value: usize| {
        let mut other = state;
        other.set_code(place, kitchen.aspects[aspect.index()].values[value]);
        kitchen.press(other, &recipes, Agent::Human, button).is_some()
    };
    beliefs.weigh(aspect, |value| if would_work(value) { CONTRADICTED_FACTOR } else { 1.0 });
}
