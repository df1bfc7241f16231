//! The links of a robot arm with their shapes and masses, and the limits of their joints.

use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// A simple collision shape of a link, relative to the shape's own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkShape {
    /// A box-shaped part of the link.
    Box {
        /// Half of the box's edges along x, y and z, in metres.
        half_m: [f64; 3],
    },
    /// A cylindrical part of the link, along z.
    Cylinder {
        /// The radius of the cylinder, in metres.
        radius_m: f64,
        /// The length of the cylinder, in metres.
        length_m: f64,
    },
    /// A spherical part of the link.
    Sphere {
        /// The radius of the sphere, in metres.
        radius_m: f64,
    },
}

/// A collision shape and its pose on its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionSolid {
    /// The kind and size of the collision shape.
    pub shape: LinkShape,
    /// The pose of the collision shape in the frame of its link.
    pub link_from_solid: Isometry3<f64>,
}

/// A revolute joint of a robot arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJoint {
    /// The axis of rotation, in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Least and greatest angle of the joint, in radians.
    pub range_rad: [f64; 2],
    /// The greatest torque of the joint's motor, in newton metres.
    pub torque_nm: f64,
    /// The greatest speed of the joint, in radians per second.
    pub speed_rad_s: f64,
}

/// Mass and moments of inertia of a robot arm's link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    /// The mass of the link, in kilograms.
    pub mass_kg: f64,
    /// The centre of mass in the frame of the link, in metres.
    pub centre_m: Point3<f64>,
    /// Moments of inertia about the centre of mass, along the link's axes, in kg m².
    pub inertia_kg_m2: Vector3<f64>,
}

/// A link of a robot arm, with the joint that connects it to the previous link.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmLink {
    /// The link's name in the URDF.
    pub name: String,
    /// Pose of the joint in the frame of the previous link, at joint angle 0.
    pub parent_from_joint: Isometry3<f64>,
    /// The joint between the link and the previous one; none if the link is fixed to the previous link.
    pub turns: Option<RevoluteJoint>,
    /// Mass and inertia of the link; none if the link has no mass.
    pub weight: Option<LinkInertia>,
    /// The collision shapes of the link.
    pub solids: Vec<CollisionSolid>,
}
