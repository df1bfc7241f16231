//! Plans of the cost to go: places of the tasks' items, and the presses that bring, process and serve these items, one
//! target dish after another; and both bounds of a state's cost to go.

use super::assign::{Assignment, TaskRequirements};
use super::goal::{DeliveryTask, STORAGE, ServingGoal};
use super::ground::{CompactState, FreeMask, KitchenTables, MAX_TARGETS, NEVER};
use crate::base::maths::ones;

/// Length, in presses, that stands for a plan that cannot be completed.
pub const BLOCKED: u32 = 1000;

pub struct PressPlan<'a> {
    pub(super) ground: &'a KitchenTables,
    pub(super) goal: &'a ServingGoal,
    pub(super) state: CompactState,
    pub(super) choice: Assignment,
    /// Bit set of the tasks that remain in the plan.
    pub(super) open: u32,
    pub(super) presses: u32,
    /// Number of dishes that the plan has served so far.
    pub(super) served: usize,
    pub(super) steps: usize,
}

impl<'a> PressPlan<'a> {
    /// A plan that begins in this state and follows this assignment of items.
    pub fn new(
        ground: &'a KitchenTables,
        goal: &'a ServingGoal,
        state: &CompactState,
        choice: &Assignment,
    ) -> PressPlan<'a> {
        PressPlan { ground, goal, state: *state, choice: *choice, open: choice.all(), presses: 0, served: 0, steps: 0 }
    }

    /// Processes all parts of dishes at their present places as far as possible.
    pub(super) fn process_all(&mut self) {
        for index in 0..self.choice.count {
            let at = self.choice.tasks[index].at;
            if at != STORAGE && self.open & (1 << index) != 0 {
                self.process(index, usize::from(at));
            }
        }
    }

    /// The target dish to which the board is committed: the only one, or the only one that can use the stack on the
    /// board.
    pub(super) fn begun(&self) -> Option<usize> {
        let class = usize::from(self.state[self.ground.board]);
        let mut can_be = (0..self.goal.targets.len()).filter(|&target| self.goal.ready[target][class] != 0);
        match (self.goal.targets.len(), can_be.next(), can_be.next()) {
            (1, _, _) => Some(0),
            (_, Some(target), None) => Some(target),
            (_, Some(target), Some(other)) if self.goal.targets[target] == self.goal.targets[other] => {
                self.tasks().find(|(_, task)| self.is_ready(task)).map(|(_, task)| usize::from(task.target))
            }
            _ => None,
        }
    }

    #[inline]
    pub(super) fn tasks(&self) -> impl Iterator<Item = (usize, DeliveryTask)> + '_ {
        ones(self.open).map(move |index| (index, self.choice.tasks[index]))
    }

    fn first_of(&self, target: usize) -> Option<(usize, DeliveryTask)> {
        self.tasks().find(|(_, task)| usize::from(task.target) == target)
    }

    pub(super) fn finish(&mut self, index: usize) {
        self.open &= !(1 << index);
    }

    /// Serves the target dish if its stack is complete and the way to the plate is free.
    pub(super) fn serve(&mut self, target: usize) -> bool {
        let ground = self.ground;
        let complete = self.goal.complete[target];
        let Some((index, task)) = self.first_of(target) else { return false };
        if task.bits != complete {
            return false;
        }
        let at = usize::from(task.at);
        let hand_free = self.state[ground.hands[0]] == 0 || self.state[ground.hands[1]] == 0;
        let plate_free = self.state[ground.plate] == 0;
        let can = at == ground.plate || plate_free && (ground.is_hand(at) || hand_free);
        if can {
            self.presses += ground.last_presses(at);
            self.state[at] = 0;
            self.finish(index);
        }
        can
    }

    /// Whether a task's item is on the board in its final (processed) form.
    pub(super) fn is_ready(&self, task: &DeliveryTask) -> bool {
        self.goal.is_ready(self.ground, &self.state, task)
    }

    /// Whether the board can take parts of this target dish: it is empty or holds a part of the dish.
    pub(super) fn board_is_open(&self, target: usize) -> bool {
        let board = self.ground.board;
        if self.state[board] == 0 {
            return true;
        }
        let ours = |(_, task): (usize, DeliveryTask)| usize::from(task.target) == target && self.is_ready(&task);
        self.tasks().any(ours)
    }

    /// Lifts a complete stack off the board while the plate is occupied, so that parts of the next target dish
    /// (possibly the content of the plate) can be brought onto the board.
    pub(super) fn lift(&mut self, target: usize, next: usize) -> bool {
        let ground = self.ground;
        let Some((index, task)) = self.first_of(target) else { return false };
        if task.bits != self.goal.complete[target] || next >= self.goal.targets.len() {
            return false;
        }
        if ground.is_hand(usize::from(task.at)) {
            return self.bring_part(next);
        }
        if self.state[ground.plate] == 0 || usize::from(task.at) != ground.board {
            return false;
        }
        let of_next = self.tasks().filter(|(_, task)| usize::from(task.target) == next);
        let needs = of_next.fold(0, |needs, (_, task)| needs | self.needs(&task));
        let mut free = (0..2).filter(|&index| self.state[ground.hands[index]] == 0);
        let hand = match (free.next(), free.next()) {
            (Some(only), None) => Some(only),
            _ if self.task_at(ground.plate).is_some() => None,
            (Some(_), Some(_)) => (0..2).find(|&index| needs & (1 << index) == 0),
            _ => None,
        };
        if let Some(hand) = hand {
            self.presses += 1;
            self.relocate(index, ground.hands[hand]);
        }
        hand.is_some()
    }

    pub(super) fn bring_part(&mut self, target: usize) -> bool {
        if !self.board_is_open(target) {
            return false;
        }
        let ground = self.ground;
        let free = ground.free(&self.state);
        let mut best: Option<(u32, usize, u8)> = None;
        for (index, task) in self.tasks().filter(|(_, task)| usize::from(task.target) == target) {
            if self.is_ready(&task) || task.bits == self.goal.complete[target] {
                continue;
            }
            let rank = match task.at {
                STORAGE => 2,
                at if ground.is_hand(usize::from(at)) => 0,
                _ => 1,
            };
            if best.is_some_and(|(least, ..)| rank >= least) {
                continue;
            }
            let presses = self.bring(&task, free);
            if presses != NEVER && u32::from(presses) <= self.least(&task) {
                best = Some((rank, index, presses));
            }
        }
        let Some((_, index, presses)) = best else { return false };
        self.presses += u32::from(presses);
        self.take_in(target, index);
        true
    }

    /// Merges a part that was brought with the stack on the board.
    fn take_in(&mut self, target: usize, index: usize) {
        let board = self.ground.board;
        let task = self.choice.tasks[index];
        if task.at != STORAGE {
            self.state[usize::from(task.at)] = 0;
        }
        let there = self.tasks().find(|(_, other)| usize::from(other.target) == target && self.is_ready(other));
        let bits = task.bits | there.map_or(0, |(_, other)| other.bits);
        self.finish(index);
        let keep = match there {
            Some((other, _)) => other,
            None => {
                self.open |= 1 << index;
                index
            }
        };
        self.choice.tasks[keep] = DeliveryTask { target: target as u8, bits, at: board as u8 };
        self.state[board] = self.goal.part_class[target][usize::from(bits)];
    }

    /// Number of presses of a task while the hands and places of this mask are free.
    pub(super) fn bring(&self, task: &DeliveryTask, free: FreeMask) -> u8 {
        let (ground, goal) = (self.ground, self.goal);
        let target = usize::from(task.target);
        if task.bits.count_ones() > 1 {
            return match (ground.is_hand(usize::from(task.at)), free & 3 != 0) {
                (true, _) => 1,
                (false, true) => 2,
                (false, false) => NEVER,
            };
        }
        let component = goal.components[target][task.bits.trailing_zeros() as usize];
        if task.at == STORAGE {
            return ground.journeys.storage_presses(free, component);
        }
        let at = usize::from(task.at);
        let content = goal.content[usize::from(self.state[at])].0;
        ground.journeys.presses(free | ground.journeys.bit[at], component, at, content)
    }

    /// Number of presses of a task if there were no obstacles.
    pub(super) fn least(&self, task: &DeliveryTask) -> u32 {
        u32::from(self.goal.way(&self.state, task, task.at).0)
    }

    /// Mask of free hands and places that the rest of a task requires.
    pub(super) fn needs(&self, task: &DeliveryTask) -> FreeMask {
        usize::from(self.goal.way(&self.state, task, task.at).1)
    }

    /// The task whose item is at this location; `None` if there is none.
    pub(super) fn task_at(&self, location: usize) -> Option<(usize, DeliveryTask)> {
        self.tasks().find(|(_, task)| usize::from(task.at) == location)
    }

    /// Moves the item of a task to another place and processes it there; the moving press is not counted.
    pub(super) fn relocate(&mut self, index: usize, place: usize) {
        let from = usize::from(self.choice.tasks[index].at);
        self.state[place] = std::mem::take(&mut self.state[from]);
        self.choice.tasks[index].at = place as u8;
        self.process(index, place);
    }

    /// Processes a part of a dish at its place as far as possible.
    pub(super) fn process(&mut self, index: usize, place: usize) {
        let task = self.choice.tasks[index];
        if task.bits.count_ones() != 1 || self.ground.is_hand(place) {
            return;
        }
        let at = |class: u8| self.goal.presses_from(task.target, place, class);
        for (process, at_place) in self.ground.process_place.iter().enumerate() {
            let class = self.state[place];
            let result = self.goal.becomes[process][usize::from(class)];
            if *at_place == Some(place) && result != 0 && at(result) + 1 == at(class) {
                self.state[place] = result;
                self.presses += 1;
            }
        }
    }
}

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
                for made in self.moves(&wants) {
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

/// The assignments of items for both serving orders, the one with the smaller lower bound of the cost to go first.
pub struct RankedAssignments {
    choices: [Assignment; 2],
    count: usize,
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

    /// Items that dishes which may be served first need from the storages: a bit set of items for each target dish.
    pub fn wanted(&self) -> [u8; MAX_TARGETS] {
        let mut wanted = [0; MAX_TARGETS];
        for choice in self.choices() {
            let first = choice.order[0];
            wanted[first] |= choice.stored(first);
        }
        wanted
    }

    /// Length of the best plan in presses, where plans that do not reach the lower bound are tried again with one
    /// deviation (discrepancy) from the greedy choice.
    pub fn close_upper(&self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> u32 {
        let upper = self.best_plan(ground, goal, state, BLOCKED, false);
        if upper <= self.lower {
            return upper;
        }
        upper.min(self.best_plan(ground, goal, state, upper - 1, true))
    }

    /// Length of the best plan in presses; [`BLOCKED`] if no plan ends within `most` presses. With `second_thought`, each
    /// plan may deviate once from the greedy choice.
    pub fn best_plan(
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
