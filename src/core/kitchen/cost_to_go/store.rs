//! The data of [`CostToGo`]: tables of the kitchen, tables of goals, and caches.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering, fence};
use std::sync::{Arc, OnceLock};

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

/// Computes costs to go of a kitchen's states, with caches. Clones share the caches, also between threads.
#[derive(Clone, Debug)]
pub struct CostToGo {
    pub(super) kitchen: Arc<Kitchen>,
    pub(super) ground: Arc<KitchenTables>,
    /// The goals by `[first target * contents + second target]` (0 for no second target), created on demand.
    goals: Arc<[OnceLock<Arc<ServingGoal>>]>,
    pub(super) cache: Arc<ValueCache>,
    pub(super) decisions: Arc<DecisionCache>,
    /// Reused buffer for the successor states of a decision.
    pub(super) nexts: Vec<SuccessorState>,
    /// Number of decisions that were in no cache.
    pub(super) decisions_missed: u64,
    /// `[agent][content]`: whether an agent can take the content again after throwing it away.
    pub(super) takes: Arc<[Vec<bool>; 2]>,
    pub(super) trashes: [bool; 2],
}

#[derive(Clone, Copy, Debug)]
pub(super) enum CacheSlot {
    At(usize, u64),
    /// No slot: without orders the cost to go is 0.
    Served,
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
        let goals = (0..kitchen.contents.len() * kitchen.contents.len()).map(|_| OnceLock::new()).collect();
        let (cache, decisions) = (ValueCache::new(CACHE_BITS).into(), DecisionCache::new(DECISION_BITS).into());
        let has = |agent: Agent, action| kitchen.buttons[agent.index()].iter().any(|button| button.action == action);
        let takes = |agent| {
            let has = |item| has(agent, ButtonAction::Take(ContentId(item as u8)));
            (0..kitchen.contents.len()).map(has).collect()
        };
        CostToGo {
            takes: Agent::BOTH.map(takes).into(),
            trashes: Agent::BOTH.map(|agent| has(agent, ButtonAction::Trash)),
            decisions_missed: 0,
            kitchen,
            ground: ground.into(),
            goals,
            cache,
            decisions,
            nexts: Vec::new(),
        }
    }

    /// Number of decisions since the start that were in no cache.
    pub fn decisions_missed(&self) -> u64 {
        self.decisions_missed
    }

    /// An evaluator for another thread, with the same caches and a counter of its own.
    pub(crate) fn beside(&self) -> CostToGo {
        CostToGo { decisions_missed: 0, ..self.clone() }
    }

    /// Adds what an evaluator counted that was used beside this one.
    pub(crate) fn add_counts(&mut self, of: &CostToGo) {
        self.decisions_missed += of.decisions_missed;
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
    pub(super) fn key_of_state(&self, state: State, targets: &mut [ContentId]) -> (usize, u64) {
        targets.sort_unstable();
        let slot = self.slot(targets);
        (slot, self.goal(slot).key_of_state(state) << SLOT_BITS | (slot << KIND_BITS) as u64)
    }

    pub(super) fn key(&self, slot: usize, goal: &ServingGoal, state: &CompactState) -> u64 {
        goal.key_of_classes(state) << SLOT_BITS | (slot << KIND_BITS) as u64
    }

    /// What is left of a goal and of a state, given by classes of contents, after one of the target dishes has been
    /// served; `None` if nothing is left to be served.
    pub(super) fn without(
        &self,
        goal: &ServingGoal,
        state: &CompactState,
        served: usize,
    ) -> Option<(usize, Arc<ServingGoal>, CompactState)> {
        let rest = goal.targets.iter().enumerate().filter(|(index, _)| *index != served);
        let rest: Vec<ContentId> = rest.map(|(_, &target)| target).collect();
        let slot = (!rest.is_empty()).then(|| self.slot(&rest))?;
        let rest = self.goal(slot).clone();
        let mut classes: CompactState = [0; 16];
        for location in self.ground.places() {
            classes[location] = rest.class_of[goal.content[usize::from(state[location])].index()];
        }
        Some((slot, rest, classes))
    }

    pub(super) fn slot(&self, targets: &[ContentId]) -> usize {
        let second = targets.get(1).map_or(0, |target| target.index());
        targets[0].index() * self.kitchen.contents.len() + second
    }

    /// The goal of the target dishes with this slot.
    #[inline]
    pub(super) fn goal(&self, slot: usize) -> &Arc<ServingGoal> {
        self.goals[slot].get_or_init(|| {
            let contents = self.kitchen.contents.len();
            let mut targets = vec![ContentId((slot / contents) as u8), ContentId((slot % contents) as u8)];
            targets.retain(|target| !target.is_empty());
            Arc::new(ServingGoal::new(&self.kitchen, &self.ground, targets))
        })
    }

    pub(super) fn classes(&self, goal: &ServingGoal, state: State) -> CompactState {
        let mut classes: CompactState = [0; 16];
        for location in self.ground.places() {
            classes[location] = goal.class_of[state.content(LocationId(location as u8)).index()];
        }
        classes
    }

    #[inline]
    pub(super) fn known(&self, fidelity: Fidelity, key: u64) -> Option<u32> {
        self.cache.get(key | fidelity as u64)
    }

    #[inline]
    pub(super) fn keep(&self, fidelity: Fidelity, key: u64, value: u32) -> u32 {
        let value = value.min(UNREACHABLE);
        self.cache.insert(key | fidelity as u64, value);
        value
    }

    #[inline]
    pub(super) fn kept(&self, state: State, recipes: &Recipes) -> CacheSlot {
        let (mut targets, count) = self.targets(state, recipes);
        self.kept_for(state, &mut targets[..count])
    }

    #[inline]
    pub(super) fn kept_for(&self, state: State, targets: &mut [ContentId]) -> CacheSlot {
        if targets.is_empty() {
            return CacheSlot::Served;
        }
        let (slot, key) = self.key_of_state(state, targets);
        CacheSlot::At(slot, key)
    }
}

