//! Poses of the robot arm above a button and touching it, with the stick down and with clearance from the table, from the
//! arm's own links and from obstacles.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rapier3d::math::Vector;
use rapier3d::parry::query::details::closest_points_segment_segment_with_locations_nD;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen};
use tomcom_core::robot::{AbortReason, JOINTS, JointAngles};

use crate::inverse::turned_towards;
use crate::kinematics::{ArmLink, CollisionSolid, LinkShape, SerialArm};

/// The height of a button above the table, in metres.
pub const BUTTON_M: f64 = 0.02;
/// Height of the arm's tip above the buttons while the arm moves across, in metres.
pub(crate) const ABOVE_M: f64 = 0.08;
/// Preferred posture of the arm: elbow up, stick down. Of all solutions of the inverse kinematics, the one nearest to
/// this posture is chosen.
pub(crate) const BENT: JointAngles = [0.0, -1.6, 1.8, -1.8, -FRAC_PI_2, 0.0];
/// Index of the elbow joint, and limit of the elbow's angle in radians.
const ELBOW: usize = 2;
const ELBOW_RAD: f64 = PI;
/// Least singular value of the Jacobian below which a pose of the arm counts as singular.
const SINGULAR: f64 = 0.03;

/// Why the robot arm cannot press a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnreachableReason {
    TooFar,
    JointLimit,
    /// The pose at the button is singular: the arm could not move in every direction.
    Singular,
    Blocked(Obstruction),
}

impl UnreachableReason {
    /// The reason why a button cannot be pressed, in words that follow "a button of the robot".
    pub fn words(self) -> &'static str {
        match self {
            UnreachableReason::TooFar => "out of reach of its arm",
            UnreachableReason::JointLimit => "where its arm's joints do not turn to",
            UnreachableReason::Singular => "where its arm is stretched, or in line with itself (singular)",
            UnreachableReason::Blocked(Obstruction::Table) => "where its arm would be on the table",
            UnreachableReason::Blocked(Obstruction::ItsOwnLinks) => "where its arm would be in its own way",
            UnreachableReason::Blocked(Obstruction::Obstacle) => "where something stands in its arm's way",
        }
    }
}

impl From<UnreachableReason> for AbortReason {
    fn from(why: UnreachableReason) -> AbortReason {
        match why {
            UnreachableReason::TooFar | UnreachableReason::JointLimit => AbortReason::OutOfReach,
            UnreachableReason::Singular => AbortReason::Singular,
            UnreachableReason::Blocked(_) => AbortReason::Obstructed,
        }
    }
}

/// The joint angles of the robot arm above a button and touching it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ButtonPoses {
    /// Joint angles with the tip above the button, in radians.
    pub above: JointAngles,
    /// Joint angles with the tip touching the button, in radians.
    pub touching: JointAngles,
}

/// The pose of the arm's tip at this position in the frame of the base (metres), with the stick down.
pub(crate) fn stick_down(at_m: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(at_m), UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI))
}

/// The arm's resting pose: the mean of the poses above the buttons.
pub fn resting_pose(buttons: &[&ButtonPoses]) -> JointAngles {
    let above: Vec<&JointAngles> = buttons.iter().map(|poses| &poses.above).collect();
    let mean = |joint: usize| above.iter().map(|pose| pose[joint]).sum::<f64>() / above.len() as f64;
    if above.is_empty() { BENT } else { std::array::from_fn(mean) }
}

impl SerialArm {
    /// Joint angles with the stick down at a position in the frame of the base (metres): of all solutions, the solution
    /// nearest to `like`. The last joint, which only spins the stick, stays as in `like`.
    ///
    /// # Errors
    /// The reason why the arm cannot reach the position in the solution nearest to `like`.
    pub(crate) fn standing_at(
        &self,
        at_m: [f64; 3],
        like: &JointAngles,
        around: &ArmSurroundings,
    ) -> Result<JointAngles, UnreachableReason> {
        let spun = |joints: JointAngles| {
            let [q1, q2, q3, q4, q5, _] = turned_towards(&joints, like);
            [q1, q2, q3, q4, q5, like[JOINTS - 1]]
        };
        let mut ways: Vec<JointAngles> = self.inverse(&stick_down(at_m)).into_iter().map(spun).collect();
        let far = |joints: &JointAngles| (0..JOINTS).map(|i| (joints[i] - like[i]).powi(2)).sum::<f64>();
        ways.sort_by(|one, two| far(one).total_cmp(&far(two)));
        let mut why = UnreachableReason::TooFar;
        for way in ways {
            match self.fault(&way, around) {
                None => return Ok(way),
                Some(fault) if why == UnreachableReason::TooFar => why = fault,
                Some(_) => {}
            }
        }
        Err(why)
    }

