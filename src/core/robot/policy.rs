//! The robot's task policy (paper, "Robot task policy"): the robot plans backwards from the current goal and takes one
//! of the best presses at random. While the human is passive, it takes the initiative.

use std::collections::hash_map::Entry;

use rand::RngExt;
use rustc_hash::FxHashMap;

use super::IdleReason;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{
    Agent, ButtonAction, ButtonId, ContentId, Kitchen, LocationId, LocationKind, OrderContent, Recipes, State,
};

/// The decision of the robot's task policy: a press, or waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolicyDecision {
    /// The robot presses this button next.
    Press(ButtonId),
    /// The robot waits, for this reason.
    Idle(IdleReason),
}

/// The presses of the robot that lower the cost to go by one press.
pub fn best_presses(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
) -> Vec<ButtonId> {
    let nearer = cost.nearer(fidelity, state, recipes, Agent::Robot);
    let buttons = kitchen.button_ids(Agent::Robot);
    buttons.filter(|button| nearer >> button.0 & 1 == 1).collect()
}

/// The order on which the human works: more presses were made for it than for every other order, counted from an empty
/// kitchen. `None` if there is no such order.
fn begun_order(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
) -> Option<LocationId> {
    let mut empty = kitchen.empty_state();
    for (order, _) in kitchen.wanted(state) {
        empty.set_order(order, state.order(order));
    }
    let mut begun: Vec<(i32, LocationId)> = kitchen
        .wanted(state)
        .map(|(order, _)| {
            let mut presses = |state| cost.order_with(fidelity, state, recipes, order) as i32;
            (presses(empty) - presses(state), order)
        })
        .collect();
    begun.sort_unstable_by_key(|(presses, _)| std::cmp::Reverse(*presses));
    match begun[..] {
        [(most, order), (others, _), ..] => (most > others).then_some(order),
        _ => None,
    }
}

/// Of these best presses, the presses for the order on which the human works; all best presses if none is for that
/// order, or if the human works on none.
fn for_the_begun_order(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
    presses: Vec<ButtonId>,
) -> Vec<ButtonId> {
    if presses.len() < 2 {
        return presses;
    }
    let Some(order) = begun_order(kitchen, cost, fidelity, state, recipes) else { return presses };
    let presses_left = cost.order_with(fidelity, state, recipes, order);
    let helps = |button: &ButtonId| {
        let next = kitchen.press(state, recipes, Agent::Robot, *button);
        next.is_some_and(|next| cost.order_is_below(fidelity, next, recipes, order, presses_left))
    };
    let helping: Vec<ButtonId> = presses.iter().copied().filter(helps).collect();
    if helping.is_empty() { presses } else { helping }
}

/// The presses among which the robot would choose in this state, each equally likely, if these were the recipes and the
/// human were active; none if no press lowers the cost to go.
pub fn choices(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
) -> Vec<ButtonId> {
    let best = best_presses(kitchen, cost, fidelity, state, recipes);
    chosen(kitchen, cost, fidelity, state, recipes, best)
}

/// Of these best presses, the presses among which the robot chooses at random.
pub fn chosen(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
    best: Vec<ButtonId>,
) -> Vec<ButtonId> {
    let best = for_the_begun_order(kitchen, cost, fidelity, state, recipes, best);
    // Contents without use are thrown away: put down somewhere, they would soon be in the way again.
    let trash = best.iter().copied().find(|&button| kitchen.button(Agent::Robot, button).action == ButtonAction::Trash);
    trash.map_or(best, |trash| vec![trash])
}

