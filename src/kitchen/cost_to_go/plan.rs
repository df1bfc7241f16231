//! The computation behind a miss of the cache: a lower bound, plans that serve one target after another, and, where the
//! two differ, a bounded search over single presses that ends in such plans.

use crate::kitchen::{Action, Agent, Kitchen};

use super::goal::{Classes, Goal, USELESS};
use super::journeys::{FreeMask, Journeys, NEVER};

/// Not possible without clearing something first.
pub const BLOCKED: u32 = 1000;

/// What is fixed for one kitchen.
#[derive(Clone, Debug)]
pub struct Ground {
    pub journeys: Journeys,
    /// Physical locations: first and one past the last index.
    pub first: usize,
    pub last: usize,
    pub hands: [usize; 2],
    pub board: usize,
    pub plate: usize,
    /// Places where anything can be put for a moment.
    pub spare: Vec<usize>,
    /// The presses other than taking: agent and action.
    pub moves: Vec<(Agent, Action)>,
    /// Where each process happens; none: in the hand.
    process_place: Vec<Option<usize>>,
    /// `[location * contents + content]`.
    accepts: Vec<bool>,
    contents: usize,
}

impl Ground {
    pub fn new(kitchen: &Kitchen) -> Ground {
        let contents = kitchen.contents.len();
        let first = kitchen.orders.len();
        let last = kitchen.locations.len();
        let id = |index: usize| crate::kitchen::LocationId(index as u8);
        let content = |index: usize| crate::kitchen::ContentId(index as u8);
        let mut accepts = vec![false; last * contents];
        for location in first..last {
            for item in 1..contents {
                accepts[location * contents + item] = kitchen.accepts(id(location), content(item));
            }
        }
        let hands = kitchen.hands.map(|hand| hand.index());
        let board = kitchen.board.index();
        let takes_all = |&location: &usize| (1..contents).all(|item| accepts[location * contents + item]);
        let spare = (first..last).filter(|location| !hands.contains(location) && *location != board);
        let spare = spare.filter(takes_all).collect();
        let mut moves: Vec<(Agent, Action)> = Vec::new();
        for agent in Agent::BOTH {
            for button in &kitchen.buttons[agent.index()] {
                let counts = match button.action {
                    Action::Take(_) | Action::Serve(_) => false,
                    // What happens at a place is the same whoever presses.
                    Action::Process(process) if kitchen.processes[usize::from(process)].place.is_some() => {
                        !moves.iter().any(|(_, other)| *other == button.action)
                    }
                    _ => true,
                };
                if counts {
                    moves.push((agent, button.action));
                }
            }
        }
        let process_place = kitchen.processes.iter().map(|process| process.place.map(|place| place.index())).collect();
        Ground {
            journeys: Journeys::new(kitchen),
            first,
            last,
            hands,
            board,
            plate: kitchen.plate.index(),
            spare,
            moves,
            process_place,
            accepts,
            contents,
        }
    }

    /// What is free in a state.
    #[inline]
    fn free(&self, state: &Classes) -> FreeMask {
        let mut free = 0;
        for location in self.first..self.last {
            if state[location] == 0 {
                free |= self.journeys.bit[location];
            }
        }
        if self.spare.iter().any(|&place| state[place] == 0) {
            free |= self.journeys.spare_bit;
        }
        free
    }

    #[inline]
    fn any_hand(free: FreeMask) -> bool {
        free & 3 != 0
    }

    #[inline]
    fn is_hand(&self, location: usize) -> bool {
        location == self.hands[0] || location == self.hands[1]
    }

    /// Presses that bring a full stack from `location` to the customer.
    #[inline]
    fn finish(&self, location: usize, free: FreeMask, plate_free: bool) -> u32 {
        if location == self.plate {
            return 1;
        }
        match (plate_free, self.is_hand(location), Self::any_hand(free)) {
            (true, true, _) => 2,
            (true, false, true) => 3,
            _ => BLOCKED,
        }
    }
}

/// The plans for one goal.
pub struct Planner<'a> {
    pub ground: &'a Ground,
    pub goal: &'a Goal,
}

