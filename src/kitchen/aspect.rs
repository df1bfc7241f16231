//! State aspects, about which the human can hold false beliefs: one per location (its content), one per dish (its recipe).

use super::dish::DishId;
use super::location::LocationId;

/// An index into [`super::Kitchen::aspects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AspectId(pub u8);

impl AspectId {
    /// The aspect of a location's content: locations come first among the aspects.
    pub fn of_location(location: LocationId) -> AspectId {
        AspectId(location.0)
    }

    /// The aspect's place in [`Kitchen::aspects`](super::Kitchen::aspects).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Kind of a state aspect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AspectKind {
    /// The content of a location; values are the bytes of [`super::State::code`].
    Location(LocationId),
    /// The recipe of a dish; values are full stacks, the true one first.
    Recipe(DishId),
}

/// One state aspect and its possible values.
#[derive(Clone, Debug, PartialEq)]
pub struct Aspect {
    /// The location's name, or "recipe of DISH".
    pub name: String,
    /// The location or the dish that it is about.
    pub kind: AspectKind,
    /// The possible values, as codes (see [`AspectKind`]).
    pub values: Vec<u8>,
    /// The name of each value in logs and tables: "rice cooked".
    pub labels: Vec<String>,
    /// How screens and reports word each value: "cooked rice".
    pub wordings: Vec<String>,
}

impl Aspect {
    /// The index of a value by its code.
    pub fn index_of(&self, code: u8) -> Option<usize> {
        self.values.iter().position(|&value| value == code)
    }
}
