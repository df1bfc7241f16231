//! The robot arm, the buttons and the human's hand as bodies in the physics engine rapier.
//!
//! Where the arm can touch a button or the hand, a cycle of the controller has four physics steps of 2 ms. Elsewhere, in
//! free air, the joints are where the controller commands, and no physics is computed: the drives of an arm without a
//! fault follow smooth commands within a milliradian. An arm that was pushed aside first comes back by the physics. The
//! choice follows from the state alone, so a session stays reproducible.
//!
//! The arm is a multibody from the URDF; each joint is driven by a motor that follows a commanded angle with no more
//! torque than the URDF allows. Buttons slide on springs, click on their way and end at a stop. The hand is a body on a
//! spring, which stands for the person's arm. The contact between hand and robot arm is a spring, too, as stiff as a
//! hand (ISO/TS 15066), because the peak force of a rigid contact would depend on the step of the physics.

pub mod bodies;

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d::prelude::{
    BroadPhaseBvh, CCDSolver, ColliderBuilder, ColliderHandle, ColliderSet, GenericJointBuilder, ImpulseJointSet,
    IntegrationParameters, IslandManager, JointAxesMask, JointAxis, MassProperties, MotorModel, MultibodyJointHandle,
    MultibodyJointSet, NarrowPhase, PhysicsPipeline, Pose, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, Rotation,
    SoftBodySet, Vector,
};
use tomcom_core::robot::{JOINTS, JointAngles};

use self::bodies::{FLESH_NS_M, HandPose, PhysicalButton, PhysicalHand, STICK, STIFFNESS_N_M, double, single};
use crate::kinematics::{ArmLink, LinkShape, SerialArm};
use crate::reach::Capsule;

/// Duration of a cycle of the arm's controller, in seconds: that of the real controller, 125 Hz.
pub const CYCLE_S: f64 = 0.008;
/// Number of physics steps in a cycle: contacts and buttons need steps of 2 ms.
const STEPS: usize = 4;
/// Number of iterations of the physics solver in each step; few iterations suffice, since the steps are short.
const ITERATIONS: usize = 2;
const GRAVITY_M_S2: f32 = -9.81;
/// Index of the angle among a joint's coordinates in the physics engine.
const ANGLE: usize = 3;
/// Number of controller cycles that a new arm needs to settle.
const SETTLES: usize = 125;
/// Gains of a joint's drive: stiffness per radian, and critical damping.
const STIFFNESS: f32 = 10_000.0;
const DAMPING: f32 = 200.0;

/// Share of the tracking error by which joint commands are corrected per cycle, and the limit of the correction in
/// radians: the correction compensates the arm's weight.
const CORRECTED: f64 = 0.1;
const MOST_CORRECTED_RAD: f64 = 0.05;
/// Distance in metres beyond which human and robot arm cannot touch within one controller cycle: in that time a reaching
/// hand moves by less than 20 mm, and the arm by less than 10 mm.
const APART_M: f64 = 0.03;
/// Tracking error of every joint, in radians, below which no physics is needed in free air.
const FOLLOWS_RAD: f64 = 0.002;

/// The contact forces measured in one controller cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactForces {
    /// The greatest force between arm and human, in newtons.
    pub human_n: f64,
    /// The force on the human when it was greatest, in newtons, in the frame of the arm's base.
    pub onto_human_n: [f64; 3],
    /// The greatest force of the stick on the button, in newtons.
    pub button_n: f64,
    /// Whether the button under the stick closed its contact.
    pub clicked: bool,
}

impl SerialArm {
    /// The distance between a hand and the arm at these joint angles, in metres.
    pub fn distance(&self, joints: &JointAngles, hand: &HandPose) -> f64 {
        hand.distance_m(&self.capsules(joints))
    }
}

