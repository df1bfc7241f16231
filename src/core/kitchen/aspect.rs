//! State aspects, about which the human can hold false beliefs: one aspect per location (its content), and one per dish
//! (its recipe).

use super::dish::DishId;
use super::location::LocationId;

/// Identifies a state aspect: an index into [`super::Kitchen::aspects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AspectId(pub u8);

impl AspectId {
    /// The state aspect that is the content of this location; locations come first in the list of aspects.
    pub fn of_location(location: LocationId) -> AspectId {
        AspectId(location.0)
    }

    /// The aspect's place in [`Kitchen::aspects`](super::Kitchen::aspects).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// What a state aspect is about: a location's content or a dish's recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectKind {
    /// The content of a location; possible values of this aspect are the bytes of [`super::State::code`].
    Location(LocationId),
    /// The recipe of a dish; possible values of this aspect are stacks of ingredients, the true recipe first.
    Recipe(DishId),
}

/// One state aspect and its possible values.
#[derive(Clone, Debug, PartialEq)]
pub struct StateAspect {
    /// Name of the state aspect: the name of its location, or "recipe of DISH".
    pub name: String,
    /// The location or the dish that the state aspect is about.
    pub kind: AspectKind,
    /// The possible values of the state aspect, as byte codes (see [`AspectKind`]).
    pub values: Vec<u8>,
    /// The name of each possible value in logs and tables: "rice cooked".
    pub labels: Vec<String>,
    /// Words of screens and reports for each possible value: "cooked rice".
    pub wordings: Vec<String>,
}

impl StateAspect {
    /// The index of a possible value of the aspect, from the value's code.
    pub fn index_of(&self, code: u8) -> Option<usize> {
        self.values.iter().position(|&value| value == code)
    }
}
