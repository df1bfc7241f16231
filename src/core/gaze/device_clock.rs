//! Estimates the offset of an eye tracker's clock from the arrival times of its samples, follows it when the tracker's
//! clock was set, and says when the tracker's time stamps are those of no clock.

use std::collections::VecDeque;

use super::quality::MAX_HZ;
use super::stamp_check::{DOUBT_S, INTERVAL_S, StampCheck, StampFault, StampVerdict, ns};
use crate::base::time::SessionTime;

/// Number of intervals in which samples arrived that give the clock offset: together longer than a network delay, and
/// shorter than the time in which clocks drift by a millisecond.
const INTERVALS: usize = 20;
/// Samples in doubt agree on a new clock offset if their smallest offsets differ by no more than this, in seconds.
const AGREE_S: f64 = 0.01;
/// The same for samples that have been in doubt for [`LOST_S`], of which there may be few.
const AGREE_AT_LAST_S: f64 = 0.02;
/// Number of samples that have to agree before the tracker's clock counts as set.
const AGREEING: usize = 5;
/// Time for which samples have to agree that the tracker's clock was set back, in seconds. A network that delays
/// samples looks like a clock set back and takes longer to rule out; no delay makes samples look too early.
const BACK_S: f64 = 0.4;
const AHEAD_S: f64 = 0.1;
/// Time for which samples in doubt are compared, in seconds: those before a step of the clock are forgotten then.
const COMPARED_S: f64 = 0.6;
/// The known clock offset is given up when all samples have been in doubt for this long, in seconds.
const LOST_S: f64 = 0.9;
/// The clock offset is forgotten when no sample arrived for this long, in seconds: clocks drift apart.
const FORGET_S: f64 = 60.0;

/// Maps an eye tracker's device time to session time. The offset comes from the samples with the shortest delay of the
/// last seconds (Cristian 1989), so that it follows a clock that drifts. A single wrong time stamp changes nothing; when
/// the tracker's clock was set, the mapping follows once samples agree. No offset holds for longer than a second
/// against all samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceClock {
    /// Beginnings of the last intervals in which samples confirmed the clock offset, with the least difference between
    /// arrival and device time in each, in nanoseconds.
    offsets: VecDeque<(SessionTime, i128)>,
    /// Number of samples that confirmed the clock offset.
    confirmed: usize,
    /// The newest of successive samples in doubt: arrival and clock offset; and the arrival of the first of them.
    doubt: VecDeque<(SessionTime, i128)>,
    doubted_since: SessionTime,
    arrived: Option<SessionTime>,
    check: StampCheck,
    /// The last verdict about the stamps; `None` before the first one.
    verdict: Option<StampVerdict>,
}

/// What a gaze sample shows about the tracker's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClockNews {
    /// The tracker's clock was set.
    Set(ClockStep),
    /// The time stamps cannot be used from now on: samples count as taken when they arrived.
    Faulty(StampFault),
    /// The time stamps are those of a clock.
    Sound,
}

/// A step of the eye tracker's clock: the clock was set during the session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockStep {
    /// By how much the tracker's clock was set ahead, in nanoseconds; negative if the clock was set back.
    pub by_ns: i64,
    /// Arrival of the first gaze sample whose session time was uncertain until the clock step was detected.
    pub uncertain_since: SessionTime,
}

impl DeviceClock {
    /// Learns from a sample with this device time that arrived now. Samples that wait to be read, and repeated samples,
    /// must not be learned from: they arrived at another time.
    pub fn learn(&mut self, device_ns: i64, arrived: SessionTime) -> Option<ClockNews> {
        if self.arrived.is_some_and(|last| arrived.secs_since(last) > FORGET_S) {
            *self = DeviceClock { verdict: self.verdict, ..DeviceClock::default() };
        }
        self.arrived = Some(arrived);
        if let Some(verdict) = self.check.take(device_ns, arrived)
            && let Some(news) = self.judge(verdict)
        {
            return Some(news);
        }
        if self.is_faulty() {
            return None;
        }
        let offset = i128::from(arrived.0) - i128::from(device_ns);
        match self.offset() {
            Some(known) if (offset - known).abs() > ns(DOUBT_S) => self.question(offset, known, arrived),
            _ => {
                self.doubt.clear();
                self.confirm(offset, arrived);
                None
            }
        }
    }

    /// The session time at which a sample with this device time was taken, which is never later than the sample's
    /// arrival; `None` if the device time does not say it.
    pub fn session_time(&self, device_ns: i64, arrived: SessionTime) -> Option<SessionTime> {
        if self.is_faulty() {
            return None;
        }
        let taken = i128::from(device_ns) + self.offset()?;
        let taken = u64::try_from(taken.clamp(0, i128::from(arrived.0))).unwrap_or(arrived.0);
        Some(SessionTime(taken))
    }

    /// Whether the time stamps cannot be used.
    pub fn is_faulty(&self) -> bool {
        matches!(self.verdict, Some(StampVerdict::Faulty(_)))
    }

    fn offset(&self) -> Option<i128> {
        self.offsets.iter().map(|(_, least)| *least).min()
    }

