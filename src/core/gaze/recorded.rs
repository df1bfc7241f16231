//! Recorded gaze: what a session reads from a file, and its times: where the tracker's clock was set, and time stamps
//! that fit no sample around them.

use std::ops::Range;

use super::{GazeSample, MIN_CONFIDENCE};
use crate::base::text::count;

/// Time without a sample that counts as a gap, in seconds.
pub const GAP_S: f64 = 1.0;

/// Numbers about the gaze that a session reads from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGazeSummary {
    /// Number of gaze samples that are replayed.
    pub samples: u64,
    /// Number of samples on the display whose confidence is enough for the belief estimate.
    pub usable: u64,
    /// Time from the first to the last sample, in seconds.
    pub seconds: f64,
    /// Number of gaps: times of more than [`GAP_S`] without a sample.
    pub gaps: u64,
    /// Duration of the longest gap, in seconds.
    pub longest_gap_s: f64,
    /// Number of samples without a confidence; they have the one that the settings give them.
    pub without_confidence: u64,
    /// Number of lines that are no samples.
    pub malformed: u64,
    /// What is wrong in the first malformed line, with the line's number.
    pub first_malformed: Option<String>,
    /// What was odd in the file and how it was read: steps of the clock, times in another unit.
    pub remarks: Vec<String>,
}

impl RecordedGazeSummary {
    /// The summary of these samples, each with its time in seconds; what else was found in the file is added.
    pub fn from_samples(samples: &[(f64, GazeSample)]) -> RecordedGazeSummary {
        let mut summary = RecordedGazeSummary { samples: samples.len() as u64, ..RecordedGazeSummary::default() };
        let is_usable = |sample: &GazeSample| sample.is_on_display() && sample.confidence >= MIN_CONFIDENCE;
        summary.usable = samples.iter().filter(|(_, sample)| is_usable(sample)).count() as u64;
        let (mut first_s, mut last_s) = (f64::INFINITY, f64::NEG_INFINITY);
        for (at_s, _) in samples {
            let gap_s = at_s - last_s;
            if gap_s.is_finite() && gap_s > GAP_S {
                summary.gaps += 1;
                summary.longest_gap_s = summary.longest_gap_s.max(gap_s);
            }
            (first_s, last_s) = (first_s.min(*at_s), last_s.max(*at_s));
        }
        if summary.samples > 0 {
            summary.seconds = last_s - first_s;
        }
        summary
    }

    /// The numbers in words: samples, seconds, gaps, malformed lines.
    pub fn words(&self) -> String {
        let mut words = format!("{} in {:.1} s", count(self.samples, "sample", "samples"), self.seconds);
        if self.usable < self.samples {
            words += &format!(", {} of them on the display with enough confidence", self.usable);
        }
        words += &match self.gaps {
            0 => format!("; no gap of more than {GAP_S:.0} s"),
            gaps => format!(
                "; {} of more than {GAP_S:.0} s, the longest of {:.1} s",
                count(gaps, "gap", "gaps"),
                self.longest_gap_s
            ),
        };
        if self.without_confidence > 0 {
            words += &format!("; {} without confidence", count(self.without_confidence, "sample", "samples"));
        }
        if self.malformed > 0 {
            words += &format!("; {}", count(self.malformed, "malformed line", "malformed lines"));
            words += &self.first_malformed.as_ref().map_or(String::new(), |first| format!(" ({first})"));
        }
        words
    }
}

/// Number of samples that have to agree before the tracker's clock counts as set; fewer samples are odd time stamps.
const AGREEING: usize = 5;

/// Limits between which the times of consecutive samples of one clock lie, all in the unit of the times.
#[derive(Clone, Copy, Debug)]
pub struct TimeLimits {
    /// Largest step back that still is a sample out of order: the samples of two eyes can be interleaved.
    pub back: i128,
    /// Least time without samples that is a gap.
    pub gap: i128,
    /// Longest time without samples; a longer step shows that the clock was set.
    pub longest: i128,
}

/// A place between two samples at which the tracker's clock was set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedClockStep {
    /// Index of the first sample after the step.
    pub at: usize,
    /// Time of the last sample before the step.
    pub from: i128,
    /// Time of the first sample after the step.
    pub to: i128,
}