impl Planner<'_> {
    /// A lower bound (nothing is ever in the way) or, `relaxed` = false, the presses of a plan that serves one target
    /// after another; [`BLOCKED`] or more if something has to be cleared first.
    pub fn serial(&self, state: &Classes, relaxed: bool) -> u32 {
        match self.goal.targets.len() {
            0 => 0,
            1 => self.serve(&mut state.clone(), 0, relaxed),
            _ if self.goal.targets[0] == self.goal.targets[1] => {
                let mut rest = *state;
                self.serve(&mut rest, 0, relaxed) + self.serve(&mut rest, 1, relaxed)
            }
            _ => {
                let mut rest = *state;
                let first = self.serve(&mut rest, 0, relaxed);
                let forwards = if first >= BLOCKED { BLOCKED } else { first + self.serve(&mut rest, 1, relaxed) };
                let mut rest = *state;
                let first = self.serve(&mut rest, 1, relaxed);
                let backwards = if first >= BLOCKED { BLOCKED } else { first + self.serve(&mut rest, 0, relaxed) };
                forwards.min(backwards)
            }
        }
    }

    /// Serves one target and leaves in `state` what it did not use.
    fn serve(&self, state: &mut Classes, target: usize, relaxed: bool) -> u32 {
        let ground = self.ground;
        let class = self.goal.target_class[target];
        if let Some(location) = self.nearest_full(state, class) {
            let free = if relaxed { ground.journeys.all_free } else { ground.free(state) };
            let plate_free = relaxed || state[ground.plate] == 0;
            let presses = ground.finish(location, free, plate_free);
            if presses < BLOCKED {
                state[location] = 0;
            }
            return presses;
        }
        let mut cost = 0;
        let on_board = usize::from(state[ground.board]);
        let mut have = self.goal.ready[target][on_board];
        let complete = self.goal.complete[target];
        if have == 0 && on_board != 0 && !relaxed {
            return BLOCKED;
        }
        if have != 0 {
            state[ground.board] = 0;
        }
        while have != complete {
            match self.next_part(state, target, have, relaxed) {
                Some((location, bits, presses)) => {
                    cost += u32::from(presses);
                    have |= bits;
                    if let Some(location) = location {
                        state[location] = 0;
                    }
                }
                None => return BLOCKED,
            }
        }
        let free = if relaxed { ground.journeys.all_free } else { ground.free(state) };
        cost + ground.finish(ground.board, free, relaxed || state[ground.plate] == 0)
    }

    fn nearest_full(&self, state: &Classes, class: u8) -> Option<usize> {
        let ground = self.ground;
        let mut best = None;
        for location in ground.first..ground.last {
            if state[location] == class {
                let rank = if location == ground.plate { 0 } else { 2 - u32::from(ground.is_hand(location)) };
                if best.is_none_or(|(least, _)| rank < least) {
                    best = Some((rank, location));
                }
            }
        }
        best.map(|(_, location)| location)
    }

    /// The next component to bring to the board: where it is now (none: in a storage), which items of the target it is,
    /// and the presses. Parts in hands first, since they set hands free.
    fn next_part(&self, state: &Classes, target: usize, have: u8, relaxed: bool) -> Option<(Option<usize>, u8, u8)> {
        let (ground, goal) = (self.ground, self.goal);
        let free = if relaxed { ground.journeys.all_free } else { ground.free(state) };
        let mut best: Option<(i32, usize, u8, u8)> = None;
        for location in ground.first..ground.last {
            let class = usize::from(state[location]);
            let fills = goal.fills[target][class];
            if fills == 0 || fills & have != 0 {
                continue;
            }
            let presses = self.bring(location, class, target, fills, free);
            if presses == NEVER {
                continue;
            }
            // What it saves against taking the same from the storages decides; a full hand is worth something too.
            let fresh: i32 = self.fresh(target, fills, ground.journeys.all_free);
            let saves = 2 * (fresh - i32::from(presses)) + i32::from(ground.is_hand(location));
            if saves >= 0 && best.is_none_or(|(most, ..)| saves > most) {
                best = Some((saves, location, fills, presses));
            }
        }
        if let Some((_, location, fills, presses)) = best {
            return Some((Some(location), fills, presses));
        }
        let missing = goal.complete[target] & !have;
        let bit = missing.trailing_zeros();
        let presses = ground.journeys.from_storage(free, goal.components[target][bit as usize]);
        (presses != NEVER).then_some((None, 1 << bit, presses))
    }

    fn fresh(&self, target: usize, bits: u8, free: FreeMask) -> i32 {
        let mut sum = 0;
        for (bit, &component) in self.goal.components[target].iter().enumerate() {
            if bits & (1 << bit) != 0 {
                sum += i32::from(self.ground.journeys.from_storage(free, component));
            }
        }
        sum
    }

    /// Presses that bring what lies at `location` onto the board.
    #[inline]
    fn bring(&self, location: usize, class: usize, target: usize, fills: u8, free: FreeMask) -> u8 {
        let ground = self.ground;
        if fills.count_ones() > 1 {
            return match (ground.is_hand(location), Ground::any_hand(free)) {
                (true, _) => 1,
                (false, true) => 2,
                (false, false) => NEVER,
            };
        }
        let component = self.goal.components[target][fills.trailing_zeros() as usize];
        let free = free | ground.journeys.bit[location];
        ground.journeys.presses(free, component, location, self.goal.content[class].0)
    }

    /// Calls `visit` with every state that one press can lead to, but presses that can never help.
    pub fn successors(&self, state: &Classes, mut visit: impl FnMut(Classes)) {
        let (ground, goal) = (self.ground, self.goal);
        for agent in Agent::BOTH {
            let hand = ground.hands[agent.index()];
            if state[hand] == 0 {
                for &class in &goal.takes[agent.index()] {
                    let mut next = *state;
                    next[hand] = class;
                    visit(next);
                }
            }
        }
        for &(agent, action) in &ground.moves {
            let hand = ground.hands[agent.index()];
            let held = state[hand];
            let mut next = *state;
            match action {
                Action::Use(location) => {
                    let location = location.index();
                    let there = state[location];
                    match (held, there) {
                        (0, 0) => continue,
                        (0, _) => (next[hand], next[location]) = (there, 0),
                        // What is of no use is thrown away rather than put down.
                        (USELESS, _) => continue,
                        (_, 0) => {
                            let content = goal.content[usize::from(held)].index();
                            if !ground.accepts[location * ground.contents + content] {
                                continue;
                            }
                            (next[hand], next[location]) = (0, held);
                        }
                        _ if location == ground.board => {
                            let stack = goal.stacks[usize::from(there) * goal.content.len() + usize::from(held)];
                            if stack == 0 {
                                continue;
                            }
                            (next[hand], next[location]) = (0, stack);
                        }
                        _ => continue,
                    }
                }
                Action::Process(process) => {
                    let place = ground.process_place[usize::from(process)].unwrap_or(hand);
                    let result = goal.becomes[usize::from(process)][usize::from(state[place])];
                    if result == 0 {
                        continue;
                    }
                    next[place] = result;
                }
                Action::Trash if held != 0 => next[hand] = 0,
                _ => continue,
            }
            visit(next);
        }
    }
}
