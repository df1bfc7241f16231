//! The bodies that the robot arm can touch: buttons, and the human's hand.

use nalgebra::{Point3, Vector3};
use rapier3d::prelude::{
    ColliderBuilder, ColliderHandle, ColliderSet, Group, ImpulseJointSet, InteractionGroups, InteractionTestMode,
    MotorModel, Pose, PrismaticJointBuilder, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, Rotation, Vector,
};

use crate::reach::{BUTTON_M, Capsule};

/// Travel of the button's cap, and the depths of the cap at which the electrical contact closes and opens, in metres.
const TRAVEL_M: f32 = 0.004;
const CLOSES_M: f32 = 0.0025;
const OPENS_M: f32 = 0.001;
/// Spring constant of a button in N/m, and preload of the spring while the button is released.
const SPRING_N_M: f32 = 600.0;
const PRELOAD_M: f32 = 0.003;
const DAMPING_NS_M: f32 = 3.0;
const CAP_KG: f32 = 0.02;
const RADIUS_M: f32 = 0.02;

/// The cap of a button: it slides down on a spring, clicks on the way, and ends at a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct PhysicalButton {
    body: RigidBodyHandle,
    collider: ColliderHandle,
    up_m: f32,
    closed: bool,
}

impl PhysicalButton {
    /// A button at a position of the table, at rest and out of the simulation.
    pub fn new(
        [x, y]: [f64; 2],
        table_m: f64,
        bodies: &mut RigidBodySet,
        colliders: &mut ColliderSet,
        joints: &mut ImpulseJointSet,
    ) -> PhysicalButton {
        let half_m = BUTTON_M as f32 / 2.0;
        let middle = Vector::new(x as f32, y as f32, table_m as f32 + half_m);
        let ground = bodies.insert(RigidBodyBuilder::fixed().translation(middle));
        let cap =
            RigidBodyBuilder::dynamic().translation(middle).additional_mass(CAP_KG).lock_rotations().enabled(false);
        let body = bodies.insert(cap);
        // A cylinder of the physics engine stands along y.
        let upright = Pose::from_rotation(Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2));
        let collider = ColliderBuilder::cylinder(half_m, RADIUS_M)
            .position(upright)
            .density(0.0)
            .collision_groups(CAP)
            .friction(0.4);
        let collider = colliders.insert_with_parent(collider, body, bodies);
        let slides = PrismaticJointBuilder::new(Vector::Z)
            .limits([-TRAVEL_M, 0.0])
            .motor_model(MotorModel::ForceBased)
            .motor_position(PRELOAD_M, SPRING_N_M, DAMPING_NS_M);
        joints.insert(ground, body, slides, true);
        PhysicalButton { body, collider, up_m: middle.z, closed: false }
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.closed
    }

    pub(crate) fn collider(&self) -> ColliderHandle {
        self.collider
    }

    /// Activates the button in the simulation; or releases the button and deactivates it.
    pub(crate) fn set_active(&mut self, bodies: &mut RigidBodySet, active: bool) {
        let Some(body) = bodies.get_mut(self.body) else { return };
        let at = body.translation();
        body.set_translation(Vector::new(at.x, at.y, self.up_m), active);
        body.set_linvel(Vector::ZERO, active);
        body.set_enabled(active);
        self.closed = false;
    }

    /// Blocks the button's cap, to simulate a fault.
    pub fn jam(&mut self, bodies: &mut RigidBodySet) {
        if let Some(body) = bodies.get_mut(self.body) {
            body.lock_translations(true, false);
        }
    }

    /// Whether the button's electrical contact closed since the last call.
    pub fn clicks(&mut self, bodies: &RigidBodySet) -> bool {
        let down_m = bodies.get(self.body).map_or(0.0, |body| self.up_m - body.translation().z);
        let was_closed = self.closed;
        self.closed = down_m > if was_closed { OPENS_M } else { CLOSES_M };
        self.closed && !was_closed
    }
}

/// Collision groups of the button's cap: caps collide with the stick only.
const CAP: InteractionGroups = InteractionGroups::new(Group::GROUP_1, Group::GROUP_2, InteractionTestMode::And);
pub(super) const STICK: InteractionGroups =
    InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And);

/// Effective mass of a hand, in kilograms (ISO/TS 15066, annex A).
const HAND_KG: f32 = 0.6;
/// Stiffness of a hand, in N/m (ISO/TS 15066, annex A).
pub(crate) const STIFFNESS_N_M: f64 = 75_000.0;
/// Damping of skin and flesh in a contact, in N s/m; the damping is small, so that the spring determines the peak
/// force.
pub(crate) const FLESH_NS_M: f64 = 40.0;
/// Stiffness and damping of the person's arm, in N/m and N s/m: the stiffness is near measured values for an arm at
/// rest (Mussa-Ivaldi, Hogan and Bizzi 1985), and the damping is critical.
const HELD_N_M: f64 = 400.0;
const HELD_NS_M: f64 = 24.0;
/// Radii of hand and forearm, and the length of the hand, in metres.
const HAND_M: f64 = 0.04;
const FOREARM_M: f64 = 0.04;
const HAND_LENGTH_M: f64 = 0.09;

