//! The state of the task, and believed recipes, in compact form, because they are copied and hashed millions of times;
//! worlds of both; and what changes the state.

use super::compiled::Kitchen;
use super::parts::{Agent, AspectId, ButtonId, ContentId, DishId, LocationId};
use crate::base::rng::mix;

/// Largest number of locations in a kitchen.
pub const MAX_LOCATIONS: usize = 16;
pub(crate) const MAX_DISHES: usize = 16;

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

/// One complete hypothesis of kitchen state and recipes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct World {
    /// The content of every location in the hypothesis.
    pub state: State,
    /// For every dish, the stack of items that is believed to be its recipe.
    pub recipes: Recipes,
}

/// A world with its weight: a probability (`f64`) or a number of draws (`u32`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightedWorld<W = f64> {
    /// The world: one hypothesis of state and recipes.
    pub world: World,
    /// The world's probability, or its number of draws.
    pub weight: W,
}

/// A set of weighted worlds, which approximates a belief (a weighted particle set). Probabilities sum to 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WeightedWorlds<W = f64> {
    /// The worlds with their weights; each world occurs once.
    pub all: Vec<WeightedWorld<W>>,
}

impl World {
    /// The world with this state and the true recipes.
    pub fn with_true_recipes(kitchen: &Kitchen, state: State) -> World {
        World { state, recipes: kitchen.true_recipes() }
    }

    /// The world with an empty kitchen and the true recipes, from which a hypothesis is built.
    pub fn empty(kitchen: &Kitchen) -> World {
        World::with_true_recipes(kitchen, kitchen.empty_state())
    }

    /// The world in 64 bits, for hash tables.
    #[inline]
    pub(crate) fn folded(&self) -> u64 {
        let fold = |bits: u128| mix(bits as u64 ^ mix((bits >> 64) as u64));
        fold(self.state.bits()) ^ fold(self.recipes.bits())
    }

    /// Sets a state aspect of the world to the value with this index.
    #[inline]
    pub fn set_value(&mut self, kitchen: &Kitchen, aspect: AspectId, value: usize) {
        kitchen.set_value(&mut self.state, &mut self.recipes, aspect, value);
    }
}

impl WeightedWorlds {
    /// The set with a single world, which is a belief without uncertainty.
    pub fn certain(world: World) -> WeightedWorlds {
        WeightedWorlds { all: vec![WeightedWorld { world, weight: 1.0 }] }
    }
}

impl WeightedWorlds<u32> {
    /// Copies another set of weighted worlds into this one, reusing this set's memory.
    pub(crate) fn copy_from(&mut self, other: &WeightedWorlds<u32>) {
        self.all.clear();
        self.all.extend_from_slice(&other.all);
    }

    /// Adds a world with its number of draws to the set.
    pub fn add(&mut self, world: World, draws: u32) {
        match self.all.iter_mut().find(|one| one.world == world) {
            Some(one) => one.weight += draws,
            None => self.all.push(WeightedWorld { world, weight: draws }),
        }
    }

    /// Total number of draws of all worlds in the set.
    pub fn draws(&self) -> u32 {
        self.all.iter().map(|one| one.weight).sum()
    }

    /// Merges equal worlds of the set; the first of them keeps its place.
    pub fn merge(&mut self) {
        let mut kept = 0;
        for index in 0..self.all.len() {
            let WeightedWorld { world, weight } = self.all[index];
            match self.all[..kept].iter_mut().find(|one| one.world == world) {
                Some(one) => one.weight += weight,
                None => {
                    self.all[kept] = WeightedWorld { world, weight };
                    kept += 1;
                }
            }
        }
        self.all.truncate(kept);
    }
}

/// A press of a button by either agent, with the state before and after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// The agent that pressed.
    pub agent: Agent,
    /// The pressed button, as an index into that agent's buttons.
    pub button: ButtonId,
    /// The state of the kitchen before the press.
    pub before: State,
    /// The state of the kitchen after the press; the same as before if the press had no effect.
    pub after: State,
    /// Whether the button's action was available in the state before, so that the press had an effect.
    pub effective: bool,
}

/// What an event of the session changed in the kitchen's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenChange {
    /// The event does not change the kitchen.
    None,
    /// The trial started with an empty kitchen.
    TrialStarted {
        /// The state of the kitchen before the trial started.
        before: State,
        /// The state of the empty kitchen.
        after: State,
    },
    /// An agent pressed a button during the trial.
    Press {
        /// The press with the states before and after it.
        press: Press,
        /// How many presses each agent has made, this press included, indexed by [`Agent::index`].
        presses: [u32; 2],
    },
    /// An agent pressed a button while no trial ran; such a press has no effect and does not count.
    UncountedPress {
        /// The agent that pressed.
        agent: Agent,
        /// The pressed button, as an index into that agent's buttons.
        button: ButtonId,
    },
    /// An order appeared, or an order that had been served disappeared.
    Order {
        /// The location of the order.
        order: LocationId,
        /// The state of the kitchen before the order changed.
        before: State,
        /// The state of the kitchen after the order changed.
        after: State,
    },
    /// The wizard corrected the content of a location in the program's state, which differed from the real one.
    Correction {
        /// The location that was corrected.
        location: LocationId,
        /// The state of the kitchen before the wizard's correction.
        before: State,
        /// The state of the kitchen after the wizard's correction.
        after: State,
    },
}

impl Kitchen {
    /// The press of this button by this agent in `state`, with its effect under the true recipes.
    pub fn try_press(&self, state: State, agent: Agent, button: ButtonId) -> Press {
        let after = self.press(state, &self.true_recipes(), agent, button);
        Press { agent, button, before: state, after: after.unwrap_or(state), effective: after.is_some() }
    }
}

impl Press {
    /// The state of the kitchen after the press; `None` if the press had no effect.
    pub fn result(&self) -> Option<State> {
        self.effective.then_some(self.after)
    }
}

impl KitchenChange {
    /// The press of either agent that made the change; `None` if the event is no press that counts.
    pub fn press(&self) -> Option<Press> {
        match self {
            KitchenChange::Press { press, .. } => Some(*press),
            _ => None,
        }
    }

    /// The press of the human that made the change; `None` if the event is no press of the human that counts.
    pub fn human_press(&self) -> Option<Press> {
        self.press().filter(|press| press.agent == Agent::Human)
    }

    /// The state of the kitchen before and after the event; `None` if the event did not change it.
    pub fn states(&self) -> Option<(State, State)> {
        let (before, after) = match self {
            KitchenChange::None | KitchenChange::UncountedPress { .. } => return None,
            KitchenChange::Press { press, .. } => (press.before, press.after),
            KitchenChange::TrialStarted { before, after }
            | KitchenChange::Order { before, after, .. }
            | KitchenChange::Correction { before, after, .. } => (*before, *after),
        };
        (before != after).then_some((before, after))
    }
}
