//! The moves that make room.

use super::plan::PressPlan;
use super::task::STORAGE;

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
    pub fn new() -> ClearingMoves {
        ClearingMoves { all: [ClearingMove::Throw { hand: 0 }; MAX_MOVES], count: 0 }
    }

    pub fn add(&mut self, other: ClearingMove) {
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
}
