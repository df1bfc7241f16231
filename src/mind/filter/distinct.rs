//! The different worlds among all draws of a press, and the costs of the human's decision in each.

use crate::base::rng::mix;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity, MAX_BUTTONS};
use crate::kitchen::{Agent, World};

/// At least this share of all draws, or of the weight that they have after the press, has to be of a world for plans to be
/// made for its costs.
const COUNTS: f64 = 0.01;

/// So many worlds ahead a decision is prefetched.
const AHEAD: usize = 4;

/// Different worlds with their numbers of draws.
#[derive(Clone, Debug, Default)]
pub struct DistinctWorlds {
    known: Vec<RatedWorld>,
    /// Open addressing by hash: index + 1, 0 is free.
    slots: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct RatedWorld {
    world: World,
    draws: u32,
    /// C after each button, once it is known, and its fidelity.
    after: Option<([u8; MAX_BUTTONS], Fidelity)>,
}

impl DistinctWorlds {
    /// Forgets all, and makes room for so many draws.
    pub fn clear(&mut self, draws: usize) {
        self.known.clear();
        self.slots.clear();
        self.slots.resize((draws * 2).next_power_of_two(), 0);
    }

    /// The index of a world that was drawn so many times more.
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
                    self.known.push(RatedWorld { world, draws: times, after: None });
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

    /// Finds the costs of all worlds that have none yet, of `draws` draws in all.
    pub fn rate(&mut self, cost: &mut CostToGo, draws: usize) {
        let fidelity = |rated: &RatedWorld| {
            if f64::from(rated.draws) >= COUNTS * draws as f64 { Fidelity::PlanBound } else { Fidelity::LowerBound }
        };
        for index in 0..self.known.len() {
            if let Some(later) = self.known.get(index + AHEAD).filter(|later| later.after.is_none()) {
                cost.prefetch(fidelity(later), later.world.state, &later.world.recipes, Agent::Human);
            }
            let rated = &mut self.known[index];
            if rated.after.is_none() {
                rated.rate(cost, fidelity(rated));
            }
        }
    }

    /// Plans for the costs of those worlds that hardly counted before the press, and do now: `weights` by world, of this
    /// sum. A bound that is a press too low is strong evidence, and wrong. Tells whether there were any.
    pub fn rate_again(&mut self, cost: &mut CostToGo, weights: &[f64], sum: f64) -> bool {
        let mut any = false;
        for (rated, &weight) in self.known.iter_mut().zip(weights) {
            if weight >= COUNTS * sum && rated.after.is_some_and(|(_, fidelity)| fidelity == Fidelity::LowerBound) {
                rated.rate(cost, Fidelity::PlanBound);
                any = true;
            }
        }
        any
    }

    /// How many different worlds there are.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// C after each button of the human in a world that was rated.
    #[inline]
    pub fn after(&self, index: u32) -> &[u8; MAX_BUTTONS] {
        const UNKNOWN: [u8; MAX_BUTTONS] = [0; MAX_BUTTONS];
        self.known[index as usize].after.as_ref().map_or(&UNKNOWN, |(after, _)| after)
    }
}

impl RatedWorld {
    fn rate(&mut self, cost: &mut CostToGo, fidelity: Fidelity) {
        self.after =
            Some((cost.decision_with(fidelity, self.world.state, &self.world.recipes, Agent::Human).after, fidelity));
    }
}
