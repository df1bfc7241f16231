//! Caches of fixed size. Whatever is forgotten is computed again, so a full cache costs time and never correctness.

use crate::base::rng::mix;
use crate::kitchen::State;

/// At most so many buttons of one agent.
pub const MAX_BUTTONS: usize = 40;

/// The lowest bits of a key tell kinds of values of the same state apart, which share a bucket.
pub const KIND_BITS: u32 = 2;

/// Values of one byte by keys below 2^56, in buckets of eight, one cache line each.
#[derive(Clone, Debug)]
pub struct Cache {
    /// Key plus one, and the value in the lowest byte; 0 is an empty entry.
    buckets: Vec<[u64; 8]>,
    mask: u64,
    /// Which entry of a full bucket goes next.
    turn: usize,
}

impl Cache {
    /// A cache of 2^`bits` values.
    pub fn new(bits: u32) -> Cache {
        let buckets = 1usize << (bits - 3);
        Cache { buckets: vec![[0; 8]; buckets], mask: buckets as u64 - 1, turn: 0 }
    }

    #[inline]
    fn bucket(&self, key: u64) -> usize {
        (mix(key >> KIND_BITS) & self.mask) as usize
    }

    #[inline]
    pub fn get(&self, key: u64) -> Option<u32> {
        let bucket = &self.buckets[self.bucket(key)];
        let entry = bucket.iter().find(|&&entry| entry >> 8 == key + 1)?;
        Some((entry & 0xff) as u32)
    }

    pub fn insert(&mut self, key: u64, value: u32) {
        let bucket = self.bucket(key);
        let bucket = &mut self.buckets[bucket];
        let known = bucket.iter().position(|&entry| entry >> 8 == key + 1);
        let place = known.or_else(|| bucket.iter().position(|&entry| entry == 0)).unwrap_or_else(|| {
            self.turn = (self.turn + 1) % 8;
            self.turn
        });
        bucket[place] = (key + 1) << 8 | u64::from(value.min(0xff) as u8);
    }
}

/// The costs of one decision: of a state, and of those that each button of an agent leads to.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Decision {
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
pub struct Decisions {
    lines: Vec<Decision>,
    mask: u64,
}

impl Decisions {
    /// Room for 2^`bits` decisions.
    pub fn new(bits: u32) -> Decisions {
        let empty = Decision { state: State::default(), question: u32::MAX, here: 0, after: [0; MAX_BUTTONS] };
        Decisions { lines: vec![empty; 1 << bits], mask: (1 << bits) - 1 }
    }

    /// Where the decision belongs, and whether it is there.
    #[inline]
    pub fn find(&self, state: State, question: u32) -> (usize, bool) {
        let bits = state.bits();
        let hash = mix(bits as u64 ^ mix((bits >> 64) as u64 ^ u64::from(question) << 32));
        let index = (hash & self.mask) as usize;
        let line = &self.lines[index];
        (index, line.question == question && line.state == state)
    }

    #[inline]
    pub fn get(&self, index: usize) -> &Decision {
        &self.lines[index]
    }

    pub fn set(&mut self, index: usize, state: State, question: u32, here: u8, after: [u8; MAX_BUTTONS]) {
        self.lines[index] = Decision { state, question, here, after };
    }
}