// Caches of fixed size, which several threads can use at once. Values that were evicted are recomputed, so a full cache
// costs time but never correctness; nor does it matter which of two threads that meet keeps its value.

/// Largest number of buttons of one agent.
pub const MAX_BUTTONS: usize = 40;

/// Number of low bits of a cache key that tell the kind of value; all kinds of value of one state share a bucket.
pub(crate) const KIND_BITS: u32 = 2;

/// Number of bits of a cache key; an entry holds the key and the value of one byte.
pub(crate) const KEY_BITS: u32 = u64::BITS - u8::BITS;

/// Marks an empty cache entry, and is larger than any key. All entries are written at creation, so that the memory is
/// mapped before use.
const EMPTY: u64 = u64::MAX;

/// Bucket of eight cache entries; an entry is a key with the value in the lowest byte, or [`EMPTY`]. Key and value stand
/// in one word, so that no thread reads half of an entry.
///
/// A bucket has the size of a cache line. It is not aligned to one: that made no look-up faster, and glibc's allocator
/// hardly ever uses a freed block again for an aligned one of the same size, so that every copy of a cache made the heap
/// larger.
#[derive(Debug)]
struct Bucket([AtomicU64; 8]);

/// Cache of one-byte values by keys of [`KEY_BITS`] bits, not all of them set, in buckets of eight entries.
#[derive(Debug)]
pub struct ValueCache {
    buckets: Vec<Bucket>,
    mask: u64,
    /// Counter that selects the cache entry to evict.
    turn: AtomicUsize,
}

impl ValueCache {
    pub fn new(bits: u32) -> ValueCache {
        let buckets = 1usize << (bits - 3);
        let bucket = || Bucket(std::array::from_fn(|_| AtomicU64::new(EMPTY)));
        ValueCache {
            buckets: (0..buckets).map(|_| bucket()).collect(),
            mask: buckets as u64 - 1,
            turn: AtomicUsize::new(0),
        }
    }

    #[inline]
    fn bucket(&self, key: u64) -> &[AtomicU64; 8] {
        &self.buckets[(mix(key >> KIND_BITS) & self.mask) as usize].0
    }

    /// Prefetches the bucket of a key from memory. Callers with several keys prefetch all of them first; the result
    /// must be passed to a black box so that the compiler keeps the load.
    #[inline]
    pub fn fetch(&self, key: u64) -> u64 {
        self.bucket(key)[0].load(Ordering::Relaxed)
    }

    #[inline]
    pub fn get(&self, key: u64) -> Option<u32> {
        let entries = self.bucket(key).iter().map(|entry| entry.load(Ordering::Relaxed));
        let entry = entries.into_iter().find(|entry| entry >> 8 == key)?;
        Some((entry & 0xff) as u32)
    }

    /// Caches a value under this key, which may evict another value.
    pub fn insert(&self, key: u64, value: u32) {
        let bucket = self.bucket(key);
        let has =
            |wanted: fn(u64, u64) -> bool| bucket.iter().position(|entry| wanted(entry.load(Ordering::Relaxed), key));
        let known = has(|entry, key| entry >> 8 == key);
        let place = known.or_else(|| has(|entry, _| entry == EMPTY)).unwrap_or_else(|| {
            let turn = (self.turn.load(Ordering::Relaxed) + 1) % 8;
            self.turn.store(turn, Ordering::Relaxed);
            turn
        });
        bucket[place].store(key << 8 | u64::from(value.min(0xff) as u8), Ordering::Relaxed);
    }
}

