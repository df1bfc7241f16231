//! The robot: its task policy, and what is recorded of its arm. The arms that carry the policy out are in `crate::arm`.

pub mod moment;
pub mod policy;
pub mod safety;

use serde::{Deserialize, Serialize};

use self::moment::ArmSample;
use self::safety::SafetyMode;
use crate::base::time::SessionTime;
use crate::kitchen::ButtonId;

/// Why the robot gave up a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AbortReason {
    /// When the arm was about to touch the button, pressing it was no longer useful.
    NoLongerUseful,
    /// The wizard stopped the robot.
    Stopped,
    /// The wizard skipped this press.
    Skipped,
    /// The wizard chose another press.
    Driven,
    /// The button is out of the arm's reach.
    OutOfReach,
    /// The pose at the button is singular.
    Singular,
    /// Every path to the button is blocked by an obstacle or by the arm itself.
    Obstructed,
    /// A hand was in the way for too long.
    HandInTheWay,
    /// The button was pressed down and did not click.
    NoClick,
    /// The arm measured a contact force above the threshold and stopped.
    Contact,
    /// A joint did not follow its command, and the arm stopped.
    Fault,
}

impl AbortReason {
    /// Every reason, in the order in which tables count them.
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

    /// Whether only the simulated arm can have this reason.
    pub fn is_of_physics(self) -> bool {
        use AbortReason::{Driven, NoLongerUseful, Skipped, Stopped};
        !matches!(self, NoLongerUseful | Stopped | Skipped | Driven)
    }

    /// In words, after "gives up the press:".
    pub fn words(self) -> &'static str {
        match self {
            AbortReason::NoLongerUseful => "no longer useful",
            AbortReason::Stopped => "stopped",
            AbortReason::Skipped => "skipped",
            AbortReason::Driven => "the wizard chose another press",
            AbortReason::OutOfReach => "out of reach",
            AbortReason::Singular => "its arm would be stretched",
            AbortReason::Obstructed => "something stands in the way",
            AbortReason::HandInTheWay => "a hand is in the way",
            AbortReason::NoClick => "the button does not click",
            AbortReason::Contact => "somebody touched the arm",
            AbortReason::Fault => "a joint is at fault",
        }
    }
}

/// Why the robot does nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleReason {
    /// No order is present.
    NoOrder,
    /// No press of the robot brings the orders nearer; the human has to act.
    HumanTurn,
    /// The wizard skipped the only press that would help, a moment ago.
    Skipped,
}

/// Something that the robot does at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotActivity {
    /// Starts a press.
    Intend {
        /// The button that it goes for.
        button: ButtonId,
        /// When the arm will touch the button.
        until: SessionTime,
    },
    /// Presses the button that it set out for.
    Press(ButtonId),
    /// Gives up the press that it set out for, or was about to.
    Abort(ButtonId, AbortReason),
    /// Becomes idle, or stays idle for another reason.
    Idle(IdleReason),
    /// A sample of the arm's motion.
    Move(ArmSample),
    /// The safety mode changed.
    Safety {
        /// The mode from now on.
        mode: SafetyMode,
        /// The contact force that caused the change, in newtons, if a contact did.
        force_n: Option<f64>,
        /// The faulty joint that caused the change, if one did; 1 is the first.
        joint: Option<u8>,
    },
    /// Somebody touched the arm.
    Touched {
        /// The force of the contact in newtons.
        force_n: f64,
    },
}
