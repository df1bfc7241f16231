//! Contents of a location: empty, an ingredient item, or a stack of items.

use super::look::Appearance;

/// An index into [`super::Kitchen::contents`]; 0 is "empty".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentId(pub u8);

impl ContentId {
    /// Nothing: the location is empty.
    pub const EMPTY: ContentId = ContentId(0);

    /// The content's place in [`Kitchen::contents`](super::Kitchen::contents).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Whether this is the empty content.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// One content of the kitchen.
#[derive(Clone, Debug, PartialEq)]
pub struct Content {
    /// The name in logs and tables: "rice cooked", "nori + rice cooked", "empty"; a full stack on the menu has its dish's name.
    pub name: String,
    /// How screens and reports word it: "cooked rice", "nori + cooked rice".
    pub wording: String,
    /// The ingredient items in it, in the order of the recipe file; one for an item, none for empty.
    pub items: Vec<ContentId>,
    /// The ingredient it is made of, as index into the recipe file's list, if it is an item.
    pub ingredient: Option<usize>,
    /// The contents that look like it: the same with one ingredient exchanged for a look-alike.
    pub look_alikes: Vec<ContentId>,
    /// How the display draws it, if it is an item and its file says so.
    pub look: Option<Appearance>,
}

impl Content {
    /// Whether it is a stack: several items that are carried as one.
    pub fn is_stack(&self) -> bool {
        self.items.len() > 1
    }
}
