//! A belief about the kitchen: one categorical distribution per state aspect; the joint distribution is their product.

use rand::RngExt;

use super::RecordedBelief;
use super::filter::draws::value_at;
use crate::base::rng::{Stream, shuffle};
use crate::kitchen::{AspectId, AspectKind, Kitchen, OrderContent, State, WeightedWorld, WeightedWorlds, World};

/// Probability below which exact sums over a belief leave a value out.
const NEGLIGIBLE: f64 = 0.002;

/// A belief about the kitchen: a probability distribution for each state aspect. Every distribution sums to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    of: Vec<Vec<f64>>,
}

impl Belief {
    /// The belief that gives probability 1 to the true value of every state aspect.
    pub fn of_truth(kitchen: &Kitchen, state: State) -> Belief {
        let point = |aspect: AspectId| {
            let mut values = vec![0.0; kitchen.aspects[aspect.index()].values.len()];
            values[kitchen.true_value(state, aspect)] = 1.0;
            values
        };
        Belief { of: kitchen.aspect_ids().map(point).collect() }
    }

    /// The belief that a simulated participant recorded, for the kitchen in `state`: listed values keep their recorded
    /// probability, and the remaining probability is spread evenly over the other values. `None` if the record names
    /// aspects or values that the kitchen does not have, or if its probabilities do not form a distribution.
    pub fn of_witness(kitchen: &Kitchen, state: State, witness: &RecordedBelief) -> Option<Belief> {
        let mut belief = Belief { of: Vec::with_capacity(kitchen.aspects.len()) };
        for (index, aspect) in kitchen.aspects.iter().enumerate() {
            let told = witness.aspects.get(index).filter(|told| told.aspect == aspect.name)?;
            if !(0.0..=1.0).contains(&told.p_truth) {
                return None;
            }
            let mut values: Vec<Option<f64>> = vec![None; aspect.values.len()];
            values[kitchen.true_value(state, AspectId(index as u8))] = Some(told.p_truth);
            for (label, &p) in &told.values {
                let value = aspect.value_named(label)?;
                values[value] = Some(p);
            }
            belief.of.push(completed(&values)?);
        }
        Some(belief)
    }

    /// The belief's distribution over the values of a state aspect.
    pub fn distribution(&self, aspect: AspectId) -> &[f64] {
        &self.of[aspect.index()]
    }

    /// Replaces the distribution of a state aspect by these weights, normalised to sum 1.
    pub fn set(&mut self, aspect: AspectId, weights: &[f64]) {
        let total: f64 = weights.iter().sum();
        self.of[aspect.index()] = weights.iter().map(|weight| weight / total).collect();
    }

    /// The probability that this belief gives to the true value of an aspect.
    pub fn p_truth(&self, kitchen: &Kitchen, state: State, aspect: AspectId) -> f64 {
        self.distribution(aspect)[kitchen.true_value(state, aspect)]
    }

    /// Worlds that represent this belief: all possible worlds with their weights if there are at most `most`, else
    /// `most` draws by Latin hypercube sampling (McKay et al. 1979), in which each value of an aspect occurs in
    /// proportion to its probability.
    pub fn worlds(&self, kitchen: &Kitchen, most: usize, random: &mut Stream) -> WeightedWorlds {
        let all = self.all_worlds(kitchen, most).unwrap_or_else(|| self.drawn_worlds(kitchen, most, random));
        WeightedWorlds { all }
    }

    fn all_worlds(&self, kitchen: &Kitchen, most: usize) -> Option<Vec<WeightedWorld>> {
        let mut worlds = vec![WeightedWorld { world: World::empty(kitchen), weight: 1.0 }];
        for (index, values) in self.of.iter().enumerate() {
            let aspect = AspectId(index as u8);
            if !self.matters(kitchen, aspect) {
                continue;
            }
            let likely = || values.iter().enumerate().filter(|(_, p)| **p >= NEGLIGIBLE);
            if worlds.len() * likely().count() > most {
                return None;
            }
            let total: f64 = likely().map(|(_, p)| p).sum();
            let with = |one: &WeightedWorld, (value, p): (usize, &f64)| {
                let mut one = WeightedWorld { weight: one.weight * p / total, ..*one };
                one.world.set_value(kitchen, aspect, value);
                one
            };
            worlds = worlds.iter().flat_map(|one| likely().map(move |value| with(one, value))).collect();
        }
        Some(worlds)
    }

    fn drawn_worlds(&self, kitchen: &Kitchen, count: usize, random: &mut Stream) -> Vec<WeightedWorld> {
        let weight = 1.0 / count as f64;
        let mut worlds = vec![WeightedWorld { world: World::empty(kitchen), weight }; count];
        let mut strata: Vec<usize> = (0..count).collect();
        for (index, values) in self.of.iter().enumerate() {
            shuffle(&mut strata, random);
            for (one, &stratum) in worlds.iter_mut().zip(&strata) {
                let value = value_at(values, (stratum as f64 + random.random::<f64>()) * weight);
                one.world.set_value(kitchen, AspectId(index as u8), usize::from(value));
            }
        }
        worlds
    }

    /// Whether decisions of the human can depend on the state aspect. Decisions cannot depend on the recipe of a dish
    /// that no order is believed to want.
    fn matters(&self, kitchen: &Kitchen, aspect: AspectId) -> bool {
        let AspectKind::Recipe(dish) = kitchen.aspects[aspect.index()].kind else { return true };
        let code = OrderContent::Dish(dish).code();
        kitchen.orders.iter().any(|&order| {
            let aspect = AspectId::of_location(order);
            let value = kitchen.aspects[aspect.index()].index_of(code);
            value.is_some_and(|value| self.distribution(aspect)[value] >= NEGLIGIBLE)
        })
    }
}

/// Spreads the remaining probability over values without a listed one; `None` if the result is not a distribution.
fn completed(told: &[Option<f64>]) -> Option<Vec<f64>> {
    if told.iter().flatten().any(|p| !(0.0..=1.0).contains(p)) {
        return None;
    }
    let sum: f64 = told.iter().flatten().sum();
    let untold = told.iter().filter(|p| p.is_none()).count();
    let left = (1.0 - sum).max(0.0) / untold.max(1) as f64;
    let values: Vec<f64> = told.iter().map(|p| p.unwrap_or(left)).collect();
    let total: f64 = values.iter().sum();
    (total > 0.0).then(|| values.iter().map(|p| p / total).collect())
}
