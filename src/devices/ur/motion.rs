//! The motions of the simulated controller: along a path with a trapezoidal speed, after a target, at a speed, to a stop.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};
use tomcom_arm::inverse::{controller_from_base, turned_towards};
use tomcom_arm::kinematics::SerialArm;
use tomcom_core::robot::{JOINTS, JointAngles};

/// Duration of a control cycle in seconds.
pub use tomcom_arm::physics::CYCLE_S;

/// Deceleration of the leading joint in a stop that the safety system or the loss of the program causes, in radians per
/// second squared.
pub const SAFETY_STOP_RAD_S2: f64 = 20.0;
/// Greatest change of a joint in one cycle while the arm follows a straight line, in radians: more means that the line
/// passes a singularity.
const JUMP_RAD: f64 = 0.1;

/// A pose of the tool centre point in the controller's base frame as six numbers: metres, and a rotation vector in radians.
pub fn six(pose: &Isometry3<f64>) -> [f64; 6] {
    let (at, turn) = (pose.translation.vector, pose.rotation.scaled_axis());
    [at.x, at.y, at.z, turn.x, turn.y, turn.z]
}

/// The length of a vector.
pub(super) fn norm(parts: &[f64]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

pub fn isometry([x, y, z, rx, ry, rz]: [f64; 6]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_scaled_axis(Vector3::new(rx, ry, rz)))
}

/// The pose of the arm's tip in the controller's base frame.
pub fn tcp(arm: &SerialArm, joints: &JointAngles) -> Isometry3<f64> {
    controller_from_base() * arm.tip(joints)
}

/// The speed of the tip in the controller's base frame: metres and radians per second.
pub(super) fn tcp_speed(arm: &SerialArm, joints: &JointAngles, speeds: &JointAngles) -> [f64; 6] {
    let moved = arm.tip_and_jacobian(joints).1 * Vector6::from(*speeds);
    let turn = controller_from_base();
    let (line, spin) = (turn * moved.fixed_rows::<3>(0), turn * moved.fixed_rows::<3>(3));
    [line.x, line.y, line.z, spin.x, spin.y, spin.z]
}

/// The joint angles nearest to `near` at which the tip has this pose in the controller's base frame.
pub fn inverse(arm: &SerialArm, pose: &Isometry3<f64>, near: &JointAngles) -> Option<JointAngles> {
    let base_from_tip = controller_from_base().inverse() * pose;
    let far = |joints: &JointAngles| (0..JOINTS).map(|joint| (joints[joint] - near[joint]).powi(2)).sum::<f64>();
    let found = arm.inverse(&base_from_tip).into_iter().map(|joints| turned_towards(&joints, near));
    let within = found.filter(|joints| arm.is_within_limits(joints));
    within.min_by(|one, two| far(one).total_cmp(&far(two)))
}

#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// All joints together; the length is that of the joint that turns furthest, in radians.
    Joints { from: JointAngles, to: JointAngles },
    /// The tool centre point on a straight line; the length is in metres, or in radians where it only turns.
    Line { from: Isometry3<f64>, to: Isometry3<f64> },
}

impl Path {
    fn length(&self) -> f64 {
        match self {
            Path::Joints { from, to } => (0..JOINTS).map(|joint| (to[joint] - from[joint]).abs()).fold(0.0, f64::max),
            Path::Line { from, to } => {
                let moves = (to.translation.vector - from.translation.vector).norm();
                if moves > 1e-6 { moves } else { from.rotation.angle_to(&to.rotation) }
            }
        }
    }

