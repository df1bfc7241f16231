//! False beliefs that a scripted wizard suspects.

use tomcom_core::kitchen::{ContentId, DishId, LocationId};

/// A false belief that the wizard suspects and wants to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SuspectedFalseBelief {
    /// A false belief about the content of a location.
    Place(LocationId),
    /// A false belief about a recipe: the order, its dish, and the stack that the participant takes for the recipe.
    Recipe(LocationId, DishId, ContentId),
    /// A wrong guess of the wizard: a location that did not cause the error, but could plausibly have caused it.
    Guess(LocationId),
}

impl SuspectedFalseBelief {
    /// The location that a signal would be about if it corrected the false belief.
    pub fn location(self) -> LocationId {
        match self {
            SuspectedFalseBelief::Place(location)
            | SuspectedFalseBelief::Recipe(location, ..)
            | SuspectedFalseBelief::Guess(location) => location,
        }
    }
}
