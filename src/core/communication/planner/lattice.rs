//! Quasi-random numbers for the first random decisions of each planner rollout, which matter most.
//!
//! Point k is the fractional part of a random shift plus k times a vector of irrational numbers (a Kronecker sequence
//! with powers of a generalised golden ratio). Every single point is uniform, so means are unbiased. The first n points
//! are spread more evenly than independent draws, so means have a smaller error.

use rand::RngExt;

use crate::base::rng::Stream;

/// Quasi-random numbers per decision of the human: one for the decision, one for the robot's choice before it, and one
/// for whether the robot's press attracts the gaze.
pub const PER_DECISION: usize = 3;
/// Number of decisions in a rollout that use quasi-random numbers.
const DECISIONS: usize = 2;
/// Dimension of the quasi-random points: one number for the time of the first decision, one for whether the latest
/// change is seen, and the numbers of the first decisions.
const NUMBERS: usize = 2 + PER_DECISION * DECISIONS;
/// The generalised golden ratio: the root above 1 of x^(NUMBERS + 1) = x + 1.
const RATIO: f64 = 1.085_070_245_491_450_8;

/// Quasi-random points of the unit cube, one point per rollout.
#[derive(Clone, Debug)]
pub struct QuasiRandomLattice {
    shift: [f64; NUMBERS],
}

impl QuasiRandomLattice {
    /// The quasi-random points with a random shift.
    pub fn shifted(random: &mut Stream) -> QuasiRandomLattice {
        QuasiRandomLattice { shift: std::array::from_fn(|_| random.random()) }
    }

    /// Quasi-random point with this number, each coordinate from 0 to below 1.
    pub fn point(&self, number: usize) -> [f64; NUMBERS] {
        let mut step = 1.0;
        self.shift.map(|shift| {
            step /= RATIO;
            (shift + number as f64 * step).fract()
        })
    }
}
