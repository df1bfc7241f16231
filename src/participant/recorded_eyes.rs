//! Fixations in recorded gaze: where a person looked, and when a content there could be read.
//!
//! A simulated participant that follows a recording reads by these fixations instead of by its own eyes (see
//! `shadowing`). The detector knows the simulated eyes: contents are read a fixed time after a fixation begins, and
//! nothing is read during a blink.

use super::eyes::READING_S;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::kitchen::{Kitchen, LocationId};

/// Number of consecutive samples whose mean tells whether a new fixation has begun.
const WINDOW: usize = 3;
/// Distance of that mean from the fixation's mean from which on a new fixation has begun, in metres on the display:
/// five standard deviations of the mean of three samples by the simulated tracker's noise.
const NEW_FIXATION_M: f64 = 0.012;
/// Confidence below which the eyes count as closed.
const OPEN_CONFIDENCE: f64 = 0.6;
/// Time without samples that ends a fixation, in seconds.
const GAP_S: f64 = 0.1;
/// Least duration of a fixation in seconds; shorter stable gaze is part of a saccade.
const SHORTEST_S: f64 = 0.1;
/// Largest distance of a fixation from the centre of the fixated location, in metres on the display: before and after
/// the tracker's offset has been taken off.
const REACH_M: [f64; 2] = [0.12, 0.07];

/// A fixation in recorded gaze.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedFixation {
    /// Session time of the first sample of the fixation.
    pub begin: SessionTime,
    /// Session time of the last sample of the fixation.
    pub end: SessionTime,
    /// Mean of the fixation's samples, as fractions of the display's width and height.
    pub point: [f64; 2],
    /// The fixated location; `None` if the fixation is at a storage or elsewhere.
    pub location: Option<LocationId>,
    /// Blinks during the fixation: session times of the first sample with closed eyes and of the first one after it.
    pub blinks: Vec<[SessionTime; 2]>,
}

impl RecordedFixation {
    /// Session time at which a content is read that is shown at the fixated location from `shown` on; `None` if the
    /// fixation ends before. Reading takes the same time as with simulated eyes, and waits for the end of a blink.
    pub fn reads(&self, shown: SessionTime) -> Option<SessionTime> {
        let mut read = self.begin.max(shown) + SessionTime::from_secs_f64(READING_S);
        for &[closed, open] in &self.blinks {
            if closed <= read && read < open {
                read = open;
            }
        }
        (read <= self.end).then_some(read)
    }
}

/// The fixations of a trial, from gaze samples with their session times, in order.
pub fn fixations(kitchen: &Kitchen, samples: &[(SessionTime, GazeSample)]) -> Vec<RecordedFixation> {
    let mut detector = FixationDetector { display_m: kitchen.display_m, ..FixationDetector::default() };
    samples.iter().for_each(|&(time, sample)| detector.take(time, sample));
    detector.close();
    let mut found = detector.found;
    found.retain(|one| one.end.secs_since(one.begin) >= SHORTEST_S);
    let offset_m = tracker_offset_m(kitchen, &found);
    for fixation in &mut found {
        fixation.location = nearest(kitchen, fixation.point, offset_m, REACH_M[1]).and_then(|(location, _)| location);
    }
    found
}

/// The tracker's systematic offset in metres: the median distance of fixations from the centres that they are next to.
fn tracker_offset_m(kitchen: &Kitchen, fixations: &[RecordedFixation]) -> [f64; 2] {
    let near = fixations.iter().filter_map(|one| nearest(kitchen, one.point, [0.0; 2], REACH_M[0]));
    let distances: Vec<[f64; 2]> = near.map(|(_, distance)| distance).collect();
    [0, 1].map(|axis| {
        let mut along: Vec<f64> = distances.iter().map(|distance| distance[axis]).collect();
        along.sort_by(f64::total_cmp);
        along.get(along.len() / 2).copied().unwrap_or(0.0)
    })
}

/// The location whose centre is nearest to a point of gaze (`None`: a storage), and the point's distance from the
/// centre along both axes in metres; `None` if nothing is within `reach_m`.
fn nearest(
    kitchen: &Kitchen,
    point: [f64; 2],
    offset_m: [f64; 2],
    reach_m: f64,
) -> Option<(Option<LocationId>, [f64; 2])> {
    let locations = kitchen.locations.iter().enumerate();
    let locations = locations.map(|(index, one)| (Some(LocationId(index as u8)), one.display));
    let areas = locations.chain(kitchen.storages.iter().map(|one| (None, one.display)));
    let distances = areas.map(|(location, area)| {
        let centre = area.centre();
        (location, [0, 1].map(|axis| (point[axis] - centre[axis]) * kitchen.display_m[axis] - offset_m[axis]))
    });
    let length = |distance: &[f64; 2]| distance[0].hypot(distance[1]);
    let best = distances.min_by(|(_, a), (_, b)| length(a).total_cmp(&length(b)))?;
    (length(&best.1) <= reach_m).then_some(best)
}

/// Splits gaze samples into intervals of stable gaze.
#[derive(Default)]
struct FixationDetector {
    display_m: [f64; 2],
    /// The present fixation and the number of its samples.
    present: Option<(RecordedFixation, f64)>,
    /// The last samples with open eyes, at most [`WINDOW`].
    window: Vec<(SessionTime, [f64; 2])>,
    closed: Option<SessionTime>,
    last: SessionTime,
    found: Vec<RecordedFixation>,
}

impl FixationDetector {
    fn take(&mut self, time: SessionTime, sample: GazeSample) {
        if time.secs_since(self.last) > GAP_S {
            self.close();
        }
        self.last = time;
        if sample.confidence < OPEN_CONFIDENCE {
            self.closed = self.closed.or(Some(time));
            return;
        }
        if let (Some(closed), Some((fixation, _))) = (self.closed.take(), &mut self.present) {
            fixation.blinks.push([closed, time]);
        }
        if self.window.len() == WINDOW {
            self.window.remove(0);
        }
        self.window.push((time, [sample.x, sample.y]));
        let Some((fixation, count)) = &mut self.present else { return self.begin() };
        let mean = mean(&self.window);
        let away_m = [0, 1].map(|axis| (mean[axis] - fixation.point[axis]) * self.display_m[axis]);
        if away_m[0].hypot(away_m[1]) > NEW_FIXATION_M {
            return self.begin();
        }
        *count += 1.0;
        for (axis, at) in fixation.point.iter_mut().enumerate() {
            *at += ([sample.x, sample.y][axis] - *at) / *count;
        }
        fixation.end = time;
    }

    /// Begins a fixation with the samples of a full window, at which the fixation before ends.
    fn begin(&mut self) {
        if self.window.len() < WINDOW {
            return;
        }
        let (begin, end) = (self.window[0].0, self.window[WINDOW - 1].0);
        if let Some((before, _)) = self.present.take() {
            self.found.push(RecordedFixation { end: before.end.min(begin), ..before });
        }
        let point = mean(&self.window);
        let fixation = RecordedFixation { begin, end, point, location: None, blinks: Vec::new() };
        self.present = Some((fixation, WINDOW as f64));
    }

    fn close(&mut self) {
        self.found.extend(self.present.take().map(|(fixation, _)| fixation));
        self.window.clear();
        self.closed = None;
    }
}

fn mean(samples: &[(SessionTime, [f64; 2])]) -> [f64; 2] {
    [0, 1].map(|axis| samples.iter().map(|(_, point)| point[axis]).sum::<f64>() / samples.len() as f64)
}