/// The pose of a human's hand and elbow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPose {
    /// The centre of the hand, in the frame of the robot arm's base, in metres.
    pub at_m: Point3<f64>,
    /// The elbow, in the frame of the robot arm's base, in metres.
    pub elbow_m: Point3<f64>,
}

/// Distance from hand to elbow along the table, and the elbow's height above the table, in metres.
const REACHES_M: f64 = 0.27;
const ELBOW_M: f64 = 0.12;

impl HandPose {
    /// A hand over a table of this height, stretched out from the human's side: the elbow is further away from the
    /// robot arm's base than the hand.
    pub fn reaching(at_m: Point3<f64>, table_m: f64) -> HandPose {
        HandPose { at_m, elbow_m: Point3::new(at_m.x + REACHES_M, at_m.y, table_m + ELBOW_M) }
    }

    /// The capsules that approximate hand and forearm.
    pub fn capsules(&self) -> [Capsule; 2] {
        let along = (self.elbow_m - self.at_m).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        let half = along * (HAND_LENGTH_M / 2.0 - HAND_M);
        let wrist = self.at_m + half;
        [
            Capsule { ends_m: [self.at_m - half, wrist], radius_m: HAND_M },
            Capsule { ends_m: [wrist, self.elbow_m], radius_m: FOREARM_M },
        ]
    }

    /// The distance between the hand and the capsules of an arm's links, in metres.
    pub fn distance_m(&self, arm: &[(usize, Capsule)]) -> f64 {
        let human = self.capsules();
        let pairs = arm.iter().flat_map(|(_, link)| human.iter().map(move |part| link.nearest(part).distance_m));
        pairs.fold(f64::INFINITY, f64::min)
    }
}

/// The rigid body of hand and forearm, held by a spring that stands for the person's arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct PhysicalHand {
    body: RigidBodyHandle,
    pub wanted: HandPose,
    /// The height of the table, onto which the arm can clamp the hand, in metres.
    table_m: f64,
}

impl PhysicalHand {
    /// A hand in this pose over a table of this height in metres, added to the bodies.
    pub fn new(bodies: &mut RigidBodySet, wanted: HandPose, table_m: f64) -> PhysicalHand {
        let body = RigidBodyBuilder::dynamic()
            .translation(single(wanted.at_m.coords))
            .additional_mass(HAND_KG)
            .lock_rotations()
            .gravity_scale(0.0)
            .can_sleep(false);
        PhysicalHand { body: bodies.insert(body), wanted, table_m }
    }

    pub fn body(&self) -> RigidBodyHandle {
        self.body
    }

    /// The present pose of the hand, which contact forces displace.
    pub fn place(&self, bodies: &RigidBodySet) -> HandPose {
        let Some(body) = bodies.get(self.body) else { return self.wanted };
        let at_m = Point3::from(double(body.translation()));
        // The forearm yields with the hand.
        HandPose { at_m, elbow_m: self.wanted.elbow_m + (at_m - self.wanted.at_m) }
    }

    pub(crate) fn velocity_m_s(&self, bodies: &RigidBodySet) -> Vector3<f64> {
        bodies.get(self.body).map_or_else(Vector3::zeros, |body| double(body.linvel()))
    }

    /// Overlap of the hand with the table in metres; 0 above it.
    pub(crate) fn depth_in_table_m(&self, bodies: &RigidBodySet) -> f64 {
        (self.table_m + HAND_M - self.place(bodies).at_m.z).max(0.0)
    }

    /// Applies the forces of a physics step to the hand: the spring of the person's arm, and the contact with the robot
    /// (newtons).
    pub fn push(&self, bodies: &mut RigidBodySet, by_robot_n: Vector3<f64>) {
        let force = self.held_n(bodies) + by_robot_n;
        let Some(body) = bodies.get_mut(self.body) else { return };
        body.reset_forces(false);
        body.add_force(single(force), true);
    }

    /// Moves the hand for this many seconds without the physics engine, by the same forces, where nothing can touch it.
    pub(crate) fn swing(&self, bodies: &mut RigidBodySet, takes_s: f32) {
        let force = single(self.held_n(bodies));
        let Some(body) = bodies.get_mut(self.body) else { return };
        let velocity = body.linvel() + force * (takes_s / HAND_KG);
        let at_m = body.translation() + velocity * takes_s;
        body.set_linvel(velocity, true);
        body.set_translation(at_m, true);
    }

    /// The forces of the person's arm and of the table on the hand, in newtons.
    fn held_n(&self, bodies: &RigidBodySet) -> Vector3<f64> {
        let away = self.wanted.at_m - self.place(bodies).at_m;
        let by_table_n = Vector3::z() * (self.depth_in_table_m(bodies) * STIFFNESS_N_M);
        away * HELD_N_M - self.velocity_m_s(bodies) * HELD_NS_M + by_table_n
    }
}

/// Converts a vector to the single precision of the physics engine.
pub(super) fn single(vector: Vector3<f64>) -> Vector {
    Vector::new(vector.x as f32, vector.y as f32, vector.z as f32)
}

/// Converts a vector from the physics engine to double precision.
pub(super) fn double(vector: Vector) -> Vector3<f64> {
    Vector3::new(f64::from(vector.x), f64::from(vector.y), f64::from(vector.z))
}
