//! The bounded best-first search over single presses, for states whose cost to go bounds and plans do not decide. The
//! search stops at states with a known value, wherever a plan reaches the lower bound, and after 48 states (again after 24
//! more). So its result is a way that exists, and mostly but not surely the shortest: see
//! [`Fidelity::Searched`]. Simulations and recommendations ask for millions of values and use it; what people are judged by
//! is proven (`proof`).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::Fidelity;
use super::goal::{ServingGoal, successors};
use super::ground::CompactState;
use super::plan::{BLOCKED, PressPlan, RankedAssignments};
use super::store::CostToGo;
use crate::kitchen::State;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchLimits {
    expansions: usize,
    /// Whether the search takes items from a storage before their way to the board is free.
    takes: bool,
}

/// Limits of the first search. With the second one, the shortest way is found from 99.8 % of the states met in sessions, and
/// from 96 % of the states after random presses (sushi kitchen, all orders).
pub const NEAR: SearchLimits = SearchLimits { expansions: 48, takes: false };
/// Limits of the second search, for states whose first result is still two or more presses above the lower bound.
pub const FAR: SearchLimits = SearchLimits { expansions: 24, takes: true };

/// Initial capacity of the search's tables, since most searches meet fewer states.
const ROOM: usize = 200;

/// Marks a state of the search whose plan has not been computed yet.
const UNSEEN: u32 = u32::MAX;

/// Ranks a state of the search behind all states with the same bound whose plans are known.
const LAST: u32 = UNSEEN - 1;

/// An open state (node) of the best-first search. States are expanded in the order of the fields: smallest bound first,
/// then smallest gap of the plan, then latest discovery. `met` differs for all, so no later field decides.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Open {
    /// Number of presses so far plus lower bound of the remaining presses.
    bound: Reverse<u32>,
    /// Number of presses by which the state's plan exceeds the lower bound, or [`UNSEEN`].
    gap: Reverse<u32>,
    /// Number of the state in the search's order of discovery.
    met: usize,
    presses: u32,
    state: CompactState,
}

pub struct BestFirstSearch<'a> {
    costs: &'a mut CostToGo,
    slot: usize,
    goal: &'a ServingGoal,
    /// Length of the best solution found so far, in presses.
    best: u32,
    open: BinaryHeap<Open>,
    met: usize,
    /// Least number of presses found to each state, by the state's key.
    seen: FxHashMap<u64, u32>,
    reach: SearchLimits,
    /// Whether the search ends at the first solution below `best`.
    any: bool,
}

