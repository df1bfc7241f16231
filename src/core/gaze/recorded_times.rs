//! Times of recorded gaze samples: where the tracker's clock was set, and time stamps that fit no sample around them.
//! Times are any whole numbers of one unit, also negative ones.

use std::ops::Range;

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

/// Recorded times on one axis.
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

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: TimeLimits = TimeLimits { back: 100, gap: 1000, longest: 86_400_000 };

    /// Test: the times are put on the axis as these numbers, with steps before these samples and odd samples at these
    /// places.
    fn check(times: &[i128], on_axis: &[i128], steps: &[usize], odd: &[usize]) {
        let found = RecordedTimeline::from_times(times, LIMITS);
        let kept: Vec<i128> = found.times.iter().copied().flatten().collect();
        assert_eq!(kept, on_axis, "{times:?}");
        assert_eq!(found.steps.iter().map(|step| step.at).collect::<Vec<usize>>(), steps, "{times:?}");
        assert_eq!(found.odd, odd, "{times:?}");
    }

    fn every_5(from: i128, count: usize) -> Vec<i128> {
        (0..count as i128).map(|nth| from + 5 * nth).collect()
    }

    #[test]
    fn gaps_and_samples_out_of_order_stay_as_they_are() {
        check(&[], &[], &[], &[]);
        check(&[-3000], &[0], &[], &[]);
        check(&[&every_5(-20, 5)[..], &[-3, -8, 2]].concat(), &[0, 5, 10, 15, 20, 17, 12, 22], &[], &[]);
        check(&[every_5(0, 5), every_5(60_000, 5)].concat(), &[every_5(0, 5), every_5(60_000, 5)].concat(), &[], &[]);
        check(&[0, 5000, 10_000, 15_000], &[0, 5000, 10_000, 15_000], &[], &[]);
        check(
            &[&every_5(0, 5)[..], &[2000], &every_5(5000, 5)].concat(),
            &[&every_5(0, 5)[..], &[2000], &every_5(5000, 5)].concat(),
            &[],
            &[],
        );
    }
}
