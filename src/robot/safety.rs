//! What keeps the arm from hurting people: it slows near a hand (speed and separation monitoring, ISO/TS 15066, 5.5.4), and
//! it stops when it feels one (power and force limiting, 5.5.5).

use serde::{Deserialize, Serialize};

/// Contact with more force than this stops the arm, in newtons; less where it moves slowly, because less is felt there.
pub const STOP_N: f64 = 60.0;
pub const STOP_REDUCED_N: f64 = 20.0;
/// A hand nearer than this slows the arm, in metres, and one nearer than that lets it come no nearer.
pub const SLOWS_M: f64 = 0.25;
pub const WAITS_M: f64 = 0.03;
/// At the first of these distances the tip may be so fast, in metres a second; in between less, in proportion.
const SLOWED_M_S: f64 = 0.8;
/// Slower than this it does not come nearer, but waits: in metres a second.
const CREEPS_M_S: f64 = 0.02;
/// Away from a hand it may always move so fast.
const LEAVES_M_S: f64 = 0.1;
/// A hand is away again a little further out, so that the mode does not flicker, in metres.
pub const MARGIN_M: f64 = 0.03;

/// The controller's safety modes, as the maker names them; those that the program has a use for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SafetyMode {
    #[default]
    Normal,
    /// A hand is near: slower.
    Reduced,
    /// The arm felt somebody, and stays where it is until the wizard lets it go on.
    ProtectiveStop,
    /// A hand is in the way: it waits until the hand is gone.
    Safeguard,
    /// The wizard stopped it.
    EmergencyStop,
    /// A joint does not do what it is told to.
    Fault,
}

impl SafetyMode {
    /// In words, as the maker writes it.
    pub fn name(self) -> &'static str {
        match self {
            SafetyMode::Normal => "NORMAL",
            SafetyMode::Reduced => "REDUCED",
            SafetyMode::ProtectiveStop => "PROTECTIVE STOP",
            SafetyMode::Safeguard => "SAFEGUARD",
            SafetyMode::EmergencyStop => "EMERGENCY STOP",
            SafetyMode::Fault => "FAULT",
        }
    }

    /// Whether it takes the wizard's key to go on.
    pub fn is_stopped(self) -> bool {
        self.has_stopped_itself() || self == SafetyMode::EmergencyStop
    }

    /// Whether the arm stopped without the wizard.
    pub fn has_stopped_itself(self) -> bool {
        matches!(self, SafetyMode::ProtectiveStop | SafetyMode::Fault)
    }

    /// With how much force the arm stops.
    pub fn threshold_n(self) -> f64 {
        match self {
            SafetyMode::Normal => STOP_N,
            _ => STOP_REDUCED_N,
        }
    }
}

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
