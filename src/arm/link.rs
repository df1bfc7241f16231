//! The links of an arm with their shapes and masses, and what their joints can do.

use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// A plain shape of a link, about its own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkShape {
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
pub struct CollisionSolid {
    pub shape: LinkShape,
    pub link_from_solid: Isometry3<f64>,
}

/// A joint that turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevoluteJoint {
    pub axis: Unit<Vector3<f64>>,
    /// Between these angles, in radians.
    pub range_rad: [f64; 2],
    /// What its motor can do, in newton metres, and how fast it can be, in radians a second.
    pub torque_nm: f64,
    pub speed_rad_s: f64,
}

/// What a link weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInertia {
    pub mass_kg: f64,
    pub centre_m: Point3<f64>,
    /// Moments of inertia about the centre, along the link's axes, in kg m².
    pub inertia_kg_m2: Vector3<f64>,
}

/// A link, with the joint that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmLink {
    pub name: String,
    /// From the link before, while the joint is at 0.
    pub parent_from_joint: Isometry3<f64>,
    /// How its joint turns; none: it is fixed.
    pub turns: Option<RevoluteJoint>,
    /// None: it weighs nothing.
    pub weight: Option<LinkInertia>,
    pub solids: Vec<CollisionSolid>,
}