/// The presses among which the robot chooses while the human is passive: those that begin the shortest way in which the
/// robot alone serves an order, or without such a way those that prepare the orders; none if every way needs the human
/// next. Of equally short ways, those for the order on which the human works have priority.
pub fn initiative(kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Vec<ButtonId> {
    let recipes = kitchen.true_recipes();
    let orders: Vec<LocationId> = kitchen.wanted(state).map(|(order, _)| order).collect();
    let mut ways: Vec<(LocationId, OwnWays)> = Vec::new();
    for order in orders {
        ways.extend(own_ways(kitchen, cost, state, &recipes, order).map(|own| (order, own)));
    }
    let Some(presses) = ways.iter().map(|(_, own)| own.presses).min() else {
        let first = preparation(kitchen, cost, state, &recipes);
        return without_waste(kitchen, cost, state, first);
    };
    ways.retain(|(_, own)| own.presses == presses);
    if let Some(begun) = begun_order(kitchen, cost, Fidelity::Searched, state, &recipes)
        && ways.iter().any(|(order, _)| *order == begun)
    {
        ways.retain(|(order, _)| *order == begun);
    }
    let mut first: Vec<ButtonId> = ways.into_iter().flat_map(|(_, own)| own.first).collect();
    first.sort_unstable();
    first.dedup();
    without_waste(kitchen, cost, state, first)
}

/// Of these equally good presses, only the one that throws a content away if no order loses by that; else the others, if
/// there are others.
fn without_waste(kitchen: &Kitchen, cost: &mut CostToGo, state: State, presses: Vec<ButtonId>) -> Vec<ButtonId> {
    let is_trash = |button: &ButtonId| kitchen.button(Agent::Robot, *button).action == ButtonAction::Trash;
    let Some(trash) = presses.iter().copied().find(is_trash) else { return presses };
    let recipes = kitchen.true_recipes();
    let after = kitchen.press(state, &recipes, Agent::Robot, trash).unwrap_or(state);
    if presses.len() == 1 || cost.all_orders(after, &recipes) <= cost.all_orders(state, &recipes) {
        return vec![trash];
    }
    presses.into_iter().filter(|button| !is_trash(button)).collect()
}

/// Whether a press to which the robot's arm is moving still helps: it lowers the cost to go or, while the human is
/// passive, it is part of the robot's initiative.
pub fn is_useful(kitchen: &Kitchen, cost: &mut CostToGo, state: State, is_passive: bool, button: ButtonId) -> bool {
    best_presses(kitchen, cost, Fidelity::Searched, state, &kitchen.true_recipes()).contains(&button)
        || is_passive && initiative(kitchen, cost, state).contains(&button)
}

/// The robot's decision in the true state: one of the presses that [`choices`], or for a passive human [`initiative`],
/// names at random, or idling if there is none. Presses in `skipped` are left out.
pub fn decide(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    state: State,
    is_passive: bool,
    skipped: &[ButtonId],
    random: &mut Stream,
) -> PolicyDecision {
    if kitchen.wanted(state).next().is_none() {
        return PolicyDecision::Idle(IdleReason::NoOrder);
    }
    let recipes = kitchen.true_recipes();
    let all = match is_passive {
        true => initiative(kitchen, cost, state),
        false => best_presses(kitchen, cost, Fidelity::Searched, state, &recipes),
    };
    let mut best: Vec<ButtonId> = all.iter().copied().filter(|button| !skipped.contains(button)).collect();
    if best.len() < all.len() && best.is_empty() {
        return PolicyDecision::Idle(IdleReason::Skipped);
    }
    if !is_passive {
        best = chosen(kitchen, cost, Fidelity::Searched, state, &recipes, best);
    }
    match best[..] {
        [] => PolicyDecision::Idle(IdleReason::HumanTurn),
        // A press that throws a content away is never a random choice, so no random number is drawn.
        [only] if kitchen.button(Agent::Robot, only).action == ButtonAction::Trash => PolicyDecision::Press(only),
        ref choices => PolicyDecision::Press(choices[random.random_range(0..choices.len())]),
    }
}

// The robot's initiative while the human is passive: the shortest way in which the robot alone serves an order, or else
// what the robot can prepare alone. Both follow from the state alone, and neither goes in circles. Every press on the
// shortest way leaves a way that is one press shorter. Preparation follows the shortest way to the least cost to go
// within reach: every press leaves a lower one within reach, or the same one a press nearer.

/// Largest number of the robot's presses in a way that serves an order.
pub(crate) const MOST_PRESSES: u32 = 12;
/// Number of the robot's presses that preparation looks ahead: put down what the hand holds, take an ingredient, put it
/// at a station, process it.
const PREPARED_PRESSES: u32 = 4;
/// Largest number of states that a search for ways visits. Searches visit a few hundred states, rarely thousands.
const MOST_STATES: usize = 50_000;

/// The shortest ways in which the robot alone serves an order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnWays {
    /// Number of the robot's presses until the order is served.
    pub presses: u32,
    /// The first presses of the shortest ways.
    pub first: Vec<ButtonId>,
}