/// The simulated world: arm, buttons and hand as bodies of the physics engine.
#[derive(Clone)]
pub struct PhysicsWorld {
    arm: SerialArm,
    parameters: IntegrationParameters,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibodies: MultibodyJointSet,
    ccd: CCDSolver,
    pipeline: WorkingMemory,
    /// Handles of the arm's revolute joints in the physics engine.
    joints: Vec<MultibodyJointHandle>,
    /// The rigid body of each link of the arm; parts that are fixed to a link belong to the link's body.
    links: Vec<RigidBodyHandle>,
    stick: Option<ColliderHandle>,
    buttons: Vec<PhysicalButton>,
    /// The button that the stick can touch; the other buttons are deactivated.
    active: Option<usize>,
    hand: Option<PhysicalHand>,
    table_m: f64,
    /// The capsules of all links at the arm's present joint angles, each with its link number.
    capsules: Vec<(usize, Capsule)>,
    /// Joint speeds in radians per second while the arm is in free air, where no physics is computed; `None` where physics
    /// is.
    free: Option<JointAngles>,
    /// Whether a joint's motor is disabled, so that the arm does not follow its commands.
    has_failed: bool,
    /// The last commanded joint angles, and the correction added to them.
    commanded: JointAngles,
    correction: JointAngles,
}

/// The physics engine's working memory, which has no state: a copy of the world gets a new one.
#[derive(Default)]
struct WorkingMemory(PhysicsPipeline);

impl Clone for WorkingMemory {
    fn clone(&self) -> WorkingMemory {
        WorkingMemory::default()
    }
}

impl std::fmt::Debug for PhysicsWorld {
    fn fmt(&self, into: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        into.debug_struct("PhysicsWorld").field("joints", &self.joints().0).finish_non_exhaustive()
    }
}

impl PhysicsWorld {
    /// A simulated arm with these joint angles, above buttons at these positions on a table of this height.
    pub fn new(arm: &SerialArm, joints: &JointAngles, buttons: &[[f64; 2]], table_m: f64) -> PhysicsWorld {
        let mut world = PhysicsWorld {
            arm: arm.clone(),
            parameters: IntegrationParameters {
                dt: (CYCLE_S / STEPS as f64) as f32,
                num_solver_iterations: ITERATIONS,
                max_ccd_substeps: 0,
                ..IntegrationParameters::default()
            },
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            impulse_joints: ImpulseJointSet::new(),
            multibodies: MultibodyJointSet::new(),
            ccd: CCDSolver::new(),
            pipeline: WorkingMemory::default(),
            joints: Vec::new(),
            links: Vec::new(),
            stick: None,
            buttons: Vec::new(),
            active: None,
            hand: None,
            table_m,
            capsules: arm.capsules(joints),
            free: None,
            has_failed: false,
            commanded: *joints,
            correction: [0.0; JOINTS],
        };
        world.build(joints);
        for &at_m in buttons {
            let (bodies, colliders) = (&mut world.bodies, &mut world.colliders);
            world.buttons.push(PhysicalButton::new(at_m, table_m, bodies, colliders, &mut world.impulse_joints));
        }
        // In these cycles the motors come to hold the arm's weight.
        for _ in 0..SETTLES {
            world.simulate(joints, false);
        }
        world
    }

    /// Joint angles of the arm in radians, and joint speeds in radians per second.
    pub fn joints(&self) -> (JointAngles, JointAngles) {
        if let Some(speeds) = self.free {
            return (self.commanded, speeds);
        }
        let Some((multibody, _)) = self.joints.first().and_then(|joint| self.multibodies.get(*joint)) else {
            return (self.commanded, [0.0; JOINTS]);
        };
        let mut angles = self.commanded;
        for (angle, handle) in angles.iter_mut().zip(&self.joints) {
            let link = self.multibodies.get(*handle).and_then(|(multibody, link)| multibody.link(link));
            *angle = link.map_or(*angle, |link| f64::from(link.joint().coords()[ANGLE]));
        }
        let speeds = multibody.generalized_velocity();
        (angles, std::array::from_fn(|joint| f64::from(speeds[joint])))
    }

    /// The pose of the human's hand, if there is a hand in the simulation.
    pub fn hand(&self) -> Option<HandPose> {
        self.hand.as_ref().map(|hand| hand.place(&self.bodies))
    }

    /// Selects the button that the stick can touch; `None` while the stick is above all buttons.
    pub fn aim_at(&mut self, button: Option<usize>) {
        if let Some(before) = self.active.filter(|_| self.active != button) {
            self.buttons[before].set_active(&mut self.bodies, false);
        }
        if let Some(now) = button.filter(|_| self.active != button) {
            self.buttons[now].set_active(&mut self.bodies, true);
        }
        self.active = button;
    }

