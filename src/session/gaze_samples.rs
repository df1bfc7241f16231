//! The participant's gaze in a session: how a sample changes its state (sampling rate, faults, the locations looked
//! at).

use crate::settings::GazeSource;
use crate::{Session, TrialPhase};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::quality::{GazeFault, GazeFaultDetector};
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::kitchen::LocationId;
use tomcom_core::kitchen::state::MAX_LOCATIONS;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStatus {
    /// Arrival of the latest sample, usable or not.
    pub arrived: Option<SessionTime>,
    /// The newest usable sample on the display, and its arrival.
    pub last: Option<(SessionTime, GazeSample)>,
    /// When the last sample inside each location's area was taken: the participant's last look there.
    pub looked_at: [Option<SessionTime>; MAX_LOCATIONS],
    /// The latest sample, if it is unusable and not faulty: with too low a confidence, or outside of the display.
    pub latest_unusable: Option<GazeSample>,
    /// Times of the trial in which no usable sample came for more than [`LOST_S`]: of the last usable sample, and of the
    /// next one or the trial's end.
    pub losses: Vec<[SessionTime; 2]>,
    /// Locations in whose areas the latest sample lies, as a bit set; empty if it is faulty or unusable, or was taken
    /// while the kitchen was not on the display.
    pub here: u32,
    /// All samples, also those counted in `unusable`.
    pub samples: u64,
    /// Samples with too low a confidence or outside of the display.
    pub unusable: u64,
    pub judge: GazeFaultDetector,
    /// Of the latest sample.
    pub fault: Option<GazeFault>,
    /// Measured over about a second: see [`Session::gaze_hz`].
    pub(crate) rate_hz: f64,
    pub(crate) measured: Option<RateMeasurement>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RateMeasurement {
    /// Arrival of the first sample.
    pub since: SessionTime,
    /// When the first sample was taken.
    pub first_taken: SessionTime,
    pub samples: u32,
}

/// Time since the last usable gaze sample from which the gaze counts as lost.
pub const LOST_S: f64 = 1.0;
/// A gap of this length makes the rate be measured anew.
const GAP_S: f64 = 0.5;
/// Time over which the rate is measured; the first measurement counts from [`FIRST_S`] on.
const MEASURED_S: f64 = 1.0;
const FIRST_S: f64 = 0.05;

/// A look counts by the time at which the sample was taken: a sample that arrives after a change may have been taken
/// before.
pub(crate) fn take_sample(session: &mut Session, now: SessionTime, sample: GazeSample) {
    let status = &mut session.gaze;
    status.samples += 1;
    measure_rate(status, now, sample.taken(now));
    status.here = 0;
    status.fault = status.judge.judge(&sample, now);
    if status.fault.is_some() {
        return;
    }
    let taken = sample.taken(now);
    if let Some(check) = &mut session.calibration {
        check.take(taken, sample);
    }
    let sample = session.corrected(sample);
    let status = &mut session.gaze;
    status.latest_unusable = (!sample.is_on_display() || sample.confidence < MIN_CONFIDENCE).then_some(sample);
    if status.latest_unusable.is_some() {
        status.unusable += 1;
        return;
    }
    note_loss(session, now);
    session.gaze.last = Some((now, sample));
    if !session.had_kitchen_on_display(taken) {
        return;
    }
    let status = &mut session.gaze;
    for (index, location) in session.kitchen.locations.iter().enumerate() {
        if location.display.distance_m([sample.x, sample.y], session.kitchen.display_m) == 0.0 {
            status.looked_at[index] = Some(taken);
            status.here |= 1 << index;
        }
    }
}

/// Keeps the time since the last usable sample, if it was long, when the next one comes or the trial ends.
pub(crate) fn note_loss(session: &mut Session, now: SessionTime) {
    let since = session.gaze.last.map_or(session.trial_start, |(at, _)| at.max(session.trial_start));
    let is_in_trial = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
    let has_gaze = session.spec.participant.gaze != GazeSource::None;
    if is_in_trial && has_gaze && session.age(since, now).as_secs_f64() > LOST_S {
        session.gaze.losses.push([since, now]);
    }
}

impl Session {
    /// Whether a sample taken at `taken` can be a look at the kitchen: during a freeze probe it is not on the display.
    pub(crate) fn had_kitchen_on_display(&self, taken: SessionTime) -> bool {
        !self.is_frozen() && self.probes.ended_at.is_none_or(|ended| taken >= ended)
    }

    /// Whether the latest sample is a look at the location's present content: taken since the content last changed.
    pub fn sees_present_content(&self, location: LocationId) -> bool {
        let is_here = self.gaze.here & 1 << location.index() != 0;
        is_here && self.gaze.looked_at[location.index()].is_some_and(|taken| taken >= self.changed_at[location.index()])
    }

    /// The location in whose area the latest sample lies.
    pub fn looked_at(&self) -> Option<LocationId> {
        let here = self.gaze.here;
        (here != 0).then(|| LocationId(here.trailing_zeros() as u8))
    }
}

/// Number of samples by the time in which they arrived, or were taken, if that is longer. Samples that arrive together
/// say nothing else.
fn measure_rate(status: &mut GazeStatus, now: SessionTime, taken: SessionTime) {
    let is_gap = status.arrived.is_none_or(|last| now.secs_since(last) >= GAP_S);
    status.arrived = Some(now);
    if is_gap || status.measured.is_none() {
        (status.rate_hz, status.measured) = (0.0, None);
    }
    let begun = RateMeasurement { since: now, first_taken: taken, samples: 0 };
    let measured = status.measured.get_or_insert(begun);
    let over_s = now.secs_since(measured.since).max(taken.secs_since(measured.first_taken));
    if over_s >= if status.rate_hz == 0.0 { FIRST_S } else { MEASURED_S } {
        status.rate_hz = f64::from(measured.samples) / over_s;
    }
    if over_s >= MEASURED_S {
        *measured = begun;
    }
    measured.samples += 1;
}

pub(crate) const MALFORMED: &str = "malformed";
pub(crate) const TOO_FREQUENT: &str = "too frequent";
pub(crate) const DUPLICATE: &str = "duplicate";

/// Kinds of faulty samples so far, each with its number.
pub fn faults(session: &Session) -> Vec<(u64, &'static str)> {
    let (dropped, read) = (session.tracker.dropped, session.gaze.judge.counts);
    let all = [
        (dropped.malformed, MALFORMED),
        (dropped.too_frequent, TOO_FREQUENT),
        (dropped.overrun, "overrun"),
        (read.duplicate, DUPLICATE),
        (read.too_old, "late"),
        (read.out_of_order, "out of order"),
    ];
    all.into_iter().filter(|(count, _)| *count > 0).collect()
}
