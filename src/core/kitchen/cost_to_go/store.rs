//! The data of [`CostToGo`]: tables of the kitchen, tables of goals, and caches.

use std::sync::Arc;

use super::Fidelity;
use super::goal::ServingGoal;
use super::ground::{CompactState, KitchenTables, MAX_TARGETS};
use crate::base::rng::mix;
use crate::kitchen::{Agent, ButtonAction, ContentId, Kitchen, LocationId, OrderContent, Recipes, State};

/// The cost to go of states from which the goal cannot be reached.
pub(crate) const UNREACHABLE: u32 = 255;
/// Number of bits of the cache sizes: 2^18 values and 2^15 decisions, 2 MiB each. Larger caches were slower without
/// more hits.
const CACHE_BITS: u32 = 18;
const DECISION_BITS: u32 = 15;
/// Number of bits of a cache key for the goal and the kind of value together.
pub(super) const SLOT_BITS: u32 = 16 + KIND_BITS;
/// Largest number of joint contents of all locations other than orders, for which the remaining bits of a key are enough.
pub(crate) const MAX_STATES: u128 = 1 << (KEY_BITS - SLOT_BITS);

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
    pub(crate) values_missed: u64,
    /// Number of values for which a search was needed, because bounds and plans differed.
    pub searches: u64,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum CacheSlot {
    At(usize, u64),
    /// No slot: the cost to go is constant, because there are no orders or an order cannot be served.
    Always(u32),
}

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

// Caches of fixed size. Values that were evicted are recomputed, so a full cache costs time but never correctness.

/// Largest number of buttons of one agent.
pub const MAX_BUTTONS: usize = 40;

/// Number of low bits of a cache key that tell the kind of value; all kinds of value of one state share a bucket.
pub(crate) const KIND_BITS: u32 = 2;

/// Number of bits of a cache key; an entry holds the key and the value of one byte.
pub(crate) const KEY_BITS: u32 = u64::BITS - u8::BITS;

/// Marks an empty cache entry, and is larger than any key. All entries are written at creation, so that the memory is
/// mapped before use.
const EMPTY: u64 = u64::MAX;

/// Bucket of eight cache entries; an entry is a key with the value in the lowest byte, or [`EMPTY`].
///
/// A bucket has the size of a cache line. It is not aligned to one: that made no look-up faster, and glibc's allocator
/// hardly ever uses a freed block again for an aligned one of the same size, so that every copy of a cache made the heap
/// larger.
#[derive(Clone, Copy, Debug)]
struct Bucket([u64; 8]);

/// Cache of one-byte values by keys of [`KEY_BITS`] bits, not all of them set, in buckets of eight entries.
#[derive(Clone, Debug)]
pub struct ValueCache {
    buckets: Vec<Bucket>,
    mask: u64,
    /// Counter that selects the cache entry to evict.
    turn: usize,
}

impl ValueCache {
    pub fn new(bits: u32) -> ValueCache {
        let buckets = 1usize << (bits - 3);
        ValueCache { buckets: vec![Bucket([EMPTY; 8]); buckets], mask: buckets as u64 - 1, turn: 0 }
    }

    #[inline]
    fn bucket(&self, key: u64) -> usize {
        (mix(key >> KIND_BITS) & self.mask) as usize
    }

    /// Prefetches the bucket of a key from memory. Callers with several keys prefetch all of them first; the result
    /// must be passed to a black box so that the compiler keeps the load.
    #[inline]
    pub fn fetch(&self, key: u64) -> u64 {
        self.buckets[self.bucket(key)].0[0]
    }

    #[inline]
    pub fn get(&self, key: u64) -> Option<u32> {
        let Bucket(bucket) = &self.buckets[self.bucket(key)];
        let entry = bucket.iter().find(|&&entry| entry >> 8 == key)?;
        Some((entry & 0xff) as u32)
    }

    /// Caches a value under this key, which may evict another value.
    pub fn insert(&mut self, key: u64, value: u32) {
        let bucket = self.bucket(key);
        let Bucket(bucket) = &mut self.buckets[bucket];
        let known = bucket.iter().position(|&entry| entry >> 8 == key);
        let place = known.or_else(|| bucket.iter().position(|&entry| entry == EMPTY)).unwrap_or_else(|| {
            self.turn = (self.turn + 1) % 8;
            self.turn
        });
        bucket[place] = key << 8 | u64::from(value.min(0xff) as u8);
    }
}

/// Costs to go for one decision: of the present state, and after each button of an agent. It has the size of a cache
/// line.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct DecisionCosts {
    state: State,
    /// Hash of the request (orders, fidelity, agent); `u32::MAX` for an empty entry.
    question: u32,
    /// Cost to go of the present state.
    pub here: u8,
    /// Cost to go after each button; equal to `here` where the button's press has no effect.
    pub after: [u8; MAX_BUTTONS],
}

/// Cache of decisions by state and request, a line of 64 bytes each; a new entry replaces the old one in its line.
#[derive(Clone, Debug)]
pub struct DecisionCache {
    lines: Vec<DecisionCosts>,
    mask: u64,
}

impl DecisionCache {
    pub fn new(bits: u32) -> DecisionCache {
        let empty = DecisionCosts { state: State::default(), question: u32::MAX, here: 0, after: [0; MAX_BUTTONS] };
        DecisionCache { lines: vec![empty; 1 << bits], mask: (1 << bits) - 1 }
    }

    #[inline]
    fn index(&self, state: State, question: u32) -> usize {
        let bits = state.bits();
        let hash = mix(bits as u64 ^ mix((bits >> 64) as u64 ^ u64::from(question) << 32));
        (hash & self.mask) as usize
    }

    /// Prefetches the line of a decision; the result must be passed to a black box so that the compiler keeps the load.
    #[inline]
    pub fn fetch(&self, state: State, question: u32) -> u32 {
        self.lines[self.index(state, question)].question
    }

    /// Index of a decision's cache line, and whether the decision is stored there.
    #[inline]
    pub fn find(&self, state: State, question: u32) -> (usize, bool) {
        let index = self.index(state, question);
        let line = &self.lines[index];
        (index, line.question == question && line.state == state)
    }

    /// The cache entry at this index, whichever decision it holds.
    #[inline]
    pub fn get(&self, index: usize) -> &DecisionCosts {
        &self.lines[index]
    }

    pub fn set(&mut self, index: usize, state: State, question: u32, here: u8, after: [u8; MAX_BUTTONS]) {
        self.lines[index] = DecisionCosts { state, question, here, after };
    }
}
