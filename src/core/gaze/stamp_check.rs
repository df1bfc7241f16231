//! Checks whether the time stamps of gaze samples advance as real time does: stamps that do not, say nothing about when
//! a sample was taken.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::quality::TOO_OLD_S;
use crate::base::time::SessionTime;

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

/// Result of the check of the stamps that arrived lately.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum StampVerdict {
    Sound,
    Faulty(StampFault),
}

/// The samples that arrived in one interval.
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

/// Smallest clock offset of an interval or a group of intervals.
struct OffsetPoint {
    /// Time of the first interval's beginning, and of the arrival of the sample with the smallest offset.
    began: SessionTime,
    at: SessionTime,
    offset: i128,
    /// Mean delay of the samples beyond the shortest one, in seconds.
    delay_s: f64,
    samples: u32,
}

/// Checks of one tracker's time stamps.
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
    pub fn take(&mut self, device_ns: i64, arrived: SessionTime) -> Option<StampVerdict> {
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
            true => Some(StampVerdict::Faulty(StampFault::StandsStill)),
            false => verdict,
        }
    }

    /// Begins an interval; returns the verdict about the intervals before it.
    fn begin(&mut self, first: i128, began: SessionTime) -> Option<StampVerdict> {
        let verdict = self.verdict(began);
        while self.intervals.front().is_some_and(|one| began.secs_since(one.began) > GROUP_S * GROUPS as f64) {
            self.intervals.pop_front();
        }
        let (least, sum_s, samples, back, far_back, stands) = (None, 0.0, 0, 0, 0, false);
        self.intervals.push_back(StampInterval { began, least, first, sum_s, samples, back, far_back, stands });
        verdict
    }

    /// The verdict about the intervals before this time.
    fn verdict(&self, now: SessionTime) -> Option<StampVerdict> {
        let in_group = |group: usize| {
            let age = move |one: &&StampInterval| (now.secs_since(one.began) / GROUP_S).ceil() as usize == group;
            self.intervals.iter().filter(age)
        };
        let count = |number: fn(&StampInterval) -> u32| in_group(1).map(number).sum::<u32>();
        let (samples, back, far_back) = (count(|one| one.samples), count(|one| one.back), count(|one| one.far_back));
        let is_more = |part: u32, share: f64| samples >= BACK && f64::from(part) > share * f64::from(samples);
        if is_more(back, BACK_SHARE) {
            return Some(StampVerdict::Faulty(StampFault::GoesBack));
        }
        let newest = self.intervals.range(self.intervals.len().saturating_sub(FEW)..);
        let few: Vec<OffsetPoint> = newest.filter_map(|one| point([one])).collect();
        let groups: Vec<OffsetPoint> = (1..=GROUPS).rev().filter_map(|group| point(in_group(group))).collect();
        let is_sure = few.len() == FEW && few.iter().all(|one| one.samples >= SAMPLES);
        let few_change = change(&few).filter(|change| is_sure && change.abs() >= FAR);
        if let Some(change) = few_change.or_else(|| change(&groups).filter(|_| groups.len() == GROUPS)) {
            let rate = 1.0 - change;
            let fault = if rate < 0.0 { StampFault::GoesBack } else { StampFault::Rate(rate) };
            return Some(StampVerdict::Faulty(fault));
        }
        // In a finer unit than seconds, samples that a network mixed up go far back, too; their rate is found first.
        if self.intervals.len() > FEW && is_more(far_back, FAR_BACK_SHARE) {
            return Some(StampVerdict::Faulty(StampFault::GoesBack));
        }
        let is_ordered = self.intervals.iter().all(|one| !one.stands && one.far_back == 0);
        let is_sound = groups.len() == GROUPS && is_ordered && mean_change(&groups)?.abs() <= SOUND_RATE;
        is_sound.then_some(StampVerdict::Sound)
    }

    /// Mean delay of samples beyond the shortest one, in seconds, in the last intervals that were over at this time;
    /// `None` if their clock offset was not steady, or not known for long enough.
    pub fn steady_delay_s(&self, at: SessionTime) -> Option<f64> {
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
