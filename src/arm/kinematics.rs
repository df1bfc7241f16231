//! Forward kinematics of a serial robot arm: poses of the arm's links for given joint angles, and the Jacobian of the
//! arm's tip.
//!
//! The description of the arm is read from a URDF; the URDF of the UR5 (`ur5.urdf` beside this file) is the project's
//! own, written from the manufacturer's published data.

use nalgebra::{Isometry3, Matrix6, Point3, Translation3, Unit, UnitQuaternion, Vector3, Vector6};
use tomcom_core::robot::{JOINTS, JointAngles};
use urdf_rs::{Geometry, JointType, Pose};

pub const UR5: &str = include_str!("ur5.urdf");

#[derive(Clone, Debug, PartialEq)]
pub struct SerialArm {
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
    pub(crate) fn from_urdf(text: &str) -> Result<SerialArm, UrdfError> {
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

    pub fn turns(&self) -> impl Iterator<Item = &RevoluteJoint> {
        self.links.iter().filter_map(|link| link.turns.as_ref())
    }

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

/// A simple collision shape of a link, relative to the shape's own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkShape {
    Box {
        /// Half of the box's edges along x, y and z, in metres.
        half_m: [f64; 3],
    },
    /// A cylindrical part of the link, along z.
    Cylinder {
        radius_m: f64,
        length_m: f64,
    },
    Sphere {
        radius_m: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionSolid {
    pub shape: LinkShape,
    pub link_from_solid: Isometry3<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJoint {
    /// The axis of rotation, in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Least and greatest angle of the joint, in radians.
    pub(crate) range_rad: [f64; 2],
    pub(crate) torque_nm: f64,
    pub speed_rad_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    pub(crate) mass_kg: f64,
    /// The centre of mass in the frame of the link, in metres.
    pub(crate) centre_m: Point3<f64>,
    /// Moments of inertia about the centre of mass, along the link's axes, in kg m².
    pub(crate) inertia_kg_m2: Vector3<f64>,
}

/// A link of a robot arm, with the joint that connects it to the previous link.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmLink {
    pub name: String,
    /// Pose of the joint in the frame of the previous link, at joint angle 0.
    pub(crate) parent_from_joint: Isometry3<f64>,
    /// The joint between the link and the previous one; none if the link is fixed to the previous link.
    pub turns: Option<RevoluteJoint>,
    pub weight: Option<LinkInertia>,
    pub solids: Vec<CollisionSolid>,
}

/// Error: a URDF does not describe an arm that the program can move.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct UrdfError {
    pub found: String,
    pub remedy: &'static str,
}

/// Reads the links of a robot arm: one chain with [`JOINTS`] revolute joints.
///
/// # Errors
/// The text is no URDF, or the URDF does not describe such an arm.
pub(crate) fn read_links(text: &str) -> Result<Vec<ArmLink>, UrdfError> {
    let wrong = |found: String, remedy| UrdfError { found, remedy };
    let robot = urdf_rs::read_from_string(text).map_err(|error| wrong(error.to_string(), "a URDF"))?;
    let is_root = |link: &&urdf_rs::Link| robot.joints.iter().all(|joint| joint.child.link != link.name);
    let root = robot.links.iter().find(is_root);
    let root = root.ok_or_else(|| wrong("links in a ring".to_string(), "a link that no joint carries"))?;
    let base = ArmLink {
        name: root.name.clone(),
        parent_from_joint: Isometry3::identity(),
        turns: None,
        weight: weight(root)?,
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
        JOINTS => Ok(links),
        count => Err(wrong(format!("{count} joints that turn"), "6 joints that turn, one after the other")),
    }
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z] = pose.xyz.0;
    let [roll, pitch, yaw] = pose.rpy.0;
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

fn carried(joint: &urdf_rs::Joint, link: &urdf_rs::Link) -> Result<ArmLink, UrdfError> {
    let turns = match joint.joint_type {
        JointType::Fixed => None,
        JointType::Revolute => {
            let axis = Unit::try_new(Vector3::from(joint.axis.xyz.0), 1e-9);
            let axis =
                axis.ok_or(UrdfError { found: format!("joint {} without an axis", joint.name), remedy: "one" })?;
            let limit = &joint.limit;
            let range_rad = [limit.lower, limit.upper];
            Some(RevoluteJoint { axis, range_rad, torque_nm: limit.effort, speed_rad_s: limit.velocity })
        }
        _ => {
            let found = format!("joint {}, which neither turns nor is fixed", joint.name);
            return Err(UrdfError { found, remedy: "joints of the types revolute and fixed" });
        }
    };
    let parent_from_joint = isometry(&joint.origin);
    Ok(ArmLink { name: link.name.clone(), parent_from_joint, turns, weight: weight(link)?, solids: solids(link)? })
}

/// Mass and inertia of a link; the moments of inertia have to be along the link's axes.
fn weight(link: &urdf_rs::Link) -> Result<Option<LinkInertia>, UrdfError> {
    let (mass_kg, inertia, origin) = (link.inertial.mass.value, &link.inertial.inertia, &link.inertial.origin);
    if mass_kg == 0.0 {
        return Ok(None);
    }
    let mixed = [inertia.ixy, inertia.ixz, inertia.iyz, origin.rpy.0[0], origin.rpy.0[1], origin.rpy.0[2]];
    let inertia_kg_m2 = Vector3::new(inertia.ixx, inertia.iyy, inertia.izz);
    if mixed.iter().any(|value| *value != 0.0) || mass_kg < 0.0 || inertia_kg_m2.min() <= 0.0 {
        let found = format!("link {} with moments of inertia that are not along its axes, or not above 0", link.name);
        return Err(UrdfError { found, remedy: "a mass and ixx, iyy, izz above 0, and no others" });
    }
    Ok(Some(LinkInertia { mass_kg, centre_m: Point3::from(Vector3::from(origin.xyz.0)), inertia_kg_m2 }))
}

fn solids(link: &urdf_rs::Link) -> Result<Vec<CollisionSolid>, UrdfError> {
    let solid = |collision: &urdf_rs::Collision| {
        let shape = match &collision.geometry {
            Geometry::Box { size } => LinkShape::Box { half_m: size.0.map(|length| length / 2.0) },
            Geometry::Cylinder { radius, length } => LinkShape::Cylinder { radius_m: *radius, length_m: *length },
            Geometry::Sphere { radius } => LinkShape::Sphere { radius_m: *radius },
            _ => {
                let found = format!("link {}, which is no plain shape", link.name);
                return Err(UrdfError { found, remedy: "boxes, cylinders and spheres" });
            }
        };
        Ok(CollisionSolid { shape, link_from_solid: isometry(&collision.origin) })
    };
    link.collision.iter().map(solid).collect()
}
