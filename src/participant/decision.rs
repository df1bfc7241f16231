//! What the participant decides to do: a sub-goal for the state that it believes in, kept to for a while.

use std::collections::VecDeque;

use rand::RngExt;

use super::beliefs::ParticipantBeliefs;
use super::population::chance;
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, Recipes, State};

/// Presses that are thought out ahead: until the hand is free again, but not more than this.
const FORESIGHT: usize = 5;
/// Chance to begin with the order that is nearer to its end.
const PREFERS_NEARER: f64 = 0.75;
/// Chance to stay with the order at hand where both could be served by the next press.
const STAYS: f64 = 0.85;

/// What the person is up to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intent {
    /// The next presses of its own, as thought out.
    pub plan: VecDeque<ButtonId>,
    /// The order that it works on, and until when it stays with it.
    pub order: Option<(LocationId, SessionTime)>,
    /// What it has just tried because nothing went on: not to be undone at once.
    pub tried: Option<ButtonId>,
}

/// A press and the state that it is believed to lead to.
type Step = (ButtonId, State);

/// Chooses what to do next; leaves the plan empty if there is nothing to do.
pub fn think(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    beliefs: &ParticipantBeliefs,
    intent: &mut Intent,
    commit_until: SessionTime,
    now: SessionTime,
    random: &mut Stream,
) {
    let (state, recipes) = beliefs.point(kitchen);
    let mut good = good_presses(kitchen, cost, state, &recipes);
    if let Some(tried) = intent.tried
        && good.len() > 1
    {
        good.retain(|(button, _)| *button != tried);
    }
    if let Some(planned) = intent.plan.front()
        && good.iter().any(|(button, _)| button == planned)
    {
        return;
    }
    intent.plan.clear();
    if good.is_empty() {
        return;
    }
    let is_wanted = |order: LocationId| kitchen.wanted(state).any(|(wanted, _)| wanted == order);
    intent.order = intent.order.filter(|&(order, until)| now < until && is_wanted(order));
    if intent.order.is_none() {
        intent.order = choose_order(kitchen, cost, state, &recipes, random).map(|order| (order, commit_until));
    }
    let mut choices: Vec<Step> = good.clone();
    if let Some((order, _)) = intent.order
        && chance(random, STAYS)
    {
        let here = cost.order(state, &recipes, order);
        choices.retain(|(_, next)| cost.order(*next, &recipes, order) < here);
    }
    let mut choices = if choices.is_empty() { good } else { choices };
    // One does not take up what one could only stand about with.
    let goes_on = |cost: &mut CostToGo, next: State| {
        kitchen.wanted(next).next().is_none() || !good_presses(kitchen, cost, next, &recipes).is_empty()
    };
    let going_on: Vec<Step> = choices.iter().copied().filter(|(_, next)| goes_on(cost, *next)).collect();
    if !going_on.is_empty() {
        choices = going_on;
    }
    let (button, mut state) = choices[random.random_range(0..choices.len())];
    intent.plan.push_back(button);
    let hand = kitchen.hands[Agent::Human.index()];
    while intent.plan.len() < FORESIGHT && !state.content(hand).is_empty() {
        let good = good_presses(kitchen, cost, state, &recipes);
        if good.is_empty() {
            break;
        }
        let (button, next) = good[random.random_range(0..good.len())];
        intent.plan.push_back(button);
        state = next;
    }
}

fn choose_order(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    state: State,
    recipes: &Recipes,
    random: &mut Stream,
) -> Option<LocationId> {
    let mut wanted: Vec<LocationId> = kitchen.wanted(state).map(|(order, _)| order).collect();
    wanted.sort_by_key(|&order| cost.order(state, recipes, order));
    let nearest = *wanted.first()?;
    match chance(random, PREFERS_NEARER) {
        true => Some(nearest),
        false => Some(wanted[random.random_range(0..wanted.len())]),
    }
}

/// The presses of the human that bring the end nearer, if everything is as `state` and `recipes` say.
pub fn good_presses(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes) -> Vec<Step> {
    let here = cost.all_orders(state, recipes);
    let mut good = effective_presses(kitchen, state, recipes);
    good.retain(|(_, next)| cost.all_orders(*next, recipes) < here);
    good
}

/// The presses of the human that would do something.
pub fn effective_presses(kitchen: &Kitchen, state: State, recipes: &Recipes) -> Vec<Step> {
    let step = |index: usize| {
        let button = ButtonId(index as u8);
        Some((button, kitchen.press(state, recipes, Agent::Human, button)?))
    };
    (0..kitchen.buttons[Agent::Human.index()].len()).filter_map(step).collect()
}

/// Nothing seems to help: the press that does the least harm; one throws away only what nothing else can be done with.
pub fn try_something(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    state: State,
    recipes: &Recipes,
    random: &mut Stream,
) -> Option<ButtonId> {
    let mut presses = effective_presses(kitchen, state, recipes);
    if presses.len() > 1 {
        presses.retain(|(button, _)| kitchen.button(Agent::Human, *button).action != ButtonAction::Trash);
    }
    let least = presses.iter().map(|(_, next)| cost.all_orders(*next, recipes)).min()?;
    presses.retain(|(_, next)| cost.all_orders(*next, recipes) == least);
    Some(presses[random.random_range(0..presses.len())].0)
}
