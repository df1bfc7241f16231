//! What real streams of gaze have wrong, counted by kind. Trackers go back in time, send things twice, pause, hold numbers
//! that are none, and change their rate; nothing of it may reach a belief.

use serde::{Deserialize, Serialize};

use super::GazeSample;
use crate::base::time::SessionTime;

/// Contents of the display are remembered for so many seconds: an older sample may have shown something else.
pub const TOO_OLD_S: f64 = 0.5;
/// No tracker sends so many samples a second for long.
pub const MAX_HZ: f64 = 2000.0;
/// So many samples may come at once after a pause.
const BURST: f64 = 1000.0;
/// Among so many of the newest samples a repeated one is found.
const RECENT: usize = 32;

/// Why a recorded sample is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GazeFault {
    /// The same sample came a little earlier.
    Duplicate,
    /// It was taken too long ago.
    TooOld,
    /// A sample that was taken later came before it.
    OutOfOrder,
}

/// How many samples were recorded and not read, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FaultCounts {
    pub duplicate: u64,
    pub too_old: u64,
    pub out_of_order: u64,
}

impl FaultCounts {
    /// All of them.
    pub fn sum(self) -> u64 {
        self.duplicate + self.too_old + self.out_of_order
    }
}

/// What came from a tracker and is no sample that could be recorded, counted since the session began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DropCounts {
    /// Messages, lines and samples that are none: broken, wrongly typed, not a number.
    pub malformed: u64,
    /// Beyond [`MAX_HZ`].
    pub too_frequent: u64,
    /// Came faster than they could be taken.
    pub overrun: u64,
}

impl DropCounts {
    /// All of them.
    pub fn sum(self) -> u64 {
        self.malformed + self.too_frequent + self.overrun
    }
}

/// Finds the faults of a stream, sample by sample. Only samples of which the tracker says when they were taken are judged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampleChecker {
    newest: Option<SessionTime>,
    recent: Vec<(Option<u64>, [u64; 2])>,
    next: usize,
    pub counts: FaultCounts,
}

impl SampleChecker {
    /// What is wrong with a sample that arrived now; nothing if it can be read.
    pub fn judge(&mut self, sample: &GazeSample, arrived: SessionTime) -> Option<GazeFault> {
        let taken = sample.taken_ns?.min(arrived);
        let mark = (sample.device_ns, [sample.x.to_bits(), sample.y.to_bits()]);
        let fault = if sample.device_ns.is_some() && self.recent.contains(&mark) {
            self.counts.duplicate += 1;
            Some(GazeFault::Duplicate)
        } else if arrived.secs_since(taken) > TOO_OLD_S {
            self.counts.too_old += 1;
            Some(GazeFault::TooOld)
        } else if self.newest.is_some_and(|newest| taken < newest) {
            self.counts.out_of_order += 1;
            Some(GazeFault::OutOfOrder)
        } else {
            self.newest = Some(taken);
            None
        };
        match self.recent.get_mut(self.next) {
            Some(place) => *place = mark,
            None => self.recent.push(mark),
        }
        self.next = (self.next + 1) % RECENT;
        fault
    }
}

/// Lets through as many samples as a tracker can send.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLimit {
    left: f64,
    at: SessionTime,
}

impl Default for RateLimit {
    fn default() -> RateLimit {
        RateLimit { left: BURST, at: SessionTime::ZERO }
    }
}

impl RateLimit {
    /// Whether a sample that arrives now may pass.
    pub fn admits(&mut self, now: SessionTime) -> bool {
        self.left = (self.left + now.secs_since(self.at) * MAX_HZ).min(BURST);
        self.at = self.at.max(now);
        let admits = self.left >= 1.0;
        self.left -= f64::from(u8::from(admits));
        admits
    }
}
