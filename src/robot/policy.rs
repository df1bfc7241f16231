//! The robot's task policy: backwards from the current goal, one of the best presses at random.

use rand::RngExt;

use super::IdleReason;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, Kitchen, State};

/// What the robot does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    Press(ButtonId),
    Idle(IdleReason),
}

/// The presses of the robot that bring the goal nearer: those after which the cost to go is one less.
pub fn best_presses(kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Vec<ButtonId> {
    let decision = cost.decision(state, &kitchen.true_recipes(), Agent::Robot);
    let buttons = (0..kitchen.buttons[Agent::Robot.index()].len()).map(|index| ButtonId(index as u8));
    buttons.filter(|button| decision.after[button.index()] < decision.here).collect()
}

/// Decides for the state as it truly is: of several best presses one at random, idle if none brings the goal nearer.
pub fn decide(kitchen: &Kitchen, cost: &mut CostToGo, state: State, random: &mut Stream) -> Decision {
    if kitchen.wanted(state).next().is_none() {
        return Decision::Idle(IdleReason::NoOrder);
    }
    let best = best_presses(kitchen, cost, state);
    match best.is_empty() {
        true => Decision::Idle(IdleReason::HumanTurn),
        false => Decision::Press(best[random.random_range(0..best.len())]),
    }
}
