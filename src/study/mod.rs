//! The study: from what single trials show to what a whole study says. Pure; recordings are read elsewhere.
//!
//! The room is pure: a `Trial` holds the counts, medians, sequences and answers of one recording, and everything else is computed from
//! trials. Offline, concepts are evaluated on unassisted trials: ToM-Com plans once and all costs of communication are applied to the same
//! benefits; ToM's thresholds are applied to the same estimate. Beliefs come from simulated participants' records, for people from two
//! raters' codes where both coded every error, else from the estimate; the summary names the source (`beliefs_from`).

pub mod charts;
pub mod definitions;
pub mod dictionary;
pub mod effect;
pub mod facts;
pub mod figures;
pub mod prevention;
pub mod report;
pub mod robot;
pub mod roc;
pub mod statistics;
pub mod svg;
pub mod tables;
pub mod trial;
pub mod trial_row;