/// Recorded times on one axis. Times are any whole numbers of one unit, also negative ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedTimeline {
    /// For each sample, the time since the first sample; `None` for an odd time stamp. After a clock step, samples go on
    /// one sampling interval after the last sample before it.
    pub times: Vec<Option<i128>>,
    /// Clock steps, in the order of the samples.
    pub steps: Vec<RecordedClockStep>,
    /// Indices of the samples with odd time stamps.
    pub odd: Vec<usize>,
}

/// The median of the differences between consecutive times; `None` for fewer than two times.
pub fn median_interval(times: &[i128]) -> Option<i128> {
    let mut intervals: Vec<i128> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = intervals.len() / 2;
    (!intervals.is_empty()).then(|| *intervals.select_nth_unstable(middle).1)
}

impl RecordedTimeline {
    /// Puts the times of samples, in the order in which they were recorded, on one axis.
    pub fn from_times(times: &[i128], limits: TimeLimits) -> RecordedTimeline {
        let mut timeline = RecordedTimeline { times: vec![None; times.len()], ..RecordedTimeline::default() };
        let runs = kept_runs(times, limits);
        let interval = median_interval(times).unwrap_or(0).max(0);
        // Distances from the axis of the clocks before the present one.
        let mut earlier: Vec<i128> = Vec::new();
        let mut offset = 0;
        for (nth, run) in runs.iter().enumerate() {
            let first = times[run.start];
            match nth.checked_sub(1).map(|before| runs[before].end - 1) {
                None => offset = -first,
                Some(last) => {
                    let gap = |offset: i128, before: i128| (first + offset - before).abs() >= limits.gap;
                    let end = times[last] + offset;
                    // A long gap of this clock that is none of an earlier one: the clock was set right again.
                    let is_right_again = gap(offset, end) && earlier.iter().any(|&earlier| !gap(earlier, end));
                    if is_right_again || !limits.follows(times[last], first) {
                        timeline.steps.push(RecordedClockStep { at: run.start, from: times[last], to: first });
                        earlier.push(offset);
                        offset = end + interval - first;
                    }
                }
            }
            run.clone().for_each(|index| timeline.times[index] = Some(times[index] + offset));
        }
        timeline.odd = (0..times.len()).filter(|&index| timeline.times[index].is_none()).collect();
        timeline
    }
}

impl TimeLimits {
    /// Whether a sample can follow another one without a clock step in between.
    fn follows(self, from: i128, to: i128) -> bool {
        (-self.back..=self.longest).contains(&(to - from))
    }
}

/// Runs of samples that go on without gap and clock step, without those whose times are odd.
fn kept_runs(times: &[i128], limits: TimeLimits) -> Vec<Range<usize>> {
    let is_near = |pair: &[i128]| (-limits.back..limits.gap).contains(&(pair[1] - pair[0]));
    let mut runs: Vec<Range<usize>> = Vec::new();
    for index in 0..times.len() {
        match runs.last_mut() {
            Some(run) if is_near(&times[index - 1..=index]) => run.end = index + 1,
            _ => runs.push(index..index + 1),
        }
    }
    // Samples that are all far apart are no odd ones among others.
    let least = runs.iter().map(ExactSizeIterator::len).max().unwrap_or(0).min(AGREEING);
    let follows = |a: &Range<usize>, b: &Range<usize>| limits.follows(times[a.end - 1], times[b.start]);
    let mut kept: Vec<Range<usize>> = Vec::new();
    let mut short: Vec<Range<usize>> = Vec::new();
    let take = |kept: &mut Vec<Range<usize>>, short: &mut Vec<Range<usize>>, next: Option<&Range<usize>>| {
        let is_step = kept.last().zip(next).is_some_and(|(last, next)| !follows(last, next));
        for run in short.drain(..) {
            let fits_last = kept.last().is_none_or(|last| follows(last, &run));
            let fits_next = next.is_none_or(|next| follows(&run, next));
            if (fits_last && fits_next) || (is_step && (fits_last || fits_next)) {
                kept.push(run);
            }
        }
        kept.extend(next.cloned());
    };
    for run in runs {
        match run.len() >= least {
            true => take(&mut kept, &mut short, Some(&run)),
            false => short.push(run),
        }
    }
    take(&mut kept, &mut short, None);
    kept
}
