//! Measures of what the human does, used live and in the analysis.
//!
//! The files from the ground up:
//!
//! - A press: [`errors`], [`attribution`] (why), `judged_press` (both); [`sequences`] of errors and episodes of false belief,
//!   `cause_kinds` (orders, recipes, places).
//! - An estimate of beliefs: [`detection`], `press_view` (what was known before a press), [`flags`],
//!   [`belief_detection`] (all of these). [`belief_basis`]: how it is known what was believed.
//! - Communication: `median`, [`matching`] of two lanes, [`wizard_performance`]. [`cause_codes`] by people has its
//!   agreement from `matching`; [`consensus`] of two raters; [`rater_choice`], which two count.

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
pub mod sequences;
pub mod wizard_performance;

pub use judged_press::JudgedPress;
pub use median::median;
