//! Worlds (complete hypotheses of state and recipes) and weighted sets of them.

use super::aspect::AspectId;
use super::compiled::Kitchen;
use super::state::{Recipes, State};

/// One complete hypothesis of kitchen state and recipes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct World {
    /// The content of every location.
    pub state: State,
    /// What is taken for the recipe of every dish.
    pub recipes: Recipes,
}

/// A world with its weight: a probability (`f64`) or a number of draws (`u32`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightedWorld<W = f64> {
    /// The world.
    pub world: World,
    /// Its probability, or its number of draws.
    pub weight: W,
}

/// A set of weighted worlds, which approximates a belief. Probabilities sum to 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WeightedWorlds<W = f64> {
    /// The worlds with their weights, each world once.
    pub all: Vec<WeightedWorld<W>>,
}

impl World {
    /// This state with the true recipes.
    pub fn with_true_recipes(kitchen: &Kitchen, state: State) -> World {
        World { state, recipes: kitchen.true_recipes() }
    }

    /// The empty kitchen with the true recipes, in which the values of a hypothesis are then set.
    pub fn empty(kitchen: &Kitchen) -> World {
        World::with_true_recipes(kitchen, kitchen.empty_state())
    }

    /// Sets an aspect to the value with this index.
    #[inline]
    pub fn set_value(&mut self, kitchen: &Kitchen, aspect: AspectId, value: usize) {
        kitchen.set_value(&mut self.state, &mut self.recipes, aspect, value);
    }
}

impl WeightedWorlds {
    /// A belief that is certain of one world.
    pub fn certain(world: World) -> WeightedWorlds {
        WeightedWorlds { all: vec![WeightedWorld { world, weight: 1.0 }] }
    }
}

impl WeightedWorlds<u32> {
    /// Copies another set, reusing this set's memory.
    pub fn copy_from(&mut self, other: &WeightedWorlds<u32>) {
        self.all.clear();
        self.all.extend_from_slice(&other.all);
    }

    /// Adds a world with its number of draws.
    pub fn add(&mut self, world: World, draws: u32) {
        match self.all.iter_mut().find(|one| one.world == world) {
            Some(one) => one.weight += draws,
            None => self.all.push(WeightedWorld { world, weight: draws }),
        }
    }

    /// Total number of draws.
    pub fn draws(&self) -> u32 {
        self.all.iter().map(|one| one.weight).sum()
    }

    /// Merges equal worlds; the first of them keeps its place.
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