    pub fn aimed_at(&self) -> Option<usize> {
        self.active
    }

    /// Whether the electrical contact of the button under the stick is closed.
    pub fn is_pressed(&self) -> bool {
        self.active.is_some_and(|active| self.buttons[active].is_closed())
    }

    /// Disables the motor of this joint to simulate a fault; with `None`, restores all motors.
    pub fn fail(&mut self, joint: Option<usize>) {
        self.has_failed = joint.is_some();
        for (index, (handle, turn)) in self.joints.iter().zip(self.arm.turns()).enumerate() {
            let Some((multibody, link)) = self.multibodies.get_mut(*handle) else { continue };
            let torque_nm = if joint == Some(index) { 0.0 } else { turn.torque_nm as f32 };
            if let Some(link) = multibody.link_mut(link) {
                link.joint.data.set_motor_max_force(JointAxis::AngX, torque_nm);
            }
        }
    }

    /// Runs a cycle of the controller: the joints move towards the angles in `command` (radians), the hand to the pose
    /// that the person wants.
    pub fn cycle(&mut self, command: &JointAngles, hand: Option<HandPose>) -> ContactForces {
        self.set_hand(hand);
        let near = self.hand().is_some_and(|hand| self.distance(&hand) < APART_M);
        let is_on_table = self.hand.is_some_and(|hand| hand.depth_in_table_m(&self.bodies) > 0.0);
        let touches = near || is_on_table || self.active.is_some() || self.has_failed;
        let felt = if touches || !self.follows() { self.simulate(command, near) } else { self.go_through_air(command) };
        self.capsules = self.arm.capsules(&self.joints().0);
        felt
    }

    /// Whether every joint is where it was last commanded to be.
    fn follows(&self) -> bool {
        let (angles, _) = self.joints();
        (0..JOINTS).all(|joint| (angles[joint] - self.commanded[joint]).abs() < FOLLOWS_RAD)
    }

    /// Moves arm and hand for one cycle in which nothing can be touched.
    fn go_through_air(&mut self, command: &JointAngles) -> ContactForces {
        self.free = Some(std::array::from_fn(|joint| (command[joint] - self.commanded[joint]) / CYCLE_S));
        self.commanded = *command;
        if let Some(hand) = self.hand {
            hand.swing(&mut self.bodies, CYCLE_S as f32);
        }
        ContactForces::default()
    }

    /// Puts the arm's bodies where the joints are, after cycles without physics.
    fn leave_the_air(&mut self) {
        let Some(speeds) = self.free.take() else { return };
        let (commanded, (angles, _)) = (self.commanded, self.joints());
        let Some((multibody, _)) = self.joints.first().and_then(|joint| self.multibodies.get_mut(*joint)) else {
            return;
        };
        let moved: [f32; JOINTS] = std::array::from_fn(|joint| (commanded[joint] - angles[joint]) as f32);
        multibody.apply_displacements(&moved);
        multibody.generalized_velocity_mut().copy_from_slice(&speeds.map(|speed| speed as f32));
        multibody.forward_kinematics(&self.bodies, false);
        multibody.update_rigid_bodies(&mut self.bodies, true);
    }

    /// Runs the physics for one cycle; `near`: the hand is so near that it can touch the arm.
    fn simulate(&mut self, command: &JointAngles, near: bool) -> ContactForces {
        self.leave_the_air();
        let before = self.commanded;
        let mut felt = ContactForces::default();
        for step in 1..=STEPS {
            let share = step as f64 / STEPS as f64;
            self.drive(
                &std::array::from_fn(|joint| before[joint] + (command[joint] - before[joint]) * share),
                &before,
                command,
            );
            let onto_human_n = self.touch(near);
            if onto_human_n.norm() > felt.human_n {
                (felt.human_n, felt.onto_human_n) = (onto_human_n.norm(), onto_human_n.into());
            }
            self.step();
            if let Some(active) = self.active {
                felt.clicked |= self.buttons[active].clicks(&self.bodies);
                felt.button_n = felt.button_n.max(self.force_on(active));
            }
        }
        let (angles, _) = self.joints();
        for joint in 0..JOINTS {
            let behind = command[joint] - angles[joint];
            let most = MOST_CORRECTED_RAD;
            self.correction[joint] = (self.correction[joint] + CORRECTED * behind).clamp(-most, most);
        }
        self.commanded = *command;
        felt
    }