    fn at(&self, share: f64, arm: &SerialArm, here: &JointAngles) -> Option<JointAngles> {
        match self {
            Path::Joints { from, to } => {
                Some(std::array::from_fn(|joint| from[joint] + (to[joint] - from[joint]) * share))
            }
            Path::Line { from, to } => {
                let place = from.translation.vector.lerp(&to.translation.vector, share);
                let turn = from.rotation.try_slerp(&to.rotation, share, 1e-9).unwrap_or(to.rotation);
                let next = inverse(arm, &Isometry3::from_parts(place.into(), turn), here)?;
                (0..JOINTS).all(|joint| (next[joint] - here[joint]).abs() < JUMP_RAD).then_some(next)
            }
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Along a path; `done` of its length lies behind, at `speed`.
    Along { path: Path, top: f64, acceleration: f64, done: f64, speed: f64 },
    /// After a target that the program sets again and again (`servoj`), with this time constant in seconds.
    Follow { target: JointAngles, lookahead_s: f64 },
    /// All joints at these speeds, in radians per second (`speedj`).
    Turn { speeds: JointAngles, acceleration: f64 },
    /// The tool centre point at this speed, in metres and radians per second (`speedl`).
    Move { speeds: [f64; 6], acceleration: f64 },
    /// To a standstill, by this deceleration of the leading joint in radians per second squared.
    Stop { deceleration: f64 },
}

impl Motion {
    /// A motion along a path that takes this many seconds, or where `takes_s` is 0 one with this speed and acceleration.
    pub fn along(path: Path, top: f64, acceleration: f64, takes_s: f64) -> Motion {
        let length = path.length();
        // A quarter of the time speeds up, a quarter slows down.
        let (top, acceleration) = if takes_s > 0.0 {
            (length / (0.75 * takes_s), length / (0.1875 * takes_s * takes_s))
        } else {
            (top, acceleration)
        };
        Motion::Along { path, top, acceleration, done: 0.0, speed: 0.0 }
    }
}

/// The commanded joint angles, and how they change.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCommand {
    pub angles: JointAngles,
    /// Radians per second.
    pub speeds: JointAngles,
    pub motion: Option<Motion>,
}

impl JointCommand {
    pub fn new(angles: JointAngles) -> JointCommand {
        JointCommand { angles, speeds: [0.0; JOINTS], motion: None }
    }

    pub fn is_still(&self) -> bool {
        self.speeds.iter().all(|speed| *speed == 0.0)
    }

    pub fn stop(&mut self, deceleration: f64) {
        self.motion = Some(Motion::Stop { deceleration });
    }

    /// Goes on by one cycle. `share` is the speed slider; `holds` says that the arm stands, or comes to stand, and keeps
    /// its motion for later.
    ///
    /// # Errors
    /// Why the arm cannot follow its motion.
    pub fn cycle(&mut self, arm: &SerialArm, share: f64, holds: bool) -> Result<(), &'static str> {
        let before = self.angles;
        let motion = self.motion.take();
        let next = match motion {
            None => self.braked(SAFETY_STOP_RAD_S2),
            Some(Motion::Stop { deceleration }) => {
                let next = self.braked(if holds { deceleration.max(SAFETY_STOP_RAD_S2) } else { deceleration });
                self.motion = (next != before).then_some(Motion::Stop { deceleration });
                next
            }
            Some(along @ Motion::Along { .. }) => return self.go_along(arm, along, share, holds),
            Some(kept) if holds => {
                self.motion = Some(kept);
                self.braked(SAFETY_STOP_RAD_S2)
            }
            Some(Motion::Follow { target, lookahead_s }) => {
                self.motion = Some(Motion::Follow { target, lookahead_s });
                let part = (CYCLE_S / lookahead_s).min(1.0) * share;
                std::array::from_fn(|joint| before[joint] + (target[joint] - before[joint]) * part)
            }
            Some(Motion::Turn { speeds, acceleration }) => {
                self.motion = Some(Motion::Turn { speeds, acceleration });
                self.towards(&speeds.map(|speed| speed * share), acceleration)
            }
            Some(Motion::Move { speeds, acceleration }) => {
                self.motion = Some(Motion::Move { speeds, acceleration });
                self.moved(arm, &speeds.map(|speed| speed * share), acceleration)?
            }
        };
        self.step_to(arm, next)
    }

