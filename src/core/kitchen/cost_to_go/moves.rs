//! Moves of a cost-to-go plan that free a hand or a place of the kitchen.

use super::partial_plan::PressPlan;
use super::task::STORAGE;

/// Largest number of alternative moves in a set.
const MAX_MOVES: usize = 32;

/// A move of one or two presses in a cost-to-go plan that frees a hand or a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearingMove {
    /// The move throws away a useless content of a hand.
    Throw {
        /// The location index of the hand.
        hand: usize,
    },
    /// The move picks up a useless content from its place.
    PickUp {
        /// The location index of the content.
        from: usize,
        /// The location index of the hand that picks the content up.
        hand: usize,
    },
    /// The move brings the item of a task to a place or into a hand.
    Bring {
        /// The index of the task whose item is brought.
        task: usize,
        /// The location index to which the item is brought.
        to: usize,
    },
    /// The move throws away the item of a task, which can be taken anew from a storage.
    Discard {
        /// The index of the task whose item is thrown away.
        task: usize,
    },
    /// The move takes an item of this class from a storage early and brings it to a place on its way to the board.
    Fetch {
        /// The index of the task for which the item is taken.
        task: usize,
        /// The equivalence class of the item that is taken.
        class: u8,
        /// The location index of the hand that takes the item.
        hand: usize,
        /// The location index to which the item is brought.
        to: usize,
    },
    /// Two tasks exchange their items in the assignment, without a press.
    Exchange {
        /// The indices of the two tasks that exchange their items.
        tasks: [usize; 2],
    },
}

/// A set of distinct moves that free a hand or a place.
#[derive(Clone, Copy, Debug)]
pub struct ClearingMoves {
    all: [ClearingMove; MAX_MOVES],
    count: usize,
}

impl ClearingMoves {
    /// An empty set of moves.
    pub fn new() -> ClearingMoves {
        ClearingMoves { all: [ClearingMove::Throw { hand: 0 }; MAX_MOVES], count: 0 }
    }

    /// Adds a move, unless the set contains it already or is full.
    pub fn add(&mut self, other: ClearingMove) {
        if self.count < MAX_MOVES && !self.all().contains(&other) {
            self.all[self.count] = other;
            self.count += 1;
        }
    }

    /// The moves, in the order in which they were added.
    pub fn all(&self) -> &[ClearingMove] {
        &self.all[..self.count]
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
