//! Belief related errors by the kind of aspect that the false belief is about, as in the paper: orders, recipes,
//! places.

use serde::{Deserialize, Serialize};

use super::attribution::{ErrorCause, FalseBeliefTarget};
use super::judged_press::JudgedPress;
use super::sequences::FalseBeliefEpisode;
use crate::kitchen::{AspectId, Kitchen};

/// Numbers of belief related errors by kind of aspect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BeliefErrorCounts {
    /// Number of errors from a false belief about an order.
    pub orders: u64,
    /// Number of errors from a false belief about a recipe.
    pub recipes: u64,
    /// Number of errors about an ordered dish where order and recipe were both believed wrong, or where it is unknown
    /// which of the two was.
    pub order_or_recipe: u64,
    /// Number of errors from a false belief about the content of any other location.
    pub places: u64,
}

impl BeliefErrorCounts {
    /// Counts the belief related errors among these presses. `episodes` tells whether the belief about an order or
    /// about its recipe was false at the time of an error.
    pub fn from_presses(
        kitchen: &Kitchen,
        presses: &[JudgedPress],
        episodes: &[FalseBeliefEpisode],
    ) -> BeliefErrorCounts {
        let mut counts = BeliefErrorCounts::default();
        for press in presses {
            let Some(ErrorCause::Belief { target, .. }) = press.cause else { continue };
            let is_false = |aspect: AspectId| {
                let is_open = |end| press.time <= end;
                episodes.iter().any(|episode| {
                    episode.aspect == aspect && episode.began <= press.time && episode.corrected.is_none_or(is_open)
                })
            };
            let count = match target {
                FalseBeliefTarget::Place(_) => &mut counts.places,
                FalseBeliefTarget::Recipe(_) => &mut counts.recipes,
                FalseBeliefTarget::Order(_, None) => &mut counts.orders,
                FalseBeliefTarget::Order(location, Some(dish)) => {
                    match (is_false(AspectId::of_location(location)), is_false(kitchen.aspect_of_dish(dish))) {
                        (true, false) => &mut counts.orders,
                        (false, true) => &mut counts.recipes,
                        _ => &mut counts.order_or_recipe,
                    }
                }
            };
            *count += 1;
        }
        counts
    }

    /// Adds two counts of belief related errors.
    pub fn plus(self, other: BeliefErrorCounts) -> BeliefErrorCounts {
        BeliefErrorCounts {
            orders: self.orders + other.orders,
            recipes: self.recipes + other.recipes,
            order_or_recipe: self.order_or_recipe + other.order_or_recipe,
            places: self.places + other.places,
        }
    }
}