impl<'a> BestFirstSearch<'a> {
    /// A search for a solution with fewer than `best` presses; with `any` it ends at the first one.
    pub fn new(
        costs: &'a mut CostToGo,
        slot: usize,
        goal: &'a ServingGoal,
        best: u32,
        reach: SearchLimits,
        any: bool,
    ) -> BestFirstSearch<'a> {
        let seen = FxHashMap::with_capacity_and_hasher(ROOM, Default::default());
        BestFirstSearch { costs, slot, goal, best, open: BinaryHeap::new(), met: 0, seen, reach, any }
    }

    /// Length of the best solution from `start`, or `best` if none is better; the search stops once `lower` is reached.
    pub fn run(mut self, start: &CompactState, lower: u32) -> u32 {
        let rating = RankedAssignments::new(&self.costs.ground, self.goal, start);
        self.rate_plan(start, rating, 0, lower);
        // The presses that a plan settles first are nearly always right: therefore the start state itself is expanded
        // last among states with equal bounds.
        self.keep(lower, LAST, 0, start);
        let mut expansions = 0;
        while let Some(next) = self.open.pop() {
            if next.bound.0 >= self.best || expansions >= self.reach.expansions && self.best < BLOCKED {
                break;
            }
            if next.gap.0 == UNSEEN {
                let rating = RankedAssignments::new(&self.costs.ground, self.goal, &next.state);
                self.rate_plan(&next.state, rating, next.presses, next.bound.0);
                continue;
            }
            expansions += 1;
            self.expand(&next);
        }
        self.best
    }

    fn keep(&mut self, bound: u32, gap: u32, presses: u32, state: &CompactState) {
        self.met += 1;
        self.open.push(Open { bound: Reverse(bound), gap: Reverse(gap), met: self.met, presses, state: *state });
    }

    fn expand(&mut self, open: &Open) {
        let goal = self.goal;
        let rating = RankedAssignments::new(&self.costs.ground, goal, &open.state);
        if goal.targets.len() > 1 {
            for choice in rating.choices() {
                let plan = PressPlan::new(&self.costs.ground, goal, &open.state, choice);
                if let Some((presses, next)) = plan.begin(choice.order[0]) {
                    self.meet(&next, open.presses + presses, open.bound.0);
                }
            }
        }
        let wanted = if self.reach.takes { rating.wanted() } else { Default::default() };
        let mut nexts = Vec::with_capacity(32);
        successors(&self.costs.ground, goal, &open.state, wanted, |next| nexts.push(next));
        for next in &nexts {
            if self.best <= open.bound.0 {
                break;
            }
            self.meet(next, open.presses + 1, open.bound.0);
        }
    }

    /// Whether the state with this key is now reached with fewer presses than before.
    fn is_new(&mut self, key: u64, presses: u32) -> bool {
        if self.seen.get(&key).is_some_and(|&seen| seen <= presses) {
            return false;
        }
        self.seen.insert(key, presses);
        true
    }

    /// Handles a state that the search reaches after `presses` presses.
    fn meet(&mut self, state: &CompactState, presses: u32, bound: u32) {
        let key = self.costs.key(self.slot, self.goal, state);
        if !self.is_new(key, presses) {
            return;
        }
        let (known, mut rating) = (self.costs.known(Fidelity::LowerBound, key), None);
        let lower = known.unwrap_or_else(|| {
            let new = RankedAssignments::new(&self.costs.ground, self.goal, state);
            let lower = new.lower;
            rating = Some(new);
            self.costs.keep(Fidelity::LowerBound, key, lower)
        });
        let lower = presses + lower;
        if lower >= self.best {
            return;
        }
        // States that are not on the best path may never be expanded, so their plans are computed only on demand.
        if lower > bound {
            return self.keep(lower, UNSEEN, presses, state);
        }
        let rating = rating.unwrap_or_else(|| RankedAssignments::new(&self.costs.ground, self.goal, state));
        self.rate_plan(state, rating, presses, bound);
    }

    /// Computes the plan of a state, from the state after all presses that are certainly optimal.
    fn rate_plan(&mut self, state: &CompactState, mut rating: RankedAssignments, presses: u32, bound: u32) {
        let goal = self.goal;
        let plan = PressPlan::new(&self.costs.ground, goal, state, &rating.choices()[0]);
        let (settling, settled, served) = plan.settle();
        let presses = presses + settling;
        if let Some(target) = served {
            let value = self.costs.cost_without(goal, &settled, target);
            self.best = self.best.min(presses + value);
            return;
        }
        let key = self.costs.key(self.slot, goal, &settled);
        if settling > 0 {
            if !self.is_new(key, presses) {
                return;
            }
            rating = RankedAssignments::new(&self.costs.ground, goal, &settled);
        }
        if presses + rating.lower >= self.best {
            return;
        }
        let most = if self.any { self.best - presses - 1 } else { BLOCKED };
        let upper = rating.best_plan(&self.costs.ground, goal, &settled, most, false);
        self.best = self.best.min(presses + upper);
        if upper <= rating.lower {
            self.costs.cache.insert(key, upper);
        } else {
            let bound = bound.max(presses + rating.lower);
            self.keep(bound, upper - rating.lower, presses, &settled);
        }
    }
}

impl CostToGo {
    pub(super) fn compute_for(&mut self, fidelity: Fidelity, key: u64, slot: usize, state: State) -> u32 {
        let goal = self.goal(slot).clone();
        let classes = self.classes(&goal, state);
        self.compute(fidelity, key, slot, &goal, &classes)
    }

    fn compute(&mut self, fidelity: Fidelity, key: u64, slot: usize, goal: &ServingGoal, state: &CompactState) -> u32 {
        let value = self.solve(fidelity, slot, goal, state);
        self.keep(fidelity, key, value)
    }

    pub(super) fn solve(&mut self, fidelity: Fidelity, slot: usize, goal: &ServingGoal, state: &CompactState) -> u32 {
        if fidelity == Fidelity::LowerBound {
            return RankedAssignments::bound(&self.ground, goal, state);
        }
        let rating = RankedAssignments::new(&self.ground, goal, state);
        let upper = rating.close_upper(&self.ground, goal, state);
        if upper <= rating.lower || fidelity == Fidelity::PlanBound && upper < BLOCKED {
            return upper;
        }
        let mut search =
            |best, reach| BestFirstSearch::new(self, slot, goal, best, reach, false).run(state, rating.lower);
        let best = search(upper, NEAR);
        // With two target dishes, a plan one press above the lower bound is common and mostly exact.
        match best < rating.lower + goal.targets.len() as u32 {
            true => best,
            false => search(best, FAR),
        }
    }

    /// Cost to go of a state after one of its target dishes has been served.
    fn cost_without(&mut self, goal: &ServingGoal, state: &CompactState, served: usize) -> u32 {
        let Some((slot, rest, classes)) = self.without(goal, state, served) else { return 0 };
        let key = self.key(slot, &rest, &classes);
        self.cache.get(key).unwrap_or_else(|| self.compute(Fidelity::Searched, key, slot, &rest, &classes))
    }
}
