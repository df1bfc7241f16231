//! The study: from what single trials show to what a whole study says. Pure; recordings are read elsewhere.

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
