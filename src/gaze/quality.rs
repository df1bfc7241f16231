//! Faults of real gaze streams, counted by kind: clocks that jump back, duplicates, pauses, invalid numbers, changing
//! rates. No faulty sample may reach the belief estimate.

use serde::{Deserialize, Serialize};

use super::GazeSample;
use crate::base::time::SessionTime;

/// Samples older than this are not read, in seconds: the display may have shown something else when they were taken.
pub const TOO_OLD_S: f64 = 0.5;
/// Upper limit of a tracker's sampling rate, in Hz.
pub const MAX_HZ: f64 = 2000.0;
/// Number of samples that may arrive at once after a pause.
const BURST: f64 = 1000.0;
/// Number of recent samples among which duplicates are detected.
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
    /// Samples that came a second time.
    pub duplicate: u64,
    /// Samples that were older than [`TOO_OLD_S`] when they arrived.
    pub too_old: u64,
    /// Samples that were taken before one that had arrived already.
    pub out_of_order: u64,
}

impl FaultCounts {
    /// All of them.
    pub fn sum(self) -> u64 {
        self.duplicate + self.too_old + self.out_of_order
    }
}

/// Input from a tracker that cannot be recorded, counted since the session began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DropCounts {
    /// Malformed messages, lines and samples: broken, wrongly typed, not a number.
    pub malformed: u64,
    /// Samples beyond [`MAX_HZ`].
    pub too_frequent: u64,
    /// Samples that arrived faster than they could be processed.
    pub overrun: u64,
}

impl DropCounts {
    /// All of them.
    pub fn sum(self) -> u64 {
        self.malformed + self.too_frequent + self.overrun
    }
}

/// Detects faults of a stream, sample by sample. Only samples with a device time are checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampleChecker {
    newest: Option<SessionTime>,
    recent: Vec<(Option<u64>, [u64; 2])>,
    next: usize,
    /// Faults found so far, by kind.
    pub counts: FaultCounts,
}

impl SampleChecker {
    /// The fault of a sample that arrived now; none if the sample can be read.
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

/// Limits the sampling rate to what a tracker can send.
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
