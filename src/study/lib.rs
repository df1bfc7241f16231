//! Analysis of a study: from single trials to summary, tables and report. Files are read and written in [`files`] alone.
//!
//! A `TrialStatistics` holds the counts, medians, sequences and answers of one recording, and `TrialDetails` what is too
//! large to be kept in memory for every trial; everything else is computed from both. Communication concepts are evaluated offline on unassisted trials: ToM-Com plans once and all costs of
//! communication are applied to the same benefits; ToM's thresholds are applied to the same estimate. Causes of errors
//! come from the recorded beliefs of simulated participants; for people from two raters' codes if both coded every
//! error, else from the belief estimate. The summary names the source of the causes (`beliefs_from`).
//!
//! - [`trial_statistics`] keeps the statistics of each trial, [`trial_totals`] sums them up; [`detail_totals`] sums up
//!   the [`trial_details`], [`concept_totals`] those of concepts; [`figures`] summarizes all of them with [`effect`],
//!   [`roc`] and [`statistics`].
//! - [`arm_analysis`] compares the conditions by the arms as planned, and again as carried out where trials deviate.
//! - [`arm_comparison`] compares any number of arms, by a [linear mixed model](linear_mixed_model) and a
//!   [negative binomial one](negative_binomial_model), after an [`arm_design`].
//! - [`drawn_study`] draws studies from a [`simulation_pool`]; [`power`] counts in how many of these studies tests find
//!   an effect, [`power_answer`] says how many participants are needed; [`arm_table`] compares the arms of a pool.
//! - [`frozen_plan`] is the plan that is frozen before a study; [`preregistration`] compares the study with that plan.
//! - [`missing_trials`] finds trials of the plan that have no recording.
//! - [`study_part`] is what a shard of a study's recordings hands to the joined analysis.
//! - [`tables`] declares the tables: the source of a row, and each [column](mod@column) with name, unit, meaning and
//!   value. Header lines, rows and [`dictionary`] are generated. A measure that is compared between assisted and
//!   unassisted trials is declared as such in the table of trials ([`tables::trials`]); the measure's columns in the
//!   table of participants and its line in the report are generated.
//! - [`report`] builds the page of the report, with [`charts`] and [`arm_chart`]; [`power_chart`] and [`cohort_chart`]
//!   are pictures of their own.
//!
//! Commands over recordings: [`pass`] reads each once for a study; [`fit`], [`similarity`], [`codes`] with
//! [`code_exchange`], [`bids_export`] and `mcap_export`; [`pool`] and [`power_measurement`] simulate. [`analysis`] has
//! computation over events, [`files`] what is read and written.

#![warn(missing_docs)]
#![deny(unsafe_code)]

pub mod acceptance;
pub mod acting_arm;
pub mod analysis;
pub mod arm_analysis;
pub mod arm_chart;
pub mod arm_comparison;
pub mod arm_design;
pub mod arm_group;
pub mod arm_table;
pub mod belief_trace;
pub mod bids_export;
pub mod charts;
pub mod code_exchange;
pub mod codes;
pub mod column;
pub mod concept_totals;
pub mod consents;
pub mod definitions;
pub mod detail_totals;
pub mod dictionary;
pub mod drawn_study;
pub mod effect;
pub mod facts;
pub mod figures;
pub mod files;
pub mod fit;
pub mod frozen_plan;
pub mod gathered;
pub mod group_orders;
pub mod kept_cost;
pub mod known_beliefs;
pub mod linear_mixed_model;
pub mod live_arms;
#[cfg(feature = "mcap")]
pub mod mcap_export;
pub mod missing_trials;
pub mod negative_binomial_model;
pub mod pairwise_differences;
pub mod parallel;
pub mod pass;
pub mod planned_trial;
pub mod pool;
pub mod power;
pub mod power_answer;
pub mod power_chart;
pub mod power_measurement;
pub mod preregistration;
pub mod prevention;
pub mod rater_episodes;
pub mod recorded_consent;
pub mod report;
pub mod robot_tally;
pub mod roc;
pub mod similarity;
pub mod simulation_pool;
pub mod standing;
pub mod statistics;
pub mod study_part;
pub mod svg;
pub mod tables;
pub mod trial_details;
pub mod trial_statistics;
pub mod trial_totals;
pub mod tutorial_summary;