    /// Why the arm must not take a pose; none if the arm may take the pose.
    pub fn fault(&self, joints: &JointAngles, around: &ArmSurroundings) -> Option<UnreachableReason> {
        if !self.is_within_limits(joints) || joints[ELBOW].abs() > ELBOW_RAD {
            return Some(UnreachableReason::JointLimit);
        }
        if self.tip_and_jacobian(joints).1.singular_values().min() < SINGULAR {
            return Some(UnreachableReason::Singular);
        }
        self.in_the_way(joints, around).map(UnreachableReason::Blocked)
    }

    /// Joint angles for pressing a button at this position on a table of this height.
    ///
    /// # Errors
    /// The reason why the arm cannot press the button.
    pub fn at_button(&self, [x, y]: [f64; 2], around: &ArmSurroundings) -> Result<ButtonPoses, UnreachableReason> {
        let top_m = around.table_m + BUTTON_M;
        let like = [y.atan2(x), BENT[1], BENT[2], BENT[3], BENT[4], BENT[5]];
        let above = self.standing_at([x, y, top_m + ABOVE_M], &like, around)?;
        Ok(ButtonPoses { above, touching: self.standing_at([x, y, top_m], &above, around)? })
    }
}

/// The first of the robot's buttons that the robot's arm cannot press with clearance, and the reason; none if there is
/// no such button.
pub fn out_of_reach(kitchen: &Kitchen) -> Option<(ButtonId, UnreachableReason)> {
    let arm = SerialArm::ur5();
    let around = ArmSurroundings { table_m: kitchen.table_height_m, obstacles: Vec::new() };
    let mut buttons = kitchen.buttons[Agent::Robot.index()].iter().enumerate();
    buttons.find_map(|(index, button)| Some((ButtonId(index as u8), arm.at_button(button.at_m, &around).err()?)))
}

// Distance of the robot arm from the table, from its own links and from obstacles. Solids are approximated by capsules.

/// Least clearance between the arm's links, and between links and table, in metres.
pub(crate) const KEPT_M: f64 = 0.02;

/// A capsule: all points within a radius of a line segment. Links, hands and obstacles are approximated by capsules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    pub ends_m: [Point3<f64>; 2],
    pub radius_m: f64,
}

/// The distance between two capsules, and their nearest points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapsuleDistance {
    /// Distance between the surfaces of two capsules in metres; negative if they overlap.
    pub distance_m: f64,
    /// The nearest point on the axis of each capsule, in metres.
    pub at_m: [Point3<f64>; 2],
}

impl Capsule {
    /// The capsule within a cylinder; the arm has no other shapes.
    fn from_solid(solid: &CollisionSolid, base_from_link: &Isometry3<f64>) -> Option<Capsule> {
        let LinkShape::Cylinder { radius_m, length_m } = solid.shape else { return None };
        let half_m = (length_m / 2.0 - radius_m).max(0.0);
        let place = base_from_link * solid.link_from_solid;
        let end = |side: f64| place * Point3::new(0.0, 0.0, side * half_m);
        Some(Capsule { ends_m: [end(-1.0), end(1.0)], radius_m })
    }

    pub fn nearest(&self, other: &Capsule) -> CapsuleDistance {
        let single = |point: Point3<f64>| Vector::new(point.x as f32, point.y as f32, point.z as f32);
        let [a, b] = self.ends_m.map(single);
        let [c, d] = other.ends_m.map(single);
        let (one, two) = closest_points_segment_segment_with_locations_nD((&a, &b), (&c, &d));
        let along = |of: &Capsule, share: f32| of.ends_m[0] + (of.ends_m[1] - of.ends_m[0]) * f64::from(share);
        let at_m = [along(self, one.barycentric_coordinates()[1]), along(other, two.barycentric_coordinates()[1])];
        CapsuleDistance { distance_m: (at_m[0] - at_m[1]).norm() - self.radius_m - other.radius_m, at_m }
    }

