//! A cache of fixed size: buckets of eight entries, one cache line each; the oldest entry of a full bucket goes.

use crate::base::rng::mix;

/// Keys below 2^56 with values of one byte.
#[derive(Clone, Debug)]
pub struct Cache {
    /// key << 8 | value + 0; 0 is an empty entry (value bytes are stored plus one).
    buckets: Vec<Bucket>,
    mask: u64,
    turn: u8,
}

#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Bucket([u64; 8]);

impl Cache {
    /// A cache of 2^`bits` entries.
    pub fn new(bits: u32) -> Cache {
        let buckets = 1usize << (bits - 3);
        Cache { buckets: vec![Bucket([0; 8]); buckets], mask: buckets as u64 - 1, turn: 0 }
    }

    #[inline]
    pub fn get(&self, key: u64) -> Option<u8> {
        let bucket = &self.buckets[(mix(key) & self.mask) as usize];
        let entry = bucket.0.iter().find(|&&entry| entry >> 8 == key + 1)?;
        Some(*entry as u8)
    }

    pub fn insert(&mut self, key: u64, value: u8) {
        let bucket = &mut self.buckets[(mix(key) & self.mask) as usize];
        let place = bucket.0.iter().position(|&entry| entry == 0).unwrap_or_else(|| {
            self.turn = self.turn.wrapping_add(1);
            usize::from(self.turn % 8)
        });
        bucket.0[place] = (key + 1) << 8 | u64::from(value);
    }
}
