//! The robot arm's trajectories. To a button: up, across, and down on the button; on each leg the arm is slow at both
//! ends.
//!
//! A leg is a cubic through four poses; the time law along the leg is a quintic (Craig, Introduction to Robotics), so
//! that speed and acceleration begin and end at 0 and never jump. The duration of a leg follows from the speed and
//! acceleration limits of the leg's kind, which are the defaults of the manufacturer's commands `movej` and `movel`.

use tomcom_core::base::maths::eased;
use tomcom_core::robot::{JOINTS, JointAngles};

use crate::kinematics::SerialArm;
use crate::reach::{ABOVE_M, ArmSurroundings, BUTTON_M, ButtonPoses, UnreachableReason};

/// Greatest speed of a joint on a leg in joint space, in radians per second.
pub const JOINT_SPEED_RAD_S: f64 = 1.05;
/// Greatest acceleration of a joint on a leg in joint space, in radians per second squared.
pub(crate) const JOINT_ACCELERATION_RAD_S2: f64 = 1.4;
/// Greatest speed of the arm's tip on a straight leg, in metres per second.
pub(crate) const TIP_SPEED_M_S: f64 = 0.25;
/// Greatest acceleration of the arm's tip on a straight leg, in metres per second squared.
pub(crate) const TIP_ACCELERATION_M_S2: f64 = 1.2;
/// The greatest speed and acceleration of the quintic time law from 0 to 1 within a time of 1.
const QUINTIC_SPEED: f64 = 1.875;
const QUINTIC_ACCELERATION: f64 = 5.7735;
/// Depth below a button's top at which the arm's tip aims, in metres; this is more than the click needs.
pub const BELOW_M: f64 = 0.006;
/// Number of points of a leg that are checked for joint limits and clearance.
const LOOKS: usize = 24;
/// Additional heights that are tried if the arm's path is blocked, in metres.
const HIGHER_M: [f64; 3] = [0.08, 0.16, 0.24];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LegKind {
    /// Moves the arm's tip straight up.
    Up,
    /// Moves all joints from one pose above the buttons to another.
    Over,
    /// Moves the arm's tip straight down on the button, until the button clicks.
    Down,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryLeg {
    pub kind: LegKind,
    /// Four poses of the arm at equal distances along the leg, which is the cubic through them.
    pub poses: [JointAngles; 4],
    /// Duration of the leg at full speed, in seconds.
    pub takes_s: f64,
}

impl TrajectoryLeg {
    /// A leg in joint space: all joints move together from pose to pose.
    fn over(from: &JointAngles, to: &JointAngles) -> TrajectoryLeg {
        let between = |share: f64| std::array::from_fn(|joint| from[joint] + (to[joint] - from[joint]) * share);
        let furthest = (0..JOINTS).map(|joint| (to[joint] - from[joint]).abs()).fold(0.0, f64::max);
        let takes_s = takes_s(furthest, JOINT_SPEED_RAD_S, JOINT_ACCELERATION_RAD_S2);
        TrajectoryLeg { kind: LegKind::Over, poses: [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(between), takes_s }
    }

    /// A straight leg: the arm's tip moves up or down from `from` to the height `to_m` above the base.
    fn straight(
        arm: &SerialArm,
        kind: LegKind,
        from: &JointAngles,
        to_m: f64,
        around: &ArmSurroundings,
    ) -> Result<TrajectoryLeg, UnreachableReason> {
        let at = arm.tip(from).translation.vector;
        let mut poses = [*from; 4];
        for part in 1..4 {
            let z = at.z + (to_m - at.z) * part as f64 / 3.0;
            poses[part] = arm.standing_at([at.x, at.y, z], &poses[part - 1], around)?;
        }
        let length_m = (to_m - at.z).abs();
        let by_tip_s = takes_s(length_m, TIP_SPEED_M_S, TIP_ACCELERATION_M_S2);
        let leg = TrajectoryLeg { kind, poses, takes_s: by_tip_s.max(0.05) };
        // Near the arm's base, a short path of the tip needs large joint motions.
        let steepest = (0..=LOOKS).map(|look| leg.slope(look as f64 / LOOKS as f64)).fold(0.0, f64::max);
        let fastest = arm.turns().map(|turn| turn.speed_rad_s).fold(f64::INFINITY, f64::min);
        Ok(TrajectoryLeg { takes_s: leg.takes_s.max(QUINTIC_SPEED * steepest / fastest), ..leg })
    }

    /// The greatest slope of a joint along the leg, in radians per whole leg.
    fn slope(&self, share: f64) -> f64 {
        let step = 1e-4;
        let (before, after) = (self.pose(share - step), self.pose(share + step));
        (0..JOINTS).map(|joint| ((after[joint] - before[joint]) / (2.0 * step)).abs()).fold(0.0, f64::max)
    }

    fn pose(&self, share: f64) -> JointAngles {
        let t = 3.0 * share;
        // Lagrange's polynomials over the nodes 0, 1, 2, 3.
        let weights = [
            -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
            t * (t - 2.0) * (t - 3.0) / 2.0,
            -t * (t - 1.0) * (t - 3.0) / 2.0,
            t * (t - 1.0) * (t - 2.0) / 6.0,
        ];
        std::array::from_fn(|joint| (0..4).map(|part| weights[part] * self.poses[part][joint]).sum())
    }

    pub fn at(&self, since_s: f64) -> JointAngles {
        let t = if self.takes_s > 0.0 { (since_s / self.takes_s).clamp(0.0, 1.0) } else { 1.0 };
        self.pose(eased(t))
    }

    pub fn end(&self) -> &JointAngles {
        &self.poses[3]
    }

    /// The first reason why the arm must not follow the leg; none if the arm may follow the leg.
    fn fault(&self, arm: &SerialArm, around: &ArmSurroundings) -> Option<UnreachableReason> {
        (0..=LOOKS).find_map(|look| arm.fault(&self.pose(look as f64 / LOOKS as f64), around))
    }
}

/// The least time in which the quintic time law covers a length with no more than this speed and acceleration.
fn takes_s(length: f64, speed: f64, acceleration: f64) -> f64 {
    (QUINTIC_SPEED * length / speed).max((QUINTIC_ACCELERATION * length / acceleration).sqrt())
}

/// The trajectory from a pose to a button until the tip is down on the button: up, across, down.
///
/// # Errors
/// What blocks the arm's path, after higher paths were tried.
pub(crate) fn way_to(
    arm: &SerialArm,
    from: &JointAngles,
    to: &ButtonPoses,
    around: &ArmSurroundings,
) -> Result<Vec<TrajectoryLeg>, UnreachableReason> {
    let mut legs = way_above(arm, from, &to.above, around)?;
    legs.push(way_down(arm, &to.above, -BELOW_M, around)?);
    Ok(legs)
}

/// The trajectory from a pose to another one above the buttons: up, if the arm is lower, and across.
///
/// # Errors
/// What blocks the arm's path, after higher paths were tried.
pub fn way_above(
    arm: &SerialArm,
    from: &JointAngles,
    above: &JointAngles,
    around: &ArmSurroundings,
) -> Result<Vec<TrajectoryLeg>, UnreachableReason> {
    let mut legs = way_up(arm, from, around)?;
    let here = legs.last().map_or(*from, |leg| *leg.end());
    legs.extend(way_over(arm, &here, above, around)?);
    Ok(legs)
}

/// The straight leg from a pose above a button down to this height of the tip over the button's top, in metres.
///
/// # Errors
/// What blocks the arm's path.
pub fn way_down(
    arm: &SerialArm,
    from: &JointAngles,
    over_top_m: f64,
    around: &ArmSurroundings,
) -> Result<TrajectoryLeg, UnreachableReason> {
    let down = TrajectoryLeg::straight(arm, LegKind::Down, from, around.table_m + BUTTON_M + over_top_m, around)?;
    down.fault(arm, around).map_or(Ok(down), Err)
}

/// The trajectory up to the height at which the arm moves between buttons, if the arm is lower.
///
/// # Errors
/// What blocks the arm's path.
pub fn way_up(
    arm: &SerialArm,
    from: &JointAngles,
    around: &ArmSurroundings,
) -> Result<Vec<TrajectoryLeg>, UnreachableReason> {
    let free_m = around.table_m + BUTTON_M + ABOVE_M;
    if arm.tip(from).translation.z > free_m - 1e-3 {
        return Ok(Vec::new());
    }
    Ok(vec![TrajectoryLeg::straight(arm, LegKind::Up, from, free_m, around)?])
}

/// The trajectory from one pose above the table to another: directly, or higher up if something is in the way.
///
/// # Errors
/// What blocks every path that was tried.
pub(crate) fn way_over(
    arm: &SerialArm,
    from: &JointAngles,
    to: &JointAngles,
    around: &ArmSurroundings,
) -> Result<Vec<TrajectoryLeg>, UnreachableReason> {
    let direct = TrajectoryLeg::over(from, to);
    let Some(fault) = direct.fault(arm, around) else {
        return Ok(if from == to { Vec::new() } else { vec![direct] });
    };
    for higher_m in HIGHER_M {
        let raised = |pose: &JointAngles| {
            let z = arm.tip(pose).translation.z;
            let leg = TrajectoryLeg::straight(arm, LegKind::Up, pose, z + higher_m, around)?;
            leg.fault(arm, around).map_or(Ok(leg), Err)
        };
        let (Ok(up), Ok(above)) = (raised(from), raised(to)) else { continue };
        let over = TrajectoryLeg::over(up.end(), above.end());
        let down = TrajectoryLeg::over(above.end(), to);
        if over.fault(arm, around).is_none() && down.fault(arm, around).is_none() {
            return Ok(vec![up, over, down]);
        }
    }
    Err(fault)
}