/// The robot's presses that change the state, each with the state after it.
fn steps<'a>(kitchen: &'a Kitchen, state: State, recipes: &'a Recipes) -> impl Iterator<Item = (ButtonId, State)> + 'a {
    let buttons = kitchen.button_ids(Agent::Robot);
    buttons.filter_map(move |button| Some((button, kitchen.press(state, recipes, Agent::Robot, button)?)))
}

/// The shortest ways of at most `MOST_PRESSES` presses in which the robot alone serves this order; `None` without such
/// a way.
pub fn own_ways(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    state: State,
    recipes: &Recipes,
    order: LocationId,
) -> Option<OwnWays> {
    let OrderContent::Dish(dish) = state.order(order) else { return None };
    if !can_make(kitchen, state, recipes.get(dish)) {
        return None;
    }
    let least = cost.order_with(Fidelity::LowerBound, state, recipes, order);
    let mut search = WaySearch { kitchen, cost, recipes, order, failed: FxHashMap::default() };
    let presses = (least..=MOST_PRESSES).find(|&presses| search.serves(state, presses))?;
    let first = steps(kitchen, state, recipes).filter(|&(_, next)| search.serves(next, presses - 1));
    let first = first.map(|(button, _)| button).collect();
    Some(OwnWays { presses, first })
}

/// Whether the robot alone could make this content, if room and presses did not matter: from what its storages, its hand
/// and the places within its reach have.
fn can_make(kitchen: &Kitchen, state: State, content: ContentId) -> bool {
    let mut made = vec![false; kitchen.contents.len()];
    let mut processes = Vec::new();
    made[state.content(kitchen.hands[Agent::Robot.index()]).index()] = true;
    for button in &kitchen.buttons[Agent::Robot.index()] {
        match button.action {
            ButtonAction::Take(item) => made[item.index()] = true,
            ButtonAction::Use(place) => made[state.content(place).index()] = true,
            ButtonAction::Process(process) => processes.push(process),
            ButtonAction::Trash | ButtonAction::Serve(_) => {}
        }
    }
    loop {
        let all: Vec<ContentId> = (0..made.len()).filter(|&one| made[one]).map(|one| ContentId(one as u8)).collect();
        let processed = all.iter().flat_map(|&one| processes.iter().filter_map(move |&by| kitchen.processed(by, one)));
        let stacked = all.iter().flat_map(|&below| all.iter().filter_map(move |&above| kitchen.stacked(below, above)));
        let new: Vec<ContentId> = processed.chain(stacked).filter(|one| !made[one.index()]).collect();
        if new.is_empty() {
            return made[content.index()];
        }
        new.iter().for_each(|one| made[one.index()] = true);
    }
}

/// Search for ways in which the robot alone serves an order, by depth. The lower bound of the cost to go, which counts
/// the presses of both agents, bounds the robot's own presses from below.
struct WaySearch<'a> {
    kitchen: &'a Kitchen,
    cost: &'a mut CostToGo,
    recipes: &'a Recipes,
    order: LocationId,
    /// For each state, the largest number of presses that were shown not to be enough.
    failed: FxHashMap<State, u32>,
}

