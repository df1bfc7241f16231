//! A lower bound of the cost to go that holds in every state: the least bound over all assignments of items to the target
//! dishes.
//!
//! The bound of `assign` follows from one assignment, which is chosen greedily, and takes a fraction of the time. Where
//! another assignment leads to a shorter way it is too high: in 7 of 4,000 states of the tests by a press. A proof needs a
//! bound that holds.

use super::assign::MAX_TASKS;
use super::classes::{CompactState, USELESS};
use super::demand::TaskRequirements;
use super::goal::ServingGoal;
use super::ground::KitchenTables;
use super::task::{DeliveryTask, STORAGE};
use crate::base::bits::ones;

/// Largest number of steps through the assignments; beyond it, the bound is that of the items' journeys alone.
const MOST_STEPS: u32 = 20_000;

/// An item, or a stack of several, that can become part of a target dish, with the presses of its journey to the board.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    bits: u8,
    at: u8,
    presses: u32,
}

/// The assignments of items to the target dishes, gone through one after another.
struct AllAssignments<'a> {
    ground: &'a KitchenTables,
    goal: &'a ServingGoal,
    state: &'a CompactState,
    /// For each target dish, what lies somewhere and can become part of the dish.
    candidates: Vec<Vec<Candidate>>,
    /// For each target dish, the least number of presses for each of its items, whatever the others are made from.
    least_of_item: Vec<Vec<u32>>,
    /// For each target dish, the least number of presses of the dish and those after it, without obstacles.
    least_from: Vec<u32>,
    tasks: [DeliveryTask; MAX_TASKS],
    count: usize,
    /// Locations whose content the present assignment uses, one bit each.
    used: u32,
    /// The least bound of the assignments so far.
    least: u32,
    steps: u32,
}

/// A lower bound of a state's cost to go that never exceeds the cost to go.
pub fn floor(ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> u32 {
    let mut all = AllAssignments::new(ground, goal, state);
    all.assign(0, 0);
    if all.steps > MOST_STEPS { all.least_from[0] } else { all.least }
}

impl<'a> AllAssignments<'a> {
    fn new(ground: &'a KitchenTables, goal: &'a ServingGoal, state: &'a CompactState) -> AllAssignments<'a> {
        let targets = goal.targets.len();
        let candidates: Vec<Vec<Candidate>> =
            (0..targets).map(|target| candidates(ground, goal, state, target)).collect();
        let least_of_item: Vec<Vec<u32>> = (0..targets)
            .map(|target| {
                let of_item = |bit: u32| {
                    let fitting = candidates[target].iter().filter(|one| one.bits & 1 << bit != 0);
                    // A stack brings several items with the same presses.
                    let lying = fitting.map(|one| one.presses / one.bits.count_ones());
                    lying.chain([u32::from(goal.fresh[target][bit as usize].0)]).min().unwrap_or(0)
                };
                (0..goal.complete[target].count_ones()).map(of_item).collect()
            })
            .collect();
        let mut least_from = vec![0; targets + 1];
        for target in (0..targets).rev() {
            let assembled = ground.last_presses(ground.board) + least_of_item[target].iter().sum::<u32>();
            let complete = ground.places().filter(|&at| state[at] == goal.target_class[target]);
            let served = complete.map(|at| ground.last_presses(at)).chain([assembled]).min().unwrap_or(0);
            least_from[target] = least_from[target + 1] + served;
        }
        AllAssignments {
            ground,
            goal,
            state,
            candidates,
            least_of_item,
            least_from,
            tasks: [DeliveryTask::default(); MAX_TASKS],
            count: 0,
            used: 0,
            least: u32::MAX,
            steps: 0,
        }
    }

    /// Assigns items to the target dish with this index and to those after it; `presses` are those of the items so far,
    /// without obstacles.
    fn assign(&mut self, target: usize, presses: u32) {
        if target == self.goal.targets.len() {
            let tasks = self.tasks[..self.count].iter().copied();
            let demand = TaskRequirements::from_tasks(self.ground, self.goal, self.state, tasks);
            self.least = self.least.min(demand.floor(self.ground, self.state));
            return;
        }
        if presses + self.least_from[target] >= self.least {
            return;
        }
        let complete = self.goal.complete[target];
        for at in self.ground.places() {
            if self.state[at] == self.goal.target_class[target] && self.used & 1 << at == 0 {
                let task = DeliveryTask { target: target as u8, bits: complete, at: at as u8 };
                self.with(task, |all| all.assign(target + 1, presses + all.ground.last_presses(at)));
            }
        }
        self.fill(target, 0, presses + self.ground.last_presses(self.ground.board));
    }

    /// Assigns an item to each of the target dish's items that are not in the bit set `have`.
    fn fill(&mut self, target: usize, have: u8, presses: u32) {
        self.steps += 1;
        let open = self.goal.complete[target] & !have;
        let rest: u32 = ones(u32::from(open)).map(|bit| self.least_of_item[target][bit]).sum();
        if presses + rest + self.least_from[target + 1] >= self.least || self.steps > MOST_STEPS {
            return;
        }
        if open == 0 {
            return self.assign(target + 1, presses);
        }
        let bit = open & open.wrapping_neg();
        for index in 0..self.candidates[target].len() {
            let one = self.candidates[target][index];
            if one.bits & bit != 0 && one.bits & have == 0 && self.used & 1 << one.at == 0 {
                self.take(target, one, have, presses);
            }
        }
        let (fresh, _) = self.goal.fresh[target][bit.trailing_zeros() as usize];
        self.take(target, Candidate { bits: bit, at: STORAGE, presses: u32::from(fresh) }, have, presses);
    }

    fn take(&mut self, target: usize, one: Candidate, have: u8, presses: u32) {
        let task = DeliveryTask { target: target as u8, bits: one.bits, at: one.at };
        self.with(task, |all| all.fill(target, have | one.bits, presses + one.presses));
    }

    /// Goes on with one more task.
    fn with(&mut self, task: DeliveryTask, go_on: impl FnOnce(&mut Self)) {
        if self.count == MAX_TASKS {
            return;
        }
        let location = if task.at == STORAGE { 0 } else { 1 << task.at };
        self.tasks[self.count] = task;
        self.count += 1;
        self.used |= location;
        go_on(self);
        self.count -= 1;
        self.used &= !location;
    }
}

/// What lies somewhere and can become part of a target dish, but is not the complete dish.
fn candidates(ground: &KitchenTables, goal: &ServingGoal, state: &CompactState, target: usize) -> Vec<Candidate> {
    let useful = ground.places().filter(|&at| state[at] > USELESS && state[at] != goal.target_class[target]);
    let candidate = |at: usize| {
        let task =
            DeliveryTask { target: target as u8, bits: goal.fills[target][usize::from(state[at])], at: at as u8 };
        let presses = if goal.is_ready(ground, state, &task) { 0 } else { goal.way(state, &task, task.at).0 };
        Candidate { bits: task.bits, at: task.at, presses: u32::from(presses) }
    };
    useful.map(candidate).filter(|one| one.bits != 0).collect()
}
