//! Reads a robot arm from a URDF: its links with their shapes and masses, its joints with their limits.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use tomcom_core::robot::JOINTS;
use urdf_rs::{Geometry, JointType, Pose};

use crate::link::{ArmLink, CollisionSolid, LinkInertia, LinkShape, RevoluteJoint};

/// Error: a URDF does not describe an arm that the program can move.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct UrdfError {
    /// What the URDF contains that is not supported.
    pub found: String,
    /// What the URDF would have to contain.
    pub remedy: &'static str,
}

/// Reads the links of a robot arm: one chain with [`JOINTS`] revolute joints.
///
/// # Errors
/// The text is no URDF, or the URDF does not describe such an arm.
pub fn read_links(text: &str) -> Result<Vec<ArmLink>, UrdfError> {
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
