//! Assignments of the items in the kitchen to the parts of the dishes that are still to be served (target dishes), and
//! the lower bounds of the cost to go that follow from them.

use super::goal::{DeliveryTask, ItemValue, STORAGE, ServingGoal};
use super::ground::{CompactState, JourneyNeeds, KitchenTables, MAX_TARGETS, USELESS};
use crate::base::maths::ones;

/// Largest number of tasks (items to bring to the board, complete stacks to serve) of all target dishes together.
pub const MAX_TASKS: usize = 16;

/// An assignment of items to all target dishes, in the order in which the dishes will be served.
#[derive(Clone, Copy, Debug)]
pub struct Assignment {
    /// The tasks of the assignment; only the first [`Self::count`] are valid.
    pub tasks: [DeliveryTask; MAX_TASKS],
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
        let lying = ones(useful & !self.used).filter(|&location| state[location] == goal.target_class[target]);
        if let Some(location) = lying.min_by_key(|&location| ground.last_presses(location)) {
            return self.push(target, complete, location as u8);
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

    /// Bit set of a target dish's items that have to be taken from a storage.
    pub fn stored(&self, target: usize) -> u8 {
        let tasks = self.tasks[..self.count].iter();
        tasks.filter(|task| usize::from(task.target) == target && task.at == STORAGE).map(|task| task.bits).sum()
    }

    /// The same assignment of items with the serving order of the target dishes reversed.
    pub fn reversed(&self) -> Assignment {
        Assignment { order: [self.order[1], self.order[0]], ..*self }
    }

    pub fn all(&self) -> u32 {
        (1 << self.count) - 1
    }
}

/// Requirements of a set of tasks: presses, places and target dishes.
#[derive(Clone, Copy, Debug, Default)]
pub struct TaskRequirements {
    /// Number of presses that the tasks would take without obstacles.
    presses: u32,
    used: u32,
    /// Free hands and places that the items' journeys to the board require.
    needs: JourneyNeeds,
    /// For each processing place (station): free hands and places that the journeys through this station require.
    station_needs: [JourneyNeeds; 8],
    /// Bit set of the target dishes that have to be assembled on the board.
    assembled: u32,
    /// Whether anything remains to be done before the last press (serving).
    is_busy: bool,
}

impl TaskRequirements {
    pub fn from_tasks(
        ground: &KitchenTables,
        goal: &ServingGoal,
        state: &CompactState,
        tasks: impl Iterator<Item = DeliveryTask>,
    ) -> TaskRequirements {
        let mut demand = TaskRequirements::default();
        for task in tasks {
            let (target, at) = (usize::from(task.target), usize::from(task.at));
            if task.at != STORAGE {
                demand.used |= 1 << task.at;
            }
            demand.is_busy |= at != ground.plate;
            if task.bits == goal.complete[target] {
                demand.presses += ground.last_presses(at);
                continue;
            }
            if demand.assembled & 1 << target == 0 {
                demand.assembled |= 1 << target;
                demand.presses += ground.last_presses(ground.board);
            }
            if !goal.is_ready(ground, state, &task) {
                let (presses, needs) = goal.way(state, &task, task.at);
                demand.presses += u32::from(presses);
                demand.need(needs);
            }
        }
        demand
    }

    fn need(&mut self, needs: JourneyNeeds) {
        self.needs |= needs;
        for station in ones(u32::from(needs >> 2)) {
            self.station_needs[station & 7] |= needs;
        }
    }

    /// Lower bound of the number of presses: presses of the journeys plus presses for clearing obstacles. It is a press
    /// too high in a few states, in which a hand that a journey through an occupied station needs is free again before
    /// the station is cleared.
    pub fn bound(&self, ground: &KitchenTables, state: &CompactState) -> u32 {
        self.least(ground, state, |needs| needs & 3 != 3)
    }

    /// Lower bound of the number of presses that holds in every state.
    pub fn floor(&self, ground: &KitchenTables, state: &CompactState) -> u32 {
        self.least(ground, state, |_| true)
    }

    /// Least number of presses; `can_keep` says whether a hand can keep the content of a station, through which journeys
    /// with these needs lead, until the end.
    fn least(&self, ground: &KitchenTables, state: &CompactState, can_keep: fn(JourneyNeeds) -> bool) -> u32 {
        let unused = |location: usize| state[location] != 0 && self.used & (1 << location) == 0;
        let mut in_the_way = 0;
        // Every useless content of a hand has to be thrown away, except in a hand that is not needed any more.
        let mut kept = false;
        if unused(ground.plate) {
            in_the_way += 1;
            kept = true;
        }
        if self.assembled != 0 && unused(ground.board) {
            in_the_way += 1;
            kept = true;
        }
        for (index, &station) in ground.journeys.stations.iter().enumerate() {
            let needs = self.station_needs[index];
            if needs != 0 && unused(station.index()) && station.index() != ground.plate {
                in_the_way += 1;
                kept |= can_keep(needs);
            }
        }
        let held = ground.hands.map(unused);
        kept |= held[0] && self.needs & 1 == 0 || held[1] && self.needs & 2 == 0;
        let thrown = u32::from(held[0]) + u32::from(held[1]) + in_the_way - u32::from(kept);
        self.presses + in_the_way + if in_the_way > 0 || self.is_busy { thrown } else { 0 }
    }
}

// A lower bound of the cost to go that holds in every state: the least bound over all assignments of items to the target
// dishes. The bound of one assignment, which is chosen greedily, takes a fraction of the time. Where another assignment
// leads to a shorter way it is too high: in 7 of 4,000 states of the tests by a press. A proof needs a bound that holds.

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
    used: u32,
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
