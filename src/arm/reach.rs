//! Poses of the robot arm above a button and touching it, with the stick down and with clearance from the table and the
//! arm's own links.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};
use tomcom_core::robot::{AbortReason, JOINTS, JointAngles};

use crate::clearance::{ArmSurroundings, Obstruction};
use crate::inverse::turned_towards;
use crate::kinematics::SerialArm;

/// The height of a button above the table, in metres.
pub const BUTTON_M: f64 = 0.02;
/// Height of the arm's tip above the buttons while the arm moves across, in metres.
pub const ABOVE_M: f64 = 0.08;
/// Preferred posture of the arm: elbow up, stick down. Of all solutions of the inverse kinematics, the one nearest to
/// this posture is chosen.
pub const BENT: JointAngles = [0.0, -1.6, 1.8, -1.8, -FRAC_PI_2, 0.0];
/// Index of the elbow joint, and limit of the elbow's angle in radians.
const ELBOW: usize = 2;
const ELBOW_RAD: f64 = PI;
/// Least singular value of the Jacobian below which a pose of the arm counts as singular.
const SINGULAR: f64 = 0.03;

/// Why the robot arm cannot press a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnreachableReason {
    /// No joint angles bring the arm's tip to the button.
    TooFar,
    /// A joint limit of the arm is exceeded at the button.
    JointLimit,
    /// The pose at the button is singular: the arm could not move in every direction.
    Singular,
    /// This obstruction blocks every pose of the arm at the button.
    Blocked(Obstruction),
}

impl UnreachableReason {
    /// The reason why a button cannot be pressed, in words that follow "a button of the robot".
    pub fn words(self) -> &'static str {
        match self {
            UnreachableReason::TooFar => "out of reach of its arm",
            UnreachableReason::JointLimit => "where its arm's joints do not turn to",
            UnreachableReason::Singular => "where its arm is stretched, or in line with itself (singular)",
            UnreachableReason::Blocked(Obstruction::Table) => "where its arm would be on the table",
            UnreachableReason::Blocked(Obstruction::ItsOwnLinks) => "where its arm would be in its own way",
            UnreachableReason::Blocked(Obstruction::Obstacle) => "where something stands in its arm's way",
        }
    }
}

impl From<UnreachableReason> for AbortReason {
    fn from(why: UnreachableReason) -> AbortReason {
        match why {
            UnreachableReason::TooFar | UnreachableReason::JointLimit => AbortReason::OutOfReach,
            UnreachableReason::Singular => AbortReason::Singular,
            UnreachableReason::Blocked(_) => AbortReason::Obstructed,
        }
    }
}

/// The joint angles of the robot arm above a button and touching it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ButtonPoses {
    /// Joint angles with the tip above the button, in radians.
    pub above: JointAngles,
    /// Joint angles with the tip touching the button, in radians.
    pub touching: JointAngles,
}

/// The pose of the arm's tip at this position in the frame of the base (metres), with the stick down.
pub fn stick_down(at_m: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(at_m), UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI))
}

/// The arm's resting pose: the mean of the poses above the buttons.
pub(super) fn resting_pose(buttons: &[&ButtonPoses]) -> JointAngles {
    let above: Vec<&JointAngles> = buttons.iter().map(|poses| &poses.above).collect();
    let mean = |joint: usize| above.iter().map(|pose| pose[joint]).sum::<f64>() / above.len() as f64;
    if above.is_empty() { BENT } else { std::array::from_fn(mean) }
}

impl SerialArm {
    /// Joint angles with the stick down at a position in the frame of the base (metres): of all solutions, the solution
    /// nearest to `like`. The last joint, which only spins the stick, stays as in `like`.
    ///
    /// # Errors
    /// The reason why the arm cannot reach the position in the solution nearest to `like`.
    pub fn standing_at(
        &self,
        at_m: [f64; 3],
        like: &JointAngles,
        around: &ArmSurroundings,
    ) -> Result<JointAngles, UnreachableReason> {
        let spun = |joints: JointAngles| {
            let [q1, q2, q3, q4, q5, _] = turned_towards(&joints, like);
            [q1, q2, q3, q4, q5, like[JOINTS - 1]]
        };
        let mut ways: Vec<JointAngles> = self.inverse(&stick_down(at_m)).into_iter().map(spun).collect();
        let far = |joints: &JointAngles| (0..JOINTS).map(|i| (joints[i] - like[i]).powi(2)).sum::<f64>();
        ways.sort_by(|one, two| far(one).total_cmp(&far(two)));
        let mut why = UnreachableReason::TooFar;
        for way in ways {
            match self.fault(&way, around) {
                None => return Ok(way),
                Some(fault) if why == UnreachableReason::TooFar => why = fault,
                Some(_) => {}
            }
        }
        Err(why)
    }

    /// Why the arm must not take a pose; none if the arm may take the pose.
    pub fn fault(&self, joints: &JointAngles, around: &ArmSurroundings) -> Option<UnreachableReason> {
        if !self.is_within_limits(joints) || joints[ELBOW].abs() > ELBOW_RAD {
            return Some(UnreachableReason::JointLimit);
        }
        if self.tip_and_jacobian(joints).1.singular_values().min() < SINGULAR {
            return Some(UnreachableReason::Singular);
        }
        self.in_the_way(joints, around).map(UnreachableReason::Blocked)
    }

    /// Joint angles for pressing a button at this position on a table of this height.
    ///
    /// # Errors
    /// The reason why the arm cannot press the button.
    pub fn at_button(&self, [x, y]: [f64; 2], around: &ArmSurroundings) -> Result<ButtonPoses, UnreachableReason> {
        let top_m = around.table_m + BUTTON_M;
        let like = [y.atan2(x), BENT[1], BENT[2], BENT[3], BENT[4], BENT[5]];
        let above = self.standing_at([x, y, top_m + ABOVE_M], &like, around)?;
        Ok(ButtonPoses { above, touching: self.standing_at([x, y, top_m], &above, around)? })
    }
}

/// The first of the robot's buttons that the robot's arm cannot press with clearance, and the reason; none if there is
/// no such button.
pub fn out_of_reach(kitchen: &Kitchen) -> Option<(ButtonId, UnreachableReason)> {
    let arm = SerialArm::ur5();
    let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
    let mut buttons = kitchen.buttons[Agent::Robot.index()].iter().enumerate();
    buttons.find_map(|(index, button)| Some((ButtonId(index as u8), arm.at_button(button.at_m, &around).err()?)))
}
