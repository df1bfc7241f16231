//! Which item in the kitchen becomes which part of which target, and the lower bound that follows from it.

use super::goal::{Classes, Goal, MAX_TARGETS, Offer, USELESS};
use super::ground::Ground;
use super::journeys::Needs;

/// At most so many parts of all targets together.
pub const MAX_TASKS: usize = 16;
/// The place of a part that is still in a storage.
pub const STORAGE: u8 = u8::MAX;

/// One part to bring to the board, or a complete stack to serve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Task {
    pub target: u8,
    /// Which items of the target it is; all of them: a complete stack.
    pub bits: u8,
    /// Where it is now, or [`STORAGE`].
    pub at: u8,
}

/// A choice of items for all targets, in the order in which the targets will be served.
#[derive(Clone, Copy, Debug)]
pub struct Assignment {
    pub tasks: [Task; MAX_TASKS],
    pub count: usize,
    pub order: [usize; MAX_TARGETS],
    /// Presses if nothing were ever in the way.
    pub presses: u32,
    /// Locations whose content is used, one bit each.
    pub used: u32,
    /// What the journeys cannot do without.
    needs: Needs,
    /// The same for those journeys that cannot do without a station, by station.
    station_needs: [Needs; 8],
    /// Whether something has to be assembled on the board.
    assembles: bool,
    board: usize,
}

impl Assignment {
    /// Chooses for one target after another what saves most presses against taking it from a storage.
    pub fn choose(ground: &Ground, goal: &Goal, state: &Classes, order: [usize; MAX_TARGETS]) -> Assignment {
        let mut choice = Assignment {
            tasks: [Task::default(); MAX_TASKS],
            count: 0,
            order,
            presses: 0,
            used: 0,
            needs: 0,
            station_needs: [0; 8],
            assembles: false,
            board: ground.board,
        };
        let mut useful = 0;
        for location in ground.places() {
            useful |= u32::from(state[location] > USELESS) << location;
        }
        for &target in &order[..goal.targets.len()] {
            choice.choose_for(ground, goal, state, target, useful);
        }
        if goal.targets.len() > 1 {
            choice.exchange(ground, goal, state);
        }
        for index in 0..choice.count {
            choice.account(goal, state, index);
        }
        choice
    }

    fn choose_for(&mut self, ground: &Ground, goal: &Goal, state: &Classes, target: usize, useful: u32) {
        let complete = goal.complete[target];
        if let Some(location) = self.nearest_complete(ground, state, goal.target_class[target], useful) {
            self.presses += ground.last_presses(location);
            self.push(target, complete, location as u8);
            return;
        }
        self.assembles = true;
        self.presses += ground.last_presses(ground.board);
        let mut have = 0;
        let on_board = usize::from(state[ground.board]);
        let ready = goal.ready[target][on_board];
        if ready != 0 && self.used & (1 << ground.board) == 0 {
            self.push(target, ready, ground.board as u8);
            have = ready;
        }
        let classes = goal.content.len();
        let offer = |location: usize| goal.offers[target][location * classes + usize::from(state[location])];
        let mut offered = [(Offer::default(), 0u8); 16];
        let mut count = 0;
        for location in ones(useful & !self.used) {
            offered[count] = (offer(location), location as u8);
            count += usize::from(offered[count].0.fills & !have != 0);
        }
        let offered = &offered[..count];
        while have != complete {
            // The first of the best.
            let mut best: Option<(Offer, u8)> = None;
            for &(offer, location) in offered.iter().filter(|(offer, _)| offer.fills & have == 0) {
                if best.is_none_or(|(other, _)| offer.rank > other.rank) {
                    best = Some((offer, location));
                }
            }
            match best {
                Some((offer, location)) => {
                    self.push(target, offer.fills, location);
                    have |= offer.fills;
                }
                None => {
                    let bit = (complete & !have).trailing_zeros() as usize;
                    self.push(target, 1 << bit, STORAGE);
                    have |= 1 << bit;
                }
            }
        }
    }

    /// Presses of a part, and what they cannot do without, if it lies at `at`.
    #[inline]
    pub(super) fn way(goal: &Goal, state: &Classes, task: &Task, at: u8) -> (u8, Needs) {
        let target = usize::from(task.target);
        if at == STORAGE {
            return goal.fresh[target][task.bits.trailing_zeros() as usize];
        }
        let index = usize::from(at) * goal.content.len() + usize::from(state[usize::from(at)]);
        (goal.near[target][index], goal.near_needs[target][index])
    }

