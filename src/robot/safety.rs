//! The safety modes of the arm, and the force that stops it (power and force limiting, ISO/TS 15066, 5.5.5).

use serde::{Deserialize, Serialize};

/// Contact with more force than this stops the arm at normal speed, in newtons.
pub const STOP_N: f64 = 60.0;
/// The same where a hand is near and the arm moves slowly, in newtons: less force is felt there.
pub const STOP_REDUCED_N: f64 = 20.0;
/// A hand nearer than this slows the arm, in metres.
pub const SLOWS_M: f64 = 0.25;
/// The controller's safety modes, as the maker names them; those that the program has a use for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SafetyMode {
    /// Nobody is near: full speed.
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
