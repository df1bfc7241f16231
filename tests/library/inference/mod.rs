//! Inference of the human's belief against exact computation, against humans who are simulated from the model itself, against
//! its own plain reference, and under whatever may come.

mod calibration;
mod exact;
mod fitting;
mod grid;
mod laws;
mod observed;
mod particles;
mod recorded;
mod unknown_gaze;
mod world;
