//! The robot in a planner rollout: its task policy with a cache, and the timing of its arm.

use crate::kitchen::cost_to_go::{CostToGo, Fidelity};
use crate::kitchen::{Agent, ButtonId, Kitchen, OrderContent, Recipes, State};
use crate::robot::policy;

/// The cache of the robot's policy has 2^15 entries.
const BITS: u32 = 15;

/// The robot's possible presses in a state, as bit sets of buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotChoices {
    /// The presses among which the policy chooses with equal probability, one bit for each button of the robot.
    pub choices: u64,
    /// The presses that the robot completes if its arm is already moving to their buttons, one bit for each button of
    /// the robot.
    pub useful: u64,
}

impl RobotChoices {
    /// Number of equally likely presses among which the robot chooses.
    pub fn count(self) -> u32 {
        self.choices.count_ones()
    }

    /// The n-th of the robot's equally likely choices, counted from 0.
    pub fn nth(self, n: u32) -> ButtonId {
        let mut left = self.choices;
        for _ in 0..n {
            left &= left - 1;
        }
        ButtonId(left.trailing_zeros() as u8)
    }
}

/// The robot's task policy with a cache by fidelity, state and ordered recipes. The policy's cache changes computing
/// time, never results.
#[derive(Clone, Debug)]
pub struct RobotPolicy {
    known: Vec<Option<(Fidelity, State, Recipes, RobotChoices)>>,
}

impl Default for RobotPolicy {
    fn default() -> Self {
        RobotPolicy { known: vec![None; 1 << BITS] }
    }
}

impl RobotPolicy {
    /// The possible choices of the robot's policy in a state, given the true recipes.
    #[inline]
    pub fn choices(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
    ) -> RobotChoices {
        let wanted = wanted_recipes(kitchen, state, recipes);
        let place = (crate::base::rng::mix(hash(state, &wanted) ^ fidelity as u64) >> (64 - BITS)) as usize;
        if let Some((of_fidelity, known, of, choices)) = self.known[place]
            && of_fidelity == fidelity
            && known == state
            && of == wanted
        {
            return choices;
        }
        let bits = |buttons: &[ButtonId]| buttons.iter().fold(0, |bits, button| bits | 1u64 << button.0);
        let best = policy::best_presses(kitchen, cost, fidelity, state, recipes);
        let useful = bits(&best);
        let choices =
            RobotChoices { choices: bits(&policy::chosen(kitchen, cost, fidelity, state, recipes, best)), useful };
        self.known[place] = Some((fidelity, state, wanted, choices));
        choices
    }
}

/// The recipes of ordered dishes, with all other recipes set to a fixed value, since decisions do not depend on those.
fn wanted_recipes(kitchen: &Kitchen, state: State, recipes: &Recipes) -> Recipes {
    let mut wanted = Recipes::default();
    for &order in &kitchen.orders {
        if let OrderContent::Dish(dish) = state.order(order) {
            wanted.set(dish, recipes.get(dish));
        }
    }
    wanted
}

fn hash(state: State, recipes: &Recipes) -> u64 {
    let (state, recipes) = (state.bits(), recipes.bits());
    let mix = crate::base::rng::mix;
    mix(mix(state as u64 ^ mix((state >> 64) as u64)) ^ mix(recipes as u64 ^ mix((recipes >> 64) as u64)))
}

/// The press towards which the robot's arm is moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OngoingRobotPress {
    /// The button of the press, as an index into the robot's buttons.
    pub button: ButtonId,
    /// Time at which the arm touches the button, in seconds since the start of the rollout.
    pub due_s: f64,
    /// Whether the wizard chose the press, so that the robot makes the press even if it is not useful.
    pub driven: bool,
}

impl OngoingRobotPress {
    /// Whether the arm completes the press when it reaches the button.
    pub fn holds(&self, choices: RobotChoices) -> bool {
        self.driven || choices.useful >> self.button.0 & 1 == 1
    }
}

/// The state of the kitchen after this press of the robot.
pub fn press(kitchen: &Kitchen, state: State, recipes: &Recipes, button: ButtonId) -> State {
    kitchen.press(state, recipes, Agent::Robot, button).unwrap_or(state)
}
