//! The robot: its task policy, and the arm that carries it out, timed or in the physics.

pub mod arm;
pub mod body;
pub mod clearance;
pub mod inverse;
pub mod kinematics;
pub mod motion;
pub mod physics;
pub mod policy;
pub mod reach;
pub mod reaching;
pub mod safety;
mod touch;
pub mod trajectory;
pub mod urdf;
pub mod worker;

use serde::{Deserialize, Serialize};

use reach::Unreachable;

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

impl From<Unreachable> for AbortReason {
    fn from(why: Unreachable) -> AbortReason {
        match why {
            Unreachable::TooFar | Unreachable::JointLimit => AbortReason::OutOfReach,
            Unreachable::Singular => AbortReason::Singular,
            Unreachable::Blocked(_) => AbortReason::Obstructed,
        }
    }
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
