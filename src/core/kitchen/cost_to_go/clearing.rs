//! Moves of a cost-to-go plan that free a hand or a place of the kitchen.

use super::goal::{DeliveryTask, STORAGE};
use super::ground::FreeMask;
use super::plan::PressPlan;

const MAX_MOVES: usize = 32;

/// A move of one or two presses in a cost-to-go plan that frees a hand or a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearingMove {
    /// The move throws away a useless content of a hand.
    Throw { hand: usize },
    PickUp {
        from: usize,
        /// The location index of the hand that picks the content up.
        hand: usize,
    },
    /// The move brings the item of a task to a place or into a hand.
    Bring { task: usize, to: usize },
    /// The move throws away the item of a task, which can be taken anew from a storage.
    Discard { task: usize },
    /// The move takes an item of this class from a storage early and brings it to a place on its way to the board.
    Fetch { task: usize, class: u8, hand: usize, to: usize },
    /// Two tasks exchange their items in the assignment, without a press.
    Exchange { tasks: [usize; 2] },
}

/// Adds a move to those that free a hand or a place, unless they contain it already or are many.
fn add(moves: &mut Vec<ClearingMove>, other: ClearingMove) {
    if moves.len() < MAX_MOVES && !moves.contains(&other) {
        moves.push(other);
    }
}

