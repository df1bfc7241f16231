//! Inference of the human's belief in whole sessions: intervals of fits, and drop-outs of the tracker.

mod drop_outs;
mod fitting_intervals;
