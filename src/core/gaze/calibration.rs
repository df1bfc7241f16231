//! Accuracy check of an eye tracker: the wall display shows targets, and the check measures the angular distance
//! between gaze samples and the shown target.

use serde::{Deserialize, Serialize};

use super::GazeSample;

/// Positions of the accuracy check's targets, in fractions of the display: the first target is in the centre.
pub const TARGETS: [[f64; 2]; 5] = [[0.5, 0.5], [0.2, 0.25], [0.8, 0.25], [0.8, 0.75], [0.2, 0.75]];
/// Time for which the accuracy check shows a target, in seconds.
pub const TARGET_S: f64 = 1.8;
/// Gaze samples of the accuracy check count from this time after the target appears, in seconds: before that time, the
/// eyes are still moving to the target.
pub const SETTLE_S: f64 = 0.7;
/// A target with fewer gaze samples does not count: the participant did not look at it, or the tracker lost the eyes.
pub(crate) const LEAST_SAMPLES: usize = 10;
/// An accuracy check with fewer valid targets gives no result.
const LEAST_TARGETS: usize = 3;
/// Largest mean angular error of good gaze, in degrees: locations are 0.15 m apart, which is 4.3 degrees seen from 2 m.
pub const GOOD_DEG: f64 = 2.0;
/// Largest mean angular error of usable gaze, in degrees.
pub const USABLE_DEG: f64 = 3.0;

/// The result of a gaze accuracy check. Degrees are of visual angle, seen from the configured distance in front of the
/// display's centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeAccuracy {
    /// Accuracy: mean angle between target and gaze, over the targets, in degrees.
    pub accuracy_deg: f64,
    /// Accuracy of the gaze after the constant offset is subtracted, in degrees.
    pub corrected_deg: f64,
    /// Precision of the gaze: root mean square of the angles between successive samples, in degrees (Holmqvist et al.
    /// 2012).
    pub precision_deg: f64,
    /// Correction to add to gaze, in fractions of the display: mean over the targets of the vector from the median gaze
    /// to the target.
    pub offset: [f64; 2],
    /// The result for each target, in the order in which the targets were shown.
    pub targets: Vec<TargetAccuracy>,
}

/// The result of a gaze accuracy check at one target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TargetAccuracy {
    /// Number of gaze samples with sufficient confidence.
    pub samples: usize,
    /// Mean angle between target and gaze in degrees; none if there were too few gaze samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy_deg: Option<f64>,
}

/// The size of the display and the viewing distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewingGeometry {
    /// Width and height of the wall display in metres.
    pub display_m: [f64; 2],
    /// Distance from the eyes to the wall display, in metres.
    pub distance_m: f64,
}

impl ViewingGeometry {
    /// The visual angle in degrees between two display points (fractions of width and height).
    pub fn angle_deg(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let ray = |point: [f64; 2]| {
            let [x, y] = [0, 1].map(|axis| (point[axis] - 0.5) * self.display_m[axis]);
            [x, y, self.distance_m]
        };
        let (a, b) = (ray(a), ray(b));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        // The arc tangent is exact for small angles, unlike the arc cosine of the dot product.
        cross.iter().map(|part| part * part).sum::<f64>().sqrt().atan2(dot).to_degrees()
    }
}

