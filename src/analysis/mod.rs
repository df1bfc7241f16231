//! Computation over sessions and recordings: what follows from events press by press, fits, comparisons and summaries.
//! Everything here is a function of events that the caller hands in; files, threads and clocks are the caller's.

pub mod advisor;
pub mod belief_check;
pub mod fitting;
pub mod follower;
pub mod gaze_summary;
pub mod trial_summary;
pub mod watcher;
pub mod wizard_log;
