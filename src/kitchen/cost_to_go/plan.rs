//! Plans: the presses that carry out an assignment, one target after another, and clear what is in the way.

use super::assign::{AssemblyTask, Assignment, STORAGE};
use super::demand::PressDemand;
use super::goal::{ContentClasses, ServingGoal};
use super::ground::KitchenTables;
use super::journeys::{FreeMask, NEVER};

/// No plan found.
pub const BLOCKED: u32 = 1000;
/// Steps of a plan, at most: a guard against moving things in circles.
const MAX_STEPS: usize = 40;

/// A plan in the making.
pub struct PressPlan<'a> {
    pub(super) ground: &'a KitchenTables,
    pub(super) goal: &'a ServingGoal,
    pub(super) state: ContentClasses,
    pub(super) choice: Assignment,
    /// Tasks that are not done, one bit each.
    pub(super) open: u32,
    pub(super) presses: u32,
    /// How many targets are served, and how many steps were taken.
    served: usize,
    steps: usize,
}

impl<'a> PressPlan<'a> {
    pub fn new(
        ground: &'a KitchenTables,
        goal: &'a ServingGoal,
        state: &ContentClasses,
        choice: &Assignment,
    ) -> PressPlan<'a> {
        PressPlan { ground, goal, state: *state, choice: *choice, open: choice.all(), presses: 0, served: 0, steps: 0 }
    }

    /// The presses of the whole plan, [`BLOCKED`] if it comes to a standstill or takes more than `limit`. Room is made in the
    /// way that mostly is best; with a second thought, once in any other way that there is: a search of one discrepancy
    /// (Harvey and Ginsberg 1995, Limited Discrepancy Search).
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
            // A part that is brought takes what was reckoned with; only what makes room takes more.
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

    /// Whether the whole plan is certain to take more than `limit`.
    fn is_over(&self, limit: u32) -> bool {
        let rest = || {
            let tasks = self.tasks().map(|(_, task)| task);
            PressDemand::from_tasks(self.ground, self.goal, &self.state, tasks).bound(self.ground, &self.state)
        };
        limit < BLOCKED && self.presses + rest() > limit
    }

    /// Does what is certain to be right: serves a complete stack if the way is free, processes parts where they are, and
    /// brings what the stack on the board needs as long as nothing is in the way. Gives the presses, the state after them, and the target if one was served.
    pub fn settle(mut self) -> (u32, ContentClasses, Option<usize>) {
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

    /// Does to all parts what can be done to them where they are.
    fn process_all(&mut self) {
        for index in 0..self.choice.count {
            let at = self.choice.tasks[index].at;
            if at != STORAGE && self.open & (1 << index) != 0 {
                self.process(index, usize::from(at));
            }
        }
    }

    /// The target that the board is certain to be for: the only one, or the only one that can use what is on it.
    fn begun(&self) -> Option<usize> {
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

    /// Decides for a target where the board could be for more than one: the presses and the state after bringing a part.
    pub fn begin(mut self, target: usize) -> Option<(u32, ContentClasses)> {
        let begins = self.begun().is_none() && self.bring_part(target);
        begins.then_some((self.presses, self.state))
    }

    #[inline]
    pub(super) fn tasks(&self) -> impl Iterator<Item = (usize, AssemblyTask)> + '_ {
        let mut open = self.open;
        std::iter::from_fn(move || {
            let index = open.trailing_zeros() as usize;
            open &= open.wrapping_sub(1);
            self.choice.tasks.get(index).map(|&task| (index, task))
        })
    }

    /// A task of the target; the only one if its stack is complete.
    fn first_of(&self, target: usize) -> Option<(usize, AssemblyTask)> {
        self.tasks().find(|(_, task)| usize::from(task.target) == target)
    }

    pub(super) fn finish(&mut self, index: usize) {
        self.open &= !(1 << index);
    }

    /// Serves the target if its stack is complete and the way is free.
    fn serve(&mut self, target: usize) -> bool {
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

    /// Whether a task's item lies on the board as it has to be.
    pub(super) fn is_ready(&self, task: &AssemblyTask) -> bool {
        self.goal.is_ready(self.ground, &self.state, task)
    }

    /// Whether the board is free for parts of this target: empty, or started for it.
    pub(super) fn board_is_open(&self, target: usize) -> bool {
        let board = self.ground.board;
        if self.state[board] == 0 {
            return true;
        }
        let ours = |(_, task): (usize, AssemblyTask)| usize::from(task.target) == target && self.is_ready(&task);
        self.tasks().any(ours)
    }

    /// When the plate is not free: lifts the complete stack off the board, so that the next target's parts, one of which may
    /// be what lies on the plate, can come onto it meanwhile.
    fn lift(&mut self, target: usize, next: usize) -> bool {
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

    /// The part is on the board now: it and what was there become one.
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
        self.choice.tasks[keep] = AssemblyTask { target: target as u8, bits, at: board as u8 };
        self.state[board] = self.goal.part_class[target][usize::from(bits)];
    }

    /// Presses of a task now.
    pub(super) fn bring(&self, task: &AssemblyTask, free: FreeMask) -> u8 {
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

    /// Presses of a task if nothing were in the way.
    pub(super) fn least(&self, task: &AssemblyTask) -> u32 {
        u32::from(self.goal.way(&self.state, task, task.at).0)
    }

    /// What the rest of a task cannot do without.
    pub(super) fn needs(&self, task: &AssemblyTask) -> FreeMask {
        usize::from(self.goal.way(&self.state, task, task.at).1)
    }

    /// The task whose item lies at a location.
    pub(super) fn task_at(&self, location: usize) -> Option<(usize, AssemblyTask)> {
        self.tasks().find(|(_, task)| usize::from(task.at) == location)
    }
}
