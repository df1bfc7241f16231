//! Inverse kinematics of the UR5: all joint angles, up to eight solutions, at which the arm's tip has a given pose. The
//! solutions are computed in closed form (Hawkins 2013, "Analytic inverse kinematics for the Universal Robots
//! UR-5/UR-10 arms"), then refined on the URDF's own kinematics.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3, Vector6};
use tomcom_core::robot::{JOINTS, JointAngles};

use crate::kinematics::SerialArm;

/// The manufacturer's Denavit-Hartenberg parameters of the UR5, in metres.
const D1: f64 = 0.089159;
const A2: f64 = -0.425;
const A3: f64 = -0.39225;
const D4: f64 = 0.10915;
const D5: f64 = 0.09465;
const D6: f64 = 0.0823;

/// Tolerance for rounding errors by which a cosine may exceed 1.
const ROUNDING: f64 = 1e-9;
/// Sine of the fifth joint's angle below which the fourth and the sixth joint turn about the same axis; the sixth joint
/// then stays at 0.
const ALIGNED: f64 = 1e-7;
/// Number of Newton steps that refine a solution, and the error at which the refinement ends: metres, radians.
const POLISHES: usize = 8;
const NEAR: f64 = 1e-10;
/// Largest error of a valid solution of the inverse kinematics.
const SOLVED: f64 = 1e-8;
/// Damping factor that keeps Newton steps short where the Jacobian is nearly singular (Wampler 1986).
const DAMPING: f64 = 1e-6;

impl SerialArm {
    /// All joint angles, between -pi and pi, at which the arm's tip has this pose in the frame of the base; the
    /// solutions are in a fixed order.
    pub fn inverse(&self, base_from_tip: &Isometry3<f64>) -> Vec<JointAngles> {
        // The last frame of the Denavit-Hartenberg table is on the flange; the frame of the last turning link is in the
        // joint.
        let flange = Translation3::new(0.0, 0.0, D6);
        let target = controller_from_base() * base_from_tip * self.stick().inverse() * flange;
        let found = closed_form(&target).into_iter().map(|joints| self.polished(base_from_tip, joints));
        found.filter(|(_, away)| *away < SOLVED).map(|(joints, _)| joints.map(wrapped)).collect()
    }

    /// The pose of the arm's tip in the frame of the flange, the last frame of the Denavit-Hartenberg table: what the
    /// manufacturer's controller calls the offset of the tool centre point.
    pub fn flange_from_tip(&self) -> Isometry3<f64> {
        Translation3::new(0.0, 0.0, -D6) * self.stick()
    }

    fn stick(&self) -> Isometry3<f64> {
        self.links.last().map_or_else(Isometry3::identity, |link| link.parent_from_joint)
    }

    /// Refines joint angles by Newton's method on the URDF's kinematics; returns the refined angles with the remaining
    /// error.
    fn polished(&self, target: &Isometry3<f64>, mut joints: JointAngles) -> (JointAngles, f64) {
        let mut best = (joints, f64::INFINITY);
        for _ in 0..POLISHES {
            let (tip, jacobian) = self.tip_and_jacobian(&joints);
            let error = twist(&tip, target);
            if error.amax() < best.1 {
                best = (joints, error.amax());
            }
            let damped = jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING * DAMPING;
            let Some(inverse) = damped.try_inverse().filter(|_| best.1 > NEAR) else { break };
            let step = jacobian.transpose() * inverse * error;
            joints = std::array::from_fn(|joint| joints[joint] + step[joint]);
        }
        best
    }
}

/// The turn from the frame of the arm's base to the base frame of the manufacturer's controller, in which poses of the
/// tool centre point are given: half a turn about z.
pub fn controller_from_base() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -PI)
}

/// The difference between two poses: metres, then a rotation vector in radians.
pub fn twist(from: &Isometry3<f64>, to: &Isometry3<f64>) -> Vector6<f64> {
    let moves = to.translation.vector - from.translation.vector;
    let turns = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(moves.x, moves.y, moves.z, turns.x, turns.y, turns.z)
}

