//! Estimates the offset of an eye tracker's clock from the arrival times of its samples, and detects when the tracker's
//! clock was set.

use crate::base::time::SessionTime;

/// Length of the time window in which the sample with the shortest delay gives the clock offset, in seconds: the window
/// is longer than a network delay, and shorter than the time in which clocks drift by a millisecond.
const WINDOW_S: f64 = 10.0;
/// A gaze sample is in doubt if its clock offset differs from the known offset by more than this, in seconds: the
/// sample was delayed, its time stamp is wrong, or the tracker's clock was set.
const DOUBT_S: f64 = 0.05;
/// Samples in doubt agree on a new clock offset if their offsets differ by no more than this, in seconds.
const AGREE_S: f64 = 0.01;
/// Number of samples that have to agree before the tracker's clock counts as set.
const AGREEING: u32 = 5;
/// Time for which samples have to agree that the tracker's clock was set back, in seconds. A network that delays
/// samples looks like a clock set back and takes longer to rule out; no delay makes samples look too early.
const BACK_S: f64 = 0.4;
const AHEAD_S: f64 = 0.1;

/// Maps an eye tracker's device time to session time. The offset comes from the samples with the shortest delay in the
/// present time window and the previous one (Cristian 1989). A single wrong time stamp changes nothing; when the
/// tracker's clock was set, the mapping follows once samples agree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceClock {
    /// Least difference between arrival and device time in the previous time window, in nanoseconds; the next field has
    /// the least difference in the present window.
    before: Option<i128>,
    least: Option<i128>,
    since: SessionTime,
    doubt: Option<Doubt>,
}

/// Consecutive gaze samples whose clock offset deviates in the same direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Doubt {
    /// Whether the samples suggest that the tracker's clock was set ahead.
    is_ahead: bool,
    /// Arrival time of the first deviating sample, and of the first sample that agrees with the present least offset.
    since: SessionTime,
    agreed_since: SessionTime,
    /// The least clock offset of the deviating samples, in nanoseconds.
    least: i128,
    /// Number of samples whose clock offset agrees with the least offset.
    agreeing: u32,
}

/// A step of the eye tracker's clock: the clock was set during the session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockStep {
    /// By how much the tracker's clock was set ahead, in nanoseconds; negative if the clock was set back.
    pub by_ns: i64,
    /// Arrival of the first gaze sample whose session time was uncertain until the clock step was detected.
    pub uncertain_since: SessionTime,
}

const fn ns(seconds: f64) -> i128 {
    (seconds * 1e9) as i128
}

impl DeviceClock {
    /// The session time at which a sample with this device time was taken, which is never later than the sample's
    /// arrival; and the clock step, if samples now show that the tracker's clock was set.
    pub fn session_time(&mut self, device_ns: i64, arrived: SessionTime) -> (SessionTime, Option<ClockStep>) {
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

    /// Handles a sample whose clock offset deviates; returns the clock step once enough samples agree.
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
