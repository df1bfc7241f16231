//! Faults of real gaze streams, counted by kind: clocks that jump back, duplicates, pauses, invalid numbers, changing
//! rates. No faulty gaze sample may reach the belief estimate.

use serde::{Deserialize, Serialize};

use super::GazeSample;
use crate::base::time::SessionTime;

/// The belief filter ignores gaze samples older than this, in seconds: the display may have shown something else when
/// such samples were taken.
pub const TOO_OLD_S: f64 = 0.5;
/// Upper limit of an eye tracker's sampling rate, in Hz.
pub(crate) const MAX_HZ: f64 = 2000.0;
/// Number of gaze samples that may arrive at once after a pause: those of 10 s at the highest rate, since samples wait
/// while the program or the network stands still.
const BURST: f64 = 10.0 * MAX_HZ;
/// Number of recent gaze samples among which duplicates are detected.
const RECENT: usize = 32;

/// Why the belief filter ignores a recorded gaze sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GazeFault {
    /// The same gaze sample had arrived shortly before.
    Duplicate,
    /// The gaze sample was taken too long before it arrived.
    TooOld,
    /// A gaze sample that was taken later had already arrived.
    OutOfOrder,
}

/// Number of gaze samples that were recorded but ignored by the belief filter, by kind of fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GazeFaultCounts {
    /// Number of duplicate gaze samples.
    pub duplicate: u64,
    /// Number of gaze samples that were older than [`TOO_OLD_S`] when they arrived.
    pub too_old: u64,
    /// Number of gaze samples that arrived after one that was taken later.
    pub out_of_order: u64,
}

impl GazeFaultCounts {
    /// Number of faulty gaze samples of all kinds.
    pub fn sum(self) -> u64 {
        self.duplicate + self.too_old + self.out_of_order
    }
}

/// Number of inputs from an eye tracker that cannot be recorded, by kind, since the session began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DroppedInputCounts {
    /// Malformed messages, lines and gaze samples: truncated, of a wrong type, not a number.
    pub malformed: u64,
    /// Gaze samples above the highest accepted rate, `MAX_HZ`.
    pub too_frequent: u64,
    /// Gaze samples that arrived faster than they could be processed.
    pub overrun: u64,
}

impl DroppedInputCounts {
    /// Number of dropped gaze inputs of all kinds.
    pub fn sum(self) -> u64 {
        self.malformed + self.too_frequent + self.overrun
    }
}

/// Detects faults of a gaze stream, sample by sample. Only samples whose time is known are checked; duplicates are found
/// among samples with a device time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeFaultDetector {
    newest: Option<SessionTime>,
    recent: Vec<(Option<i64>, [u64; 2])>,
    next: usize,
    /// Number of faults found so far in the gaze stream, by kind.
    pub counts: GazeFaultCounts,
}

impl GazeFaultDetector {
    /// The fault of a gaze sample that arrived now; none if the sample has no fault.
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

/// Limits the rate of gaze samples to what a tracker can send.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeRateLimiter {
    left: f64,
    at: SessionTime,
}

impl Default for GazeRateLimiter {
    fn default() -> GazeRateLimiter {
        GazeRateLimiter { left: BURST, at: SessionTime::ZERO }
    }
}

impl GazeRateLimiter {
    /// Whether a gaze sample that arrives now is within the rate limit.
    pub fn admits(&mut self, now: SessionTime) -> bool {
        self.left = (self.left + now.secs_since(self.at) * MAX_HZ).min(BURST);
        self.at = self.at.max(now);
        let admits = self.left >= 1.0;
        self.left -= f64::from(u8::from(admits));
        admits
    }
}
