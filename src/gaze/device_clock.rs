//! Estimates the offset of a tracker's clock from the arrival times of its samples.

use crate::base::time::SessionTime;

/// Length of the window whose shortest delay counts, in seconds: longer than a network delay, shorter than the time in
/// which clocks drift by a millisecond.
const WINDOW_S: f64 = 10.0;
/// A device clock that jumps back by more than this was restarted, in seconds.
const RESTART_S: f64 = 1.0;

/// Maps device time to session time. The offset comes from the samples with the shortest delay in this window and the
/// previous one (Cristian 1989).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceClock {
    /// Arrival less device time, in nanoseconds: the least of the window before, and of this one.
    before: Option<i128>,
    least: Option<i128>,
    since: SessionTime,
    newest_ns: u64,
}

impl DeviceClock {
    /// The session time at which a sample with this device time was taken; never later than its arrival.
    pub fn session_time(&mut self, device_ns: u64, arrived: SessionTime) -> SessionTime {
        let back_s = self.newest_ns.saturating_sub(device_ns) as f64 / 1e9;
        if back_s > RESTART_S {
            *self = DeviceClock::default();
        }
        self.newest_ns = self.newest_ns.max(device_ns);
        let offset = i128::from(arrived.0) - i128::from(device_ns);
        if self.least.is_none() || arrived.secs_since(self.since) > WINDOW_S {
            (self.before, self.least, self.since) = (self.least, Some(offset), arrived);
        }
        let least = self.least.map_or(offset, |least| least.min(offset));
        self.least = Some(least);
        let offset = self.before.map_or(least, |before| before.min(least));
        let taken = (i128::from(device_ns) + offset).clamp(0, i128::from(arrived.0));
        SessionTime(u64::try_from(taken).unwrap_or(arrived.0))
    }
}
