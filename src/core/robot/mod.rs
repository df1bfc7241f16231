//! The robot: its task policy, and its recorded activity. The robot arms that carry the policy out are in `tomcom_arm`.

pub mod initiative;
pub mod moment;
pub mod policy;
pub mod safety;

use serde::{Deserialize, Serialize};

use self::moment::ArmSample;
use self::safety::SafetyMode;
use crate::base::time::SessionTime;
use crate::kitchen::ButtonId;

/// Why the robot abandoned a press that it had begun or planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AbortReason {
    /// When the arm was about to touch the button, a press of the button was no longer useful.
    NoLongerUseful,
    /// The wizard stopped the robot.
    Stopped,
    /// The wizard skipped this press of the robot.
    Skipped,
    /// The wizard chose another press for the robot.
    Driven,
    /// The button is outside of the arm's workspace.
    OutOfReach,
    /// The arm's pose at the button is singular.
    Singular,
    /// Every path of the arm to the button is blocked by an obstacle or by the arm itself.
    Obstructed,
    /// A hand was in the arm's way for too long.
    HandInTheWay,
    /// The arm pushed the button down, but the button did not click.
    NoClick,
    /// The arm measured a contact force above the threshold and stopped.
    Contact,
    /// A joint did not follow its command, and the arm stopped.
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

    /// Whether only the arm in the physics simulation can abandon a press for this reason.
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
            AbortReason::HandInTheWay => "a hand is in the way",
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
