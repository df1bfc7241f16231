//! The sequence of ordered dishes in a trial, drawn from a seeded random stream.

use rand::RngExt;

use crate::SessionSpec;
use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_core::kitchen::DishId;

/// After each run of this many orders, all matched lists contain the same dishes.
const RUN: usize = 3;

#[derive(Clone, Debug)]
pub struct OrderList {
    random: Stream,
    menu: usize,
    matched: Option<Matched>,
}

/// Blocks contain every dish of the menu once, in an order that all trials of a participant share. Each block is
/// divided into short runs, within which each trial has its own order. So two trials of a participant have the same
/// dishes up to the last complete run.
#[derive(Clone, Debug)]
struct Matched {
    shared: Stream,
    /// Dishes of the present block still to be ordered, in reverse order.
    block: Vec<u8>,
    /// Likewise, of the present run.
    run: Vec<u8>,
}

impl OrderList {
    /// In a plan, matched with the participant's other trials; else independent uniform draws. `menu`: number of
    /// dishes.
    pub fn new(menu: usize, spec: &SessionSpec, trial: u64) -> OrderList {
        let seed = spec.seed;
        let matched = spec.step.as_ref().map(|step| {
            let name = if step.period.is_some() { "orders of a participant" } else { "orders of a familiarisation" };
            let shared = stream(seed, name, u64::from(step.participant));
            Matched { shared, block: Vec::new(), run: Vec::new() }
        });
        OrderList { random: stream(seed, "orders", trial), menu, matched }
    }

    pub fn draw(&mut self) -> DishId {
        match &mut self.matched {
            None => DishId(self.random.random_range(0..self.menu) as u8),
            Some(matched) => DishId(matched.draw(self.menu, &mut self.random)),
        }
    }
}

impl Matched {
    fn draw(&mut self, menu: usize, own: &mut Stream) -> u8 {
        if self.run.is_empty() {
            if self.block.is_empty() {
                self.block = (0..menu as u8).collect();
                shuffle(&mut self.block, &mut self.shared);
            }
            self.run = self.block.split_off(self.block.len().saturating_sub(RUN));
            shuffle(&mut self.run, own);
        }
        self.run.pop().unwrap_or(0)
    }
}
