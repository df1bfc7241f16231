//! Forward kinematics of a serial robot arm: poses of the arm's links for given joint angles, and the Jacobian of the
//! arm's tip.
//!
//! The description of the arm is read from a URDF; the URDF of the UR5 (`ur5.urdf` beside this file) is the project's
//! own, written from the manufacturer's published data.

use nalgebra::{Isometry3, Matrix6, UnitQuaternion, Vector6};
use tomcom_core::robot::JointAngles;

use crate::link::{ArmLink, RevoluteJoint};
use crate::urdf::{UrdfError, read_links};

/// The robot arm UR5 as a URDF.
pub const UR5: &str = include_str!("ur5.urdf");

/// A serial robot arm, from its base to its tip.
#[derive(Clone, Debug, PartialEq)]
pub struct SerialArm {
    /// The links of the arm, from the base on.
    pub links: Vec<ArmLink>,
}

impl SerialArm {
    /// The UR5 with a stick, with which it presses buttons.
    pub fn ur5() -> SerialArm {
        SerialArm::from_urdf(UR5).expect("our own file")
    }

    /// Reads a robot arm from a URDF: one chain of links with [`tomcom_core::robot::JOINTS`] revolute joints.
    ///
    /// # Errors
    /// The text is no URDF, or the URDF does not describe such an arm.
    pub fn from_urdf(text: &str) -> Result<SerialArm, UrdfError> {
        Ok(SerialArm { links: read_links(text)? })
    }

    /// The poses of the arm's links in the frame of the base (metres).
    pub fn forward(&self, joints: &JointAngles) -> Vec<Isometry3<f64>> {
        let mut angles = joints.iter();
        let mut base_from_link = Isometry3::identity();
        let place = |link: &ArmLink| {
            base_from_link *= link.parent_from_joint;
            if let Some(turn) = &link.turns {
                let angle = angles.next().copied().unwrap_or_default();
                base_from_link *= UnitQuaternion::from_axis_angle(&turn.axis, angle);
            }
            base_from_link
        };
        self.links.iter().map(place).collect()
    }

    /// The pose of the arm's tip in the frame of the base (metres).
    pub fn tip(&self, joints: &JointAngles) -> Isometry3<f64> {
        self.forward(joints).last().copied().unwrap_or_else(Isometry3::identity)
    }

    /// The revolute joints of the arm, from the base on.
    pub fn turns(&self) -> impl Iterator<Item = &RevoluteJoint> {
        self.links.iter().filter_map(|link| link.turns.as_ref())
    }

    /// Whether all joint angles are within the limits of their joints.
    pub fn is_within_limits(&self, joints: &JointAngles) -> bool {
        self.turns().zip(joints).all(|(turn, angle)| (turn.range_rad[0]..=turn.range_rad[1]).contains(angle))
    }

    /// The pose of the arm's tip in the frame of the base, and the geometric Jacobian of the tip: metres, then radians,
    /// per radian of each joint.
    pub fn tip_and_jacobian(&self, joints: &JointAngles) -> (Isometry3<f64>, Matrix6<f64>) {
        let places = self.forward(joints);
        let tip = places.last().copied().unwrap_or_else(Isometry3::identity);
        let mut jacobian = Matrix6::zeros();
        let turning = self.links.iter().zip(&places).filter_map(|(link, place)| Some((link.turns?.axis, place)));
        for (column, (axis, base_from_link)) in turning.enumerate() {
            let axis = base_from_link.rotation * axis.into_inner();
            let moves = axis.cross(&(tip.translation.vector - base_from_link.translation.vector));
            jacobian.set_column(column, &Vector6::new(moves.x, moves.y, moves.z, axis.x, axis.y, axis.z));
        }
        (tip, jacobian)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::{Matrix4, Vector3};

    use super::*;
    use tomcom_core::robot::JOINTS;

    /// The parameters d, a, alpha of the manufacturer's Denavit-Hartenberg table.
    const DH: [[f64; 3]; JOINTS] = [
        [0.089159, 0.0, FRAC_PI_2],
        [0.0, -0.425, 0.0],
        [0.0, -0.39225, 0.0],
        [0.10915, 0.0, FRAC_PI_2],
        [0.09465, 0.0, -FRAC_PI_2],
        [0.0823, 0.0, 0.0],
    ];

    /// The pose of the flange in the frame of `base_link`, from the Denavit-Hartenberg table alone.
    fn flange_by_dh(joints: &JointAngles) -> Matrix4<f64> {
        let mut base_from_flange = Matrix4::new_rotation(Vector3::z() * PI);
        for ([d, a, alpha], angle) in DH.iter().zip(joints) {
            let ((st, ct), (sa, ca)) = (angle.sin_cos(), alpha.sin_cos());
            base_from_flange *= Matrix4::new(
                ct,
                -st * ca,
                st * sa,
                a * ct,
                st,
                ct * ca,
                -ct * sa,
                a * st,
                0.0,
                sa,
                ca,
                *d,
                0.0,
                0.0,
                0.0,
                1.0,
            );
        }
        base_from_flange
    }

    #[test]
    fn the_urdf_has_the_kinematics_of_the_published_table() {
        let arm = SerialArm::ur5();
        let stick = Matrix4::new_translation(&Vector3::new(0.0, 0.0, 0.12));
        for n in 0..500 {
            let joints: JointAngles = std::array::from_fn(|joint| ((n * 37 + joint * 101) as f64 * 0.7).sin() * PI);
            let tip = arm.forward(&joints)[7].to_homogeneous();
            let away = (tip - flange_by_dh(&joints) * stick).amax();
            assert!(away < 1e-9, "{joints:?}: {away}");
        }
    }

    #[test]
    fn what_is_no_arm_is_told() {
        let one_joint = r#"<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>
            <child link="b"/><axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>"#;
        assert_eq!(SerialArm::from_urdf(one_joint).unwrap_err().found, "1 joints that turn");
        assert!(SerialArm::from_urdf("<robot").is_err());
        let sliding = UR5.replacen("revolute", "prismatic", 1);
        assert!(SerialArm::from_urdf(&sliding).unwrap_err().found.contains("shoulder_pan"));
    }
}
