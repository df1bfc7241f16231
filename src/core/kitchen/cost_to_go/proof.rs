//! Proven costs to go, by which presses are judged: a value is proven if the shortest known way is no longer than a lower
//! bound that holds (`floor`), or if a search over single presses finds no shorter way within a budget.
//!
//! The search takes the presses that can help, as `successors` has them: what no target dish can use is thrown away once
//! it is in a hand, and nothing useless is taken or made. No shorter way is lost: every hand has a trash button, and an
//! emptier kitchen is never worse. `tests/core/cost_to_go.rs` holds proven values against an exact search.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::Fidelity;
use super::assign::floor;
use super::goal::{ServingGoal, successors};
use super::ground::CompactState;
use super::store::CostToGo;
use crate::kitchen::{ContentId, LocationId, OrderContent, Recipes, State};

/// Number of states that the proofs of one judgement expand together at most. The 11,000 proofs of the tests expand at most
/// some 1,600 each.
const MOST_EXPANSIONS: u32 = 160_000;

/// Number of states that the proofs of one judgement may still expand. Proofs are not cached, so that what is proven
/// within a budget follows from the states alone, and never from earlier requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    expansions: u32,
}

impl Default for ProofBudget {
    fn default() -> ProofBudget {
        ProofBudget { expansions: MOST_EXPANSIONS }
    }
}

/// A cost to go, and whether it is certainly the least number of presses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProvenCost {
    /// The least number of presses that was found.
    pub presses: u32,
    /// Whether no way with fewer presses exists; false where the budget did not suffice to tell.
    pub is_proven: bool,
}

/// An open state of the search. States are expanded in the order of the fields: smallest bound first, then most presses
/// so far, then latest discovery. `met` differs for all, so no later field decides.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Open {
    /// Number of presses so far plus lower bound of the remaining presses.
    bound: Reverse<u32>,
    presses: u32,
    /// Number of the state in the search's order of discovery.
    met: u32,
    slot: usize,
    state: CompactState,
}

/// A search for the least number of presses, which ends with a proof or with the budget.
struct ProofSearch<'a> {
    costs: &'a mut CostToGo,
    best: u32,
    open: BinaryHeap<Open>,
    /// Least number of presses to each state so far, by the state's key.
    seen: FxHashMap<u64, u32>,
    met: u32,
}

impl CostToGo {
    /// C(s, recipes), proven as far as the budget suffices: number of presses until all present orders are served.
    pub fn proven_all_orders(&mut self, state: State, recipes: &Recipes, budget: &mut ProofBudget) -> ProvenCost {
        let (mut targets, count) = self.targets(state, recipes);
        self.proven(state, &mut targets[..count], budget)
    }

    /// C_k(s, recipes), proven as far as the budget suffices: number of presses until the order at this location is
    /// served; 0 without an order.
    pub fn proven_order(
        &mut self,
        state: State,
        recipes: &Recipes,
        order: LocationId,
        budget: &mut ProofBudget,
    ) -> ProvenCost {
        match state.order(order) {
            OrderContent::Dish(dish) => self.proven(state, &mut [recipes.get(dish)], budget),
            _ => ProvenCost { presses: 0, is_proven: true },
        }
    }

    fn proven(&mut self, state: State, targets: &mut [ContentId], budget: &mut ProofBudget) -> ProvenCost {
        let presses = self.cost(Fidelity::Searched, state, targets);
        let known = ProvenCost { presses, is_proven: true };
        if targets.is_empty() {
            return known;
        }
        let (slot, _) = self.key_of_state(state, targets);
        let goal = self.goal(slot).clone();
        let classes = self.classes(&goal, state);
        if floor(&self.ground, &goal, &classes) >= presses {
            return known;
        }
        ProofSearch::new(self, presses).run((slot, &goal, &classes), budget)
    }
}

impl ProofSearch<'_> {
    fn new(costs: &mut CostToGo, best: u32) -> ProofSearch<'_> {
        ProofSearch { costs, best, open: BinaryHeap::new(), seen: FxHashMap::default(), met: 0 }
    }

    fn run(
        mut self,
        (slot, goal, start): (usize, &ServingGoal, &CompactState),
        budget: &mut ProofBudget,
    ) -> ProvenCost {
        self.meet(slot, goal, start, 0);
        while let Some(next) = self.open.pop().filter(|next| next.bound.0 < self.best) {
            let goal = self.costs.goal(next.slot).clone();
            let key = self.costs.key(next.slot, &goal, &next.state);
            if self.seen.get(&key).is_some_and(|&least| least < next.presses) {
                continue;
            }
            if budget.expansions == 0 {
                return ProvenCost { presses: self.best, is_proven: false };
            }
            budget.expansions -= 1;
            self.expand(&next, &goal);
        }
        ProvenCost { presses: self.best, is_proven: true }
    }

    fn expand(&mut self, open: &Open, goal: &ServingGoal) {
        let plate = self.costs.ground.plate;
        for target in 0..goal.targets.len() {
            if goal.target_class[target] == open.state[plate] {
                self.serve(open, goal, target);
            }
        }
        let mut nexts = Vec::with_capacity(32);
        successors(&self.costs.ground, goal, &open.state, goal.complete, |next| nexts.push(next));
        for next in &nexts {
            self.meet(open.slot, goal, next, open.presses + 1);
        }
    }

    fn serve(&mut self, open: &Open, goal: &ServingGoal, target: usize) {
        let mut state = open.state;
        state[self.costs.ground.plate] = 0;
        match self.costs.without(goal, &state, target) {
            Some((slot, rest, classes)) => self.meet(slot, &rest, &classes, open.presses + 1),
            None => self.best = self.best.min(open.presses + 1),
        }
    }

    fn meet(&mut self, slot: usize, goal: &ServingGoal, state: &CompactState, presses: u32) {
        let key = self.costs.key(slot, goal, state);
        if self.seen.get(&key).is_some_and(|&least| least <= presses) {
            return;
        }
        let bound = presses + floor(&self.costs.ground, goal, state);
        if bound >= self.best {
            return;
        }
        self.seen.insert(key, presses);
        self.met += 1;
        self.open.push(Open { bound: Reverse(bound), presses, met: self.met, slot, state: *state });
    }
}