impl WaySearch<'_> {
    /// Whether the robot alone serves the order from this state by at most this number of presses.
    fn serves(&mut self, state: State, presses: u32) -> bool {
        if !matches!(state.order(self.order), OrderContent::Dish(_)) {
            return true;
        }
        if presses == 0 || self.cost.order_with(Fidelity::LowerBound, state, self.recipes, self.order) > presses {
            return false;
        }
        match self.failed.get(&state) {
            Some(&failed) if presses <= failed => return false,
            None if self.failed.len() >= MOST_STATES => return false,
            _ => {}
        }
        let (kitchen, recipes) = (self.kitchen, self.recipes);
        if steps(kitchen, state, recipes).any(|(_, next)| self.serves(next, presses - 1)) {
            return true;
        }
        self.failed.insert(state, presses);
        false
    }
}

/// The first presses of the shortest ways of the robot to the least cost to go of all orders that it reaches alone within
/// a few presses, none of which blocks a place that the human needs next; none if no such way lowers the cost to go.
pub fn preparation(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes) -> Vec<ButtonId> {
    // The first presses of the shortest ways to each visited state, as bit sets of buttons.
    let mut visited: FxHashMap<State, (u32, u64)> = FxHashMap::default();
    visited.insert(state, (0, 0));
    let mut least = (cost.all_orders_with(Fidelity::PlanBound, state, recipes), 0, 0);
    let mut states = vec![state];
    for depth in 1..=PREPARED_PRESSES {
        let mut nexts = Vec::new();
        for &from in &states {
            let first = visited[&from].1;
            let needed = needed_next(kitchen, cost, from, recipes);
            for (button, next) in steps(kitchen, from, recipes) {
                if blocks(kitchen, &needed, from, next, recipes) {
                    continue;
                }
                let first = if depth == 1 { 1 << button.0 } else { first };
                match visited.entry(next) {
                    Entry::Occupied(mut known) if known.get().0 == depth => known.get_mut().1 |= first,
                    Entry::Occupied(_) => {}
                    Entry::Vacant(new) => {
                        new.insert((depth, first));
                        nexts.push(next);
                    }
                }
            }
        }
        for next in &nexts {
            let (value, first) = (cost.all_orders_with(Fidelity::PlanBound, *next, recipes), visited[next].1);
            if value < least.0 {
                least = (value, depth, first);
            } else if (value, depth) == (least.0, least.1) {
                least.2 |= first;
            }
        }
        states = nexts;
    }
    let buttons = kitchen.button_ids(Agent::Robot);
    buttons.filter(|button| least.2 >> button.0 & 1 == 1).collect()
}

/// The human's presses that lower the cost to go and put something down at a place.
fn needed_next(kitchen: &Kitchen, cost: &mut CostToGo, state: State, recipes: &Recipes) -> Vec<ButtonId> {
    if state.content(kitchen.hands[Agent::Human.index()]).is_empty() {
        return Vec::new();
    }
    let nearer = cost.nearer(Fidelity::PlanBound, state, recipes, Agent::Human);
    let puts_down = |button: ButtonId| match kitchen.button(Agent::Human, button).action {
        ButtonAction::Use(place) => kitchen.location(place).kind == LocationKind::Place,
        _ => false,
    };
    let buttons = kitchen.button_ids(Agent::Human);
    buttons.filter(|button| nearer >> button.0 & 1 == 1 && puts_down(*button)).collect()
}

/// Whether a press of the robot puts something where a press of the human would put something next.
fn blocks(kitchen: &Kitchen, needed: &[ButtonId], before: State, after: State, recipes: &Recipes) -> bool {
    let hand = kitchen.hands[Agent::Robot.index()];
    let puts_down = !before.content(hand).is_empty() && after.content(hand).is_empty();
    puts_down && needed.iter().any(|&button| kitchen.press(after, recipes, Agent::Human, button).is_none())
}