impl PressPlan<'_> {
    /// Applies a move to the plan and adds the move's presses.
    pub(super) fn make(&mut self, made: ClearingMove) {
        let ground = self.ground;
        self.presses += match made {
            ClearingMove::Throw { .. } | ClearingMove::PickUp { .. } | ClearingMove::Discard { .. } => 1,
            ClearingMove::Bring { task, to } => {
                // Moving an item between two places needs a free hand.
                let from = usize::from(self.choice.tasks[task].at);
                if ground.is_hand(from) || ground.is_hand(to) { 1 } else { 2 }
            }
            ClearingMove::Fetch { .. } => 2,
            ClearingMove::Exchange { .. } => 0,
        };
        match made {
            ClearingMove::Throw { hand } => self.state[hand] = 0,
            ClearingMove::PickUp { from, hand } => self.state[hand] = std::mem::take(&mut self.state[from]),
            ClearingMove::Bring { task, to } => self.relocate(task, to),
            ClearingMove::Discard { task } => {
                self.state[usize::from(self.choice.tasks[task].at)] = 0;
                self.choice.tasks[task].at = STORAGE;
            }
            ClearingMove::Fetch { task, class, hand, to } => {
                self.state[hand] = class;
                self.choice.tasks[task].at = hand as u8;
                self.relocate(task, to);
            }
            ClearingMove::Exchange { tasks: [one, other] } => {
                let at = self.choice.tasks[one].at;
                self.choice.tasks[one].at = self.choice.tasks[other].at;
                self.choice.tasks[other].at = at;
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct RequiredFreePlaces {
    pub target: usize,
    /// Whether parts of the target dish still have to be brought to the board.
    pub assembling: bool,
    /// Mask of free hands and places that the parts of the dish require.
    pub needs: FreeMask,
    /// Mask of free hands and places that all remaining tasks require.
    pub later: FreeMask,
    /// Whether both agents' hands hold something.
    pub hands_full: bool,
}

impl RequiredFreePlaces {
    /// Whether the hand of this agent should be empty for the work on the target dish.
    pub fn hand(&self, agent: usize) -> bool {
        self.hands_full || self.needs & (1 << agent) != 0
    }
}

impl PressPlan<'_> {
    /// The present requirements of the work on a target dish: hands, places, and whether parts are missing.
    pub(super) fn wants(&self, target: usize) -> RequiredFreePlaces {
        let of_target = || self.tasks().filter(move |(_, task)| usize::from(task.target) == target);
        let complete = self.goal.complete[target];
        let assembling = of_target().any(|(_, task)| task.bits != complete && !self.is_ready(&task));
        let needs = of_target().filter(|(_, task)| !self.is_ready(task));
        let needs = needs.fold(0, |needs, (_, task)| needs | self.needs(&task));
        let later = self.tasks().fold(needs, |needs, (_, task)| needs | self.needs(&task));
        let hands_full = self.ground.hands.iter().all(|&hand| self.state[hand] != 0);
        RequiredFreePlaces { target, assembling, needs, later, hands_full }
    }

    pub(super) fn blocks(&self, wants: &RequiredFreePlaces, location: usize) -> bool {
        let ground = self.ground;
        match location {
            _ if self.state[location] == 0 => false,
            _ if location == ground.board => wants.assembling && !self.board_is_open(wants.target),
            _ if location == ground.plate => !wants.assembling,
            _ => !ground.is_hand(location) && wants.needs & ground.journeys.bit[location] != 0,
        }
    }

    /// The place where a part can be put down with the fewest additional presses: (additional presses, place).
    pub(super) fn best_place(&self, index: usize, needs: FreeMask, through: bool) -> Option<(u32, usize)> {
        let ground = self.ground;
        let task = self.choice.tasks[index];
        let from = usize::from(task.at);
        let class = self.state[from];
        let accepts = |place: usize| ground.accepts(place, self.goal.content[usize::from(class)]);
        let mut best: Option<(u32, u32, usize)> = None;
        for place in ground.places() {
            let taken = self.state[place] != 0 || ground.is_hand(place) || place == ground.board || !accepts(place);
            if taken {
                continue;
            }
            let in_use = needs & ground.journeys.bit[place] != 0;
            let detour = match task.bits.count_ones() {
                1 => {
                    let at = |location: usize| u32::from(self.goal.presses_from(task.target, location, class));
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

    /// The occupied place to which the single item of a task has to go next; `None` if its way is free.
    pub(super) fn blocked_by(&self, task: usize) -> Option<usize> {
        let ground = self.ground;
        let from = usize::from(self.choice.tasks[task].at);
        let content = self.goal.content[usize::from(self.state[from])];
        let places = ground.places().filter(|&place| !ground.is_hand(place) && place != ground.board);
        let mut blocked = places.filter(|&place| self.state[place] != 0 && ground.accepts(place, content));
        blocked.find(|&place| self.leads(task, from, place))
    }

    /// Whether moving the single item of a task from one location to another shortens the item's journey.
    pub(super) fn leads(&self, task: usize, from: usize, to: usize) -> bool {
        let of = self.choice.tasks[task];
        let class = self.state[usize::from(of.at)];
        let at = |location: usize| self.goal.presses_from(of.target, location, class);
        of.bits.count_ones() == 1 && at(to) + 1 == at(from)
    }
}

impl PressPlan<'_> {
    /// Clears an obstacle to the work on a target dish by the move that is usually best (one or two presses); returns
    /// whether there is such a move.
    pub(super) fn clear(&mut self, wants: &RequiredFreePlaces) -> bool {
        let best = self
            .put_down(wants)
            .or_else(|| self.throw_away(wants))
            .or_else(|| self.empty_place(wants))
            .or_else(|| self.make_way(wants))
            .or_else(|| self.empty_hand(wants));
        if let Some(best) = best {
            self.make(best);
        }
        best.is_some()
    }

    /// Puts down the content of a hand that has to be free, at a place on the content's way to the board.
    fn put_down(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let wanted = (0..2).filter(|&agent| wants.hand(agent));
        wanted.into_iter().find_map(|agent| {
            let (task, _) = self.task_at(self.ground.hands[agent])?;
            match self.best_place(task, wants.needs, true)? {
                (0, to) => Some(ClearingMove::Bring { task, to }),
                _ => None,
            }
        })
    }

    /// Throws away a useless content of a hand that has to be free, or of one of two full hands.
    fn throw_away(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let hands = self.ground.hands;
        let useless = |agent: usize| self.state[hands[agent]] != 0 && self.task_at(hands[agent]).is_none();
        let needed = (0..2).find(|&agent| wants.needs & (1 << agent) != 0 && useless(agent));
        // A hand that is needed later is emptied first; the other hand may keep its content until the plan's end.
        let full = (0..2).filter(|&agent| wants.hands_full && useless(agent));
        let full = full.max_by_key(|&agent| (wants.later & (1 << agent) != 0, agent == 0));
        needed.or(full).map(|agent| ClearingMove::Throw { hand: hands[agent] })
    }

    /// Removes a content that blocks the parts of the target dish, if a hand is free.
    fn empty_place(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let ground = self.ground;
        let [human, robot] = ground.hands;
        let hand = match (self.state[human] == 0, self.state[robot] == 0) {
            (false, false) => return None,
            (true, false) => human,
            (false, true) => robot,
            (true, true) if wants.later & 1 == 0 => human,
            (true, true) => robot,
        };
        let blocking = ground.places().filter(|&location| self.blocks(wants, location));
        // Order of preference: contents that move on along their own way, useless contents, contents that have to be
        // put aside.
        let ranked = blocking.filter_map(|from| match self.task_at(from) {
            None => Some((1, ClearingMove::PickUp { from, hand })),
            Some((task, _)) => {
                let (detour, made) = self.put_aside(wants, task, hand)?;
                Some((2 * detour.min(1), made))
            }
        });
        ranked.min_by_key(|&(rank, _)| rank).map(|(_, made)| made)
    }

    /// Moves a part out of the way: along the part's own way, into a hand, or to another place; returns the additional
    /// presses and the move.
    fn put_aside(&self, wants: &RequiredFreePlaces, task: usize, hand: usize) -> Option<(u32, ClearingMove)> {
        let of = self.choice.tasks[task];
        let from = usize::from(of.at);
        // A part of the present target dish on the board that cannot stay there would otherwise come back at once.
        let returns =
            usize::from(of.target) == wants.target && from == self.ground.board && self.leads(task, from, hand);
        if returns {
            return Some((0, ClearingMove::Bring { task, to: hand }));
        }
        let spare_hand = wants.needs & self.ground.journeys.bit[hand] == 0;
        match self.best_place(task, wants.needs, false) {
            Some((detour, to)) if detour == 0 || !spare_hand => Some((detour, ClearingMove::Bring { task, to })),
            _ if spare_hand => Some((1, ClearingMove::Bring { task, to: hand })),
            _ => None,
        }
    }

    /// Removes a content from the place to which the item in a needed hand has to go.
    fn make_way(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let ground = self.ground;
        let needed = (0..2).filter(|&agent| !wants.hands_full && wants.needs & (1 << agent) != 0);
        needed.into_iter().find_map(|agent| {
            let (held, _) = self.task_at(ground.hands[agent])?;
            let other = ground.hands[1 - agent];
            let from = self.blocked_by(held)?;
            let Some((task, _)) = self.task_at(from) else { return Some(ClearingMove::PickUp { from, hand: other }) };
            let spare_hand = wants.needs & ground.journeys.bit[other] == 0;
            match self.best_place(task, wants.needs, true) {
                Some((0, to)) => Some(ClearingMove::Bring { task, to }),
                _ if spare_hand && self.leads(task, from, other) => Some(ClearingMove::Bring { task, to: other }),
                _ => None,
            }
        })
    }

    /// Puts down the content of a hand that has to be free, or throws the content away if there is no place for it.
    fn empty_hand(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let mut best: Option<(u32, ClearingMove)> = None;
        let mut consider = |rest: u32, made: ClearingMove| {
            if best.is_none_or(|(least, _)| rest < least) {
                best = Some((rest, made));
            }
        };
        for agent in (0..2).filter(|&agent| wants.hand(agent)) {
            let Some((task, of)) = self.task_at(self.ground.hands[agent]) else { continue };
            if let Some((detour, to)) = self.best_place(task, wants.needs, true) {
                consider(detour, ClearingMove::Bring { task, to });
            }
            if of.bits.count_ones() == 1 {
                let (fresh, _) = self.goal.fresh[usize::from(of.target)][of.bits.trailing_zeros() as usize];
                // Throwing the item away costs one press, plus the presses of a fresh item.
                consider((u32::from(fresh) + 1).saturating_sub(self.least(&of)), ClearingMove::Discard { task });
            }
        }
        best.map(|(_, best)| best)
    }
}

// Moves that free a hand or a place: what the work on a target dish requires, the greedy choice of a move (throw an
// obstacle away, pick it up, put it aside), and all other moves, where the plan deviates from the greedy choice.

impl PressPlan<'_> {
    /// All moves that can free the hands and places that the work on a target dish needs.
    pub(super) fn moves(&self, wants: &RequiredFreePlaces) -> Vec<ClearingMove> {
        let mut moves = Vec::with_capacity(MAX_MOVES);
        for agent in 0..2 {
            self.empty(wants, agent, &mut moves);
        }
        for from in self.ground.places().filter(|&place| self.blocks(wants, place)) {
            self.take_away(wants, from, &mut moves);
        }
        self.exchange(&mut moves);
        self.fetch(&mut moves);
        moves
    }

    /// Adds the moves that empty the hand of an agent.
    fn empty(&self, wants: &RequiredFreePlaces, agent: usize, moves: &mut Vec<ClearingMove>) {
        let hand = self.ground.hands[agent];
        let wanted = wants.hand(agent);
        let Some((task, of)) = self.task_at(hand) else {
            if wanted && self.state[hand] != 0 {
                add(moves, ClearingMove::Throw { hand });
            }
            return;
        };
        if let Some((detour, to)) = self.best_place(task, wants.needs, true)
            && (wanted || detour == 0)
        {
            add(moves, ClearingMove::Bring { task, to });
        }
        if of.bits.count_ones() == 1 && wanted {
            add(moves, ClearingMove::Discard { task });
        }
        if let Some(from) = self.blocked_by(task) {
            self.take_away(wants, from, moves);
        }
    }

    /// Adds the moves that empty a place of the kitchen.
    fn take_away(&self, wants: &RequiredFreePlaces, from: usize, moves: &mut Vec<ClearingMove>) {
        for hand in self.ground.hands.into_iter().filter(|&hand| self.state[hand] == 0) {
            let Some((task, _)) = self.task_at(from) else {
                add(moves, ClearingMove::PickUp { from, hand });
                continue;
            };
            add(moves, ClearingMove::Bring { task, to: hand });
            if let Some((_, to)) = self.best_place(task, wants.needs, true) {
                add(moves, ClearingMove::Bring { task, to });
            }
        }
    }

    /// Adds exchanges of items between two target dishes that need no additional presses.
    fn exchange(&self, moves: &mut Vec<ClearingMove>) {
        let movable = |task: &DeliveryTask| task.bits.count_ones() == 1 && task.at != STORAGE && !self.is_ready(task);
        let way = |task: &DeliveryTask, at: u8| self.goal.way(&self.state, task, at).0;
        for (one, a) in self.tasks().filter(|(_, task)| movable(task)) {
            for (other, b) in self.tasks().filter(|(_, task)| movable(task) && task.target > a.target) {
                let fit = self.goal.fits(&self.state, &a, b.at) && self.goal.fits(&self.state, &b, a.at);
                if fit && way(&a, b.at) + way(&b, a.at) <= way(&a, a.at) + way(&b, b.at) {
                    add(moves, ClearingMove::Exchange { tasks: [one, other] });
                }
            }
        }
    }

    /// Adds moves that take an item from a storage early and put it on a free place on its way to the board, so that
    /// the hand is free later.
    fn fetch(&self, moves: &mut Vec<ClearingMove>) {
        let (ground, goal) = (self.ground, self.goal);
        for (task, of) in self.tasks().filter(|(_, task)| task.at == STORAGE) {
            let target = usize::from(of.target);
            let fresh = u32::from(goal.fresh[target][of.bits.trailing_zeros() as usize].0);
            for (agent, hand) in ground.hands.into_iter().enumerate().filter(|(_, hand)| self.state[*hand] == 0) {
                let fits = |class: &u8| goal.fills[target][usize::from(*class)] == of.bits;
                for class in goal.takes[agent].iter().copied().filter(fits) {
                    let at = |location: usize| u32::from(goal.presses_from(of.target, location, class));
                    let is_free = |place: &usize| {
                        let is_place = !ground.is_hand(*place) && *place != ground.board;
                        is_place && self.state[*place] == 0 && ground.accepts(*place, goal.content[usize::from(class)])
                    };
                    for to in ground.places().filter(is_free) {
                        if at(hand) + 1 == fresh && at(to) + 2 == fresh {
                            add(moves, ClearingMove::Fetch { task, class, hand, to });
                        }
                    }
                }
            }
        }
    }
}
