//! The robot's task policy (paper, "Robot task policy"): backwards from the current goal, one of the best presses at random.

use rand::RngExt;

use super::IdleReason;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, Recipes, State};

/// What the robot does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolicyDecision {
    /// It sets out for this button of the robot.
    Press(ButtonId),
    /// It waits, for this reason.
    Idle(IdleReason),
}

/// The presses of the robot that bring the goal nearer: those after which the cost to go is one less.
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

/// Of these presses those for the order that is nearer to being served, which is the one that the human works on as a rule;
/// all of them if none is for it, or if both orders are as near.
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

/// What the robot may press in this state if these are the recipes, each as likely; nothing if no press brings the goal
/// nearer.
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

/// Of these best presses those that the robot decides between.
pub fn chosen(
    kitchen: &Kitchen,
    cost: &mut CostToGo,
    fidelity: Fidelity,
    state: State,
    recipes: &Recipes,
    best: Vec<ButtonId>,
) -> Vec<ButtonId> {
    let best = for_the_nearer_order(kitchen, cost, fidelity, state, recipes, best);
    // What serves no order is thrown away: put down somewhere, it would soon be in the way again.
    let trash = best.iter().copied().find(|&button| kitchen.button(Agent::Robot, button).action == ButtonAction::Trash);
    trash.map_or(best, |trash| vec![trash])
}

/// Decides for the state as it truly is: of several best presses one at random, idle if none brings the goal nearer.
/// Those of `skipped` are left out.
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
    let all = best_presses(kitchen, cost, Fidelity::Exact, state, &recipes);
    let best: Vec<ButtonId> = all.iter().copied().filter(|button| !skipped.contains(button)).collect();
    if best.len() < all.len() && best.is_empty() {
        return PolicyDecision::Idle(IdleReason::Skipped);
    }
    match chosen(kitchen, cost, Fidelity::Exact, state, &recipes, best)[..] {
        [] => PolicyDecision::Idle(IdleReason::HumanTurn),
        // What is thrown away is no choice, and draws nothing.
        [only] if kitchen.button(Agent::Robot, only).action == ButtonAction::Trash => PolicyDecision::Press(only),
        ref choices => PolicyDecision::Press(choices[random.random_range(0..choices.len())]),
    }
}
