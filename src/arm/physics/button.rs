//! A simulated button: a cap that slides down on a spring, clicks on the way, and ends at a stop.

use rapier3d::prelude::{
    ColliderBuilder, ColliderHandle, ColliderSet, Group, ImpulseJointSet, InteractionGroups, InteractionTestMode,
    MotorModel, Pose, PrismaticJointBuilder, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, Rotation, Vector,
};

use crate::reach::BUTTON_M;

/// Travel of the button's cap, and the depths of the cap at which the electrical contact closes and opens, in metres.
const TRAVEL_M: f32 = 0.004;
const CLOSES_M: f32 = 0.0025;
const OPENS_M: f32 = 0.001;
/// Spring constant of a button in N/m, and preload of the spring while the button is released.
const SPRING_N_M: f32 = 600.0;
const PRELOAD_M: f32 = 0.003;
const DAMPING_NS_M: f32 = 3.0;
const MASS_KG: f32 = 0.02;
const RADIUS_M: f32 = 0.02;

/// The cap of a button in the physics.
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
            RigidBodyBuilder::dynamic().translation(middle).additional_mass(MASS_KG).lock_rotations().enabled(false);
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

    /// The collider of the button's cap.
    pub fn collider(&self) -> ColliderHandle {
        self.collider
    }

    /// Activates the button in the simulation; or releases the button and deactivates it.
    pub fn set_active(&mut self, bodies: &mut RigidBodySet, active: bool) {
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
/// Collision group of the robot's stick.
pub(super) const STICK: InteractionGroups =
    InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And);
