//! The study: from what single trials show to what a whole study says. Pure; recordings are read elsewhere.
//!
//! The room is pure: a `Trial` holds the counts, medians, sequences and answers of one recording, and everything else is computed from
//! trials. Offline, concepts are evaluated on unassisted trials: ToM-Com plans once and all costs of communication are applied to the same
//! benefits; ToM's thresholds are applied to the same estimate. Beliefs come from simulated participants' records, for people from two
//! raters' codes where both coded every error, else from the estimate; the summary names the source (`beliefs_from`).
//!
//! - [`trial`] keeps a few numbers of each trial; [`figures`] sums them up, with [`effect`], [`roc`] and [`statistics`].
//! - [`tables`] declares the tables: of each what a row is made from, and each [column](mod@column) with name, unit, meaning
//!   and value. First lines, rows and [`dictionary`] follow from the declarations. A statistic that is compared between assisted and
//!   unassisted trials is a column of the table of trials that says so ([`tables::trials`]); its two columns of the table of
//!   participants and its line in the report follow.
//! - [`report`] makes the page, with [`charts`].

pub mod arm_group;
pub mod charts;
pub mod column;
pub mod definitions;
pub mod dictionary;
pub mod effect;
pub mod facts;
pub mod figures;
pub mod prevention;
pub mod report;
pub mod robot_tally;
pub mod roc;
pub mod statistics;
pub mod svg;
pub mod tables;
pub mod trial;
