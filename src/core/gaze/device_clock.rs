//! The clock of an eye tracker: estimates its offset from the arrival times of samples, follows it when it was set, and
//! says when the tracker's time stamps are those of no clock.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::quality::{MAX_HZ, TOO_OLD_S};
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
    confirmed: usize,
    /// The newest of successive samples in doubt: arrival and clock offset; and the arrival of the first of them.
    doubt: VecDeque<(SessionTime, i128)>,
    doubted_since: SessionTime,
    arrived: Option<SessionTime>,
    check: StampCheck,
    /// The last verdict about the stamps; `None` before the first one.
    verdict: Option<Result<(), StampFault>>,
}

/// What a gaze sample shows about the tracker's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClockNews {
    /// The tracker's clock was set.
    Set(ClockStep),
    /// Whether the time stamps are those of a clock, from now on; where they are not, samples count as taken when they
    /// arrived.
    Stamps(Result<(), StampFault>),
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
        self.verdict.is_some_and(|verdict| verdict.is_err())
    }

    fn offset(&self) -> Option<i128> {
        self.offsets.iter().map(|(_, least)| *least).min()
    }

    /// Takes over a verdict about the stamps; returns whether the verdict is new.
    fn judge(&mut self, verdict: Result<(), StampFault>) -> Option<ClockNews> {
        let is_same = match (self.verdict, verdict) {
            // A rate is estimated anew with every interval; only another one is news.
            (Some(Err(StampFault::Rate(told))), Err(StampFault::Rate(rate))) => {
                (rate - told).abs() <= 0.5 * told.abs().max(1.0)
            }
            (known, verdict) => known == Some(verdict),
        };
        if is_same {
            return None;
        }
        let was_faulty = self.is_faulty();
        self.verdict = Some(verdict);
        if was_faulty || verdict.is_err() {
            self.forget();
        }
        Some(ClockNews::Stamps(verdict))
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

/// A gaze sample is in doubt if its clock offset differs by more than this from what other samples say, in seconds: the
/// sample was delayed, its time stamp is wrong, or the tracker's clock was set.
pub(super) const DOUBT_S: f64 = 0.05;
/// Length of the intervals in which the smallest clock offset is kept, in seconds: some samples of a slow tracker.
pub(super) const INTERVAL_S: f64 = 0.25;
/// Number of successive intervals that show a rate which is far from real time.
const FEW: usize = 5;
/// Such a rate deviates from real time by this much at least; a smaller deviation shows in groups, and more exactly.
const FAR: f64 = 0.2;
/// Least number of samples in each of them; of slower trackers a rate shows in groups of intervals.
const SAMPLES: u32 = 5;
/// Length of a group of intervals in seconds, and number of groups that show a rate near real time. The smallest offset
/// of a group is more certain than that of an interval.
const GROUP_S: f64 = 1.0;
const GROUPS: usize = 4;
/// Stamps whose rate deviates from real time by no more than this are sound; clocks of computers deviate by 0.0002, and
/// by 0.005 while they are slewed.
const SOUND_RATE: f64 = 0.005;
/// Least change of the clock offset that counts as a change of rate, in seconds, for samples without any delay.
const LEAST_CHANGE_S: f64 = 0.015;
/// The same in parts of the samples' mean delay: of the delay itself, since a network's delays go up and down, and of its
/// standard error.
const DELAYS: f64 = 0.5;
const STANDARD_ERRORS: f64 = 3.0;
/// In a change of rate, the offset changes from each interval to the next by this share of the mean change at least.
const STEADY: f64 = 0.4;
/// Stamps that stay the same for this long, in this number of samples at least, stand still. Samples of one frame of a
/// scene camera have the same stamp for less.
const STANDS_S: f64 = 0.25;
const STANDS: u32 = 5;
/// Stamps go back if more than this share of them lies before the previous stamp; or if more than this smaller share lies
/// so far before it that no delay in the network explains it. Both are shares of at least this number of samples.
const BACK_SHARE: f64 = 0.75;
const FAR_BACK_SHARE: f64 = 0.25;
const BACK: u32 = 8;
/// A clock offset is steady if it changes by no more than this over this number of intervals, in seconds.
const FLAT_S: f64 = 0.03;
const STEADY_FOR: usize = 4;

/// Fault of a tracker's time stamps, because of which samples count as taken when they arrived.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StampFault {
    /// The stamps advance by this many seconds in a second of real time; negative: they run backwards.
    Rate(f64),
    /// The stamps stay the same from sample to sample.
    StandsStill,
    /// The stamps go back from sample to sample.
    GoesBack,
}

