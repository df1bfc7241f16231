//! Belief samples for planner rollouts: worlds drawn from a belief that is itself drawn from the Dirichlets of the
//! estimate.

use crate::base::rng::Stream;
use crate::kitchen::{AspectId, AspectKind, Kitchen, OrderContent, State, WeightedWorlds, World};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::filter::urn::PolyaUrn;

/// Belief samples for the rollouts of one recommendation. The first draws are stratified over the samples by the mean
/// of each state aspect.
#[derive(Clone, Debug, Default)]
pub struct BeliefSamples {
    urns: Vec<PolyaUrn>,
    /// First draws of the values in all samples: `[aspect * samples + sample]`.
    firsts: Vec<u8>,
    /// All draws of values in the present sample: `[aspect * states + draw]`.
    drawn: Vec<u8>,
    /// State aspects of which the present belief sample has several values.
    mixed: Vec<usize>,
    samples: usize,
    states: usize,
}

impl BeliefSamples {
    /// Prepares `samples` belief samples of `states` worlds each.
    pub fn prepare(&mut self, belief: &DirichletBelief, samples: usize, states: usize, random: &mut Stream) {
        (self.samples, self.states) = (samples, states);
        let aspects = belief.aspects.len();
        self.urns.resize(aspects, PolyaUrn::default());
        self.firsts.resize(aspects * samples, 0);
        self.drawn.resize(aspects * states, 0);
        for (index, dirichlet) in belief.aspects.iter().enumerate() {
            self.urns[index].fill(dirichlet, states, random);
            self.urns[index].first_draws(random, &mut self.firsts[index * samples..(index + 1) * samples]);
        }
    }

    /// Draws one belief sample. A recipe is drawn only if decisions depend on it: in worlds whose orders show the
    /// recipe's dish, and if the true orders do.
    pub fn draw(
        &mut self,
        kitchen: &Kitchen,
        truth: State,
        sample: usize,
        random: &mut Stream,
        worlds: &mut WeightedWorlds<u32>,
    ) {
        let states = self.states;
        self.mixed.clear();
        for (index, urn) in self.urns.iter().enumerate() {
            let drawn = &mut self.drawn[index * states..(index + 1) * states];
            let first = self.firsts[index * self.samples + sample];
            match urn.draw_on(random, first, drawn) {
                true => drawn.fill(first),
                false => self.mixed.push(index),
            }
        }
        worlds.all.clear();
        let all: Vec<usize> = (0..self.urns.len()).collect();
        if self.mixed.iter().any(|index| kitchen.orders.iter().any(|order| order.index() == *index)) {
            // The recipes on which decisions depend differ from draw to draw, since the drawn orders differ.
            for draw in 0..states {
                let mut world = World::empty(kitchen);
                self.set(kitchen, truth, draw, &all, &mut world);
                worlds.add(world, 1);
            }
            return;
        }
        let mut world = World::empty(kitchen);
        self.set(kitchen, truth, 0, &all, &mut world);
        if self.mixed.is_empty() {
            return worlds.add(world, states as u32);
        }
        for draw in 0..states {
            self.set(kitchen, truth, draw, &self.mixed, &mut world);
            worlds.add(world, 1);
        }
    }

    /// Sets these state aspects of a world to the values of one draw; locations come before recipes.
    fn set(&self, kitchen: &Kitchen, truth: State, draw: usize, aspects: &[usize], world: &mut World) {
        for &index in aspects {
            let counts = match kitchen.aspects[index].kind {
                AspectKind::Location(_) => true,
                AspectKind::Recipe(dish) => {
                    let wanted = OrderContent::Dish(dish);
                    let is_wanted = |&order| world.state.order(order) == wanted || truth.order(order) == wanted;
                    kitchen.orders.iter().any(is_wanted)
                }
            };
            if counts {
                let value = usize::from(self.drawn[index * self.states + draw]);
                world.set_value(kitchen, AspectId(index as u8), value);
            }
        }
    }
}
