//! The arms that carry out the robot's task policy: a timed one, whose presses take a while by chance, and a UR5 in the
//! physics with a human hand beside it.

pub mod body;
pub mod clearance;
pub mod controller;
pub mod inverse;
pub mod kinematics;
pub mod link;
pub mod motion;
pub mod physics;
pub mod reach;
pub mod reaching;
pub mod separation;
mod touch;
pub mod trajectory;
pub mod urdf;
pub mod worker;
