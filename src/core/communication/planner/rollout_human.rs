//! The human in a planner rollout: the update of the human's weighted worlds, and the human's choices.
//!
//! The human's belief in a rollout is one belief sample, represented by worlds drawn from it; equal worlds are merged,
//! with their number of draws as weight. Most people are nearly certain of one value, so few distinct worlds remain.

use super::rollout_robot::{RobotChoices, RobotPolicy};
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, ButtonId, ContentId, Fidelity, Kitchen, OrderContent, State,
    WeightedWorld, WeightedWorlds, World,
};
use crate::mind::choice::{ChoiceModel, ChoiceWeights};

/// Worlds that are drawn less than once in this many draws use the lower bound of their cost to go.
const FEW_DRAWS: u32 = 8;

impl WeightedWorlds<u32> {
    /// Whether a state aspect has its true value in all worlds.
    pub fn are_certain_of(&self, kitchen: &Kitchen, aspect: AspectId, truth: State) -> bool {
        match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(location) => {
                let code = truth.code(location);
                self.all.iter().all(|one| one.world.state.code(location) == code)
            }
            AspectKind::Recipe(dish) => {
                let stack: ContentId = kitchen.dish(dish).stack();
                self.all.iter().all(|one| one.world.recipes.get(dish) == stack)
            }
        }
    }

    /// Sets a state aspect to its true value in all worlds; returns whether a world changed.
    pub fn learn(&mut self, kitchen: &Kitchen, aspect: AspectId, truth: State) -> bool {
        if self.are_certain_of(kitchen, aspect, truth) {
            return false;
        }
        for WeightedWorld { world, .. } in &mut self.all {
            match kitchen.aspects[aspect.index()].kind {
                AspectKind::Location(location) => world.state.set_code(location, truth.code(location)),
                AspectKind::Recipe(dish) => world.recipes.set(dish, kitchen.dish(dish).stack()),
            }
        }
        self.merge();
        true
    }

    /// Conditions the worlds on the human's own press and on whether the press was effective. If no world is consistent
    /// with it, the aspects involved are set to their true values, as if the human looked at them.
    pub fn pressed(
        &mut self,
        kitchen: &Kitchen,
        button: ButtonId,
        involved: &[AspectId],
        before: State,
        after: Option<State>,
    ) {
        let press = |world: &World| kitchen.press(world.state, &world.recipes, Agent::Human, button);
        if self.all.iter().any(|one| press(&one.world).is_some() == after.is_some()) {
            self.all.retain_mut(|one| {
                let next = press(&one.world);
                one.world.state = next.unwrap_or(one.world.state);
                next.is_some() == after.is_some()
            });
            return self.merge();
        }
        let truth = after.unwrap_or(before);
        for &aspect in involved {
            self.learn(kitchen, aspect, truth);
        }
        if let ButtonAction::Serve(order) = kitchen.button(Agent::Human, button).action
            && let OrderContent::Dish(dish) = before.order(order)
        {
            self.learn(kitchen, kitchen.aspect_of_dish(dish), truth);
        }
    }

    /// Predicts a press of the robot, of which the human notices only that it happened: the weight of every world is
    /// divided evenly among the presses that the robot's policy allows in that world. The random number `draw`, uniform
    /// in [0, 1), distributes remainders of integer weights.
    pub fn robot_pressed(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, policy: &mut RobotPolicy, draw: f64) {
        let n = self.draws();
        for index in 0..self.all.len() {
            let WeightedWorld { world: World { state, recipes }, weight: count } = self.all[index];
            let choices: RobotChoices = policy.choices(kitchen, cost, fidelity(count, n), state, &recipes);
            let ways = choices.count();
            if ways == 0 {
                continue;
            }
            let first = (draw * f64::from(ways)) as u32;
            let share = |way: u32| count / ways + u32::from(way < count % ways);
            let after =
                |way: u32| super::rollout_robot::press(kitchen, state, &recipes, choices.nth((first + way) % ways));
            self.all[index].world.state = after(0);
            self.all[index].weight = share(0);
            for way in (1..ways).filter(|&way| share(way) > 0) {
                let world = World { state: after(way), recipes };
                self.all.push(WeightedWorld { world, weight: share(way) });
            }
        }
        self.merge();
    }
}

/// Fidelity of the cost to go of a world that was drawn `count` times in `n` draws.
fn fidelity(count: u32, n: u32) -> Fidelity {
    if count * FEW_DRAWS >= n { Fidelity::PlanBound } else { Fidelity::LowerBound }
}

/// Softmax weights of the choices of a human whose belief is given by weighted worlds.
pub fn choice_weights(model: &ChoiceModel, cost: &mut CostToGo, worlds: &WeightedWorlds<u32>) -> ChoiceWeights {
    let mut sums = [0u32; MAX_BUTTONS];
    let n = worlds.draws();
    let mut here = 0u32;
    for &WeightedWorld { world: World { state, recipes }, weight } in &worlds.all {
        let decision = cost.decision_with(fidelity(weight, n), state, &recipes, Agent::Human);
        here += weight * u32::from(decision.here);
        for (sum, &after) in sums.iter_mut().zip(&decision.after) {
            *sum += weight * u32::from(after);
        }
    }
    model.weights(here, &sums[..model.buttons()], n)
}
