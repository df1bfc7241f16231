//! The links of an arm with their shapes and masses, and what their joints can do.

use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// A plain shape of a link, about its own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkShape {
    /// A box.
    Box {
        /// Half of its edges along x, y and z, in metres.
        half_m: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius, in metres.
        radius_m: f64,
        /// Its length, in metres.
        length_m: f64,
    },
    /// A sphere.
    Sphere {
        /// Its radius, in metres.
        radius_m: f64,
    },
}

/// A shape and its place on its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionSolid {
    /// The shape.
    pub shape: LinkShape,
    /// Its place in the frame of its link.
    pub link_from_solid: Isometry3<f64>,
}

/// A joint that turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJoint {
    /// The axis of rotation, in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Between these angles, in radians.
    pub range_rad: [f64; 2],
    /// The greatest torque of its motor, in newton metres.
    pub torque_nm: f64,
    /// Its greatest speed, in radians per second.
    pub speed_rad_s: f64,
}

/// What a link weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    /// The mass, in kilograms.
    pub mass_kg: f64,
    /// The centre of mass in the frame of the link, in metres.
    pub centre_m: Point3<f64>,
    /// Moments of inertia about the centre, along the link's axes, in kg m².
    pub inertia_kg_m2: Vector3<f64>,
}

/// A link, with the joint that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmLink {
    /// The link's name in the URDF.
    pub name: String,
    /// From the link before, while the joint is at 0.
    pub parent_from_joint: Isometry3<f64>,
    /// How its joint turns; none: it is fixed.
    pub turns: Option<RevoluteJoint>,
    /// None: it weighs nothing.
    pub weight: Option<LinkInertia>,
    /// The shapes by which it collides.
    pub solids: Vec<CollisionSolid>,
}
