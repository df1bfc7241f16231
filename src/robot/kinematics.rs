//! Kinematics of a serial arm: where its links are for given joint angles, and joint angles that bring its tip to a place.
//!
//! The arm is read from a URDF; that of the UR5 (`ur5.urdf` beside this file) is the project's own, written from the
//! maker's published facts.

use nalgebra::{Isometry3, Matrix6, Translation3, Unit, UnitQuaternion, Vector3, Vector6};
use urdf_rs::{Geometry, JointType, Pose};

/// The UR5 as a URDF.
pub const UR5: &str = include_str!("ur5.urdf");

/// The number of joints that move.
pub const JOINTS: usize = 6;
/// Angles of the joints, from the base on, in radians.
pub type Joints = [f64; JOINTS];

/// Damping of the least squares, which keeps steps short near singular poses.
const DAMPING: f64 = 0.05;
/// No joint moves further in one step, in radians.
const STEP: f64 = 0.3;
const STEPS: usize = 300;
/// How near the tip comes, in metres and in radians.
const NEAR_M: f64 = 1e-4;
const NEAR_RAD: f64 = 1e-3;

/// Why a URDF is no arm that the program can move.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct UrdfError {
    pub found: String,
    pub remedy: &'static str,
}

/// A plain shape of a link, about its own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Box {
        half_m: [f64; 3],
    },
    /// Along z.
    Cylinder {
        radius_m: f64,
        length_m: f64,
    },
    Sphere {
        radius_m: f64,
    },
}

/// A shape and its place on its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    pub shape: Shape,
    pub link_from_solid: Isometry3<f64>,
}

/// A link, with the joint that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    pub name: String,
    /// From the link before, while the joint is at 0.
    parent_from_joint: Isometry3<f64>,
    /// The axis about which it turns and its range in radians; none: it is fixed.
    turns: Option<(Unit<Vector3<f64>>, [f64; 2])>,
    pub solids: Vec<Solid>,
}

/// A serial arm, from its base to its tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    pub links: Vec<Link>,
}

impl Arm {
    /// The UR5 with a stick to press buttons with.
    pub fn ur5() -> Arm {
        Arm::of_urdf(UR5).expect("our own file")
    }

    /// Reads an arm: one chain of links with [`JOINTS`] joints that turn.
    ///
    /// # Errors
    /// The text is no URDF, or not of such an arm.
    pub fn of_urdf(text: &str) -> Result<Arm, UrdfError> {
        let wrong = |found: String, remedy| UrdfError { found, remedy };
        let robot = urdf_rs::read_from_string(text).map_err(|error| wrong(error.to_string(), "a URDF"))?;
        let is_root = |link: &&urdf_rs::Link| robot.joints.iter().all(|joint| joint.child.link != link.name);
        let root = robot.links.iter().find(is_root);
        let root = root.ok_or_else(|| wrong("links in a ring".to_string(), "a link that no joint carries"))?;
        let base = Link {
            name: root.name.clone(),
            parent_from_joint: Isometry3::identity(),
            turns: None,
            solids: solids(root)?,
        };
        let mut links = vec![base];
        while let Some(last) = links.last() {
            let mut joints = robot.joints.iter().filter(|joint| joint.parent.link == last.name);
            let (Some(joint), other) = (joints.next(), joints.next()) else { break };
            if other.is_some() || links.len() > robot.links.len() {
                return Err(wrong(format!("two joints on link {}", last.name), "a single chain of links"));
            }
            let link = robot.links.iter().find(|link| link.name == joint.child.link);
            let link = link.ok_or_else(|| wrong(format!("no link {}", joint.child.link), "every link of a joint"))?;
            links.push(carried(joint, link)?);
        }
        match links.iter().filter(|link| link.turns.is_some()).count() {
            JOINTS => Ok(Arm { links }),
            count => Err(wrong(format!("{count} joints that turn"), "6 joints that turn, one after the other")),
        }
    }

    /// Where the links are, in the frame of the base (metres).
    pub fn forward(&self, joints: &Joints) -> Vec<Isometry3<f64>> {
        let mut angles = joints.iter();
        let mut base_from_link = Isometry3::identity();
        let place = |link: &Link| {
            base_from_link *= link.parent_from_joint;
            if let (Some((axis, _)), Some(angle)) = (&link.turns, link.turns.and_then(|_| angles.next())) {
                base_from_link *= UnitQuaternion::from_axis_angle(axis, *angle);
            }
            base_from_link
        };
        self.links.iter().map(place).collect()
    }

    /// Whether all joints are within their ranges.
    pub fn is_within_limits(&self, joints: &Joints) -> bool {
        let ranges = self.links.iter().filter_map(|link| link.turns.map(|(_, range)| range));
        ranges.zip(joints).all(|([low, high], angle)| (low..=high).contains(angle))
    }

    /// Joint angles at which the tip is at this place in the frame of the base (metres) and points straight down, near
    /// to those where the search begins; `None` if it does not come there. Damped least squares (Wampler 1986; Nakamura
    /// and Hanafusa 1986).
    pub fn pointing_down(&self, at_m: [f64; 3], start: &Joints) -> Option<Joints> {
        let mut joints = *start;
        for _ in 0..STEPS {
            let (tip, jacobian) = self.tip_and_jacobian(&joints);
            let away = Vector3::from(at_m) - tip.translation.vector;
            let tilt = (tip * Vector3::z()).cross(&-Vector3::z());
            let is_down = (tip * Vector3::z()).z < 0.0 && tilt.norm() < NEAR_RAD;
            if away.norm() < NEAR_M && is_down {
                return self.is_within_limits(&joints).then_some(joints);
            }
            let error = Vector6::new(away.x, away.y, away.z, tilt.x, tilt.y, tilt.z);
            let damped = jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING * DAMPING;
            let step = jacobian.transpose() * damped.try_inverse()? * error;
            let scale = (STEP / step.amax().max(STEP)).min(1.0);
            joints.iter_mut().zip(step.iter()).for_each(|(angle, change)| *angle += change * scale);
        }
        None
    }

