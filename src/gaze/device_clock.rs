//! Estimates the offset of a tracker's clock from the arrival times of its samples, and follows the clock when it is set.

use crate::base::time::SessionTime;

/// Length of the window whose shortest delay counts, in seconds: longer than a network delay, shorter than the time in
/// which clocks drift by a millisecond.
const WINDOW_S: f64 = 10.0;
/// A sample that is off by more than this is in doubt, in seconds: it was delayed, its time stamp is wrong, or the clock was set.
const DOUBT_S: f64 = 0.05;
/// Samples in doubt agree on a new offset if they are no further apart than this, in seconds.
const AGREE_S: f64 = 0.01;
/// Number of samples that have to agree before the clock is taken as set.
const AGREEING: u32 = 5;
/// For how long they have to agree, in seconds. A clock that was set back looks like a network that delays samples, which takes
/// longer to tell apart; no delay makes samples look too early.
const BACK_S: f64 = 0.4;
const AHEAD_S: f64 = 0.1;

/// Maps device time to session time. The offset comes from the samples with the shortest delay in this window and the
/// previous one (Cristian 1989). A single wrong time stamp changes nothing; a clock that was set is followed once samples agree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceClock {
    /// Arrival less device time, in nanoseconds: the least of the window before, and of this one.
    before: Option<i128>,
    least: Option<i128>,
    since: SessionTime,
    doubt: Option<Doubt>,
}

/// Consecutive samples that are off in the same direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Doubt {
    /// Whether they come from a clock that is ahead.
    is_ahead: bool,
    /// Arrival of the first of them, and of the first that agrees with the present least offset.
    since: SessionTime,
    agreed_since: SessionTime,
    /// The least offset of them, in nanoseconds.
    least: i128,
    /// How many agree with it.
    agreeing: u32,
}

/// The device's clock was set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockStep {
    /// By how much it went ahead, in nanoseconds; negative: back.
    pub by_ns: i64,
    /// Arrival of the first sample whose session time was uncertain until now.
    pub uncertain_since: SessionTime,
}

const fn ns(seconds: f64) -> i128 {
    (seconds * 1e9) as i128
}

impl DeviceClock {
    /// The session time at which a sample with this device time was taken, never later than its arrival; and whether the clock
    /// turned out to have been set.
    pub fn session_time(&mut self, device_ns: u64, arrived: SessionTime) -> (SessionTime, Option<ClockStep>) {
        let offset = i128::from(arrived.0) - i128::from(device_ns);
        let step = match self.offset() {
            Some(known) if (offset - known).abs() > ns(DOUBT_S) => self.question(offset, known, arrived),
            _ => {
                self.doubt = None;
                self.learn(offset, arrived);
                None
            }
        };
        let taken = i128::from(device_ns) + self.offset().unwrap_or(offset);
        let taken = u64::try_from(taken.clamp(0, i128::from(arrived.0))).unwrap_or(arrived.0);
        (SessionTime(taken), step)
    }

    fn offset(&self) -> Option<i128> {
        let least = self.least?;
        Some(self.before.map_or(least, |before| before.min(least)))
    }

    fn learn(&mut self, offset: i128, arrived: SessionTime) {
        if self.least.is_none() || arrived.secs_since(self.since) > WINDOW_S {
            (self.before, self.least, self.since) = (self.least, Some(offset), arrived);
        }
        self.least = self.least.map(|least| least.min(offset));
    }

    /// Takes a sample that is off; the step, if enough of them agree now.
    fn question(&mut self, offset: i128, known: i128, arrived: SessionTime) -> Option<ClockStep> {
        let is_ahead = offset < known;
        let fresh = Doubt { is_ahead, since: arrived, agreed_since: arrived, least: offset, agreeing: 1 };
        let doubt = match self.doubt.filter(|doubt| doubt.is_ahead == is_ahead) {
            None => fresh,
            Some(doubt) if offset < doubt.least - ns(AGREE_S) => Doubt { since: doubt.since, ..fresh },
            Some(doubt) => Doubt {
                least: doubt.least.min(offset),
                agreeing: doubt.agreeing + u32::from(offset <= doubt.least + ns(AGREE_S)),
                ..doubt
            },
        };
        self.doubt = Some(doubt);
        let agreed_s = arrived.secs_since(doubt.agreed_since);
        if doubt.agreeing < AGREEING || agreed_s < if is_ahead { AHEAD_S } else { BACK_S } {
            return None;
        }
        *self = DeviceClock { least: Some(doubt.least), since: arrived, ..DeviceClock::default() };
        let by_ns = i64::try_from(known - doubt.least).unwrap_or(if is_ahead { i64::MAX } else { i64::MIN });
        Some(ClockStep { by_ns, uncertain_since: doubt.since })
    }
}
