//! Builds the multibody of the robot arm for the physics engine rapier from the arm's URDF.

use nalgebra::{Isometry3, Vector3};
use rapier3d::prelude::{
    ColliderBuilder, GenericJointBuilder, JointAxesMask, JointAxis, MassProperties, MotorModel, Pose, RigidBodyBuilder,
    RigidBodyHandle, Rotation,
};
use tomcom_core::robot::{JOINTS, JointAngles};

use super::{PhysicsWorld, button, hand_body::single};
use crate::link::{ArmLink, LinkShape};

/// Reflected rotor inertia of the arm's large and small drives (rotor inertia times gear ratio squared), in kg m². The
/// values are estimates: the manufacturer does not publish the inertia.
const ARMATURE_KG_M2: [f32; JOINTS] = [1.0, 1.0, 1.0, 0.2, 0.2, 0.2];

impl PhysicsWorld {
    /// Assembles the robot arm at these joint angles.
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

    /// Adds the collision shape of the stick, with which the arm presses buttons.
    fn add_stick(&mut self, parent: RigidBodyHandle, link: &ArmLink, parent_from_link: &Isometry3<f64>) {
        for solid in &link.solids {
            let LinkShape::Cylinder { radius_m, length_m } = solid.shape else { continue };
            let half_m = (length_m / 2.0 - radius_m) as f32;
            let collider = ColliderBuilder::capsule_z(half_m, radius_m as f32)
                .position(pose(&(parent_from_link * solid.link_from_solid)))
                .density(0.0)
                .collision_groups(button::STICK);
            self.stick = Some(self.colliders.insert_with_parent(collider, parent, &mut self.bodies));
        }
    }
}

/// Converts a pose to single precision.
fn pose(isometry: &Isometry3<f64>) -> Pose {
    let turn = isometry.rotation.coords;
    let rotation = Rotation::from_xyzw(turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32);
    Pose::from_parts(single(isometry.translation.vector), rotation.normalize())
}

fn mass(link: &ArmLink) -> MassProperties {
    let Some(weight) = &link.weight else { return MassProperties::default() };
    MassProperties::new(single(weight.centre_m.coords), weight.mass_kg as f32, single(weight.inertia_kg_m2))
}
