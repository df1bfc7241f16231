//! Measures of whole sessions: what is known of the beliefs behind presses, and how signals are judged.

mod choices;
mod judged_signals;
