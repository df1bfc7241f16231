//! The safety modes of the robot arm, and the contact force that stops it (power and force limiting, ISO/TS 15066,
//! 5.5.5).

use serde::{Deserialize, Serialize};

/// Contact force above which the arm stops at normal speed, in newtons.
pub const STOP_N: f64 = 60.0;
/// Contact force above which the arm stops while it moves slowly near a hand, in newtons: the contacts of a slow arm
/// are weaker.
pub const STOP_REDUCED_N: f64 = 20.0;
/// Distance between the human's hand and the arm below which the arm moves slowly, in metres.
pub const SLOWS_M: f64 = 0.25;
/// Safety modes of the robot arm's controller, with the names of the manufacturer (Universal Robots); only the modes
/// that the program uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SafetyMode {
    /// Nobody is near the arm: the arm moves at full speed.
    #[default]
    Normal,
    /// A hand is near the arm: the arm moves slowly.
    Reduced,
    /// The arm stopped after a contact, and stays where it is until the wizard releases it.
    ProtectiveStop,
    /// A hand is in the way of the arm: the arm stands until the hand is gone (speed and separation monitoring).
    Safeguard,
    /// The wizard stopped the arm.
    EmergencyStop,
    /// A joint of the arm does not follow its command.
    Fault,
}

impl SafetyMode {
    /// The safety mode in words, as the manufacturer writes it.
    pub fn name(self) -> &'static str {
        match self {
            SafetyMode::Normal => "NORMAL",
            SafetyMode::Reduced => "REDUCED",
            SafetyMode::ProtectiveStop => "PROTECTIVE STOP",
            SafetyMode::Safeguard => "SAFEGUARD STOP",
            SafetyMode::EmergencyStop => "EMERGENCY STOP",
            SafetyMode::Fault => "FAULT",
        }
    }

    /// Whether the arm stays stopped until the wizard releases it.
    pub fn is_stopped(self) -> bool {
        self.has_stopped_itself() || self == SafetyMode::EmergencyStop
    }

    /// Whether the arm stopped by itself, without the wizard.
    pub fn has_stopped_itself(self) -> bool {
        matches!(self, SafetyMode::ProtectiveStop | SafetyMode::Fault)
    }

    /// Contact force above which the arm stops in this safety mode, in newtons.
    pub fn threshold_n(self) -> f64 {
        match self {
            SafetyMode::Normal => STOP_N,
            _ => STOP_REDUCED_N,
        }
    }
}
