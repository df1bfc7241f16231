//! The robot's task policy (paper, "Robot task policy"): the robot plans backwards from the current goal and takes one
//! of the best presses at random. While the human is passive, it takes the initiative ([`super::initiative`]).

use rand::RngExt;

use super::IdleReason;
use super::initiative::{OwnWays, own_ways, preparation};
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, Recipes, State};

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
    let buttons = (0..kitchen.buttons[Agent::Robot.index()].len()).map(|index| ButtonId(index as u8));
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
