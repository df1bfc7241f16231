//! The state of the task, and believed recipes, in compact form, because they are copied and hashed millions of times.

use super::content::ContentId;
use super::dish::DishId;
use super::location::LocationId;

/// Largest number of locations in a kitchen.
pub const MAX_LOCATIONS: usize = 16;
/// Largest number of dishes on a menu.
pub const MAX_DISHES: usize = 16;

/// Content of every location, one byte each: a [`ContentId`], or an [`OrderContent`] at an order location.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(align(16))]
pub struct State([u8; MAX_LOCATIONS]);

/// Content of an order location: no order, an ordered dish, or that the order was served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OrderContent {
    /// The location shows no order.
    None,
    /// The order was served a moment ago.
    Served,
    /// The location shows an order for a dish: the finished dish, not its recipe.
    Dish(DishId),
}

impl OrderContent {
    /// The byte that stands for this order content in a [`State`].
    pub const fn code(self) -> u8 {
        match self {
            OrderContent::None => 0,
            OrderContent::Served => 1,
            OrderContent::Dish(dish) => dish.0 + 2,
        }
    }

    /// Reads the content of an order location from its byte, the inverse of [`OrderContent::code`].
    pub const fn from_code(code: u8) -> Self {
        match code {
            0 => OrderContent::None,
            1 => OrderContent::Served,
            dish => OrderContent::Dish(DishId(dish - 2)),
        }
    }
}

impl State {
    /// Content of a location that is not an order location.
    #[inline]
    pub fn content(self, location: LocationId) -> ContentId {
        ContentId(self.0[location.index() & (MAX_LOCATIONS - 1)])
    }

    /// Sets the content of a location that is not an order location.
    #[inline]
    pub fn set_content(&mut self, location: LocationId, content: ContentId) {
        self.0[location.index() & (MAX_LOCATIONS - 1)] = content.0;
    }

    /// What an order location shows in this state.
    #[inline]
    pub fn order(self, location: LocationId) -> OrderContent {
        OrderContent::from_code(self.code(location))
    }

    /// Sets what an order location shows.
    #[inline]
    pub fn set_order(&mut self, location: LocationId, content: OrderContent) {
        self.set_code(location, content.code());
    }

    /// The byte of a location in the state, whatever its kind: the value of its state aspect.
    #[inline]
    pub fn code(self, location: LocationId) -> u8 {
        self.0[location.index() & (MAX_LOCATIONS - 1)]
    }

    /// Sets the byte of a location: [`OrderContent::code`] for orders, a [`ContentId`] for other locations.
    #[inline]
    pub fn set_code(&mut self, location: LocationId, code: u8) {
        self.0[location.index() & (MAX_LOCATIONS - 1)] = code;
    }

    /// The contents of all locations as one number, used for hashing.
    #[inline]
    pub fn bits(self) -> u128 {
        u128::from_le_bytes(self.0)
    }
}

/// For every dish, the stack of items that somebody believes to be its recipe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(align(16))]
pub struct Recipes([u8; MAX_DISHES]);

impl Recipes {
    /// The stack of items that is believed to be this dish's recipe.
    #[inline]
    pub fn get(&self, dish: DishId) -> ContentId {
        ContentId(self.0[dish.index() & (MAX_DISHES - 1)])
    }

    /// All recipes as one number, used for hashing.
    #[inline]
    pub fn bits(self) -> u128 {
        u128::from_le_bytes(self.0)
    }

    /// Sets the stack of items that is believed to be this dish's recipe.
    #[inline]
    pub fn set(&mut self, dish: DishId, stack: ContentId) {
        self.0[dish.index() & (MAX_DISHES - 1)] = stack.0;
    }
}
