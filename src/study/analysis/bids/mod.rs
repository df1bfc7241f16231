//! Recordings as the tables of the Brain Imaging Data Structure (BIDS): a recording becomes a session with behaviour,
//! gaze becomes an eye-tracking recording, and questionnaires become phenotype tables.
//!
//! Column names and required fields are those of BIDS 1.10 and later (behavioral experiments, physiological recordings,
//! phenotypic data). This module makes the content of the files; its caller writes the files.

pub mod dataset;
pub mod events;
pub(crate) mod recording_tables;
pub(crate) mod sample_rows;
pub mod tsv;
