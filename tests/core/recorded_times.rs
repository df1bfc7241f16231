//! The axis of time of recorded gaze.

use tomcom_core::gaze::recorded::{RecordedTimeline, TimeLimits};

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
