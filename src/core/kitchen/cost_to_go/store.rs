//! The data of [`CostToGo`]: tables of the kitchen, tables of goals, and caches by state keys.

use std::sync::Arc;

use super::cache::{DecisionCache, KEY_BITS, KIND_BITS, ValueCache};
use super::classes::{CompactState, MAX_TARGETS};
use super::fidelity::Fidelity;
use super::goal::ServingGoal;
use super::ground::KitchenTables;
use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, OrderContent, Recipes, State};

/// The cost to go of states from which the goal cannot be reached.
pub const UNREACHABLE: u32 = 255;
/// Number of bits of the cache sizes: 2^18 values and 2^15 decisions, 2 MiB each. Larger caches were slower without
/// more hits.
const CACHE_BITS: u32 = 18;
const DECISION_BITS: u32 = 15;
/// Number of bits of a cache key for the goal and the kind of value together.
pub(super) const SLOT_BITS: u32 = 16 + KIND_BITS;
/// Largest number of joint contents of all locations other than orders, for which the remaining bits of a key are enough.
pub const MAX_STATES: u128 = 1 << (KEY_BITS - SLOT_BITS);

/// Computes costs to go of a kitchen's states, with caches.
#[derive(Clone, Debug)]
pub struct CostToGo {
    pub(super) kitchen: Arc<Kitchen>,
    pub(super) ground: KitchenTables,
    /// The goals by `[first target * contents + second target]` (0 for no second target), created on demand.
    pub(super) goals: Vec<Option<Arc<ServingGoal>>>,
    pub(super) cache: ValueCache,
    pub(super) decisions: DecisionCache,
    /// Reused buffer for the successor states of a decision.
    pub(super) nexts: Vec<SuccessorState>,
    pub(super) counts: EvaluationCounts,
    /// `[agent][content]`: whether an agent can take the content again after throwing it away.
    pub(super) takes: [Vec<bool>; 2],
    /// For each agent, whether the agent has a trash button.
    pub(super) trashes: [bool; 2],
}

/// Number of cache look-ups and computations since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EvaluationCounts {
    /// Number of decisions that were not in the cache.
    pub decisions_missed: u64,
    /// Number of requests for the cost to go of a single state.
    pub values: u64,
    /// Number of values that had to be computed, because no cache held them.
    pub values_missed: u64,
    /// Number of values for which a search was needed, because bounds and plans differed.
    pub searches: u64,
}

/// Cache slot of a state's cost to go.
#[derive(Clone, Copy, Debug)]
pub(super) enum CacheSlot {
    /// The slot of the goal, and the key of the state in that slot.
    At(usize, u64),
    /// No slot: the cost to go is constant, because there are no orders or an order cannot be served.
    Always(u32),
}

/// A state after one press, with bounds of its cost to go.
#[derive(Clone, Copy, Debug)]
pub(super) struct SuccessorState {
    pub(super) button: usize,
    pub(super) state: State,
    pub(super) kept: CacheSlot,
    /// Lower bound of the cost to go and, where requested, the length of the best plan.
    pub(super) bracket: (u32, Option<u32>),
}

impl CostToGo {
    /// A cost-to-go evaluator for this kitchen, with empty caches.
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

    /// Counters of cache look-ups and computations since the start.
    pub fn counts(&self) -> EvaluationCounts {
        self.counts
    }

    /// The stacks (dishes) that the present orders want, in the order of the orders, and their number.
    #[inline]
    pub(super) fn targets(&self, state: State, recipes: &Recipes) -> ([ContentId; MAX_TARGETS], usize) {
        let mut targets = [ContentId::EMPTY; MAX_TARGETS];
        let mut count = 0;
        for order in 0..self.ground.first {
            if let OrderContent::Dish(dish) = state.order(LocationId(order as u8)) {
                targets[count] = recipes.get(dish);
                count += 1;
            }
        }
        (targets, count)
    }

    /// The cache slot of the target dishes (at least one) and the key of the state.
    #[inline]
    pub(super) fn key_of_state(&mut self, state: State, targets: &mut [ContentId]) -> Option<(usize, u64)> {
        targets.sort_unstable();
        let slot = self.slot(targets);
        self.make_goal(slot, targets);
        let goal = self.goals[slot].as_ref()?;
        Some((slot, goal.key_of_state(state) << SLOT_BITS | (slot << KIND_BITS) as u64))
    }

    /// Cache key of a state's searched cost to go.
    pub(super) fn key(&self, slot: usize, goal: &ServingGoal, state: &CompactState) -> u64 {
        goal.key_of_classes(state) << SLOT_BITS | (slot << KIND_BITS) as u64
    }

    pub(super) fn slot(&self, targets: &[ContentId]) -> usize {
        let second = targets.get(1).map_or(0, |target| target.index());
        targets[0].index() * self.kitchen.contents.len() + second
    }

    #[inline]
    pub(super) fn make_goal(&mut self, slot: usize, targets: &[ContentId]) {
        if self.goals[slot].is_none() {
            let goal = ServingGoal::new(&self.kitchen, &self.ground, targets.to_vec());
            self.goals[slot] = Some(Arc::new(goal));
        }
    }

    pub(super) fn classes(&self, goal: &ServingGoal, state: State) -> CompactState {
        let mut classes: CompactState = [0; 16];
        for location in self.ground.places() {
            classes[location] = goal.class_of[state.content(LocationId(location as u8)).index()];
        }
        classes
    }

    #[inline]
    pub(super) fn known(&mut self, fidelity: Fidelity, key: u64) -> Option<u32> {
        self.counts.values += 1;
        self.cache.get(key | fidelity as u64)
    }

    #[inline]
    pub(super) fn keep(&mut self, fidelity: Fidelity, key: u64, value: u32) -> u32 {
        self.counts.values_missed += 1;
        let value = value.min(UNREACHABLE);
        self.cache.insert(key | fidelity as u64, value);
        value
    }

    #[inline]
    pub(super) fn kept(&mut self, state: State, recipes: &Recipes) -> CacheSlot {
        let (mut targets, count) = self.targets(state, recipes);
        self.kept_for(state, &mut targets[..count])
    }

    #[inline]
    pub(super) fn kept_for(&mut self, state: State, targets: &mut [ContentId]) -> CacheSlot {
        if targets.is_empty() {
            return CacheSlot::Always(0);
        }
        match self.key_of_state(state, targets) {
            Some((slot, key)) => CacheSlot::At(slot, key),
            None => CacheSlot::Always(UNREACHABLE),
        }
    }
}
