//! Analysis of a study: from single trials to summary, tables and report. Files are read and written in [`files`] alone.
//!
//! [`TrialStatistics`](trial_statistics::TrialStatistics) holds the counts, medians, sequences and answers of one recording, and
//! [`TrialDetails`](trial_statistics::TrialDetails) what is too large to be kept in memory for every trial; everything
//! else is computed from both. Communication concepts are evaluated offline on unassisted trials: ToM-Com plans once and
//! all costs of communication are applied to the same benefits; ToM's thresholds are applied to the same estimate. Causes
//! of errors come from the recorded beliefs of simulated participants; for people from two raters' codes if both coded
//! every error, else from the belief estimate. The summary names the source of the causes (`beliefs_from`).
//!
//! - [`figures`] summarizes the trials with [`effect`], [`roc`] and [`statistics`]. [`arm_comparison`] compares any number
//!   of arms, as planned and as carried out, by a linear mixed model and a
//!   negative binomial one ([`mixed_models`]).
//! - [`pool`] simulates participants, [`drawn_study`] draws studies from them; [`power`] counts in how many of these
//!   studies tests find an effect; [`arm_table`] compares the arms of a pool.
//! - [`frozen_plan`] is the plan that is frozen before a study, and compared with it; [`planned_trial`] finds trials of a
//!   plan that have no recording, or two.
//! - [`study_part`] is what a shard of a study's recordings hands to the joined analysis.
//! - [`tables`] declares the tables: the source of a row, and each [column](mod@column) with name, unit, meaning and
//!   value. Header lines, rows and dictionary are generated. A measure that is compared between assisted and unassisted
//!   trials is declared as such in the table of trials ([`tables::trials`]); the measure's columns in the table of
//!   participants and its line in the report are generated.
//! - [`report`] builds the page of the report, with [`charts`].
//!
//! Commands over recordings: [`pass`] reads each once for a study; [`fit`], [`similarity`], [`codes`],
//! [`bids_export`], [`annotation_export`] and `mcap_export`. [`analysis`] has computation over events, [`files`] what is read
//! and written.

#![deny(unsafe_code)]

pub mod acceptance;
pub mod analysis;
pub mod annotation_export;
pub mod arm_comparison;
pub mod arm_table;
pub mod bids_export;
pub mod charts;
pub mod codes;
pub mod column;
pub mod definitions;
pub mod drawn_study;
pub mod effect;
pub mod facts;
pub mod figures;
pub mod files;
pub mod fit;
pub mod frozen_plan;
pub mod gathered;
mod grouping;
pub mod headline;
pub mod kept_cost;
pub mod live_arms;
#[cfg(feature = "mcap")]
pub mod mcap_export;
pub mod mixed_models;
pub mod parallel;
pub mod pass;
pub mod planned_trial;
pub mod pool;
pub mod power;
pub mod prevention;
pub mod rater_episodes;
pub mod report;
pub mod robot_tally;
pub mod roc;
pub mod similarity;
pub mod standing;
pub mod statistics;
pub mod study_part;
pub mod tables;
pub mod tournament;
pub mod trial_statistics;
mod why;
