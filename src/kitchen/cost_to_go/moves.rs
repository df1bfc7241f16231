//! The moves that make room, and all that might.

use super::assign::{AssemblyTask, STORAGE};
use super::clear::TargetNeeds;
use super::plan::PressPlan;

/// At most so many moves are thought of at once.
const MAX_MOVES: usize = 32;

/// One press or two that make room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearingMove {
    /// Throws away what is of no use in this hand.
    Throw { hand: usize },
    /// Picks up what is of no use.
    PickUp { from: usize, hand: usize },
    /// Brings the item of a task to a place or into a hand.
    Bring { task: usize, to: usize },
    /// Throws away an item that can be taken anew.
    Discard { task: usize },
    /// Takes an item, of this class, from a storage already, and brings it to a place on its way.
    Fetch { task: usize, class: u8, hand: usize, to: usize },
    /// No press: two tasks exchange their items.
    Exchange { tasks: [usize; 2] },
}

/// Moves, each once.
#[derive(Clone, Copy, Debug)]
pub struct ClearingMoves {
    all: [ClearingMove; MAX_MOVES],
    count: usize,
}

impl ClearingMoves {
    fn new() -> ClearingMoves {
        ClearingMoves { all: [ClearingMove::Throw { hand: 0 }; MAX_MOVES], count: 0 }
    }

    fn add(&mut self, other: ClearingMove) {
        if self.count < MAX_MOVES && !self.all().contains(&other) {
            self.all[self.count] = other;
            self.count += 1;
        }
    }

    pub fn all(&self) -> &[ClearingMove] {
        &self.all[..self.count]
    }
}

impl PressPlan<'_> {
    /// All moves that might make room for what the work on a target needs.
    pub(super) fn moves(&self, wants: &TargetNeeds) -> ClearingMoves {
        let mut moves = ClearingMoves::new();
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

    /// Makes a move.
    pub(super) fn make(&mut self, made: ClearingMove) {
        let ground = self.ground;
        self.presses += match made {
            ClearingMove::Throw { .. } | ClearingMove::PickUp { .. } | ClearingMove::Discard { .. } => 1,
            ClearingMove::Bring { task, to } => {
                // From one place to another it takes a hand.
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

    /// The item of a task lies at another place from now on, and is processed there; a press to get there is not counted.
    pub(super) fn relocate(&mut self, index: usize, place: usize) {
        let from = usize::from(self.choice.tasks[index].at);
        self.state[place] = std::mem::take(&mut self.state[from]);
        self.choice.tasks[index].at = place as u8;
        self.process(index, place);
    }

    /// Does to a part what can be done to it where it is.
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

    /// The ways to empty an agent's hand.
    fn empty(&self, wants: &TargetNeeds, agent: usize, moves: &mut ClearingMoves) {
        let hand = self.ground.hands[agent];
        let wanted = wants.hand(agent);
        let Some((task, of)) = self.task_at(hand) else {
            if wanted && self.state[hand] != 0 {
                moves.add(ClearingMove::Throw { hand });
            }
            return;
        };
        if let Some((detour, to)) = self.best_place(task, wants.needs, true)
            && (wanted || detour == 0)
        {
            moves.add(ClearingMove::Bring { task, to });
        }
        if of.bits.count_ones() == 1 && wanted {
            moves.add(ClearingMove::Discard { task });
        }
        if let Some(from) = self.blocked_by(task) {
            self.take_away(wants, from, moves);
        }
    }

    /// The ways to take away what lies at a place.
    fn take_away(&self, wants: &TargetNeeds, from: usize, moves: &mut ClearingMoves) {
        for hand in self.ground.hands.into_iter().filter(|&hand| self.state[hand] == 0) {
            let Some((task, _)) = self.task_at(from) else {
                moves.add(ClearingMove::PickUp { from, hand });
                continue;
            };
            moves.add(ClearingMove::Bring { task, to: hand });
            if let Some((_, to)) = self.best_place(task, wants.needs, true) {
                moves.add(ClearingMove::Bring { task, to });
            }
        }
    }

    /// The exchanges of two targets' items that take no more presses.
    fn exchange(&self, moves: &mut ClearingMoves) {
        let movable = |task: &AssemblyTask| task.bits.count_ones() == 1 && task.at != STORAGE && !self.is_ready(task);
        let way = |task: &AssemblyTask, at: u8| self.goal.way(&self.state, task, at).0;
        for (one, a) in self.tasks().filter(|(_, task)| movable(task)) {
            for (other, b) in self.tasks().filter(|(_, task)| movable(task) && task.target > a.target) {
                let fit = self.goal.fits(&self.state, &a, b.at) && self.goal.fits(&self.state, &b, a.at);
                if fit && way(&a, b.at) + way(&b, a.at) <= way(&a, a.at) + way(&b, b.at) {
                    moves.add(ClearingMove::Exchange { tasks: [one, other] });
                }
            }
        }
    }

    /// What could be taken from a storage and brought to a free place on its way, so that the hand that takes it is not
    /// needed later.
    fn fetch(&self, moves: &mut ClearingMoves) {
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
                            moves.add(ClearingMove::Fetch { task, class, hand, to });
                        }
                    }
                }
            }
        }
    }
}
