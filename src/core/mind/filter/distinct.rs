//! The distinct worlds among all draws for a press of the human, each with the costs to go of the human's decision in
//! that world, computed once.

use crate::base::rng::mix;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity, MAX_BUTTONS};
use crate::kitchen::{Agent, World};

/// A world's costs to go are computed with [`Fidelity::PlanBound`] if the world has at least this share of all draws,
/// or of the posterior weight; else with [`Fidelity::LowerBound`].
const COUNTS: f64 = 0.01;

/// Number of worlds by which prefetching from memory is ahead of the computation.
const AHEAD: usize = 4;

/// Distinct worlds with the number of draws of each.
#[derive(Clone, Debug, Default)]
pub struct DistinctWorlds {
    known: Vec<RatedWorld>,
    /// Hash table with open addressing: index + 1 of a world, 0 for a free slot.
    slots: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct RatedWorld {
    world: World,
    draws: u32,
    /// Costs to go of the decision in the world; `None` until the costs are computed.
    costs: Option<WorldCosts>,
}

/// The costs to go of the human's decision in one world.
#[derive(Clone, Copy, Debug)]
struct WorldCosts {
    /// Cost to go after a press of each button of the human.
    after: [u8; MAX_BUTTONS],
    fidelity: Fidelity,
}

impl DistinctWorlds {
    /// Removes all worlds and reserves hash slots for `draws` draws.
    pub fn clear(&mut self, draws: usize) {
        self.known.clear();
        self.slots.clear();
        self.slots.resize((draws * 2).next_power_of_two(), 0);
    }

    /// Adds `times` draws of a world and returns the world's index.
    #[inline]
    pub fn count(&mut self, world: World, times: u32) -> u32 {
        let mask = self.slots.len() - 1;
        let (bits, of_recipes) = (world.state.bits(), world.recipes.bits());
        let folded =
            mix(bits as u64 ^ mix((bits >> 64) as u64)) ^ mix(of_recipes as u64 ^ mix((of_recipes >> 64) as u64));
        let mut slot = folded as usize & mask;
        loop {
            match self.slots[slot] {
                0 => {
                    self.known.push(RatedWorld { world, draws: times, costs: None });
                    self.slots[slot] = self.known.len() as u32;
                    return self.known.len() as u32 - 1;
                }
                index => {
                    let known = &mut self.known[index as usize - 1];
                    if known.world == world {
                        known.draws += times;
                        return index - 1;
                    }
                }
            }
            slot = (slot + 1) & mask;
        }
    }

    /// Computes the costs to go of all worlds for which they are missing; `draws` is the total number of draws.
    pub fn rate(&mut self, cost: &mut CostToGo, draws: usize) {
        let fidelity = |rated: &RatedWorld| {
            if f64::from(rated.draws) >= COUNTS * draws as f64 { Fidelity::PlanBound } else { Fidelity::LowerBound }
        };
        for index in 0..self.known.len() {
            if let Some(later) = self.known.get(index + AHEAD).filter(|later| later.costs.is_none()) {
                cost.prefetch(fidelity(later), later.world.state, &later.world.recipes, Agent::Human);
            }
            let rated = &mut self.known[index];
            if rated.costs.is_none() {
                rated.rate(cost, fidelity(rated));
            }
        }
    }

    /// Recomputes costs with [`Fidelity::PlanBound`] for worlds that have lower bounds only and whose posterior weight
    /// (`weights` by world, with total `sum`) is now relevant: a lower bound that is one press too low would be strong
    /// but wrong evidence. Returns whether there were such worlds.
    pub fn rate_again(&mut self, cost: &mut CostToGo, weights: &[f64], sum: f64) -> bool {
        let mut any = false;
        for (rated, &weight) in self.known.iter_mut().zip(weights) {
            if weight >= COUNTS * sum && rated.costs.is_some_and(|costs| costs.fidelity == Fidelity::LowerBound) {
                rated.rate(cost, Fidelity::PlanBound);
                any = true;
            }
        }
        any
    }

    /// Number of distinct worlds among the draws.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Cost to go after each button of the human in a world whose costs have been computed.
    #[inline]
    pub fn after(&self, index: u32) -> &[u8; MAX_BUTTONS] {
        const UNKNOWN: [u8; MAX_BUTTONS] = [0; MAX_BUTTONS];
        self.known[index as usize].costs.as_ref().map_or(&UNKNOWN, |costs| &costs.after)
    }
}

impl RatedWorld {
    fn rate(&mut self, cost: &mut CostToGo, fidelity: Fidelity) {
        let decision = cost.decision_with(fidelity, self.world.state, &self.world.recipes, Agent::Human);
        self.costs = Some(WorldCosts { after: decision.after, fidelity });
    }
}
