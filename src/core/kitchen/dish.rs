//! The dishes of the menu.

use serde::{Deserialize, Serialize};

use super::content::ContentId;
use super::look::Appearance;

/// Identifies a dish: an index into [`super::Kitchen::dishes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DishId(pub u8);

impl DishId {
    /// The dish's place in [`Kitchen::dishes`](super::Kitchen::dishes).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A dish of the menu.
#[derive(Clone, Debug, PartialEq)]
pub struct Dish {
    /// The dish's name from the recipe file, which orders and screens show.
    pub name: String,
    /// Variants of the dish's recipe that people may believe in: stacks of items, the true recipe first.
    pub variants: Vec<ContentId>,
    /// How the participant's display draws the finished dish, if the recipe file says so.
    pub look: Option<Appearance>,
}

impl Dish {
    /// The true recipe of the dish, as a stack of items.
    pub fn stack(&self) -> ContentId {
        self.variants[0]
    }
}
