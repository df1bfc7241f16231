//! The arms that carry out the robot's task policy: a timed one, whose presses take a while by chance, and a UR5 in the
//! physics with a human hand beside it. The second needs the feature `physics`.

#[cfg(feature = "physics")]
pub mod body;
#[cfg(not(feature = "physics"))]
#[path = "without_physics.rs"]
pub mod body;
#[cfg(feature = "physics")]
pub mod clearance;
#[cfg(feature = "physics")]
pub mod controller;
#[cfg(feature = "physics")]
pub mod inverse;
#[cfg(feature = "physics")]
pub mod kinematics;
#[cfg(feature = "physics")]
pub mod link;
#[cfg(feature = "physics")]
pub mod motion;
#[cfg(feature = "physics")]
pub mod physics;
#[cfg(feature = "physics")]
pub mod reach;
#[cfg(feature = "physics")]
pub mod reaching;
pub mod report;
#[cfg(feature = "physics")]
pub mod separation;
#[cfg(feature = "physics")]
mod touch;
#[cfg(feature = "physics")]
pub mod trajectory;
#[cfg(feature = "physics")]
pub mod urdf;
pub mod worker;
