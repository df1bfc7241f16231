//! Forward kinematics of a serial robot arm: poses of the arm's links for given joint angles, and the Jacobian of the
//! arm's tip.
//!
//! The description of the arm is read from a URDF; the URDF of the UR5 (`ur5.urdf` beside this file) is the project's
//! own, written from the manufacturer's published data.

use nalgebra::{Isometry3, Matrix6, Point3, Translation3, Unit, UnitQuaternion, Vector3, Vector6};
use tomcom_core::robot::JointAngles;
use urdf_rs::{Geometry, JointType, Pose};

pub const UR5: &str = include_str!("ur5.urdf");

#[derive(Clone, Debug, PartialEq)]
pub struct SerialArm {
    pub links: Vec<ArmLink>,
}

impl SerialArm {
    /// The UR5 with a stick, with which it presses buttons.
    pub fn ur5() -> SerialArm {
        SerialArm { links: links(&urdf_rs::read_from_string(UR5).expect("our own file")) }
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

/// The links of the arm, from the base on: the URDF has them in this order, each but the base with the joint before it.
fn links(robot: &urdf_rs::Robot) -> Vec<ArmLink> {
    let link = |link: &urdf_rs::Link| {
        let joint = robot.joints.iter().find(|joint| joint.child.link == link.name);
        ArmLink {
            name: link.name.clone(),
            parent_from_joint: joint.map_or_else(Isometry3::identity, |joint| isometry(&joint.origin)),
            turns: joint.filter(|joint| joint.joint_type == JointType::Revolute).map(|joint| RevoluteJoint {
                axis: Unit::new_normalize(Vector3::from(joint.axis.xyz.0)),
                range_rad: [joint.limit.lower, joint.limit.upper],
                torque_nm: joint.limit.effort,
                speed_rad_s: joint.limit.velocity,
            }),
            weight: weight(&link.inertial),
            solids: link.collision.iter().filter_map(solid).collect(),
        }
    };
    robot.links.iter().map(link).collect()
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z] = pose.xyz.0;
    let [roll, pitch, yaw] = pose.rpy.0;
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

/// Mass and inertia of a link; `None` of a link without mass. The file's moments of inertia are along the link's axes.
fn weight(inertial: &urdf_rs::Inertial) -> Option<LinkInertia> {
    let (mass_kg, inertia) = (inertial.mass.value, &inertial.inertia);
    (mass_kg > 0.0).then(|| LinkInertia {
        mass_kg,
        centre_m: Point3::from(Vector3::from(inertial.origin.xyz.0)),
        inertia_kg_m2: Vector3::new(inertia.ixx, inertia.iyy, inertia.izz),
    })
}

/// A collision shape of a link: the file's shapes are cylinders.
fn solid(collision: &urdf_rs::Collision) -> Option<CollisionSolid> {
    let Geometry::Cylinder { radius, length } = collision.geometry else { return None };
    let shape = LinkShape::Cylinder { radius_m: radius, length_m: length };
    Some(CollisionSolid { shape, link_from_solid: isometry(&collision.origin) })
}
