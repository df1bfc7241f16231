//! Random numbers that lie evenly over all rollouts: of what matters most, what comes first.
//!
//! Point k is the fraction of k times a vector of irrational numbers, from a random shift on (a Kronecker sequence, by powers
//! of a generalised golden ratio). Every point by itself is uniform, so means stay unbiased; any number of the first ones
//! lies more evenly than independent draws, so means come out nearer.

use rand::RngExt;

use crate::base::rng::Stream;

/// Numbers of a decision: the decision itself, the robot's choice before it, whether the eye is drawn to its press.
pub const PER_DECISION: usize = 3;
/// Decisions that have such numbers.
const DECISIONS: usize = 2;
/// When the human decides first, whether it sees what has just changed, and the first decisions.
const NUMBERS: usize = 2 + PER_DECISION * DECISIONS;
/// The root above 1 of x^(NUMBERS + 1) = x + 1.
const RATIO: f64 = 1.085_070_245_491_450_8;

/// Evenly spread points of the unit cube.
#[derive(Clone, Debug)]
pub struct Lattice {
    shift: [f64; NUMBERS],
}

impl Lattice {
    /// With a random shift.
    pub fn shifted(random: &mut Stream) -> Lattice {
        Lattice { shift: std::array::from_fn(|_| random.random()) }
    }

    /// Point `number`, each coordinate from 0 to below 1.
    pub fn point(&self, number: usize) -> [f64; NUMBERS] {
        let mut step = 1.0;
        self.shift.map(|shift| {
            step /= RATIO;
            (shift + number as f64 * step).fract()
        })
    }
}
