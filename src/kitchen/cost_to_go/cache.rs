//! Caches of fixed size. Whatever is forgotten is computed again, so a full cache costs time and never correctness.

use crate::base::rng::mix;
use crate::kitchen::State;

/// At most so many buttons of one agent.
pub const MAX_BUTTONS: usize = 40;

/// The lowest bits of a key tell kinds of values of the same state apart, which share a bucket.
pub const KIND_BITS: u32 = 2;

/// No key is as high. It is written everywhere at first, so that the memory is there when a decision has to be quick.
const EMPTY: u64 = u64::MAX;

/// Keys, with the value in the lowest byte; or [`EMPTY`].
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Bucket([u64; 8]);

/// Values of one byte by keys below 2^56 - 1, in buckets of eight, one cache line each.
#[derive(Clone, Debug)]
pub struct ValueCache {
    buckets: Vec<Bucket>,
    mask: u64,
    /// Which entry of a full bucket goes next.
    turn: usize,
}

impl ValueCache {
    /// A cache of 2^`bits` values.
    pub fn new(bits: u32) -> ValueCache {
        let buckets = 1usize << (bits - 3);
        ValueCache { buckets: vec![Bucket([EMPTY; 8]); buckets], mask: buckets as u64 - 1, turn: 0 }
    }

    #[inline]
    fn bucket(&self, key: u64) -> usize {
        (mix(key >> KIND_BITS) & self.mask) as usize
    }

    /// Has the memory fetch what is kept under this key. Whoever asks for several keys does this for all of them first, and
    /// waits once; what comes back is to be kept from the optimizer.
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

/// The costs of one decision: of a state, and of those that each button of an agent leads to.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct DecisionCosts {
    state: State,
    /// Targets and agent; `u32::MAX`: an empty entry.
    question: u32,
    /// Presses until all orders are served if nothing is pressed now.
    pub here: u8,
    /// The same after a press of each button, without that press; that of `here` where the press has no effect.
    pub after: [u8; MAX_BUTTONS],
}

/// Decisions by state and question, one cache line each; the newest of those that share a line stays.
#[derive(Clone, Debug)]
pub struct DecisionCache {
    lines: Vec<DecisionCosts>,
    mask: u64,
}

impl DecisionCache {
    /// Room for 2^`bits` decisions.
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

    /// Has the memory fetch the line of a decision; what comes back is to be kept from the optimizer.
    #[inline]
    pub fn fetch(&self, state: State, question: u32) -> u32 {
        self.lines[self.index(state, question)].question
    }

    /// Where the decision belongs, and whether it is there.
    #[inline]
    pub fn find(&self, state: State, question: u32) -> (usize, bool) {
        let index = self.index(state, question);
        let line = &self.lines[index];
        (index, line.question == question && line.state == state)
    }

    #[inline]
    pub fn get(&self, index: usize) -> &DecisionCosts {
        &self.lines[index]
    }

    pub fn set(&mut self, index: usize, state: State, question: u32, here: u8, after: [u8; MAX_BUTTONS]) {
        self.lines[index] = DecisionCosts { state, question, here, after };
    }
}
