//! Beliefs of the simulated participant: one categorical distribution per state aspect, with operations on them.

use tomcom_core::kitchen::{AspectId, AspectKind, ContentId, DishId, Kitchen, LocationId, OrderContent, State, World};

/// Beliefs of a simulated participant: one distribution per state aspect. Every distribution sums to 1, and every value
/// of an aspect has a positive probability.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticipantBeliefs {
    of: Vec<Vec<f64>>,
}

/// Probability that is spread evenly over all values of an aspect, so that no value becomes impossible.
const RESIDUE: f64 = 1e-6;

impl ParticipantBeliefs {
    /// Beliefs with probability `sure` on each aspect's value in `state` and on the true recipes; the participant's
    /// memory changes the beliefs about recipes afterwards.
    pub fn of_state(kitchen: &Kitchen, state: State, sure: f64) -> ParticipantBeliefs {
        let mut beliefs = ParticipantBeliefs { of: kitchen.aspects.iter().map(|a| uniform(a.values.len())).collect() };
        for index in 0..kitchen.aspects.len() {
            let aspect = AspectId(index as u8);
            beliefs.settle(aspect, kitchen.true_value(state, aspect), sure);
        }
        beliefs
    }

    /// The participant's probability distribution over the values of a state aspect.
    pub fn distribution(&self, aspect: AspectId) -> &[f64] {
        &self.of[aspect.index()]
    }

    /// Index of the most probable value of a state aspect; ties go to the first value.
    pub fn most_likely(&self, aspect: AspectId) -> usize {
        let values = self.distribution(aspect);
        (1..values.len()).fold(0, |best, index| if values[index] > values[best] { index } else { best })
    }

    /// Probability of the most probable value of an aspect.
    pub fn certainty(&self, aspect: AspectId) -> f64 {
        self.distribution(aspect)[self.most_likely(aspect)]
    }

    /// Sets the probability of one value of an aspect to `sure`; the other values share the rest in their present
    /// proportions.
    pub fn settle(&mut self, aspect: AspectId, value: usize, sure: f64) {
        let values = &mut self.of[aspect.index()];
        let others = 1.0 - values[value];
        let left = 1.0 - sure;
        for (index, p) in values.iter_mut().enumerate() {
            *p = match index == value {
                true => sure,
                false if others > 0.0 => *p / others * left,
                false => 0.0,
            };
        }
        normalise(values);
    }

    /// Moves the distribution of an aspect by the share `weight` towards another distribution, which `towards` gives as
    /// unnormalised weights.
    pub fn mix(&mut self, aspect: AspectId, towards: &[f64], weight: f64) {
        let total: f64 = towards.iter().sum();
        if total <= 0.0 {
            return;
        }
        let values = &mut self.of[aspect.index()];
        for (p, other) in values.iter_mut().zip(towards) {
            *p = *p * (1.0 - weight) + weight * other / total;
        }
        normalise(values);
    }

    /// Multiplies the probability of each value of an aspect by a factor, then normalizes.
    pub fn weigh(&mut self, aspect: AspectId, factor: impl Fn(usize) -> f64) {
        let values = &mut self.of[aspect.index()];
        for (index, p) in values.iter_mut().enumerate() {
            *p *= factor(index);
        }
        normalise(values);
    }

    /// Replaces the distribution of an aspect by unnormalized weights.
    pub fn replace(&mut self, aspect: AspectId, weights: &[f64]) {
        self.mix(aspect, weights, 1.0);
    }

    /// The world (state and recipes) that is most probable in the participant's beliefs.
    pub fn point(&self, kitchen: &Kitchen) -> World {
        let World { mut state, mut recipes } = World::empty(kitchen);
        for (index, aspect) in kitchen.aspects.iter().enumerate() {
            let code = aspect.values[self.most_likely(AspectId(index as u8))];
            match aspect.kind {
                AspectKind::Location(location) => state.set_code(location, code),
                AspectKind::Recipe(dish) => recipes.set(dish, ContentId(code)),
            }
        }
        World { state, recipes }
    }

    /// Probability that the participant assigns to the true value of an aspect.
    pub fn p_truth(&self, kitchen: &Kitchen, state: State, aspect: AspectId) -> f64 {
        self.distribution(aspect)[kitchen.true_value(state, aspect)]
    }
}

/// The dish that an order wants, as the participant believes.
pub fn wanted_dish(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, order: LocationId) -> Option<DishId> {
    let aspect = AspectId::of_location(order);
    match OrderContent::from_code(kitchen.aspects[aspect.index()].values[beliefs.most_likely(aspect)]) {
        OrderContent::Dish(dish) => Some(dish),
        _ => None,
    }
}

fn uniform(length: usize) -> Vec<f64> {
    vec![1.0 / length as f64; length]
}

fn normalise(values: &mut [f64]) {
    let total: f64 = values.iter().sum();
    if !(total.is_finite() && total > 0.0) {
        values.fill(1.0 / values.len() as f64);
        return;
    }
    let share = RESIDUE / values.len() as f64;
    for p in values.iter_mut() {
        *p = *p / total * (1.0 - RESIDUE) + share;
    }
}
