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
    /// The arm would be stretched there, or in line with itself.
    Singular,
    /// Something stands in every way to it, or the arm would be in its own.
    Obstructed,
    /// A hand was in the way for too long.
    HandInTheWay,
    /// The arm was down on the button, which did not click.
    NoClick,
    /// The arm felt somebody, and stopped.
    Contact,
    /// A joint did not follow, and the arm stopped.
    Fault,
}

impl AbortReason {
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

    /// Whether only an arm in the physics can have it.
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
    /// Only the human can go on.
    HumanTurn,
    /// The wizard skipped the only press that would help, a moment ago.
    Skipped,
}

/// What the robot does at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotActivity {
    /// Sets out to press a button, which it will touch at `until`.
    Intend { button: ButtonId, until: SessionTime },
    /// Presses the button that it set out for.
    Press(ButtonId),
    /// Gives up the press that it set out for, or was about to.
    Abort(ButtonId, AbortReason),
    /// Begins to do nothing, or goes on doing nothing for another reason.
    Idle(IdleReason),
    /// The arm moves, or begins to do something else.
    Move(ArmSample),
    /// The arm is safe in another way: slower, waiting, or stopped. With what it felt in newtons where that is why, and with
    /// the joint at fault, 1 the first.
    Safety { mode: SafetyMode, force_n: Option<f64>, joint: Option<u8> },
    /// Somebody touched the arm, with so much force in newtons.
    Touched { force_n: f64 },
}
