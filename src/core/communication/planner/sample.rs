//! Draws for planner rollouts: belief samples, and quasi-random numbers.

use rand::RngExt;

use crate::base::rng::Stream;
use crate::kitchen::{AspectId, AspectKind, Kitchen, OrderContent, State, WeightedWorlds, World};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::filter::draws::PolyaUrn;

/// Belief samples for the rollouts of one recommendation: worlds drawn from a belief that is itself drawn from the
/// Dirichlets of the estimate. The first draws are stratified over the samples by the mean
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

// Quasi-random numbers for the first random decisions of each rollout, which matter most. Point k is the fractional part of
// a random shift plus k times a vector of irrational numbers (a Kronecker sequence with powers of a generalised golden
// ratio). Every single point is uniform, so means are unbiased. The first n points are spread more evenly than independent
// draws, so means have a smaller error.

/// Quasi-random numbers per decision of the human: one for the decision, one for the robot's choice before it, and one
/// for whether the robot's press attracts the gaze.
pub const PER_DECISION: usize = 3;
/// Number of decisions in a rollout that use quasi-random numbers.
const DECISIONS: usize = 2;
/// Dimension of the quasi-random points: one number for the time of the first decision, one for whether the latest
/// change is seen, and the numbers of the first decisions.
const NUMBERS: usize = 2 + PER_DECISION * DECISIONS;
/// The generalised golden ratio: the root above 1 of x^(NUMBERS + 1) = x + 1.
const RATIO: f64 = 1.085_070_245_491_450_8;

/// Quasi-random points of the unit cube, one point per rollout.
#[derive(Clone, Debug)]
pub struct QuasiRandomLattice {
    shift: [f64; NUMBERS],
}

impl QuasiRandomLattice {
    pub fn shifted(random: &mut Stream) -> QuasiRandomLattice {
        QuasiRandomLattice { shift: std::array::from_fn(|_| random.random()) }
    }

    /// Quasi-random point with this number, each coordinate from 0 to below 1.
    pub fn point(&self, number: usize) -> [f64; NUMBERS] {
        let mut step = 1.0;
        self.shift.map(|shift| {
            step /= RATIO;
            (shift + number as f64 * step).fract()
        })
    }
}