/// Costs to go for one decision: of the present state, and after each button of an agent.
#[derive(Clone, Copy, Debug)]
pub struct DecisionCosts {
    /// Cost to go of the present state.
    pub here: u8,
    /// Cost to go after each button; equal to `here` where the button's press has no effect.
    pub after: [u8; MAX_BUTTONS],
}

/// Words of a decision in a line of the cache: the state, and the costs after each button.
const STATE_WORDS: usize = 2;
const AFTER_WORDS: usize = MAX_BUTTONS / 8;

/// A line of 64 bytes of the cache of decisions. `head` has, from the lowest bit, `here` (8 bits), the hash of the request
/// (32 bits; all set in an empty line), whether a thread is writing (1 bit), and the number of writings (23 bits): a
/// sequence lock (Boehm 2012, "Can seqlocks get along with programming language memory models?").
#[derive(Debug)]
struct DecisionLine {
    head: AtomicU64,
    state: [AtomicU64; STATE_WORDS],
    after: [AtomicU64; AFTER_WORDS],
}

const WRITING: u64 = 1 << 40;

fn zeros<const N: usize>() -> [AtomicU64; N] {
    std::array::from_fn(|_| AtomicU64::new(0))
}

impl DecisionLine {
    fn empty() -> DecisionLine {
        DecisionLine { head: AtomicU64::new(u64::from(u32::MAX) << 8), state: zeros(), after: zeros() }
    }

    #[inline]
    fn get(&self, state: [u64; STATE_WORDS], question: u32) -> Option<DecisionCosts> {
        let head = self.head.load(Ordering::Acquire);
        if (head >> 8) as u32 != question || head & WRITING != 0 {
            return None;
        }
        if self.state.iter().zip(state).any(|(word, state)| word.load(Ordering::Relaxed) != state) {
            return None;
        }
        let mut after = [0; MAX_BUTTONS];
        for (bytes, word) in after.chunks_exact_mut(8).zip(&self.after) {
            bytes.copy_from_slice(&word.load(Ordering::Relaxed).to_le_bytes());
        }
        fence(Ordering::Acquire);
        (self.head.load(Ordering::Relaxed) == head).then_some(DecisionCosts { here: head as u8, after })
    }

    /// Keeps a decision, unless another thread is writing.
    fn set(&self, state: [u64; STATE_WORDS], question: u32, costs: &DecisionCosts) {
        let head = self.head.load(Ordering::Relaxed);
        let locked = head | WRITING;
        if head & WRITING != 0
            || self.head.compare_exchange(head, locked, Ordering::Acquire, Ordering::Relaxed).is_err()
        {
            return;
        }
        fence(Ordering::Release);
        for (word, state) in self.state.iter().zip(state) {
            word.store(state, Ordering::Relaxed);
        }
        for (word, bytes) in self.after.iter().zip(costs.after.chunks_exact(8)) {
            word.store(bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte)), Ordering::Relaxed);
        }
        let written = (locked >> 41).wrapping_add(1) << 41;
        self.head.store(written | u64::from(question) << 8 | u64::from(costs.here), Ordering::Release);
    }
}

/// Cache of decisions by state and request (orders, fidelity, agent); a new entry replaces the old one in its line.
#[derive(Debug)]
pub struct DecisionCache {
    lines: Vec<DecisionLine>,
    mask: u64,
}

impl DecisionCache {
    pub fn new(bits: u32) -> DecisionCache {
        DecisionCache { lines: (0..1 << bits).map(|_| DecisionLine::empty()).collect(), mask: (1 << bits) - 1 }
    }

    #[inline]
    fn line(&self, [low, high]: [u64; STATE_WORDS], question: u32) -> &DecisionLine {
        &self.lines[(mix(low ^ mix(high ^ u64::from(question) << 32)) & self.mask) as usize]
    }

    /// Prefetches the line of a decision; the result must be passed to a black box so that the compiler keeps the load.
    #[inline]
    pub fn fetch(&self, state: State, question: u32) -> u64 {
        self.line(words(state), question).head.load(Ordering::Relaxed)
    }

    #[inline]
    pub fn get(&self, state: State, question: u32) -> Option<DecisionCosts> {
        let state = words(state);
        self.line(state, question).get(state, question)
    }

    pub fn set(&self, state: State, question: u32, costs: &DecisionCosts) {
        let state = words(state);
        self.line(state, question).set(state, question, costs);
    }
}

#[inline]
fn words(state: State) -> [u64; STATE_WORDS] {
    let bits = state.bits();
    [bits as u64, (bits >> 64) as u64]
}
