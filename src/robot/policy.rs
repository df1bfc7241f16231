//! The robot's task policy (paper, "Robot task policy"): the robot plans backwards from the current goal and takes one
//! of the best presses at random.

use rand::RngExt;

use super::IdleReason;
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

/// Of these best presses, the presses for the order that is nearer to completion, on which the human mostly works; all
/// best presses if none is for that order, or if both orders are equally near to completion.
fn for_the_nearer_order(
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
    let mut orders: Vec<(u32, LocationId)> =
        kitchen.wanted(state).map(|(order, _)| (cost.order_with(fidelity, state, recipes, order), order)).collect();
    orders.sort_unstable();
    let [(presses_left, nearer), (others, _)] = orders[..] else { return presses };
    if presses_left == others {
        return presses;
    }
    let helps = |button: &ButtonId| {
        let next = kitchen.press(state, recipes, Agent::Robot, *button);
        next.is_some_and(|next| cost.order_is_below(fidelity, next, recipes, nearer, presses_left))
    };
    let helping: Vec<ButtonId> = presses.iter().copied().filter(helps).collect();
    if helping.is_empty() { presses } else { helping }
}

/// The presses among which the robot would choose in this state, each equally likely, if these were the recipes; none
/// if no press lowers the cost to go.
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
    let best = for_the_nearer_order(kitchen, cost, fidelity, state, recipes, best);
    // Contents without use are thrown away: put down somewhere, they would soon be in the way again.
    let trash = best.iter().copied().find(|&button| kitchen.button(Agent::Robot, button).action == ButtonAction::Trash);
    trash.map_or(best, |trash| vec![trash])
}

/// The robot's decision in the true state: one of its best presses at random, or idling if no press lowers the cost to
/// go. Presses in `skipped` are left out.
pub fn decide(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    state: State,
    skipped: &[ButtonId],
    random: &mut Stream,
) -> PolicyDecision {
    if kitchen.wanted(state).next().is_none() {
        return PolicyDecision::Idle(IdleReason::NoOrder);
    }
    let recipes = kitchen.true_recipes();
    let all = best_presses(kitchen, cost, Fidelity::Searched, state, &recipes);
    let best: Vec<ButtonId> = all.iter().copied().filter(|button| !skipped.contains(button)).collect();
    if best.len() < all.len() && best.is_empty() {
        return PolicyDecision::Idle(IdleReason::Skipped);
    }
    match chosen(kitchen, cost, Fidelity::Searched, state, &recipes, best)[..] {
        [] => PolicyDecision::Idle(IdleReason::HumanTurn),
        // A press that throws a content away is never a random choice, so no random number is drawn.
        [only] if kitchen.button(Agent::Robot, only).action == ButtonAction::Trash => PolicyDecision::Press(only),
        ref choices => PolicyDecision::Press(choices[random.random_range(0..choices.len())]),
    }
}
