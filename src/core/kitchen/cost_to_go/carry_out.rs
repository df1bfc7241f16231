//! Executes a plan press by press: one target dish after another, clearing obstacles on the way.

use super::classes::CompactState;
use super::demand::TaskRequirements;
use super::partial_plan::{BLOCKED, PressPlan};

/// Largest number of steps of a plan, as a guard against endless loops.
const MAX_STEPS: usize = 40;

impl PressPlan<'_> {
    /// Length of the whole plan in presses; [`BLOCKED`] if the plan gets stuck or exceeds `limit`. Obstacles are
    /// cleared greedily; with `second_thought`, one deviation from the greedy choice is tried (Harvey and Ginsberg
    /// 1995, Limited Discrepancy Search).
    pub fn carry_out(mut self, limit: u32, second_thought: bool) -> u32 {
        if limit < BLOCKED && self.choice.demand.bound(self.ground, &self.state) > limit {
            return BLOCKED;
        }
        self.process_all();
        self.go_on(limit, second_thought)
    }

    fn go_on(mut self, mut limit: u32, second_thought: bool) -> u32 {
        let mut best = BLOCKED;
        while self.served < self.goal.targets.len() {
            let target = self.choice.order[self.served];
            if self.serve(target) {
                self.served += 1;
                continue;
            }
            self.steps += 1;
            if self.steps == MAX_STEPS {
                return best;
            }
            // Bringing a part to the board costs the presses of the assignment; only clearing obstacles costs
            // additional presses.
            if self.bring_part(target) {
                continue;
            }
            let wants = self.wants(target);
            if second_thought {
                for &made in self.moves(&wants).all() {
                    let mut other = PressPlan { ..self };
                    other.make(made);
                    if other.is_over(limit) {
                        continue;
                    }
                    let presses = other.go_on(limit, false);
                    if presses <= limit {
                        (best, limit) = (presses, presses - 1);
                    }
                }
            }
            let lifts = self.goal.targets.len() > 1;
            let advanced = lifts && self.lift(target, 1 - target) || self.clear(&wants);
            if !advanced || self.is_over(limit) {
                return best;
            }
        }
        if self.presses <= limit { self.presses } else { best }
    }

    /// Whether the complete plan certainly takes more than `limit` presses.
    fn is_over(&self, limit: u32) -> bool {
        let rest = || {
            let tasks = self.tasks().map(|(_, task)| task);
            TaskRequirements::from_tasks(self.ground, self.goal, &self.state, tasks).bound(self.ground, &self.state)
        };
        limit < BLOCKED && self.presses + rest() > limit
    }

    /// Does the presses that are certainly optimal: serves a complete stack if the way is free, processes parts where
    /// they are, and brings the parts of the stack on the board as long as nothing is in the way. Returns the number of
    /// presses, the state after these presses, and the target dish that was served, if any.
    pub fn settle(mut self) -> (u32, CompactState, Option<usize>) {
        let order = self.choice.order;
        loop {
            for &target in &order[..self.goal.targets.len()] {
                if self.serve(target) {
                    return (self.presses, self.state, Some(target));
                }
            }
            self.process_all();
            if !self.begun().is_some_and(|target| self.bring_part(target)) {
                return (self.presses, self.state, None);
            }
        }
    }

    /// Commits the board to a target dish: returns number of presses and state after the dish's first part was brought
    /// there.
    pub fn begin(mut self, target: usize) -> Option<(u32, CompactState)> {
        let begins = self.begun().is_none() && self.bring_part(target);
        begins.then_some((self.presses, self.state))
    }
}
