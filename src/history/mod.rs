//! What a session's events add up to over time, for every reader of a session: the course of the estimated belief, the
//! comparison of what wizard and assistants communicated, and words for what happened. Nothing is drawn here, and no
//! file is read.

pub mod belief_track;
pub mod comparison;
pub mod landmark;
pub mod wording;