    fn step_to(&mut self, arm: &SerialArm, next: JointAngles) -> Result<(), &'static str> {
        self.speeds = std::array::from_fn(|joint| (next[joint] - self.angles[joint]) / CYCLE_S);
        self.angles = next;
        let is_too_fast = arm.turns().zip(&self.speeds).any(|(turn, speed)| speed.abs() > turn.speed_rad_s);
        if is_too_fast { Err("a joint would be faster than its limit") } else { Ok(()) }
    }

    fn go_along(&mut self, arm: &SerialArm, motion: Motion, share: f64, holds: bool) -> Result<(), &'static str> {
        let Motion::Along { path, top, acceleration, mut done, mut speed } = motion else { return Ok(()) };
        let length = path.length();
        let left = (length - done).max(0.0);
        let wanted = if holds { 0.0 } else { (top * share).min((2.0 * acceleration * left).sqrt()) };
        let slows = if holds { acceleration.max(SAFETY_STOP_RAD_S2) } else { acceleration * 2.0 };
        speed += (wanted - speed).clamp(-slows * CYCLE_S, acceleration * CYCLE_S);
        done += speed * CYCLE_S;
        // The last step is as long as a cycle's braking.
        let ends = length - done <= acceleration * CYCLE_S * CYCLE_S && !holds;
        let part = if ends || length == 0.0 { 1.0 } else { (done / length).min(1.0) };
        let next = path.at(part, arm, &self.angles).ok_or("its line passes a singularity, or leaves its reach")?;
        self.step_to(arm, next)?;
        if ends {
            self.speeds = [0.0; JOINTS];
        } else {
            self.motion = Some(Motion::Along { path, top, acceleration, done, speed });
        }
        Ok(())
    }

    /// The next joint angles while the joints approach these speeds together.
    fn towards(&self, wanted: &JointAngles, acceleration: f64) -> JointAngles {
        let furthest = (0..JOINTS).map(|joint| (wanted[joint] - self.speeds[joint]).abs()).fold(0.0, f64::max);
        let part = if furthest > 0.0 { (acceleration * CYCLE_S / furthest).min(1.0) } else { 1.0 };
        std::array::from_fn(|joint| {
            let speed = self.speeds[joint] + (wanted[joint] - self.speeds[joint]) * part;
            self.angles[joint] + speed * CYCLE_S
        })
    }

    fn braked(&self, deceleration: f64) -> JointAngles {
        self.towards(&[0.0; JOINTS], deceleration)
    }

    /// The next joint angles while the tool centre point approaches this speed.
    fn moved(&self, arm: &SerialArm, wanted: &[f64; 6], acceleration: f64) -> Result<JointAngles, &'static str> {
        let here = tcp(arm, &self.angles);
        let is = tcp_speed(arm, &self.angles, &self.speeds);
        let away: Vec<f64> = (0..6).map(|part| wanted[part] - is[part]).collect();
        let furthest =
            Vector3::new(away[0], away[1], away[2]).norm().max(Vector3::new(away[3], away[4], away[5]).norm());
        let part = if furthest > 0.0 { (acceleration * CYCLE_S / furthest).min(1.0) } else { 1.0 };
        let speeds: [f64; 6] = std::array::from_fn(|one| is[one] + away[one] * part);
        let place = here.translation.vector + Vector3::new(speeds[0], speeds[1], speeds[2]) * CYCLE_S;
        let turned =
            UnitQuaternion::from_scaled_axis(Vector3::new(speeds[3], speeds[4], speeds[5]) * CYCLE_S) * here.rotation;
        let next = inverse(arm, &Isometry3::from_parts(place.into(), turned), &self.angles);
        let next = next.filter(|next| (0..JOINTS).all(|joint| (next[joint] - self.angles[joint]).abs() < JUMP_RAD));
        next.ok_or("its line passes a singularity, or leaves its reach")
    }
}
