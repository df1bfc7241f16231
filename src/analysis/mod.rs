//! Computation over sessions and recordings: judged presses and estimates, fits, comparisons and summaries. Everything here is a
//! function of events that the caller passes in; files, threads and clocks belong to the caller.

pub mod advisor;
pub mod belief_check;
pub mod fitting;
pub mod follower;
pub mod gaze_summary;
pub mod trial_summary;
pub mod watcher;
pub mod wizard_log;
