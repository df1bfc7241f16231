//! The participant's eyes as a tracker sees them: fixations, saccades, blinks, noise; 120 samples a second.

use rand::RngExt;

use super::population::{Individual, chance, normal};
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;

/// Samples a second, the rate of a Pupil Core.
pub const RATE_HZ: u64 = 120;
/// From landing on something to having read it, in seconds: about half of a usual fixation.
const READING_S: f64 = 0.14;
/// A fixation lasts at least so long, in seconds.
const SHORTEST_FIXATION_S: f64 = 0.16;
/// Where a saccade lands around its goal, and how restless a fixation is: standard deviations in metres.
const LANDING_M: f64 = 0.012;
const TREMOR_M: f64 = 0.004;
/// The tracker's offset drifts by so much a second, as a share of its size (standard deviation, per root second).
const DRIFT: f64 = 0.05;
/// Mean time between blinks, and their shortest and longest duration, in seconds.
const BLINK_EVERY_S: f64 = 4.5;
const BLINK_S: [f64; 2] = [0.1, 0.2];

/// What the eyes just did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixationProgress {
    /// On the way, or still looking.
    Nothing,
    /// Looked long enough to have read what is there.
    Read,
    /// Ready to look elsewhere.
    Done,
}

/// The eyes of one person and the tracker in front of them.
#[derive(Clone, Debug)]
pub struct Eyes {
    random: Stream,
    display_m: [f64; 2],
    fixation_s: f64,
    /// The tracker's present offset, in metres.
    offset_m: [f64; 2],
    offset_size_m: f64,
    started: SessionTime,
    samples: u64,
    from: [f64; 2],
    goal: [f64; 2],
    leaves: SessionTime,
    lands: SessionTime,
    reads: Option<SessionTime>,
    ends: SessionTime,
    blink: (SessionTime, SessionTime),
}

impl Eyes {
    /// Eyes that rest on the middle of the display.
    pub fn new(mut random: Stream, display_m: [f64; 2], individual: &Individual, offset_size_m: f64) -> Eyes {
        let offset_m = [normal(&mut random) * offset_size_m, normal(&mut random) * offset_size_m];
        let zero = SessionTime::ZERO;
        Eyes {
            random,
            display_m,
            fixation_s: individual.fixation_s,
            offset_m,
            offset_size_m,
            started: zero,
            samples: 0,
            from: [0.5, 0.5],
            goal: [0.5, 0.5],
            leaves: zero,
            lands: zero,
            reads: None,
            ends: zero,
            blink: (zero, zero),
        }
    }

    /// The trial begins: the first sample is due now.
    pub fn start(&mut self, now: SessionTime) {
        self.started = now;
        self.samples = 0;
        self.blink = self.next_blink(now);
        self.look_at(now, self.goal);
    }

    /// When the next sample is due.
    pub fn due(&self) -> SessionTime {
        self.started + SessionTime(self.samples * 1_000_000_000 / RATE_HZ)
    }

    /// Everything later by `by`.
    pub fn postpone(&mut self, by: SessionTime) {
        for time in [&mut self.started, &mut self.leaves, &mut self.lands, &mut self.ends] {
            *time = *time + by;
        }
        self.blink = (self.blink.0 + by, self.blink.1 + by);
        self.reads = self.reads.map(|time| time + by);
    }

    /// Sets out to look at a display point.
    pub fn look_at(&mut self, now: SessionTime, point: [f64; 2]) {
        self.from = self.position(now);
        let landing = |goal: f64, length_m: f64, random: &mut Stream| goal + normal(random) * LANDING_M / length_m;
        self.goal = [
            landing(point[0], self.display_m[0], &mut self.random),
            landing(point[1], self.display_m[1], &mut self.random),
        ];
        let dx = (self.goal[0] - self.from[0]) * self.display_m[0];
        let dy = (self.goal[1] - self.from[1]) * self.display_m[1];
        // The main sequence of saccades: 20 ms and 2 ms more a degree; a degree is 35 mm at 2 m.
        let saccade_s = 0.02 + 0.002 * dx.hypot(dy) / 0.035;
        let fixation_s = (self.fixation_s * (0.35 * normal(&mut self.random)).exp()).max(SHORTEST_FIXATION_S);
        self.leaves = now;
        self.lands = now + SessionTime::from_secs_f64(saccade_s);
        self.reads = Some(self.lands + SessionTime::from_secs_f64(READING_S));
        self.ends = self.lands + SessionTime::from_secs_f64(fixation_s);
    }

