//! The robot: its task policy, its recorded activity, its safety modes. The robot arms that carry the policy out are in
//! `tomcom_arm`.

pub mod policy;

use serde::{Deserialize, Serialize};

use crate::base::time::SessionTime;
use crate::kitchen::ButtonId;

/// Why the robot abandoned a press that it had begun or planned.
#[allow(missing_docs, reason = "`words` says each")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AbortReason {
    NoLongerUseful,
    Stopped,
    Skipped,
    Driven,
    OutOfReach,
    Singular,
    Obstructed,
    HandInTheWay,
    NoClick,
    Contact,
    Fault,
}

impl AbortReason {
    /// Every reason for an abandoned press, in the order in which tables count them.
    pub const ALL: [AbortReason; 11] = [
        AbortReason::NoLongerUseful,
        AbortReason::Stopped,
        AbortReason::Skipped,
        AbortReason::Driven,
        AbortReason::OutOfReach,
        AbortReason::Singular,
        AbortReason::Obstructed,
        AbortReason::HandInTheWay,
        AbortReason::NoClick,
        AbortReason::Contact,
        AbortReason::Fault,
    ];

    /// Whether only an arm that touches buttons, simulated or real, can abandon a press for this reason.
    pub fn is_of_physics(self) -> bool {
        use AbortReason::{Driven, NoLongerUseful, Skipped, Stopped};
        !matches!(self, NoLongerUseful | Stopped | Skipped | Driven)
    }

    /// The reason for abandoning the press in words, after "gives up the press:".
    pub fn words(self) -> &'static str {
        match self {
            AbortReason::NoLongerUseful => "no longer useful",
            AbortReason::Stopped => "stopped",
            AbortReason::Skipped => "skipped",
            AbortReason::Driven => "the wizard chose another press",
            AbortReason::OutOfReach => "out of reach",
            AbortReason::Singular => "its arm would be stretched",
            AbortReason::Obstructed => "something stands in the way",
            AbortReason::HandInTheWay => "hand in the way",
            AbortReason::NoClick => "the button does not click",
            AbortReason::Contact => "somebody touched the arm",
            AbortReason::Fault => "a joint is at fault",
        }
    }
}

/// Why the robot is idle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleReason {
    /// No order is shown, so the robot has nothing to do.
    NoOrder,
    /// The robot leaves the next press to the human: no press of its own reduces the cost to go and, if the human is
    /// passive, every way needs the human next.
    HumanTurn,
    /// The only useful press of the robot is left out for the moment: it failed, or the wizard skipped it.
    Skipped,
}

/// An activity of the robot, as it is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotEvent {
    /// The robot begins a press: its arm starts to move to the button.
    Intend {
        /// The button that the robot is going to press.
        button: ButtonId,
        /// The session time at which the arm will touch the button.
        until: SessionTime,
        /// Whether the press is part of the robot's initiative, since the human is passive.
        initiative: bool,
    },
    /// The robot presses the button to which it was moving.
    Press(ButtonId),
    /// The robot abandons the press of this button, for this reason.
    Abort(ButtonId, AbortReason),
    /// The robot becomes idle, or stays idle for another reason.
    Idle {
        /// Why the robot is idle.
        reason: IdleReason,
        /// The human's presses for one of which the robot waits, as a bit set of the human's buttons.
        waits_for: u64,
    },
    /// A sample of the arm's motion.
    Move(ArmSample),
    /// The safety mode of the arm changed.
    Safety {
        /// The safety mode from now on.
        mode: SafetyMode,
        /// The contact force in newtons that caused the change of the safety mode; `None` if no contact caused the
        /// change.
        force_n: Option<f64>,
        /// The number of the faulty joint that caused the change of the safety mode, where 1 is the first joint; `None`
        /// if no joint caused the change.
        joint: Option<u8>,
    },
    /// Somebody touched the robot's arm.
    Touched {
        /// The force of the contact in newtons.
        force_n: f64,
    },
}

/// The number of joints of the robot arm.
pub const JOINTS: usize = 6;
/// Names of the joints in the arm's URDF, from the base on.
pub const JOINT_NAMES: [&str; JOINTS] = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
/// Joint angles of the robot arm, from the base on, in radians.
pub type JointAngles = [f64; JOINTS];

/// Phase of the arm's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmPhase {
    /// The arm rests above the buttons.
    #[default]
    Rests,
    /// The arm comes up from a button.
    Retracts,
    /// The arm moves above the buttons to its target.
    Travels,
    /// The arm stands above its button, ready to press.
    Hovers,
    /// The arm pushes its button down.
    Presses,
}

/// A sample of the robot arm's motion, as it is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmSample {
    /// The phase of the arm's motion.
    pub phase: ArmPhase,
    /// Joint angles in radians, from the base on, rounded to a ten thousandth.
    pub joints: JointAngles,
    /// The greatest contact force since the previous sample, on a button or a person, in newtons.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub force_n: f64,
    /// The centre of the human's hand, in the frame of the robot arm's base, in metres; `None` where nothing measures it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand_m: Option<[f64; 3]>,
    /// The distance between the human's hand and the arm, in metres; `None` where nothing measures it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand_away_m: Option<f64>,
}

fn is_nothing(force_n: &f64) -> bool {
    *force_n == 0.0
}

/// How far a real arm is on its way to taking orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmStage {
    /// There is no connection to its controller.
    Lost,
    /// It has no power, or its brakes are closed: the wizard's confirmation switches it on.
    Off,
    /// Its power comes on, its brakes open, or its program starts.
    Starts,
    /// It was never above its buttons: the wizard's confirmation begins the dry run.
    Untried,
    /// It goes above each of its buttons, slowly.
    DryRun,
    /// It was above each of its buttons: the wizard's confirmation lets it press.
    Tried,
    /// It takes orders.
    Ready,
    /// Its program does not run: the wizard's confirmation starts it again.
    Stopped,
}

impl ArmStage {
    /// What the wizard's confirmation lets the arm do in this stage, in words; `None` where there is nothing to confirm.
    pub fn asks(self) -> Option<&'static str> {
        match self {
            ArmStage::Off => Some("switches the arm on and opens its brakes: nobody is near the arm"),
            ArmStage::Untried => {
                Some("lets the arm go above each button at a tenth of its speed: nobody is near the arm")
            }
            ArmStage::Tried => Some("confirms that the arm went above each button, and touched nothing"),
            ArmStage::Stopped => Some("unlocks the arm and starts its program again: nobody is near the arm"),
            ArmStage::Lost | ArmStage::Starts | ArmStage::DryRun | ArmStage::Ready => None,
        }
    }
}

/// Contact force above which the arm stops at normal speed, in newtons (power and force limiting, ISO/TS 15066, 5.5.5).
pub(crate) const STOP_N: f64 = 60.0;
/// Contact force above which the arm stops while it moves slowly near a hand, in newtons: the contacts of a slow arm
/// are weaker.
pub(crate) const STOP_REDUCED_N: f64 = 20.0;
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
