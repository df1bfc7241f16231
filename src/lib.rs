//! tomcom: Wizard-of-Oz experiments in human-robot cooperation, with a model of what the human believes.
//!
//! A human and a robot cook together in a virtual kitchen: each press of a button moves, processes or serves something.
//! The human may hold *false beliefs*, having missed what the robot did, or misremembering a recipe. A wizard, or an
//! assistant, sends *signals* that show the human a recipe or a location. This crate is the program `tomcom` that runs
//! such experiments. What it stands on are crates of their own: the model ([`tomcom_core`]), simulated people
//! ([`tomcom_people`]), the robot arms (`tomcom_arm`), sessions with their recordings ([`tomcom_session`]), their devices
//! ([`tomcom_devices`]) and studies ([`tomcom_study`]).
//!
//! A **session** ([`tomcom_session::Session`]) is its event log. [`tomcom_session::apply()`] is the only way to change one. The
//! **engine** ([`tomcom_session::engine::SessionEngine`]) raises the events of robot, simulated participant and clock; its caller
//! passes the time.
//!
//! # The modules
//!
//! Imports go one way, from right to left: `console`, `run`, `cli`. ARCHITECTURE.md says what
//! each contains, and what it must not depend on.
//!
//! # Features
//!
//! All are on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `display` | the server of the participant's display |
//! | `mcap` | recordings as MCAP |
//! | `physics` | the simulated arm and its kinematics |
//! | `rerun` | streams for Rerun's viewers |
//! | `ur` | a real UR5's driver, and a simulated controller |
//!
//! A build refuses what it leaves out, and names the missing feature: [`tomcom_session::features`].

#![deny(unsafe_code)]

pub mod cli;
pub mod console;
pub mod run;