    /// What has come of the present look by now.
    pub fn advance(&mut self, now: SessionTime) -> FixationProgress {
        if let Some(reads) = self.reads
            && now >= reads
            && !self.is_closed(now)
        {
            self.reads = None;
            return FixationProgress::Read;
        }
        if now >= self.ends { FixationProgress::Done } else { FixationProgress::Nothing }
    }

    /// What is looked at has just changed: it has to be read again.
    pub fn look_again(&mut self, now: SessionTime) {
        let read = now + SessionTime::from_secs_f64(READING_S);
        self.reads = Some(read);
        self.ends = self.ends.max(read);
    }

    /// Whether the eyes rest on their goal.
    pub fn has_landed(&self, now: SessionTime) -> bool {
        now >= self.lands && !self.is_closed(now)
    }

    /// Where the eyes are, as fractions of the display.
    pub fn position(&self, now: SessionTime) -> [f64; 2] {
        let duration = self.lands.secs_since(self.leaves);
        let part = if duration > 0.0 { (now.secs_since(self.leaves) / duration).min(1.0) } else { 1.0 };
        // Saccades start and end softly.
        let part = part * part * (3.0 - 2.0 * part);
        [0, 1].map(|axis| self.from[axis] + (self.goal[axis] - self.from[axis]) * part)
    }

    /// The sample that is due, as the tracker sends it.
    pub fn sample(&mut self, now: SessionTime) -> GazeSample {
        self.samples += 1;
        if now >= self.blink.1 {
            self.blink = self.next_blink(now);
        }
        let interval = 1.0 / RATE_HZ as f64;
        for offset in &mut self.offset_m {
            let pull = *offset * DRIFT * DRIFT / 2.0 * interval;
            *offset += DRIFT * self.offset_size_m * interval.sqrt() * normal(&mut self.random) - pull;
        }
        let eye = self.position(now);
        let mut seen = [0.0; 2];
        for axis in 0..2 {
            let error_m = self.offset_m[axis] + TREMOR_M * normal(&mut self.random);
            seen[axis] = eye[axis] + error_m / self.display_m[axis];
        }
        let confidence = match self.is_closed(now) {
            true => 0.3 * self.random.random::<f64>(),
            false => (0.95 - 0.04 * normal(&mut self.random).abs()).clamp(0.0, 1.0),
        };
        // Trackers send no more digits than they can know; the log is the shorter for it.
        let rounded = |value: f64| (value * 1e4).round() / 1e4;
        GazeSample::new(rounded(seen[0]), rounded(seen[1]), rounded(confidence))
    }

    fn is_closed(&self, now: SessionTime) -> bool {
        now >= self.blink.0 && now < self.blink.1
    }

    fn next_blink(&mut self, now: SessionTime) -> (SessionTime, SessionTime) {
        let wait_s = -BLINK_EVERY_S * (1.0 - self.random.random::<f64>()).ln();
        let length_s = BLINK_S[0] + (BLINK_S[1] - BLINK_S[0]) * self.random.random::<f64>();
        // Now and then a second blink follows at once.
        let wait_s = if chance(&mut self.random, 0.05) { 0.1 } else { wait_s.max(0.3) };
        let shut = now + SessionTime::from_secs_f64(wait_s);
        (shut, shut + SessionTime::from_secs_f64(length_s))
    }
}
