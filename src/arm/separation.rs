//! Speed and separation monitoring (ISO/TS 15066, 5.5.4): the robot arm slows down near a hand and waits for a hand in
//! its way.

use tomcom_core::robot::{SLOWS_M, SafetyMode};

/// Protective separation distance in metres: the arm does not approach a hand that is nearer than this.
const WAITS_M: f64 = 0.03;
/// Highest speed of the arm's tip in m/s at the distance at which the arm begins to slow down; nearer to the hand, the
/// limit falls in proportion to the distance.
const SLOWED_M_S: f64 = 0.8;
/// Speeds of the arm's tip below this limit, in m/s, count as waiting.
const CREEPS_M_S: f64 = 0.02;
/// Speed limit of the arm's tip for motion away from a hand, in m/s.
const LEAVES_M_S: f64 = 0.1;
/// Hysteresis of the distances between hand and arm in metres, so that the safety mode does not flicker.
pub const MARGIN_M: f64 = 0.03;

/// The speed limit of the arm's tip in m/s for a hand at this distance, depending on whether the arm approaches the
/// hand.
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

/// The safety mode for a hand at this distance while the arm is not stopped. `waits` says whether the arm must not move
/// at all.
pub fn mode_near(before: SafetyMode, distance_m: f64, waits: bool) -> SafetyMode {
    let is_out = distance_m >= SLOWS_M + if before == SafetyMode::Normal { 0.0 } else { MARGIN_M };
    match (waits, is_out) {
        (true, _) => SafetyMode::Safeguard,
        (false, true) => SafetyMode::Normal,
        (false, false) => SafetyMode::Reduced,
    }
}
