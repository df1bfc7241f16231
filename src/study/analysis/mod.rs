//! Computation over sessions and recordings: judged presses and estimates, fits, comparisons and summaries. Everything
//! in this module is a function of events that the caller passes in; files, threads and clocks belong to the caller.

pub mod annotations;
pub mod bids;
pub mod comparison_summary;
pub mod film_clock;
pub mod film_flashes;
pub mod fitting;
#[cfg(feature = "mcap")]
pub mod foxglove;
pub mod kitchen_summary;
pub mod lesson_report;
pub mod likelihood;
pub mod offer_summary;
pub mod probe_detection;
pub mod probe_figures;
pub mod probe_record;
pub mod recording_summary;
pub mod seen_contents;
pub mod trial_summary;
