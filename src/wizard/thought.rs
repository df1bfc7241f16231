//! What a scripted wizard takes for believed wrong.

use crate::kitchen::{ContentId, DishId, LocationId};

/// What the wizard takes for believed wrong, and wants to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thought {
    /// What is at a place.
    Place(LocationId),
    /// The recipe of the dish that an order wants, which is held for this one.
    Recipe(LocationId, DishId, ContentId),
    /// Something about this place, which is not the cause but might have been.
    Guess(LocationId),
}

impl Thought {
    /// The place that the signal is about.
    pub fn location(self) -> LocationId {
        match self {
            Thought::Place(location) | Thought::Recipe(location, ..) | Thought::Guess(location) => location,
        }
    }
}
