//! The robot arms that carry out the robot's task policy: a timed arm, whose presses have a random duration, a UR5
//! in a physics simulation with a human hand beside it, which needs the feature `physics`, and a real arm elsewhere.
//!
//! `worker` makes the robot's presses with any of them. Of a real arm, `real_arm` has what was reported last, and the order
//! that its driver is to carry out. The timed arm draws the duration of a press. The simulated UR5
//! has a controller at 125 Hz over the physics engine rapier, in steps of 2 ms near contacts and of 8 ms elsewhere.
//! The path of the UR5 to a button is planned before the motion starts (up, across, down; cubic legs with a quintic
//! time law) and checked against table, own links and obstacles. Slowing down only stretches the time along the
//! path, so the arm never leaves a checked path. Contact with the hand, and between hand and table, are springs
//! with the stiffness of a hand, computed beside the physics, because the peak force of a rigid contact would
//! depend on the step.
//!
//! Control cycles are internal events of the session and happen only while the arm moves, is about to move, or the hand
//! moves. Above the button, the program decides again whether the press is still useful. A press is a click of the
//! button. The hand follows the presses and never changes them. The stop thresholds are in `tomcom_core::robot`; a
//! contact is recorded once, a tenth of a second after the contact began.

#![deny(unsafe_code)]

pub mod real_arm;
pub mod worker;

#[cfg(feature = "physics")]
pub mod body;
#[cfg(not(feature = "physics"))]
#[path = "without_physics.rs"]
pub mod body;
#[cfg(feature = "physics")]
pub mod controller;
#[cfg(feature = "physics")]
pub mod inverse;
#[cfg(feature = "physics")]
pub mod kinematics;
#[cfg(feature = "physics")]
pub mod physics;
#[cfg(feature = "physics")]
pub mod reach;
#[cfg(feature = "physics")]
pub mod reaching;
#[cfg(feature = "physics")]
pub mod trajectory;
