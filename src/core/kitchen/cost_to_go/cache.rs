//! Caches of fixed size for costs to go. Values that were evicted are recomputed, so a full cache costs time but never
//! correctness.

use crate::base::rng::mix;
use crate::kitchen::State;

/// Largest number of buttons of one agent.
pub const MAX_BUTTONS: usize = 40;

/// Number of low bits of a cache key that tell the kind of value; all kinds of value of one state share a bucket.
pub const KIND_BITS: u32 = 2;

/// Number of bits of a cache key; an entry holds the key and the value of one byte.
pub const KEY_BITS: u32 = u64::BITS - u8::BITS;

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
    /// A cache with room for 2^`bits` values.
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

    /// The cached value of this key; `None` if the cache does not hold it.
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
    /// A cache with room for 2^`bits` decisions.
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

    /// Replaces the cache entry at this index.
    pub fn set(&mut self, index: usize, state: State, question: u32, here: u8, after: [u8; MAX_BUTTONS]) {
        self.lines[index] = DecisionCosts { state, question, here, after };
    }
}
