//! Lower and upper bound of a state's cost to go, computed without a search.

use super::assign::Assignment;
use super::classes::{CompactState, MAX_TARGETS};
use super::goal::ServingGoal;
use super::ground::KitchenTables;
use super::partial_plan::{BLOCKED, PressPlan};

/// The assignments of items for both serving orders, the one with the smaller lower bound of the cost to go first.
pub struct RankedAssignments {
    choices: [Assignment; 2],
    count: usize,
    /// The lower bound of the cost to go, in presses.
    pub lower: u32,
}

impl RankedAssignments {
    /// The assignments of items in this state, and the lower bound of the cost to go that follows from the assignments.
    pub fn new(ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> RankedAssignments {
        let forwards = Assignment::choose(ground, goal, state, [0, 1]);
        let lower = forwards.demand.bound(ground, state);
        if !order_counts(goal, state) {
            let count = if goal.targets_differ() { 2 } else { 1 };
            return RankedAssignments { choices: [forwards, forwards.reversed()], count, lower };
        }
        let backwards = Assignment::choose(ground, goal, state, [1, 0]);
        let other = backwards.demand.bound(ground, state);
        match lower <= other {
            true => RankedAssignments { choices: [forwards, backwards], count: 2, lower },
            false => RankedAssignments { choices: [backwards, forwards], count: 2, lower: other },
        }
    }

    /// The lower bound of the cost to go alone, without the assignments.
    pub fn bound(ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> u32 {
        let of_order = |order| Assignment::choose(ground, goal, state, order).demand.bound(ground, state);
        let forwards = of_order([0, 1]);
        if order_counts(goal, state) { forwards.min(of_order([1, 0])) } else { forwards }
    }

    /// The assignments of items, the one with the smaller lower bound of the cost to go first.
    pub fn choices(&self) -> &[Assignment] {
        &self.choices[..self.count]
    }

    /// The assignment of items with the smaller lower bound of the cost to go.
    pub fn best_choice(&self) -> &Assignment {
        &self.choices[0]
    }

    /// Items that dishes which may be served first need from the storages: a bit set of items for each target dish.
    pub fn wanted(&self) -> [u8; MAX_TARGETS] {
        let mut wanted = [0; MAX_TARGETS];
        for choice in self.choices() {
            let first = choice.order[0];
            wanted[first] |= choice.stored(first);
        }
        wanted
    }

    /// Length of the best plan in presses; [`BLOCKED`] if no plan ends within `most` presses.
    pub fn upper(&self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState, most: u32) -> u32 {
        self.best_plan(ground, goal, state, most, false)
    }

    /// Length of the best plan in presses, where plans that do not reach the lower bound are tried again with one
    /// deviation (discrepancy) from the greedy choice.
    pub fn close_upper(&self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> u32 {
        let upper = self.upper(ground, goal, state, BLOCKED);
        if upper <= self.lower {
            return upper;
        }
        upper.min(self.best_plan(ground, goal, state, upper - 1, true))
    }

    fn best_plan(
        &self,
        ground: &KitchenTables,
        goal: &ServingGoal,
        state: &CompactState,
        most: u32,
        second_thought: bool,
    ) -> u32 {
        let (mut upper, mut limit) = (BLOCKED, most);
        for choice in self.choices() {
            let presses = PressPlan::new(ground, goal, state, choice).carry_out(limit, second_thought);
            if presses > limit {
                continue;
            }
            upper = presses;
            if upper <= self.lower {
                return upper;
            }
            limit = upper - 1;
        }
        upper
    }
}

/// Whether the order in which the target dishes choose their items can matter.
fn order_counts(goal: &ServingGoal, state: &CompactState) -> bool {
    goal.targets_differ() && state.iter().any(|&class| goal.is_shared[usize::from(class)])
}
