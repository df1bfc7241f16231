//! What comes from a tracker, whatever it is, on its way into the session.

use std::time::Instant;

use crate::gaze::GazeSample;

/// So many news may wait to be taken.
pub const WAITING: usize = 4096;

/// News of a tracker. Places are fractions of the wall display, the origin at the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum GazeNews {
    /// A sample, and when it was taken, where the clocks were compared.
    Sample(GazeSample, Option<Instant>),
    /// So many messages, lines or samples that were none.
    Malformed(u64),
    /// Number of rejected senders: connections and datagrams that are not a tracker's.
    Rejected(u64),
    /// So many news that nobody took in time.
    Overrun(u64),
    /// A tracker's program began to send; its clock may be another one than before.
    Began,
    /// A tracker's program answers, and calls itself so.
    Connected(String),
    /// It does not any more.
    Lost(String),
    SeesDisplay(bool),
    /// A fixation that is over.
    Fixation(TrackerFixation),
    /// Lids closed, or opened.
    Blink {
        is_onset: bool,
        confidence: f64,
        taken: SampleTime,
    },
}

/// When something was, on the tracker's clock and on ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleTime {
    pub device_ns: u64,
    pub at: Option<Instant>,
}

/// A fixation as a tracker finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerFixation {
    pub id: u64,
    /// On the display, if it was there.
    pub at: Option<[f64; 2]>,
    pub duration_ms: f64,
    pub dispersion_deg: f64,
    pub confidence: f64,
    pub began: SampleTime,
}
