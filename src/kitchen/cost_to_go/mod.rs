//! Cost to go: the least number of presses, of both agents one after another, until the orders are served.
//!
//! It is computed backwards from the goal. For every part of the wanted stacks the tables of `journeys` say how many presses
//! it is away from the board, from every place and for everything that may be in the way. An `assign::Assignment` chooses
//! which item becomes which part, which gives a lower bound; a `plan::PressPlan` carries it out, press by press, and clears what
//! is in the way, which gives an upper bound. Where they agree, the value is settled; where they do not, a bounded
//! `search` over single presses decides. What was found is kept by state classes (see `goal`: all that is of no use is
//! one class), and whole decisions are kept by state. A value depends on the state and the recipes alone, never on what was
//! asked before.

mod assign;
mod cache;
mod clear;
mod decide;
mod demand;
mod goal;
mod ground;
mod journeys;
mod moves;
mod plan;
mod rating;
mod search;

use std::sync::Arc;

use self::cache::{DecisionCache, ValueCache};
pub use self::cache::{DecisionCosts, MAX_BUTTONS};
pub use self::decide::Fidelity;
use self::decide::SuccessorState;
use self::goal::{ContentClasses, ServingGoal};
use self::ground::KitchenTables;
use self::plan::BLOCKED;
use self::rating::AssignmentRating;
use self::search::BestFirstSearch;
use super::Kitchen;
use super::action::{Agent, ButtonAction};
use super::content::ContentId;
use super::layout::LocationId;
use super::state::{OrderContent, Recipes, State};

/// The value of states from which the goal cannot be reached.
pub const UNREACHABLE: u32 = 255;
/// 2^18 values and 2^15 decisions, 2 MiB each: larger ones would be asked as rarely twice, and answer more slowly.
const CACHE_BITS: u32 = 18;
const DECISION_BITS: u32 = 15;
/// Keys leave so many bits for the goal and the kind of value.
const SLOT_BITS: u32 = 16 + cache::KIND_BITS;

/// Computes costs to go and remembers them.
#[derive(Clone, Debug)]
pub struct CostToGo {
    kitchen: Arc<Kitchen>,
    ground: KitchenTables,
    /// `[first target * contents + second target]`, made when first wanted; no second target: 0.
    goals: Vec<Option<Arc<ServingGoal>>>,
    cache: ValueCache,
    decisions: DecisionCache,
    /// Room for the states around a decision.
    nexts: Vec<SuccessorState>,
    counts: EvaluationCounts,
    /// `[agent][content]`: what an agent that has thrown it away can take again.
    takes: [Vec<bool>; 2],
    /// By agent, whether it can throw away what it has taken.
    trashes: [bool; 2],
}

/// How often what was done since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EvaluationCounts {
    /// Decisions that had to be put together, button by button.
    pub decisions_missed: u64,
    /// Single values asked for, and those that had to be computed.
    pub values: u64,
    pub values_missed: u64,
    /// Those for which bound and plans did not agree.
    pub searches: u64,
}

impl CostToGo {
    pub fn new(kitchen: Arc<Kitchen>) -> CostToGo {
        let ground = KitchenTables::new(&kitchen);
        let goals = vec![None; kitchen.contents.len() * kitchen.contents.len()];
        let (cache, decisions) = (ValueCache::new(CACHE_BITS), DecisionCache::new(DECISION_BITS));
        let has = |agent: Agent, action| kitchen.buttons[agent.index()].iter().any(|button| button.action == action);
        let takes = |agent| {
            let has = |item| has(agent, ButtonAction::Take(ContentId(item as u8)));
            (0..kitchen.contents.len()).map(has).collect()
        };
        CostToGo {
            takes: Agent::BOTH.map(takes),
            trashes: Agent::BOTH.map(|agent| has(agent, ButtonAction::Trash)),
            counts: EvaluationCounts::default(),
            kitchen,
            ground,
            goals,
            cache,
            decisions,
            nexts: Vec::new(),
        }
    }

    /// C(s, recipes): presses until all present orders are served; 0 if there is none, [`UNREACHABLE`] if they never can be.
    pub fn all_orders(&mut self, state: State, recipes: &Recipes) -> u32 {
        let (mut targets, count) = self.targets(state, recipes);
        self.cost(Fidelity::Exact, state, &mut targets[..count])
    }

    /// C_k(s, recipes): presses until the order at this location is served; 0 if it wants nothing.
    pub fn order(&mut self, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        self.order_with(Fidelity::Exact, state, recipes, order)
    }

    /// The same at a given fidelity.
    pub fn order_with(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        match state.order(order) {
            OrderContent::Dish(dish) => self.cost(fidelity, state, &mut [recipes.get(dish)]),
            _ => 0,
        }
    }

    /// Whether the order's value is below `limit`, which is at most one press above it; cheaper than the value.
    pub fn order_is_below(
        &mut self,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        order: LocationId,
        limit: u32,
    ) -> bool {
        match state.order(order) {
            OrderContent::Dish(dish) if fidelity == Fidelity::Exact => {
                let kept = self.kept_for(state, &mut [recipes.get(dish)]);
                self.is_below(limit, state, kept)
            }
            _ => self.order_with(fidelity, state, recipes, order) < limit,
        }
    }

    /// How much was looked up and how much computed since the start.
    pub fn counts(&self) -> EvaluationCounts {
        self.counts
    }

