//! Named random streams: every use of randomness draws from a stream of its own, which has a name and a seed. One part
//! of the program therefore never changes the draws of another part, and trial k does not depend on the number of
//! trials.

use rand::{RngExt, SeedableRng};
pub use rand_chacha::ChaCha8Rng as Stream;

/// The random stream called `name` of the run with this `seed`; `index` tells trials, rollouts or participants apart.
pub fn stream(seed: u64, name: &str, index: u64) -> Stream {
    let mut key = mix(seed ^ 0x746f_6d63_6f6d);
    for byte in name.bytes() {
        key = mix(key ^ u64::from(byte));
    }
    Stream::seed_from_u64(mix(key ^ mix(index)))
}

/// Shuffles a list, so that all orders are equally likely (Fisher and Yates). The draws are part of what a seed means:
/// another order of drawing would change the recordings of every seed.
pub fn shuffle<T>(list: &mut [T], random: &mut Stream) {
    for last in (1..list.len()).rev() {
        list.swap(last, random.random_range(0..=last));
    }
}

/// The random seed for everything that depends on this trial of the run alone.
pub fn of_trial(seed: u64, trial: u64) -> u64 {
    mix(seed ^ mix(trial))
}

/// Mixes a 64-bit number: the finaliser of SplitMix64 (Steele, Lea and Flood 2014), a bijection that spreads every bit.
pub fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
