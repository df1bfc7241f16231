//! A cost-to-go plan under construction: places of its tasks' items, and the presses that bring, process and serve
//! these items.

use super::assign::Assignment;
use super::classes::CompactState;
use super::goal::ServingGoal;
use super::ground::KitchenTables;
use super::journeys::{FreeMask, NEVER};
use super::task::{DeliveryTask, STORAGE};

/// Length, in presses, that stands for a plan that cannot be completed.
pub const BLOCKED: u32 = 1000;

/// A cost-to-go plan under construction.
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
        let mut open = self.open;
        std::iter::from_fn(move || {
            let index = open.trailing_zeros() as usize;
            open &= open.wrapping_sub(1);
            self.choice.tasks.get(index).map(|&task| (index, task))
        })
    }

    /// The first remaining task of a target dish.
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
        match hand {
            Some(hand) => {
                self.presses += 1;
                self.relocate(index, ground.hands[hand]);
                true
            }
            None => false,
        }
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