/// The equivalent angle between -pi and pi.
pub fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The same pose of the arm, with every joint turned by whole turns so that the joint is nearest to the same joint in
/// the other pose.
pub fn turned_towards(joints: &JointAngles, other: &JointAngles) -> JointAngles {
    std::array::from_fn::<f64, JOINTS, _>(|joint| other[joint] + wrapped(joints[joint] - other[joint]))
}

fn angle_of_cosine(cosine: f64) -> Option<f64> {
    (cosine.abs() <= 1.0 + ROUNDING).then(|| cosine.clamp(-1.0, 1.0).acos())
}

/// Closed-form solutions for a pose of the flange in the frame of the controller's base.
fn closed_form(flange: &Isometry3<f64>) -> Vec<JointAngles> {
    let at = flange.translation.vector;
    let turn = flange.rotation.to_rotation_matrix();
    let wrist = at - turn * Vector3::z() * D6;
    let Some(shoulder) = angle_of_cosine(D4 / wrist.x.hypot(wrist.y)) else { return Vec::new() };
    let mut found = Vec::new();
    for q1 in [shoulder, -shoulder].map(|side| wrist.y.atan2(wrist.x) + side + FRAC_PI_2) {
        let (s1, c1) = q1.sin_cos();
        let Some(bend) = angle_of_cosine((at.x * s1 - at.y * c1 - D4) / D6) else { continue };
        for q5 in [bend, -bend] {
            // The first joint's axis in the frame of the flange, which the sixth joint turns.
            let across = turn.inverse() * Vector3::new(s1, -c1, 0.0);
            let s5 = q5.sin();
            let q6 = if s5.abs() < ALIGNED { 0.0 } else { (-across.y / s5).atan2(across.x / s5) };
            found.extend(elbows(flange, [q1, q5, q6]));
        }
    }
    found
}

/// The two solutions for the elbow, as of a planar arm, for given angles of the other joints.
fn elbows(flange: &Isometry3<f64>, [q1, q5, q6]: [f64; 3]) -> Vec<JointAngles> {
    let fourth = link(q1, D1, FRAC_PI_2).inverse() * flange * (link(q5, D5, -FRAC_PI_2) * link(q6, D6, 0.0)).inverse();
    let x_axis = fourth.rotation * Vector3::x();
    let q234 = x_axis.y.atan2(x_axis.x);
    let (x, y) = (fourth.translation.x, fourth.translation.y);
    let Some(elbow) = angle_of_cosine((x * x + y * y - A2 * A2 - A3 * A3) / (2.0 * A2 * A3)) else {
        return Vec::new();
    };
    let bent = |q3: f64| {
        let q2 = y.atan2(x) - (A3 * q3.sin()).atan2(A2 + A3 * q3.cos());
        [q1, q2, q3, q234 - q2 - q3, q5, q6]
    };
    vec![bent(elbow), bent(-elbow)]
}

/// The transformation of a Denavit-Hartenberg row whose `a` is 0.
fn link(theta: f64, d: f64, alpha: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), theta);
    let twist = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), alpha);
    Isometry3::from_parts(Translation3::new(0.0, 0.0, d), turn * twist)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn out_of_reach_there_is_none() {
        let arm = SerialArm::ur5();
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
        for at in [[1.2, 0.0, 0.1], [0.0, 0.0, 0.5], [0.03, 0.0, 0.1]] {
            assert!(arm.inverse(&Isometry3::from_parts(Translation3::from(at), down)).is_empty(), "{at:?}");
        }
    }

    #[test]
    fn where_two_axes_are_aligned_there_still_are_solutions() {
        let arm = SerialArm::ur5();
        for q5 in [0.0, PI, 1e-9] {
            let target = arm.tip(&[0.4, -1.1, 1.3, -0.7, q5, 0.3]);
            let found = arm.inverse(&target);
            assert!(!found.is_empty());
            assert!(found.iter().all(|joints| twist(&arm.tip(joints), &target).amax() < 1e-6));
        }
    }
}