    /// The force of the stick on a button in the last physics step, in newtons.
    fn force_on(&self, button: usize) -> f64 {
        let Some(stick) = self.stick else { return 0.0 };
        let pair = self.narrow_phase.contact_pair(stick, self.buttons[button].collider());
        pair.map_or(0.0, |pair| f64::from(pair.total_impulse_magnitude() / self.parameters.dt))
    }

    fn set_hand(&mut self, hand: Option<HandPose>) {
        match (&mut self.hand, hand) {
            (Some(one), Some(wanted)) => one.wanted = wanted,
            (None, Some(wanted)) => self.hand = Some(PhysicalHand::new(&mut self.bodies, wanted, self.table_m)),
            (Some(one), None) => {
                let (islands, colliders) = (&mut self.islands, &mut self.colliders);
                let (impulses, multibodies) = (&mut self.impulse_joints, &mut self.multibodies);
                let none = &mut SoftBodySet::new();
                self.bodies.remove(one.body(), islands, colliders, impulses, multibodies, none, true);
                self.hand = None;
            }
            (None, None) => {}
        }
    }

    pub fn distance(&self, hand: &HandPose) -> f64 {
        hand.distance_m(&self.capsules)
    }

    /// Blocks this button, to simulate a fault.
    pub fn jam(&mut self, button: usize) {
        self.buttons[button].jam(&mut self.bodies);
    }

    /// Applies the brakes: every joint stays where it is, whatever its motor does.
    pub fn brake(&mut self) {
        self.fail(None);
        self.commanded = self.joints().0;
    }

    fn drive(&mut self, target: &JointAngles, before: &JointAngles, after: &JointAngles) {
        for (joint, handle) in self.joints.iter().enumerate() {
            let Some((multibody, link)) = self.multibodies.get_mut(*handle) else { continue };
            let Some(link) = multibody.link_mut(link) else { continue };
            let position = (target[joint] + self.correction[joint]) as f32;
            let speed = ((after[joint] - before[joint]) / CYCLE_S) as f32;
            link.joint.data.set_motor(JointAxis::AngX, position, speed, STIFFNESS, DAMPING);
        }
    }

    /// Applies the contact force between arm and human at their deepest overlap. Returns the force on the
    /// human in newtons.
    fn touch(&mut self, near: bool) -> Vector3<f64> {
        let Some(hand) = self.hand else { return Vector3::zeros() };
        let deepest = if near { self.deepest(&hand) } else { None };
        let (link, onto_human_n, at) = deepest.unwrap_or((0, Vector3::zeros(), Point3::origin()));
        hand.push(&mut self.bodies, onto_human_n);
        for body in self.links.iter().skip(1) {
            if let Some(body) = self.bodies.get_mut(*body) {
                body.reset_forces(false);
                body.reset_torques(false);
            }
        }
        if let Some(body) = self.links.get(link).and_then(|body| self.bodies.get_mut(*body)) {
            body.add_force_at_point(single(-onto_human_n), single(at.coords), true);
        }
        onto_human_n
    }

    /// The link with the deepest overlap with the human, the force on the human in newtons, and the contact point.
    fn deepest(&self, hand: &PhysicalHand) -> Option<(usize, Vector3<f64>, Point3<f64>)> {
        let human = hand.place(&self.bodies).capsules();
        let arm = self.arm.capsules(&self.joints().0);
        let pairs = arm.iter().flat_map(|(link, shape)| human.iter().map(move |part| (*link, shape.nearest(part))));
        let (link, nearest) = pairs.min_by(|one, two| one.1.distance_m.total_cmp(&two.1.distance_m))?;
        let depth_m = -nearest.distance_m;
        let [on_arm, on_human] = nearest.at_m;
        let away = (on_human - on_arm).try_normalize(1e-6).unwrap_or_else(Vector3::z);
        let at = on_human - away * (depth_m / 2.0);
        let of_link = self.bodies.get(*self.links.get(link)?)?.velocity_at_point(single(at.coords));
        let closing_m_s = (double(of_link) - hand.velocity_m_s(&self.bodies)).dot(&away);
        let force_n = depth_m * STIFFNESS_N_M + closing_m_s * FLESH_NS_M;
        (depth_m > 0.0 && force_n > 0.0).then(|| (link, away * force_n, at))
    }