    fn lowest_m(&self) -> f64 {
        self.ends_m[0].z.min(self.ends_m[1].z) - self.radius_m
    }
}

/// What blocks a pose or a path of the robot arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstruction {
    Table,
    ItsOwnLinks,
    Obstacle,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmSurroundings {
    /// Height of the table in the frame of the arm's base, in metres.
    pub table_m: f64,
    /// Other obstacles around the arm, in the frame of its base.
    pub obstacles: Vec<Capsule>,
}

impl SerialArm {
    /// The capsules of all links at these joint angles, each with its link number, in the base frame.
    pub fn capsules(&self, joints: &JointAngles) -> Vec<(usize, Capsule)> {
        let places = self.forward(joints);
        let links = self.links.iter().zip(&places).enumerate();
        let of_link = |(at, (link, place)): (usize, (&ArmLink, &Isometry3<f64>))| -> Vec<(usize, Capsule)> {
            link.solids.iter().filter_map(|solid| Some((at, Capsule::from_solid(solid, place)?))).collect()
        };
        links.flat_map(of_link).collect()
    }

    /// The first obstruction that is nearer to the arm than `KEPT_M`. Only the stick may touch the table.
    pub fn in_the_way(&self, joints: &JointAngles, around: &ArmSurroundings) -> Option<Obstruction> {
        let capsules = self.capsules(joints);
        let stick = self.links.len() - 1;
        let is_low = |(link, capsule): &(usize, Capsule)| {
            // The base stands on the table, and the shoulder on the base.
            let kept_m = if *link == stick { 0.0 } else { KEPT_M };
            *link > 1 && capsule.lowest_m() < around.table_m + kept_m
        };
        if capsules.iter().any(is_low) {
            return Some(Obstruction::Table);
        }
        let is_near = |one: &Capsule, two: &Capsule| one.nearest(two).distance_m < KEPT_M;
        let meets_itself = |(link, one): &(usize, Capsule)| {
            capsules.iter().any(|(other, two)| can_meet(*link, *other) && is_near(one, two))
        };
        if capsules.iter().any(meets_itself) {
            return Some(Obstruction::ItsOwnLinks);
        }
        let meets = |(_, one): &(usize, Capsule)| around.obstacles.iter().any(|two| is_near(one, two));
        capsules.iter().any(meets).then_some(Obstruction::Obstacle)
    }
}

/// Whether two links of the arm can collide. Neighbouring links of the chain cannot; nor can base and upper arm, or two
/// of wrist and stick, since their joints keep them apart.
fn can_meet(link: usize, other: usize) -> bool {
    other > link + 1 && other > 2 && link < JOINTS - 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(joints: JointAngles, expected: Option<Obstruction>) {
        assert_eq!(SerialArm::ur5().in_the_way(&joints, &ArmSurroundings::default()), expected, "{joints:?}");
    }

    #[test]
    fn an_arm_is_told_what_it_is_too_near_to() {
        check(BENT, None);
        check([0.0, 0.3, 0.0, 0.0, 0.0, 0.0], Some(Obstruction::Table));
        // A pose with the forearm folded back onto the upper arm.
        check([0.0, -FRAC_PI_2, 3.1, 0.0, 0.0, 0.0], Some(Obstruction::ItsOwnLinks));
        let at = SerialArm::ur5().tip(&BENT).translation.vector;
        let obstacles = vec![Capsule { ends_m: [Point3::from(at); 2], radius_m: 0.03 }];
        let around = ArmSurroundings { table_m: 0.0, obstacles };
        assert_eq!(SerialArm::ur5().in_the_way(&BENT, &around), Some(Obstruction::Obstacle));
    }

    #[test]
    fn the_distance_of_capsules_is_that_of_their_surfaces() {
        let capsule = |from: [f64; 3], to: [f64; 3]| Capsule { ends_m: [from.into(), to.into()], radius_m: 0.1 };
        let lying = capsule([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let above = capsule([0.5, -1.0, 0.5], [0.5, 1.0, 0.5]);
        let nearest = lying.nearest(&above);
        assert!((nearest.distance_m - 0.3).abs() < 1e-6);
        assert!((nearest.at_m[0] - Point3::new(0.5, 0.0, 0.0)).norm() < 1e-6);
        assert!(lying.nearest(&capsule([0.2, 0.0, 0.05], [0.2, 0.0, 3.0])).distance_m < 0.0);
    }
}
