//! The composers: they bring session, robot, participant, files and clock together. Nothing else does.

pub mod advisor;
mod begun;
pub mod check_beliefs;
pub mod compare;
mod desk;
pub mod engine;
pub mod figures;
pub mod film;
pub mod follower;
pub mod headless;
pub mod kitchen;
pub mod leaving;
pub mod live;
pub mod options;
mod parallel;
pub mod plan;
pub mod replay;
pub mod resume;
pub mod review;
pub mod series;
pub mod similarity;
pub mod simulate;
pub mod standing;
pub mod tell;
pub mod timing;
pub mod verify;
