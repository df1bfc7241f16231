//! Contents of a location: nothing, an item (an ingredient in a state), or a stack of items.

use super::look::Appearance;

/// Identifies a content: an index into [`super::Kitchen::contents`]; 0 is "empty".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentId(pub u8);

impl ContentId {
    /// The empty content: the location holds nothing.
    pub const EMPTY: ContentId = ContentId(0);

    /// The content's place in [`Kitchen::contents`](super::Kitchen::contents).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Whether this is the empty content (nothing).
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Something that a location can hold: nothing, an item, or a stack of items.
#[derive(Clone, Debug, PartialEq)]
pub struct Content {
    /// The content's name in logs and tables: "rice cooked", "nori + rice cooked", "empty"; a stack that is a dish of
    /// the menu has the dish's name.
    pub name: String,
    /// Words of screens and reports for the content: "cooked rice", "nori + cooked rice".
    pub wording: String,
    /// The items in the content, in the order of the recipe file; one for a single item, none for "empty".
    pub items: Vec<ContentId>,
    /// Whether the content is a stack that is a dish of the menu, and has the dish's name.
    pub is_dish: bool,
    /// The ingredient of a single item, as an index into the recipe file's list; `None` for a stack.
    pub ingredient: Option<usize>,
    /// The contents that look similar: the same content with one ingredient replaced by a look-alike.
    pub look_alikes: Vec<ContentId>,
    /// How the participant's display draws a single item, if the recipe file says so.
    pub look: Option<Appearance>,
}

impl Content {
    /// Whether the content is a stack: several items that are carried as one.
    pub fn is_stack(&self) -> bool {
        self.items.len() > 1
    }
}
