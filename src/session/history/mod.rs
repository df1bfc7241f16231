//! History of a session for console, replay, study and Rerun: the belief estimate over time and its false beliefs, the comparison of wizard
//! and assistants, the reasons of errors, and the wording of events. This module draws nothing and reads no files.

pub mod belief_track;
pub mod comparison;
pub mod error_reasons;
pub mod event_words;
pub mod false_beliefs;
pub mod signal_words;
pub mod wording;