    /// The stacks that the present orders want, in the order of the orders, and their number.
    #[inline]
    fn targets(&self, state: State, recipes: &Recipes) -> ([ContentId; goal::MAX_TARGETS], usize) {
        let mut targets = [ContentId::EMPTY; goal::MAX_TARGETS];
        let mut count = 0;
        for order in 0..self.ground.first {
            if let OrderContent::Dish(dish) = state.order(LocationId(order as u8)) {
                targets[count] = recipes.get(dish);
                count += 1;
            }
        }
        (targets, count)
    }

    fn cost(&mut self, fidelity: Fidelity, state: State, targets: &mut [ContentId]) -> u32 {
        if targets.is_empty() {
            return 0;
        }
        let Some((slot, key)) = self.key_of_state(state, targets) else { return UNREACHABLE };
        if let Some(value) = self.known(fidelity, key) {
            return value;
        }
        self.compute_for(fidelity, key, slot, state)
    }

    fn compute_for(&mut self, fidelity: Fidelity, key: u64, slot: usize, state: State) -> u32 {
        let Some(goal) = self.goals[slot].clone() else { return UNREACHABLE };
        let classes = self.classes(&goal, state);
        self.compute(fidelity, key, slot, &goal, &classes)
    }

    /// A state's key together with these targets (at least one), and their slot.
    #[inline]
    fn key_of_state(&mut self, state: State, targets: &mut [ContentId]) -> Option<(usize, u64)> {
        targets.sort_unstable();
        let slot = self.slot(targets);
        self.make_goal(slot, targets);
        let goal = self.goals[slot].as_ref()?;
        Some((slot, goal.key_of_state(state) << SLOT_BITS | (slot << cache::KIND_BITS) as u64))
    }

    fn classes(&self, goal: &ServingGoal, state: State) -> ContentClasses {
        let mut classes: ContentClasses = [0; 16];
        for location in self.ground.places() {
            classes[location] = goal.class_of[state.content(LocationId(location as u8)).index()];
        }
        classes
    }

    #[inline]
    fn known(&mut self, fidelity: Fidelity, key: u64) -> Option<u32> {
        self.counts.values += 1;
        self.cache.get(key | fidelity as u64)
    }

    #[inline]
    fn keep(&mut self, fidelity: Fidelity, key: u64, value: u32) -> u32 {
        self.counts.values_missed += 1;
        let value = value.min(UNREACHABLE);
        self.cache.insert(key | fidelity as u64, value);
        value
    }

    /// The value of a state of classes without one of its targets, which has just been served.
    fn without(&mut self, goal: &ServingGoal, state: &ContentClasses, served: usize) -> u32 {
        let rest = goal.targets.iter().enumerate().filter(|(index, _)| *index != served);
        let rest: Vec<ContentId> = rest.map(|(_, &target)| target).collect();
        if rest.is_empty() {
            return 0;
        }
        let slot = self.slot(&rest);
        self.make_goal(slot, &rest);
        let Some(rest) = self.goals[slot].clone() else { return UNREACHABLE };
        let mut classes: ContentClasses = [0; 16];
        for location in self.ground.places() {
            classes[location] = rest.class_of[goal.content[usize::from(state[location])].index()];
        }
        let key = self.key(slot, &rest, &classes);
        self.cache.get(key).unwrap_or_else(|| self.compute(Fidelity::Exact, key, slot, &rest, &classes))
    }

    fn compute(
        &mut self,
        fidelity: Fidelity,
        key: u64,
        slot: usize,
        goal: &ServingGoal,
        state: &ContentClasses,
    ) -> u32 {
        let value = self.solve(fidelity, slot, goal, state);
        self.keep(fidelity, key, value)
    }

    fn solve(&mut self, fidelity: Fidelity, slot: usize, goal: &ServingGoal, state: &ContentClasses) -> u32 {
        if fidelity == Fidelity::LowerBound {
            return AssignmentRating::bound(&self.ground, goal, state);
        }
        let rating = AssignmentRating::new(&self.ground, goal, state);
        let upper = rating.close_upper(&self.ground, goal, state);
        if upper <= rating.lower || fidelity == Fidelity::PlanBound && upper < BLOCKED {
            return upper;
        }
        self.counts.searches += 1;
        let best = BestFirstSearch::run(self, slot, goal, state, rating.lower, upper, search::NEAR);
        // One press above the bound is common with two targets, and then mostly exact.
        match best < rating.lower + goal.targets.len() as u32 {
            true => best,
            false => BestFirstSearch::run(self, slot, goal, state, rating.lower, best, search::FAR),
        }
    }

    /// The key of its exact value.
    fn key(&self, slot: usize, goal: &ServingGoal, state: &ContentClasses) -> u64 {
        goal.key_of_classes(state) << SLOT_BITS | (slot << cache::KIND_BITS) as u64
    }

    fn slot(&self, targets: &[ContentId]) -> usize {
        let second = targets.get(1).map_or(0, |target| target.index());
        targets[0].index() * self.kitchen.contents.len() + second
    }

    #[inline]
    fn make_goal(&mut self, slot: usize, targets: &[ContentId]) {
        if self.goals[slot].is_none() {
            let goal = ServingGoal::new(&self.kitchen, &self.ground, targets.to_vec());
            self.goals[slot] = Some(Arc::new(goal));
        }
    }
}
