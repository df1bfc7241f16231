//! Measures of the human's behaviour, beliefs and signals, used live and in the analysis.
//!
//! The files from the ground up:
//!
//! - A press: [`errors`], [`attribution`] (cause of an error), `judged_press` (both); [`sequences`] of errors and
//!   episodes of false belief, `cause_kinds` (orders, recipes, places).
//! - An estimate of beliefs: [`detection`] (ROC, calibration), `press_view` (belief and estimate before a press),
//!   [`flags`], [`belief_detection`] (all of these),
//!   [`resampled_detection`] (the same of resampled trials). [`belief_basis`]: the source of knowledge about beliefs.
//! - Communication: `median`, [`matching`] of two lists of communications, [`wizard_performance`]. [`cause_codes`]:
//!   raters' codes of causes, whose agreement uses `matching`; [`consensus`] of two raters; [`rater_choice`]: which two
//!   raters an analysis uses.

pub mod attribution;
pub mod belief_basis;
pub mod belief_detection;
pub mod cause_codes;
pub mod cause_kinds;
pub mod consensus;
pub mod detection;
pub mod errors;
pub mod flags;
mod judged_press;
pub mod matching;
mod median;
mod press_view;
pub mod rater_choice;
pub mod resampled_detection;
pub mod sequences;
pub mod wizard_performance;

pub use judged_press::JudgedPress;
pub use median::median;
