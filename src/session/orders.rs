//! The orders of a trial: a seeded list, drawn and never typed in.

use rand::RngExt;

use crate::base::rng::{Stream, stream};
use crate::kitchen::DishId;

/// The dishes that a trial's orders want, one after another, whichever order location is free.
#[derive(Clone, Debug)]
pub struct OrderList {
    random: Stream,
    menu: usize,
}

impl OrderList {
    /// The list of a trial; `menu` is the number of dishes.
    pub fn new(menu: usize, seed: u64, trial: u64) -> OrderList {
        OrderList { random: stream(seed, "orders", trial), menu }
    }

    /// The next dish.
    pub fn draw(&mut self) -> DishId {
        DishId(self.random.random_range(0..self.menu) as u8)
    }
}
