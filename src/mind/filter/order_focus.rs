//! Which orders the human considers: all of them, or only the one on which the human works.
//!
//! A human who works on one order presses what serves that order, whatever is believed about the others. So a press is
//! evidence of beliefs about the considered orders only. The focus is a discrete variable with a posterior distribution,
//! updated by every press: each belief sample has one of its values, by systematic sampling.

use super::urn::value_at;
use crate::kitchen::{Kitchen, LocationId, OrderContent, State, World};

/// Share of the probabilities that returns to those before the first press, at every press of the human: the human may
/// turn to another order.
pub const RETURNING: f64 = 0.1;

/// Posterior probabilities of which orders the human considers. Focus 0 is on all orders, focus k on order k alone.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderFocus {
    prior: Vec<f64>,
    probabilities: Vec<f64>,
}

impl OrderFocus {
    /// The distribution before the first press, for people of whom the share `one_order` considers one order only.
    pub fn new(kitchen: &Kitchen, one_order: f64) -> OrderFocus {
        let prior = match kitchen.orders.len() {
            orders @ 2.. if one_order > 0.0 => {
                let each = std::iter::repeat_n(one_order / orders as f64, orders);
                std::iter::once(1.0 - one_order).chain(each).collect()
            }
            _ => vec![1.0],
        };
        OrderFocus { probabilities: prior.clone(), prior }
    }

    /// Number of values of the focus: all orders, and each alone.
    pub fn count(&self) -> usize {
        self.prior.len()
    }

    /// The probability of each focus.
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The focus of a belief sample, by its index in a batch: shares of the batch are as the probabilities.
    pub fn of_sample(&self, index: usize, batch: usize) -> u8 {
        value_at(&self.probabilities, (index as f64 + 0.5) / batch as f64)
    }

    /// The focus that a human chooses who has none yet; the random number `draw` is uniform in [0, 1).
    pub fn chosen_anew(&self, draw: f64) -> u8 {
        value_at(&self.prior, draw)
    }

    /// Takes over the probabilities given a press, of which a share returns to those before the first press.
    pub fn learn(&mut self, given_press: &[f64]) {
        for ((p, given), prior) in self.probabilities.iter_mut().zip(given_press).zip(&self.prior) {
            *p = (1.0 - RETURNING) * given + RETURNING * prior;
        }
    }

    /// Releases the focus on orders that differ between two states: who considered such an order alone chooses anew.
    pub fn release(&mut self, kitchen: &Kitchen, before: State, after: State) {
        for focus in 1..self.count() {
            if !is_on_changed(kitchen, focus as u8, before, after) {
                continue;
            }
            let released = std::mem::take(&mut self.probabilities[focus]);
            self.probabilities.iter_mut().zip(&self.prior).for_each(|(p, prior)| *p += released * prior);
        }
    }
}

/// The order of a focus on one order.
fn only_order(kitchen: &Kitchen, focus: u8) -> Option<LocationId> {
    usize::from(focus).checked_sub(1).and_then(|index| kitchen.orders.get(index)).copied()
}

/// Whether a focus is on one order, and this order differs between two states.
pub fn is_on_changed(kitchen: &Kitchen, focus: u8, before: State, after: State) -> bool {
    only_order(kitchen, focus).is_some_and(|order| before.code(order) != after.code(order))
}

/// What a human with this focus considers of a believed world: no other orders than the one of the focus, and no recipes
/// of their dishes. Who believes that nothing is ordered there considers everything.
pub fn considered(kitchen: &Kitchen, mut world: World, focus: u8) -> World {
    let Some(only) = only_order(kitchen, focus) else { return world };
    let OrderContent::Dish(wanted) = world.state.order(only) else { return world };
    for &order in kitchen.orders.iter().filter(|&&order| order != only) {
        if let OrderContent::Dish(dish) = world.state.order(order)
            && dish != wanted
        {
            world.recipes.set(dish, kitchen.dish(dish).variants[0]);
        }
        world.state.set_order(order, OrderContent::None);
    }
    world
}

#[cfg(test)]
mod tests {
    use super::*;

    fn focus(probabilities: [f64; 3]) -> OrderFocus {
        OrderFocus { prior: vec![0.2, 0.4, 0.4], probabilities: probabilities.to_vec() }
    }

    #[test]
    fn belief_samples_have_every_focus_as_often_as_it_is_probable() {
        let focus = focus([0.25, 0.5, 0.25]);
        let of: Vec<u8> = (0..8).map(|index| focus.of_sample(index, 8)).collect();
        assert_eq!(of, [0, 0, 1, 1, 1, 1, 2, 2]);
    }

    #[test]
    fn no_focus_becomes_impossible() {
        let mut focus = focus([0.2, 0.4, 0.4]);
        (0..50).for_each(|_| focus.learn(&[0.0, 1.0, 0.0]));
        assert!((focus.probabilities()[1] - 0.94).abs() < 1e-9, "{focus:?}");
        assert!((focus.probabilities().iter().sum::<f64>() - 1.0).abs() < 1e-9);
        focus.learn(&[0.0, 0.0, 1.0]);
        assert!(focus.probabilities()[2] > 0.9, "{focus:?}");
    }
}