impl StampFault {
    /// What is wrong with the time stamps, in words; `t` is their name in lines of JSON.
    pub fn words(self) -> String {
        match self {
            StampFault::StandsStill => "t stands still".to_string(),
            StampFault::GoesBack => "t goes back from sample to sample".to_string(),
            StampFault::Rate(rate) if rate < 3.0 => {
                let digits = usize::from((rate - 1.0).abs() < 0.02);
                format!("t runs at {:.digits$} % of real time", 100.0 * rate)
            }
            StampFault::Rate(rate) => {
                let units = [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")];
                let unit = units.into_iter().find(|(per_s, _)| (rate / per_s - 1.0).abs() < 0.25);
                let (rate, like) = unit.unwrap_or((rate, "counts of samples or frames"));
                format!("t runs {rate:.0} times as fast as real time, like {like}")
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct StampInterval {
    began: SessionTime,
    /// Smallest clock offset of the interval in nanoseconds, and the arrival of its sample; stamps that differ from both of
    /// their neighbours are left out.
    least: Option<(i128, SessionTime)>,
    /// Clock offset of the first sample, and the sum of differences from it in seconds, for the mean.
    first: i128,
    sum_s: f64,
    samples: u32,
    /// Number of stamps that lie before the previous one, and number of those that lie far before it.
    back: u32,
    far_back: u32,
    stands: bool,
}

struct OffsetPoint {
    /// Time of the first interval's beginning, and of the arrival of the sample with the smallest offset.
    began: SessionTime,
    at: SessionTime,
    offset: i128,
    /// Mean delay of the samples beyond the shortest one, in seconds.
    delay_s: f64,
    samples: u32,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StampCheck {
    /// Intervals in which samples arrived; the last one is not over.
    intervals: VecDeque<StampInterval>,
    /// Clock offsets and arrivals of the last two samples.
    last: [Option<(i128, SessionTime)>; 2],
    /// The last stamp, the arrival of the first sample that had it, and the number of samples with it.
    held: Option<(i64, SessionTime, u32)>,
}

impl StampCheck {
    /// Adds a sample; returns a verdict if the samples up to now allow one.
    pub fn take(&mut self, device_ns: i64, arrived: SessionTime) -> Option<Result<(), StampFault>> {
        let offset = i128::from(arrived.0) - i128::from(device_ns);
        let is_over = |last: &StampInterval| arrived.secs_since(last.began) >= INTERVAL_S;
        let verdict = if self.intervals.back().is_none_or(is_over) { self.begin(offset, arrived) } else { None };
        let back = self.held.map_or(0, |(last, ..)| i128::from(last) - i128::from(device_ns));
        let (since, held) = match self.held {
            Some((last, since, count)) if last == device_ns => (since, count + 1),
            _ => (arrived, 1),
        };
        self.held = Some((device_ns, since, held));
        let stands = held >= STANDS && arrived.secs_since(since) >= STANDS_S;
        let [before, previous] = self.last;
        self.last = [previous, Some((offset, arrived))];
        let interval = self.intervals.back_mut()?;
        // The previous sample is judged now that both of its neighbours are known.
        let is_odd = |found: i128| before.is_none_or(|(before, _)| found < before.min(offset) - ns(DOUBT_S));
        if let Some(found) = previous.filter(|(found, _)| !is_odd(*found)) {
            interval.least = Some(interval.least.map_or(found, |least| least.min(found)));
        }
        interval.sum_s += seconds(offset - interval.first);
        interval.samples += 1;
        interval.back += u32::from(back > 0);
        interval.far_back += u32::from(back > ns(TOO_OLD_S));
        interval.stands |= stands;
        match stands {
            true => Some(Err(StampFault::StandsStill)),
            false => verdict,
        }
    }

    /// Begins an interval; returns the verdict about the intervals before it.
    fn begin(&mut self, first: i128, began: SessionTime) -> Option<Result<(), StampFault>> {
        let verdict = self.verdict(began);
        while self.intervals.front().is_some_and(|one| began.secs_since(one.began) > GROUP_S * GROUPS as f64) {
            self.intervals.pop_front();
        }
        let (least, sum_s, samples, back, far_back, stands) = (None, 0.0, 0, 0, 0, false);
        self.intervals.push_back(StampInterval { began, least, first, sum_s, samples, back, far_back, stands });
        verdict
    }

    fn verdict(&self, now: SessionTime) -> Option<Result<(), StampFault>> {
        let in_group = |group: usize| {
            let age = move |one: &&StampInterval| (now.secs_since(one.began) / GROUP_S).ceil() as usize == group;
            self.intervals.iter().filter(age)
        };
        let count = |number: fn(&StampInterval) -> u32| in_group(1).map(number).sum::<u32>();
        let (samples, back, far_back) = (count(|one| one.samples), count(|one| one.back), count(|one| one.far_back));
        let is_more = |part: u32, share: f64| samples >= BACK && f64::from(part) > share * f64::from(samples);
        if is_more(back, BACK_SHARE) {
            return Some(Err(StampFault::GoesBack));
        }
        let newest = self.intervals.range(self.intervals.len().saturating_sub(FEW)..);
        let few: Vec<OffsetPoint> = newest.filter_map(|one| point([one])).collect();
        let groups: Vec<OffsetPoint> = (1..=GROUPS).rev().filter_map(|group| point(in_group(group))).collect();
        let is_sure = few.len() == FEW && few.iter().all(|one| one.samples >= SAMPLES);
        let few_change = change(&few).filter(|change| is_sure && change.abs() >= FAR);
        if let Some(change) = few_change.or_else(|| change(&groups).filter(|_| groups.len() == GROUPS)) {
            let rate = 1.0 - change;
            let fault = if rate < 0.0 { StampFault::GoesBack } else { StampFault::Rate(rate) };
            return Some(Err(fault));
        }
        // In a finer unit than seconds, samples that a network mixed up go far back, too; their rate is found first.
        if self.intervals.len() > FEW && is_more(far_back, FAR_BACK_SHARE) {
            return Some(Err(StampFault::GoesBack));
        }
        let is_ordered = self.intervals.iter().all(|one| !one.stands && one.far_back == 0);
        let is_sound = groups.len() == GROUPS && is_ordered && mean_change(&groups)?.abs() <= SOUND_RATE;
        is_sound.then_some(Ok(()))
    }

    /// Mean delay of samples beyond the shortest one, in seconds, in the last intervals that were over at this time;
    /// `None` if their clock offset was not steady, or not known for long enough.
    pub(crate) fn steady_delay_s(&self, at: SessionTime) -> Option<f64> {
        let over = self.intervals.iter().filter(|one| at.secs_since(one.began) >= INTERVAL_S);
        let points: Vec<OffsetPoint> = over.rev().take(STEADY_FOR).filter_map(|one| point([one])).collect();
        let change = points.first()?.offset - points.last()?.offset;
        let is_steady = points.len() == STEADY_FOR && change.abs() <= ns(FLAT_S);
        is_steady.then(|| points.iter().map(|point| point.delay_s).fold(0.0, f64::max))
    }
}

/// The smallest clock offset of successive intervals; `None` if they have none.
fn point<'a>(intervals: impl IntoIterator<Item = &'a StampInterval>) -> Option<OffsetPoint> {
    let mut found: Option<OffsetPoint> = None;
    for one in intervals {
        let Some((least, at)) = one.least else { continue };
        let samples = one.samples;
        // The smallest offset can be that of the last sample before the interval.
        let delay_s = (seconds(one.first - least) + one.sum_s / f64::from(samples.max(1))).max(0.0);
        found = Some(match found {
            None => OffsetPoint { began: one.began, at, offset: least, delay_s, samples },
            Some(point) => OffsetPoint {
                at: if least < point.offset { at } else { point.at },
                offset: point.offset.min(least),
                delay_s: point.delay_s.max(delay_s),
                samples: point.samples + samples,
                ..point
            },
        });
    }
    found
}

/// Change of the clock offset in seconds per second, from the first to the last point.
fn mean_change(points: &[OffsetPoint]) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let over_s = last.at.secs_since(first.at);
    (over_s > 0.0).then(|| seconds(last.offset - first.offset) / over_s)
}

/// Change of the clock offset in seconds per second, if it is steady and larger than delays of samples explain.
fn change(points: &[OffsetPoint]) -> Option<f64> {
    let mean = mean_change(points)?;
    let total_s = seconds(points.last()?.offset - points.first()?.offset);
    let unsure_s = |point: &OffsetPoint| point.delay_s * (DELAYS + STANDARD_ERRORS / f64::from(point.samples).sqrt());
    let least_s = LEAST_CHANGE_S + points.iter().map(unsure_s).fold(0.0, f64::max);
    let is_steady = points.windows(2).all(|pair| {
        let step = seconds(pair[1].offset - pair[0].offset) / pair[1].began.secs_since(pair[0].began);
        step * mean.signum() >= STEADY * mean.abs()
    });
    (is_steady && total_s.abs() > least_s).then_some(mean)
}

pub(super) const fn ns(seconds: f64) -> i128 {
    (seconds * 1e9) as i128
}

fn seconds(ns: i128) -> f64 {
    ns as f64 / 1e9
}
