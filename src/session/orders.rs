//! The orders of a trial: a seeded list, drawn and never typed in.

use rand::RngExt;

use super::settings::SessionSpec;
use crate::base::rng::{Stream, stream};
use crate::kitchen::DishId;

/// After at most so many orders, matched lists hold the same dishes.
const RUN: usize = 3;

/// The dishes that a trial's orders want, one after another, whichever order location is free.
#[derive(Clone, Debug)]
pub struct OrderList {
    random: Stream,
    menu: usize,
    matched: Option<Matched>,
}

/// Blocks in which every dish of the menu comes once, in an order that all trials of a participant share. Every block is
/// cut into short runs, and each trial has its own order within a run: as far as two trials of a participant have come, they
/// asked for the same dishes as often, up to the run in which each ended.
#[derive(Clone, Debug)]
struct Matched {
    shared: Stream,
    /// What is left of the block, from the back.
    block: Vec<u8>,
    /// What is left of the run, from the back.
    run: Vec<u8>,
}

impl OrderList {
    /// The list of a trial: of a plan matched with the participant's other trials, else every dish as likely every time.
    /// `menu` is the number of dishes.
    pub fn new(menu: usize, spec: &SessionSpec, trial: u64) -> OrderList {
        let seed = spec.seed;
        let matched = spec.step.as_ref().map(|step| {
            let name = if step.period.is_some() { "orders of a participant" } else { "orders of a familiarisation" };
            let shared = stream(seed, name, u64::from(step.participant));
            Matched { shared, block: Vec::new(), run: Vec::new() }
        });
        OrderList { random: stream(seed, "orders", trial), menu, matched }
    }

    /// The next dish.
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

/// Fisher and Yates: every order as likely.
fn shuffle(dishes: &mut [u8], random: &mut Stream) {
    for last in (1..dishes.len()).rev() {
        dishes.swap(last, random.random_range(0..=last));
    }
}