    /// Lets two targets exchange their items where that saves presses.
    fn exchange(&mut self, ground: &Ground, goal: &Goal, state: &Classes) {
        let fits = |task: &Task, at: u8| {
            at == STORAGE || goal.fills[usize::from(task.target)][usize::from(state[usize::from(at)])] == task.bits
        };
        let of_first = self.tasks[..self.count].iter().take_while(|task| task.target == self.tasks[0].target).count();
        let stored = self.tasks[..of_first].iter().filter(|task| task.at == STORAGE);
        let wanted = stored.fold(0, |needs, task| needs | usize::from(Self::way(goal, state, task, STORAGE).1)) & 3;
        // What lies somewhere can only be exchanged if both targets can use it.
        let can = |task: &Task| {
            let is_shared = || goal.is_shared[usize::from(state[usize::from(task.at)])];
            task.bits.count_ones() == 1 && (task.at == STORAGE || is_shared())
        };
        for first in 0..of_first {
            if !can(&self.tasks[first]) {
                continue;
            }
            for second in of_first..self.count {
                let (a, b) = (self.tasks[first], self.tasks[second]);
                if !can(&b) || !can(&a) || a.at == b.at || !fits(&a, b.at) || !fits(&b, a.at) {
                    continue;
                }
                let presses = |task: &Task, at: u8| u32::from(Self::way(goal, state, task, at).0);
                let (exchanged, kept) = (presses(&a, b.at) + presses(&b, a.at), presses(&a, a.at) + presses(&b, b.at));
                // Of two hands the one that the first target needs should be free first.
                let frees = |at: u8| at != STORAGE && wanted & ground.journeys.bit[usize::from(at)] != 0;
                if exchanged < kept || exchanged == kept && frees(b.at) && !frees(a.at) {
                    self.tasks[first].at = b.at;
                    self.tasks[second].at = a.at;
                }
            }
        }
    }

    /// Adds up a task: its presses and what it cannot do without.
    fn account(&mut self, goal: &Goal, state: &Classes, index: usize) {
        let task = self.tasks[index];
        let target = usize::from(task.target);
        let on_board = task.at != STORAGE && goal.ready[target][usize::from(state[usize::from(task.at)])] == task.bits;
        if task.bits == goal.complete[target] || on_board && usize::from(task.at) == self.board {
            return;
        }
        let (presses, needs) = Self::way(goal, state, &task, task.at);
        self.presses += u32::from(presses);
        self.need(needs);
    }

    fn need(&mut self, needs: Needs) {
        self.needs |= needs;
        let mut stations = needs >> 2;
        while stations != 0 {
            self.station_needs[stations.trailing_zeros() as usize & 7] |= needs;
            stations &= stations - 1;
        }
    }

    fn push(&mut self, target: usize, bits: u8, at: u8) {
        if self.count < MAX_TASKS {
            self.tasks[self.count] = Task { target: target as u8, bits, at };
            self.count += 1;
        }
        if at != STORAGE {
            self.used |= 1 << at;
        }
    }

    fn nearest_complete(&self, ground: &Ground, state: &Classes, class: u8, useful: u32) -> Option<usize> {
        let complete = ones(useful & !self.used).filter(|&location| state[location] == class);
        complete.min_by_key(|&location| ground.last_presses(location))
    }

    /// Which items of a target have to be taken from a storage, bit by bit.
    pub fn stored(&self, target: usize) -> u8 {
        let tasks = self.tasks[..self.count].iter();
        tasks.filter(|task| usize::from(task.target) == target && task.at == STORAGE).map(|task| task.bits).sum()
    }

    /// The same choice, the targets served the other way round.
    pub fn reversed(&self) -> Assignment {
        Assignment { order: [self.order[1], self.order[0]], ..*self }
    }

    /// All tasks, one bit each.
    pub fn all(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Where the items of these tasks lie, one bit each.
    pub fn places(&self, tasks: u32) -> u32 {
        let at = (0..self.count).filter(|index| tasks & (1 << index) != 0).map(|index| self.tasks[index].at);
        at.filter(|&at| at != STORAGE).fold(0, |set, at| set | 1 << at)
    }

    /// Presses that are needed at least: those of the journeys, and those that clear what is in their way.
    pub fn bound(&self, ground: &Ground, state: &Classes) -> u32 {
        let unused = |location: usize| state[location] != 0 && self.used & (1 << location) == 0;
        let mut in_the_way = 0;
        // Everything of no use that is in a hand or picked up has to be thrown away, but what a hand holds to the end that
        // is not needed any more.
        let mut kept = false;
        if unused(ground.plate) {
            in_the_way += 1;
            kept = true;
        }
        if self.assembles && unused(ground.board) {
            in_the_way += 1;
            kept = true;
        }
        for (index, &station) in ground.journeys.stations.iter().enumerate() {
            let needs = self.station_needs[index];
            if needs != 0 && unused(station.index()) && station.index() != ground.plate {
                in_the_way += 1;
                kept |= needs & 3 != 3;
            }
        }
        let held = ground.hands.map(unused);
        kept |= held[0] && self.needs & 1 == 0 || held[1] && self.needs & 2 == 0;
        let busy = in_the_way > 0 || self.tasks[..self.count].iter().any(|task| usize::from(task.at) != ground.plate);
        let thrown = u32::from(held[0]) + u32::from(held[1]) + in_the_way - u32::from(kept);
        let thrown = if busy { thrown } else { 0 };
        self.presses + in_the_way + thrown
    }
}

/// The positions of the bits that are set.
#[inline]
pub fn ones(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (position < u32::BITS).then_some(position as usize)
    })
}
