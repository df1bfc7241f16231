//! Worlds (complete hypotheses of kitchen state and recipes) and weighted sets of worlds.

use super::aspect::AspectId;
use super::compiled::Kitchen;
use super::state::{Recipes, State};

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
    pub fn copy_from(&mut self, other: &WeightedWorlds<u32>) {
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
