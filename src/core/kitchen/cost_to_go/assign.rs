//! Assigns the items in the kitchen to the parts of the dishes that are still to be served (target dishes).

use super::classes::{CompactState, MAX_TARGETS, USELESS};
use super::demand::TaskRequirements;
use super::goal::{ItemValue, ServingGoal};
use super::ground::KitchenTables;
use super::task::{DeliveryTask, STORAGE};
use crate::base::bits::ones;

/// Largest number of tasks (items to bring to the board, complete stacks to serve) of all target dishes together.
pub const MAX_TASKS: usize = 16;

/// An assignment of items to all target dishes, in the order in which the dishes will be served.
#[derive(Clone, Copy, Debug)]
pub struct Assignment {
    /// The tasks of the assignment; only the first [`Self::count`] are valid.
    pub tasks: [DeliveryTask; MAX_TASKS],
    /// Number of valid tasks in the assignment.
    pub count: usize,
    /// The target dishes in the order in which they will be served.
    pub order: [usize; MAX_TARGETS],
    /// Locations whose content the assignment uses, one bit each.
    used: u32,
    /// Requirements of all tasks, from which the lower bound of the cost to go follows.
    pub demand: TaskRequirements,
}

impl Assignment {
    /// Assigns items greedily, target dish by target dish, by the number of presses that an item saves compared with a
    /// fresh item from a storage.
    ///
    /// Known limit: a usable stack on the board is always taken. Where a larger stack of the same target dish lies
    /// elsewhere, clearing the board for the larger stack can be shorter, and the search, which the lower bound guides,
    /// does not find that way (`proof` does). With nori on the board, nori and salmon on the counter and rice on the plate, salmon
    /// maki takes 8 presses (the robot takes the nori away and keeps it), and 10 are found.
    pub fn choose(
        ground: &KitchenTables,
        goal: &ServingGoal,
        state: &CompactState,
        order: [usize; MAX_TARGETS],
    ) -> Assignment {
        let mut choice = Assignment {
            tasks: [DeliveryTask::default(); MAX_TASKS],
            count: 0,
            order,
            used: 0,
            demand: TaskRequirements::default(),
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
        choice.demand = choice.demanded(ground, goal, state);
        choice.change_hands(ground, goal, state);
        choice
    }

    fn demanded(&self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) -> TaskRequirements {
        TaskRequirements::from_tasks(ground, goal, state, self.tasks[..self.count].iter().copied())
    }

    /// If both hands hold the same content and only one of the two is used: uses the content of the other hand instead,
    /// if fewer obstacles have to be cleared then.
    fn change_hands(&mut self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) {
        let [one, other] = ground.hands;
        let both = 1 << one | 1 << other;
        if state[one] != state[other] || !(self.used & both).is_power_of_two() {
            return;
        }
        let (from, to) = if self.used & 1 << one != 0 { (one, other) } else { (other, one) };
        let mut changed = *self;
        for task in changed.tasks[..changed.count].iter_mut().filter(|task| usize::from(task.at) == from) {
            task.at = to as u8;
        }
        changed.used ^= both;
        changed.demand = changed.demanded(ground, goal, state);
        if changed.demand.bound(ground, state) < self.demand.bound(ground, state) {
            *self = changed;
        }
    }

    fn choose_for(
        &mut self,
        ground: &KitchenTables,
        goal: &ServingGoal,
        state: &CompactState,
        target: usize,
        useful: u32,
    ) {
        let complete = goal.complete[target];
        if let Some(location) = self.nearest_complete(ground, state, goal.target_class[target], useful) {
            self.push(target, complete, location as u8);
            return;
        }
        let mut have = 0;
        let on_board = usize::from(state[ground.board]);
        let ready = goal.ready[target][on_board];
        if ready != 0 && self.used & (1 << ground.board) == 0 {
            self.push(target, ready, ground.board as u8);
            have = ready;
        }
        let classes = goal.content.len();
        let mut offered = [ItemValue::default(); 16];
        let mut count = 0;
        for location in ones(useful & !self.used) {
            offered[count] = goal.offers[target][location * classes + usize::from(state[location])];
            count += usize::from(offered[count].fills() & !have != 0);
        }
        while have != complete {
            let open = |&offer: &ItemValue| if offer.fills() & have == 0 { offer } else { ItemValue::default() };
            let best = offered[..count].iter().map(open).max().unwrap_or_default();
            let (fills, at) = match best.fills() {
                0 => (1 << (complete & !have).trailing_zeros(), STORAGE),
                fills => (fills, best.location()),
            };
            self.push(target, fills, at);
            have |= fills;
        }
    }

    /// Exchanges items between two target dishes where an exchange saves presses.
    fn exchange(&mut self, ground: &KitchenTables, goal: &ServingGoal, state: &CompactState) {
        // Exchanges are possible only for items that both target dishes can use.
        let (mut stored, mut shared) = (0u32, 0u32);
        for (index, task) in self.tasks[..self.count].iter().enumerate().filter(|(_, task)| task.bits.count_ones() == 1)
        {
            if task.at == STORAGE {
                stored |= 1 << index;
            } else if goal.is_shared[usize::from(state[usize::from(task.at)])] {
                shared |= 1 << index;
            }
        }
        if shared == 0 {
            return;
        }
        let of_first = self.tasks[..self.count].iter().take_while(|task| task.target == self.tasks[0].target).count();
        let is_first = (1 << of_first) - 1;
        let needs = |index: usize| usize::from(goal.way(state, &self.tasks[index], STORAGE).1);
        let wanted = ones(stored & is_first).fold(0, |wanted, index| wanted | needs(index)) & 3;
        let fits = |task: &DeliveryTask, at: u8| goal.fits(state, task, at);
        let presses = |task: &DeliveryTask, at: u8| u32::from(goal.way(state, task, at).0);
        // The hand that the first target dish needs should become free first; a stack on the board stays on the board.
        let frees = |at: u8| at != STORAGE && wanted & ground.journeys.bit[usize::from(at)] != 0;
        for first in ones((stored | shared) & is_first) {
            for second in ones((stored | shared) & !is_first) {
                let (a, b) = (self.tasks[first], self.tasks[second]);
                if a.at == b.at || !fits(&a, b.at) || !fits(&b, a.at) {
                    continue;
                }
                let (exchanged, kept) = (presses(&a, b.at) + presses(&b, a.at), presses(&a, a.at) + presses(&b, b.at));
                let may_change = usize::from(a.at) != ground.board && !frees(a.at);
                if exchanged < kept || exchanged == kept && frees(b.at) && may_change {
                    self.tasks[first].at = b.at;
                    self.tasks[second].at = a.at;
                }
            }
        }
    }

    fn push(&mut self, target: usize, bits: u8, at: u8) {
        if self.count < MAX_TASKS {
            self.tasks[self.count] = DeliveryTask { target: target as u8, bits, at };
            self.count += 1;
        }
        if at != STORAGE {
            self.used |= 1 << at;
        }
    }

    fn nearest_complete(&self, ground: &KitchenTables, state: &CompactState, class: u8, useful: u32) -> Option<usize> {
        let complete = ones(useful & !self.used).filter(|&location| state[location] == class);
        complete.min_by_key(|&location| ground.last_presses(location))
    }

    /// Bit set of a target dish's items that have to be taken from a storage.
    pub fn stored(&self, target: usize) -> u8 {
        let tasks = self.tasks[..self.count].iter();
        tasks.filter(|task| usize::from(task.target) == target && task.at == STORAGE).map(|task| task.bits).sum()
    }

    /// The same assignment of items with the serving order of the target dishes reversed.
    pub fn reversed(&self) -> Assignment {
        Assignment { order: [self.order[1], self.order[0]], ..*self }
    }

    /// Bit set of all tasks of this assignment.
    pub fn all(&self) -> u32 {
        (1 << self.count) - 1
    }
}
