//! Computation over sessions and recordings: judged presses and estimates, fits, comparisons and summaries. Everything here is a
//! function of events that the caller passes in; files, threads and clocks belong to the caller.

pub mod advisor;
#[cfg(feature = "cli")]
pub mod belief_check;
#[cfg(feature = "cli")]
pub mod cohort_table;
pub mod compared_recording;
pub mod comparison_summary;
pub mod error_list;
pub mod event_lines;
pub mod exclusion_status;
#[cfg(feature = "cli")]
pub mod fitting;
pub mod follower;
pub mod gaze_summary;
pub mod kitchen_summary;
pub mod lesson_report;
#[cfg(feature = "cli")]
pub mod likelihood;
#[cfg(feature = "cli")]
pub mod looks;
pub mod offer_steadiness;
pub mod offer_summary;
pub mod order_work;
pub mod planner_accuracy;
pub mod recording_summary;
#[cfg(feature = "cli")]
pub mod recording_table;
pub mod sweep_row;
pub mod timing_summary;
pub mod training_record;
#[cfg(feature = "cli")]
mod trial_bootstrap;
pub mod trial_summary;
pub mod watcher;
pub mod wizard_log;
