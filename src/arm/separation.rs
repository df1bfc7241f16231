//! Speed and separation monitoring (ISO/TS 15066, 5.5.4): the arm slows near a hand, and waits for one in its way.

use crate::robot::safety::{SLOWS_M, SafetyMode};

/// A hand nearer than this lets the arm come no nearer, in metres.
const WAITS_M: f64 = 0.03;
/// At the first of these distances the tip may be so fast, in metres a second; in between less, in proportion.
const SLOWED_M_S: f64 = 0.8;
/// Slower than this it does not come nearer, but waits: in metres a second.
const CREEPS_M_S: f64 = 0.02;
/// Away from a hand it may always move so fast.
const LEAVES_M_S: f64 = 0.1;
/// A hand is away again a little further out, so that the mode does not flicker, in metres.
pub const MARGIN_M: f64 = 0.03;

/// How fast the tip may be with a hand at this distance of the arm, which comes nearer or not (metres a second).
pub fn speed_limit(distance_m: f64, comes_nearer: bool) -> f64 {
    let by_distance = match distance_m {
        far if far >= SLOWS_M => f64::INFINITY,
        near => SLOWED_M_S * (near - WAITS_M).max(0.0) / (SLOWS_M - WAITS_M),
    };
    match comes_nearer {
        true if by_distance < CREEPS_M_S => 0.0,
        true => by_distance,
        false => by_distance.max(LEAVES_M_S),
    }
}

/// The mode with a hand at this distance, for an arm that is not stopped; it waits if it may not move at all.
pub fn mode_near(before: SafetyMode, distance_m: f64, waits: bool) -> SafetyMode {
    let is_out = distance_m >= SLOWS_M + if before == SafetyMode::Normal { 0.0 } else { MARGIN_M };
    match (waits, is_out) {
        (true, _) => SafetyMode::Safeguard,
        (false, true) => SafetyMode::Normal,
        (false, false) => SafetyMode::Reduced,
    }
}
