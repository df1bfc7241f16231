//! Gaze: the tags on the wall display, and the tracker's clock.

mod clocks;
mod tags;