    /// Takes over a verdict about the stamps; returns whether the verdict is new.
    fn judge(&mut self, verdict: StampVerdict) -> Option<ClockNews> {
        let is_same = match (self.verdict, verdict) {
            // A rate is estimated anew with every interval; only another one is news.
            (Some(StampVerdict::Faulty(StampFault::Rate(told))), StampVerdict::Faulty(StampFault::Rate(rate))) => {
                (rate - told).abs() <= 0.5 * told.abs().max(1.0)
            }
            (known, verdict) => known == Some(verdict),
        };
        if is_same {
            return None;
        }
        let was_faulty = self.is_faulty();
        self.verdict = Some(verdict);
        if was_faulty || verdict != StampVerdict::Sound {
            self.forget();
        }
        Some(match verdict {
            StampVerdict::Sound => ClockNews::Sound,
            StampVerdict::Faulty(fault) => ClockNews::Faulty(fault),
        })
    }

    fn forget(&mut self) {
        self.offsets.clear();
        self.doubt.clear();
        self.confirmed = 0;
    }

    fn confirm(&mut self, offset: i128, arrived: SessionTime) {
        self.confirmed += 1;
        match self.offsets.back_mut() {
            Some((began, least)) if arrived.secs_since(*began) < INTERVAL_S => *least = (*least).min(offset),
            _ => {
                if self.offsets.len() == INTERVALS {
                    self.offsets.pop_front();
                }
                self.offsets.push_back((arrived, offset));
            }
        }
    }

    /// Handles a sample whose clock offset deviates; returns the clock step once enough samples agree.
    fn question(&mut self, offset: i128, known: i128, arrived: SessionTime) -> Option<ClockNews> {
        if self.doubt.is_empty() {
            self.doubted_since = arrived;
        }
        match self.doubt.back_mut() {
            // More samples than any tracker sends count as one, which bounds memory and time.
            Some((last, least)) if arrived.secs_since(*last) < 1.0 / MAX_HZ => *least = (*least).min(offset),
            _ => self.doubt.push_back((arrived, offset)),
        }
        let is_past = |(at, _): &(SessionTime, i128)| arrived.secs_since(*at) > COMPARED_S;
        while self.doubt.pop_front_if(|one| is_past(one)).is_some() {}
        let is_lost = arrived.secs_since(self.doubted_since) >= LOST_S;
        let agreed = self.agreed(known, arrived, is_lost);
        if agreed.is_none() && !is_lost {
            return None;
        }
        // Where the clock was not set but runs at another rate, the samples before the doubt had come close.
        let before = self.offsets.iter().rev().take(2).map(|(_, least)| *least).min().unwrap_or(known);
        let step = agreed.filter(|(first, _)| (first - before).abs() > ns(DOUBT_S)).map(|(_, least)| least);
        let told = step.filter(|least| self.confirmed >= AGREEING && self.is_as_quick_as_before(*least));
        let found = step.or_else(|| self.middle_of_newest())?;
        self.forget();
        self.confirm(found, arrived);
        let by_ns = i64::try_from(before - told?).unwrap_or(if found < before { i64::MAX } else { i64::MIN });
        Some(ClockNews::Set(ClockStep { by_ns, uncertain_since: self.doubted_since }))
    }

    /// The clock offset on which the samples in doubt agree: the smallest one of their first half, and that of all.
    fn agreed(&self, known: i128, arrived: SessionTime, is_lost: bool) -> Option<(i128, i128)> {
        let half = self.doubt.len() / 2;
        let (first, second) = (low(self.doubt.range(..half))?, low(self.doubt.range(half..))?);
        let (least, apart) = (first.min(second), (first - second).abs());
        let near = self.doubt.iter().filter(|(_, offset)| (least..=least + ns(AGREE_S)).contains(offset)).count();
        let for_s = arrived.secs_since(self.doubt.front()?.0);
        let is_long = for_s >= if least < known { AHEAD_S } else { BACK_S };
        let agree = near >= AGREEING && is_long && apart <= ns(AGREE_S) || is_lost && apart <= ns(AGREE_AT_LAST_S);
        agree.then_some((first, least))
    }

    /// Whether the samples in doubt would be as little delayed as those before, if the clock offset were `least`: a
    /// network that delays samples does not delay all of them alike.
    fn is_as_quick_as_before(&self, least: i128) -> bool {
        let newest = self.doubt.range(self.doubt.len() / 2..);
        let (count, sum) = (newest.len(), newest.map(|(_, offset)| offset - least).sum::<i128>());
        let delay_s = sum as f64 / 1e9 / count.max(1) as f64;
        self.check.steady_delay_s(self.doubted_since).is_some_and(|before_s| delay_s <= 2.0 * before_s + AGREE_S)
    }

    /// Median clock offset of the newer half of the samples in doubt.
    fn middle_of_newest(&self) -> Option<i128> {
        let mut offsets: Vec<i128> = self.doubt.range(self.doubt.len() / 2..).map(|(_, offset)| *offset).collect();
        let middle = offsets.len() / 2;
        (!offsets.is_empty()).then(|| *offsets.select_nth_unstable(middle).1)
    }
}

/// The second smallest clock offset of these samples, since a single one can be that of a wrong time stamp; `None` if there are
/// fewer than two.
fn low<'a>(samples: impl Iterator<Item = &'a (SessionTime, i128)>) -> Option<i128> {
    let mut least = [i128::MAX; 2];
    for &(_, offset) in samples {
        if offset < least[0] {
            least = [offset, least[0]];
        } else {
            least[1] = least[1].min(offset);
        }
    }
    (least[1] < i128::MAX).then_some(least[1])
}
