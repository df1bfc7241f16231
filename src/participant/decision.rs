//! Decisions of the simulated participant: a sub-goal for the believed state, which is pursued for some seconds.

use std::collections::VecDeque;

use rand::RngExt;

use super::population::chance;
use super::true_beliefs::ParticipantBeliefs;
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, Recipes, State};

/// Maximum number of presses planned ahead; a plan ends earlier where the hand becomes empty.
const FORESIGHT: usize = 5;
/// Probability to choose the order with the lowest cost to go; otherwise the order is random.
const PREFERS_NEARER: f64 = 0.75;
/// Probability to consider only presses that reduce the cost to go of the order in progress.
const STAYS_WITH_ORDER: f64 = 0.85;

/// Current plan of the simulated participant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intent {
    /// Planned next presses of the participant.
    pub plan: VecDeque<ButtonId>,
    /// The order that the participant works on, and the time until which it stays with this order.
    pub order: Option<(LocationId, SessionTime)>,
    /// The last press that was tried without a plan; it is not undone immediately.
    pub tried: Option<ButtonId>,
}

/// A button and the state that the participant believes to result from pressing it.
type Step = (ButtonId, State);

/// Plans the next presses; the plan stays empty if no press is useful.
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
        && chance(random, STAYS_WITH_ORDER)
    {
        let here = cost.order(state, &recipes, order);
        choices.retain(|(_, next)| cost.order(*next, &recipes, order) < here);
    }
    let mut choices = if choices.is_empty() { good } else { choices };
    // An item is not picked up if no press would be useful afterwards.
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

/// Human presses that reduce the cost to go, given `state` and `recipes`.
pub fn good_presses(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes) -> Vec<Step> {
    let here = cost.all_orders(state, recipes);
    let mut good = effective_presses(kitchen, state, recipes);
    good.retain(|(_, next)| cost.all_orders(*next, recipes) < here);
    good
}

/// Human presses that change the state, given `state` and `recipes`.
pub fn effective_presses(kitchen: &Kitchen, state: State, recipes: &Recipes) -> Vec<Step> {
    let step = |index: usize| {
        let button = ButtonId(index as u8);
        Some((button, kitchen.press(state, recipes, Agent::Human, button)?))
    };
    (0..kitchen.buttons[Agent::Human.index()].len()).filter_map(step).collect()
}

/// Chooses the press that increases the cost to go least when no press reduces it; discarding an item is the last resort.
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