/// The gaze accuracy from samples that were taken while the targets were shown. `samples` has one list per target, with
/// the samples of sufficient confidence in order of time. `None` if too few targets have enough samples.
pub fn measure(viewing: &ViewingGeometry, targets: &[[f64; 2]], samples: &[Vec<GazeSample>]) -> Option<GazeAccuracy> {
    let looked: Vec<([f64; 2], &Vec<GazeSample>)> =
        targets.iter().copied().zip(samples).filter(|(_, samples)| samples.len() >= LEAST_SAMPLES).collect();
    if looked.len() < LEAST_TARGETS.min(targets.len()) {
        return None;
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
        sum / count.max(1) as f64
    };
    let off = |target: [f64; 2], by: [f64; 2], samples: &[GazeSample]| {
        mean(&mut samples.iter().map(|sample| viewing.angle_deg(target, [sample.x + by[0], sample.y + by[1]])))
    };
    let offset = [0, 1].map(|axis| {
        let median = |samples: &[GazeSample]| {
            let mut values: Vec<f64> = samples.iter().map(|sample| [sample.x, sample.y][axis]).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        mean(&mut looked.iter().map(|(target, samples)| target[axis] - median(samples)))
    });
    let steps = looked.iter().flat_map(|(_, samples)| samples.windows(2));
    let steps = steps.map(|pair| viewing.angle_deg([pair[0].x, pair[0].y], [pair[1].x, pair[1].y]).powi(2));
    let precision_deg = mean(&mut { steps }).sqrt();
    let of_targets = |by: [f64; 2]| mean(&mut looked.iter().map(|(target, samples)| off(*target, by, samples)));
    let found = targets.iter().zip(samples).map(|(target, samples)| TargetAccuracy {
        samples: samples.len(),
        accuracy_deg: (samples.len() >= LEAST_SAMPLES).then(|| thousandths(off(*target, [0.0; 2], samples))),
    });
    Some(GazeAccuracy {
        accuracy_deg: thousandths(of_targets([0.0; 2])),
        corrected_deg: thousandths(of_targets(offset)),
        precision_deg: thousandths(precision_deg),
        offset: offset.map(|value| (value * 1e5).round() / 1e5),
        targets: found.collect(),
    })
}

/// Gaze that moves less than this over all targets, in fractions of the display, is no one's.
const STILL: f64 = 0.01;

/// Ways in which a sender may mean its coordinates, in words, and the point of the display that is then looked at.
type Reading = (&'static str, fn([f64; 2]) -> [f64; 2]);
const READINGS: [Reading; 5] = [
    ("x and y are swapped", |[x, y]| [y, x]),
    ("y counts from the bottom", |[x, y]| [x, 1.0 - y]),
    ("x counts from the right", |[x, y]| [1.0 - x, y]),
    ("x and y count from the centre", |[x, y]| [x + 0.5, y + 0.5]),
    ("x and y are in percent", |[x, y]| [x / 100.0, y / 100.0]),
];

/// How the sender seems to mean its coordinates, in words, if the gaze is on the targets only when it is read so.
/// `samples`: as for [`measure`].
pub fn mistaken_coordinates(
    viewing: &ViewingGeometry,
    targets: &[[f64; 2]],
    samples: &[Vec<GazeSample>],
) -> Option<&'static str> {
    let off_deg = |read: fn([f64; 2]) -> [f64; 2]| {
        let read = |sample: &GazeSample| {
            let [x, y] = read([sample.x, sample.y]);
            GazeSample { x, y, ..*sample }
        };
        let samples: Vec<Vec<GazeSample>> = samples.iter().map(|samples| samples.iter().map(read).collect()).collect();
        measure(viewing, targets, &samples).map(|found| found.accuracy_deg)
    };
    if off_deg(|point| point)? <= USABLE_DEG {
        return None;
    }
    let all = || samples.iter().flatten();
    let spread = |axis: fn(&GazeSample) -> f64| {
        all().map(axis).fold(f64::NEG_INFINITY, f64::max) - all().map(axis).fold(f64::INFINITY, f64::min)
    };
    if spread(|sample| sample.x) < STILL && spread(|sample| sample.y) < STILL {
        return Some("x and y do not follow the targets, but stay the same");
    }
    let tried = READINGS.iter().filter_map(|(words, read)| Some((off_deg(*read)?, *words)));
    let best = tried.min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.filter(|(deg, _)| *deg <= USABLE_DEG).map(|(_, words)| words)
}

/// Rounds to three decimals: a gaze accuracy check is not more precise.
fn thousandths(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
