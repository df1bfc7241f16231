//! State aspects: what the human may be wrong about. One per location (its content), one per dish (its recipe).

use super::Kitchen;
use super::content::ContentId;
use super::layout::LocationId;
use super::recipe::DishId;
use super::state::{Recipes, State};

/// An index into [`super::Kitchen::aspects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AspectId(pub u8);

impl AspectId {
    /// The aspect of a location's content: locations come first among the aspects.
    pub fn of_location(location: LocationId) -> AspectId {
        AspectId(location.0)
    }

    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// What an aspect is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectKind {
    /// What the location holds; values are the bytes of [`super::State::code`].
    Location(LocationId),
    /// Which full stack the dish is; values are contents, the true one first.
    Recipe(DishId),
}

/// One state aspect and its possible values.
#[derive(Clone, Debug, PartialEq)]
pub struct Aspect {
    /// The location's name, or "recipe of DISH".
    pub name: String,
    pub kind: AspectKind,
    /// The possible values, as codes (see [`AspectKind`]).
    pub values: Vec<u8>,
    /// What a screen writes for each value.
    pub labels: Vec<String>,
}

impl Aspect {
    /// The index of a value by its code.
    pub fn index_of(&self, code: u8) -> Option<usize> {
        self.values.iter().position(|&value| value == code)
    }
}

impl Kitchen {
    /// The index of the true value of an aspect; a place that shows what it cannot hold counts as its first value.
    pub fn true_value(&self, state: State, aspect: AspectId) -> usize {
        let aspect = &self.aspects[aspect.index()];
        match aspect.kind {
            AspectKind::Location(location) => aspect.index_of(state.code(location)).unwrap_or(0),
            AspectKind::Recipe(_) => 0,
        }
    }

    /// Gives an aspect one of its values, by index, in a state or in recipes.
    #[inline]
    pub fn set_value(&self, state: &mut State, recipes: &mut Recipes, aspect: AspectId, value: usize) {
        let aspect = &self.aspects[aspect.index()];
        match aspect.kind {
            AspectKind::Location(location) => state.set_code(location, aspect.values[value]),
            AspectKind::Recipe(dish) => recipes.set(dish, ContentId(aspect.values[value])),
        }
    }

    /// The aspect of a dish's recipe: recipes follow the locations.
    pub fn aspect_of_dish(&self, dish: DishId) -> AspectId {
        AspectId((self.locations.len() + dish.index()) as u8)
    }
}
