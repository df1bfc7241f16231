//! The part of a plan that makes room: throws away, picks up, puts aside.

use super::assign::{STORAGE, ones};
use super::journeys::FreeMask;
use super::plan::Plan;

impl Plan<'_> {
    /// Makes room for the target: one press or two that throw away, pick up, or put aside.
    pub(super) fn clear(&mut self, target: usize) -> bool {
        let of_target = || self.tasks().filter(move |(_, task)| usize::from(task.target) == target);
        let complete = self.goal.complete[target];
        let assembling = of_target().any(|(_, task)| task.bits != complete && !self.is_ready(&task));
        let needs = of_target().filter(|(_, task)| !self.is_ready(task));
        let needs = needs.fold(0, |needs, (_, task)| needs | self.needs(&task));
        // Which hand the coming work can spare.
        let later = self.tasks().fold(needs, |needs, (_, task)| needs | self.needs(&task));
        let hands_full = self.ground.hands.iter().all(|&hand| self.state[hand] != 0);
        self.throw_away(needs, later, hands_full)
            || self.empty_place(target, assembling, needs, later)
            || self.empty_hand(needs, hands_full)
    }

    /// Throws away what is of no use from a hand that is needed, or from one of two full ones.
    fn throw_away(&mut self, needs: FreeMask, later: FreeMask, hands_full: bool) -> bool {
        let hands = self.ground.hands;
        let useless = |index: usize| self.state[hands[index]] != 0 && self.task_at(hands[index]).is_none();
        let needed = (0..2).find(|&index| needs & (1 << index) != 0 && useless(index));
        // A hand that will be needed later rather than one that may hold it to the end.
        let full = (0..2).filter(|&index| hands_full && useless(index));
        let full = full.max_by_key(|&index| (later & (1 << index) != 0, index == 0));
        let Some(index) = needed.or(full) else { return false };
        self.presses += 1;
        self.state[hands[index]] = 0;
        true
    }

    /// Takes away what lies where the target's parts have to go, if a hand is free for it.
    fn empty_place(&mut self, target: usize, assembling: bool, needs: FreeMask, later: FreeMask) -> bool {
        let ground = self.ground;
        let [human, robot] = ground.hands;
        let hand = match (self.state[human] == 0, self.state[robot] == 0) {
            (false, false) => return false,
            (true, false) => human,
            (false, true) => robot,
            (true, true) => {
                if later & 1 == 0 {
                    human
                } else {
                    robot
                }
            }
        };
        let blocks = |location: usize| match location {
            _ if self.state[location] == 0 => false,
            _ if location == ground.board => assembling && !self.board_is_open(target),
            _ if location == ground.plate => !assembling,
            _ => !ground.is_hand(location) && needs & ground.journeys.bit[location] != 0,
        };
        let blocking: u32 = ground.places().filter(|&location| blocks(location)).map(|at| 1 << at).sum();
        // First what has a way of its own, then what has to be held or thrown away.
        let tasks = self.choice.places(self.open);
        let turns = if self.bold { [blocking & tasks, blocking & !tasks] } else { [blocking, 0] };
        for location in turns.into_iter().flat_map(ones) {
            match self.task_at(location) {
                None => {
                    self.presses += 1;
                    self.state[hand] = self.state[location];
                    self.state[location] = 0;
                    return true;
                }
                Some((index, _)) if self.put_aside(index, hand, needs) => return true,
                Some(_) => {}
            }
        }
        false
    }

    /// Puts down what a needed hand holds, or throws it away if there is no place.
    fn empty_hand(&mut self, needs: FreeMask, hands_full: bool) -> bool {
        let mut best: Option<(u32, usize, Option<usize>)> = None;
        for (index, hand) in self.ground.hands.into_iter().enumerate() {
            if self.state[hand] == 0 || !(needs & (1 << index) != 0 || hands_full) {
                continue;
            }
            let Some((task_index, task)) = self.task_at(hand) else { continue };
            if let Some((rest, place)) = self.best_place(task_index, needs, self.bold)
                && best.is_none_or(|(least, ..)| rest < least)
            {
                best = Some((rest, task_index, Some(place)));
            }
            if task.bits.count_ones() == 1 {
                let (fresh, _) = self.goal.fresh[usize::from(task.target)][task.bits.trailing_zeros() as usize];
                // Thrown away with one press, taken anew with those of a fresh one.
                let rest = (u32::from(fresh) + 1).saturating_sub(self.least(&task));
                if best.is_none_or(|(least, ..)| rest < least) {
                    best = Some((rest, task_index, None));
                }
            }
        }
        match best {
            None => false,
            Some((_, index, Some(place))) => {
                self.presses += 1;
                self.relocate(index, place);
                true
            }
            Some((_, index, None)) => {
                self.presses += 1;
                self.state[usize::from(self.choice.tasks[index].at)] = 0;
                self.choice.tasks[index].at = STORAGE;
                true
            }
        }
    }

    /// Moves a part out of the way: along its own way, or into a hand that can hold it, or somewhere else.
    fn put_aside(&mut self, index: usize, hand: usize, needs: FreeMask) -> bool {
        let spare_hand = needs & self.ground.journeys.bit[hand] == 0;
        match self.best_place(index, needs, false) {
            Some((detour, place)) if detour == 0 || !spare_hand => {
                self.presses += 2;
                self.relocate(index, place);
            }
            _ if spare_hand => {
                self.presses += 1;
                self.relocate(index, hand);
            }
            _ => return false,
        }
        true
    }

    pub(super) fn relocate(&mut self, index: usize, place: usize) {
        let from = usize::from(self.choice.tasks[index].at);
        self.state[place] = self.state[from];
        self.state[from] = 0;
        self.choice.tasks[index].at = place as u8;
        self.process(index, place);
    }

    /// Does to a part what can be done to it where it is.
    pub(super) fn process(&mut self, index: usize, place: usize) {
        let task = self.choice.tasks[index];
        if task.bits.count_ones() != 1 || self.ground.is_hand(place) {
            return;
        }
        let near = &self.goal.near[usize::from(task.target)];
        let at = |class: u8| near[place * self.goal.content.len() + usize::from(class)];
        for (process, at_place) in self.ground.process_place.iter().enumerate() {
            let class = self.state[place];
            let result = self.goal.becomes[process][usize::from(class)];
            if *at_place == Some(place) && result != 0 && at(result) + 1 == at(class) {
                self.state[place] = result;
                self.presses += 1;
            }
        }
    }

    /// Where to put a part down so that its way becomes longer by as little as possible: (presses that it costs extra, place).
    fn best_place(&self, index: usize, needs: FreeMask, through: bool) -> Option<(u32, usize)> {
        let ground = self.ground;
        let task = self.choice.tasks[index];
        let from = usize::from(task.at);
        let class = usize::from(self.state[from]);
        let accepts = |place: usize| ground.accepts(place, self.goal.content[class]);
        let mut best: Option<(u32, u32, usize)> = None;
        for place in ground.places() {
            let taken = self.state[place] != 0 || ground.is_hand(place) || place == ground.board || !accepts(place);
            if taken {
                continue;
            }
            let in_use = needs & ground.journeys.bit[place] != 0;
            let detour = match task.bits.count_ones() {
                1 => {
                    let near = &self.goal.near[usize::from(task.target)];
                    let at = |location: usize| u32::from(near[location * self.goal.content.len() + class]);
                    let moved = if ground.is_hand(from) { 1 } else { 2 };
                    (at(place) + moved).saturating_sub(at(from))
                }
                _ => 2,
            };
            if in_use && !(through && detour == 0) {
                continue;
            }
            let rank = u32::from(place == ground.plate) + 2 * u32::from(in_use);
            if best.is_none_or(|(least, least_rank, _)| (detour, rank) < (least, least_rank)) {
                best = Some((detour, rank, place));
            }
        }
        best.map(|(detour, _, place)| (detour, place))
    }
}
