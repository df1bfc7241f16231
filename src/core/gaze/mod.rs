//! Gaze: samples on the wall display, and the locations that the participant may have looked at.
//!
//! All gaze sources lead to the same event with three times: arrival (the event's time), the tracker's time, and the
//! session time at which the sample was taken. Faults of gaze are judged when the event is applied, so a recording
//! keeps every sample and a replay judges the same way. Recorded gaze stays raw; an accepted offset is corrected where
//! gaze is used.

pub mod calibration;
pub mod device_clock;
pub mod quality;
pub mod recorded;
pub mod tags;

use serde::{Deserialize, Serialize};

use crate::base::time::SessionTime;
use crate::kitchen::{Kitchen, LocationId};

/// Gaze samples below this confidence are not used by the belief filter (recommendation of Pupil Labs).
pub const MIN_CONFIDENCE: f64 = 0.6;

/// One gaze sample, in display coordinates: fractions of width and height, origin at the top left, y down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeSample {
    /// Horizontal position as a fraction of the display's width; outside 0 to 1 the gaze is beside the display.
    pub x: f64,
    /// Vertical position as a fraction of the display's height, downwards.
    pub y: f64,
    /// The tracker's confidence in the sample, 0 to 1.
    pub confidence: f64,
    /// Time of the sample on the tracker's clock in nanoseconds, if the tracker reports it. It may be negative: trackers
    /// choose what their time counts from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device_ns: Option<i64>,
    /// Session time at which the sample was taken, if the offset of the tracker's clock is known; otherwise the
    /// sample's arrival time counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taken_ns: Option<SessionTime>,
}

impl GazeSample {
    /// A gaze sample without a device time.
    pub fn new(x: f64, y: f64, confidence: f64) -> GazeSample {
        GazeSample { x, y, confidence, device_ns: None, taken_ns: None }
    }

    /// Session time at which the sample was taken, for a sample that arrived at `arrived`: no later than its arrival.
    pub fn taken(&self, arrived: SessionTime) -> SessionTime {
        self.taken_ns.map_or(arrived, |taken| taken.min(arrived))
    }

    /// Whether the gaze is on the display, and not beside it; a point that is NaN is not.
    pub fn is_on_display(&self) -> bool {
        (0.0..=1.0).contains(&self.x) && (0.0..=1.0).contains(&self.y)
    }

    /// The gaze sample as it is recorded: position to a hundred thousandth of the display (15 um on a wall display, far
    /// below what any tracker resolves), confidence to a thousandth.
    pub fn rounded(self) -> GazeSample {
        let to = |value: f64, parts: f64| (value * parts).round() / parts;
        GazeSample { x: to(self.x, 1e5), y: to(self.y, 1e5), confidence: to(self.confidence, 1e3), ..self }
    }
}

/// The location nearest to a point of the wall display, and its distance in metres (0 inside the location's area).
pub fn nearest_location(kitchen: &Kitchen, point: [f64; 2]) -> Option<(LocationId, f64)> {
    let distance = |index: usize| kitchen.locations[index].display.distance_m(point, kitchen.display_m);
    let nearest = (0..kitchen.locations.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
    Some((LocationId(nearest as u8), distance(nearest)))
}