    /// The tip in the frame of the base, and its geometric Jacobian: metres, then radians, a radian of each joint.
    fn tip_and_jacobian(&self, joints: &Joints) -> (Isometry3<f64>, Matrix6<f64>) {
        let places = self.forward(joints);
        let tip = places.last().copied().unwrap_or_else(Isometry3::identity);
        let mut jacobian = Matrix6::zeros();
        let turning = self.links.iter().zip(&places).filter_map(|(link, place)| Some((link.turns?.0, place)));
        for (column, (axis, base_from_link)) in turning.enumerate() {
            let axis = base_from_link.rotation * axis.into_inner();
            let moves = axis.cross(&(tip.translation.vector - base_from_link.translation.vector));
            jacobian.set_column(column, &Vector6::new(moves.x, moves.y, moves.z, axis.x, axis.y, axis.z));
        }
        (tip, jacobian)
    }
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z] = pose.xyz.0;
    let [roll, pitch, yaw] = pose.rpy.0;
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

fn carried(joint: &urdf_rs::Joint, link: &urdf_rs::Link) -> Result<Link, UrdfError> {
    let turns = match joint.joint_type {
        JointType::Fixed => None,
        JointType::Revolute => {
            let axis = Unit::try_new(Vector3::from(joint.axis.xyz.0), 1e-9);
            let axis =
                axis.ok_or(UrdfError { found: format!("joint {} without an axis", joint.name), remedy: "one" })?;
            Some((axis, [joint.limit.lower, joint.limit.upper]))
        }
        _ => {
            let found = format!("joint {}, which neither turns nor is fixed", joint.name);
            return Err(UrdfError { found, remedy: "joints of the types revolute and fixed" });
        }
    };
    Ok(Link { name: link.name.clone(), parent_from_joint: isometry(&joint.origin), turns, solids: solids(link)? })
}

fn solids(link: &urdf_rs::Link) -> Result<Vec<Solid>, UrdfError> {
    let solid = |collision: &urdf_rs::Collision| {
        let shape = match &collision.geometry {
            Geometry::Box { size } => Shape::Box { half_m: size.0.map(|length| length / 2.0) },
            Geometry::Cylinder { radius, length } => Shape::Cylinder { radius_m: *radius, length_m: *length },
            Geometry::Sphere { radius } => Shape::Sphere { radius_m: *radius },
            _ => {
                let found = format!("link {}, which is no plain shape", link.name);
                return Err(UrdfError { found, remedy: "boxes, cylinders and spheres" });
            }
        };
        Ok(Solid { shape, link_from_solid: isometry(&collision.origin) })
    };
    link.collision.iter().map(solid).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::Matrix4;

    use super::*;

    /// d, a, alpha of the maker's table.
    const DH: [[f64; 3]; JOINTS] = [
        [0.089159, 0.0, FRAC_PI_2],
        [0.0, -0.425, 0.0],
        [0.0, -0.39225, 0.0],
        [0.10915, 0.0, FRAC_PI_2],
        [0.09465, 0.0, -FRAC_PI_2],
        [0.0823, 0.0, 0.0],
    ];

    /// The flange in the frame of `base_link`, from the table alone.
    fn flange_by_dh(joints: &Joints) -> Matrix4<f64> {
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
        let arm = Arm::ur5();
        let stick = Matrix4::new_translation(&Vector3::new(0.0, 0.0, 0.12));
        for n in 0..500 {
            let joints: Joints = std::array::from_fn(|joint| ((n * 37 + joint * 101) as f64 * 0.7).sin() * PI);
            let tip = arm.forward(&joints)[7].to_homogeneous();
            let away = (tip - flange_by_dh(&joints) * stick).amax();
            assert!(away < 1e-9, "{joints:?}: {away}");
        }
    }

    #[test]
    fn a_pose_is_found_for_every_place_on_the_table() {
        let arm = Arm::ur5();
        for (x, y) in (0..5).flat_map(|x| (0..9).map(move |y| (0.2 + 0.1 * f64::from(x), -0.4 + 0.1 * f64::from(y)))) {
            let start = [y.atan2(x), -FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2, 0.0];
            let joints = arm.pointing_down([x, y, 0.05], &start).unwrap_or_else(|| panic!("no pose for {x} {y}"));
            let places = arm.forward(&joints);
            let tip = places[7];
            assert!((tip.translation.vector - Vector3::new(x, y, 0.05)).norm() < 1e-3);
            assert!((tip * Vector3::z()).z < -0.999, "it points down");
            // Nothing but the stick comes near the table.
            assert!(places[2..7].iter().all(|place| place.translation.z > 0.05), "{x} {y}");
        }
    }

    #[test]
    fn what_is_no_arm_is_told() {
        let one_joint = r#"<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>
            <child link="b"/><axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>"#;
        assert_eq!(Arm::of_urdf(one_joint).unwrap_err().found, "1 joints that turn");
        assert!(Arm::of_urdf("<robot").is_err());
        let sliding = UR5.replacen("revolute", "prismatic", 1);
        assert!(Arm::of_urdf(&sliding).unwrap_err().found.contains("shoulder_pan"));
    }
}