    fn step(&mut self) {
        self.pipeline.0.step(
            Vector::new(0.0, 0.0, GRAVITY_M_S2),
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibodies,
            &mut SoftBodySet::new(),
            &mut self.ccd,
            &(),
            &(),
        );
    }
}

/// Reflected rotor inertia of the arm's large and small drives (rotor inertia times gear ratio squared), in kg m². The
/// values are estimates: the manufacturer does not publish the inertia.
const ARMATURE_KG_M2: [f32; JOINTS] = [1.0, 1.0, 1.0, 0.2, 0.2, 0.2];

impl PhysicsWorld {
    pub(super) fn build(&mut self, joints: &JointAngles) {
        let mut carried_from = Isometry3::identity();
        for link in self.arm.links.clone() {
            let Some(parent) = self.links.last().copied() else {
                self.links.push(self.bodies.insert(RigidBodyBuilder::fixed()));
                continue;
            };
            let parent_from_link = carried_from * link.parent_from_joint;
            let Some(turn) = &link.turns else {
                self.links.push(parent);
                carried_from = parent_from_link;
                self.add_stick(parent, &link, &carried_from);
                continue;
            };
            let body = self
                .bodies
                .insert(RigidBodyBuilder::dynamic().can_sleep(false).additional_mass_properties(mass(&link)));
            // A revolute joint of the physics engine turns about x.
            let x_onto_axis = nalgebra::UnitQuaternion::rotation_between(&Vector3::x(), &turn.axis)
                .unwrap_or_else(nalgebra::UnitQuaternion::identity);
            let frame = Isometry3::from_parts(Default::default(), x_onto_axis);
            let joint = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
                .local_frame1(pose(&(parent_from_link * frame)))
                .local_frame2(pose(&frame))
                .motor_model(JointAxis::AngX, MotorModel::AccelerationBased)
                .motor_max_force(JointAxis::AngX, turn.torque_nm as f32)
                .build();
            self.joints.extend(self.multibodies.insert(parent, body, joint, true));
            self.links.push(body);
            carried_from = Isometry3::identity();
        }
        let Some((multibody, _)) = self.joints.first().and_then(|joint| self.multibodies.get_mut(*joint)) else {
            return;
        };
        // Before this step the multibody does not have the information that its root is fixed.
        multibody.forward_kinematics(&self.bodies, true);
        multibody.damping_mut().fill(0.0);
        multibody.armature_mut().copy_from_slice(&ARMATURE_KG_M2);
        multibody.apply_displacements(&joints.map(|angle| angle as f32));
        multibody.forward_kinematics(&self.bodies, false);
        multibody.update_rigid_bodies(&mut self.bodies, true);
    }

    fn add_stick(&mut self, parent: RigidBodyHandle, link: &ArmLink, parent_from_link: &Isometry3<f64>) {
        for solid in &link.solids {
            let LinkShape::Cylinder { radius_m, length_m } = solid.shape else { continue };
            let half_m = (length_m / 2.0 - radius_m) as f32;
            let collider = ColliderBuilder::capsule_z(half_m, radius_m as f32)
                .position(pose(&(parent_from_link * solid.link_from_solid)))
                .density(0.0)
                .collision_groups(STICK);
            self.stick = Some(self.colliders.insert_with_parent(collider, parent, &mut self.bodies));
        }
    }
}

fn pose(isometry: &Isometry3<f64>) -> Pose {
    let turn = isometry.rotation.coords;
    let rotation = Rotation::from_xyzw(turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32);
    Pose::from_parts(single(isometry.translation.vector), rotation.normalize())
}

fn mass(link: &ArmLink) -> MassProperties {
    let Some(weight) = &link.weight else { return MassProperties::default() };
    MassProperties::new(single(weight.centre_m.coords), weight.mass_kg as f32, single(weight.inertia_kg_m2))
}
