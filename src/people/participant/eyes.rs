//! Simulated eye tracking of a participant: fixations, saccades, blinks and noise, at 120 gaze samples per second.

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;

use super::population::ParticipantTraits;
use super::{chance, normal};

/// Gaze samples per second, as a Pupil Core eye tracker delivers them.
pub(crate) const RATE_HZ: u64 = 120;
/// Time from the start of a fixation until its location has been read, in seconds: about half of a usual fixation.
const READING_S: f64 = 0.14;
/// Shortest duration of a fixation, in seconds.
const SHORTEST_FIXATION_S: f64 = 0.16;
/// Standard deviations in metres on the display: of a saccade's landing point, and of the gaze's jitter during a
/// fixation.
const LANDING_M: f64 = 0.012;
const TREMOR_M: f64 = 0.004;
/// Drift of the simulated eye tracker's offset, as a share of the offset's size (standard deviation per root second).
const DRIFT: f64 = 0.05;
/// Mean time between blinks, and shortest and longest duration of a blink, in seconds.
const BLINK_EVERY_S: f64 = 4.5;
const BLINK_S: [f64; 2] = [0.1, 0.2];

/// Progress of the present fixation of the simulated eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixationProgress {
    /// Nothing happened: the saccade is still under way, or the fixation continues.
    Nothing,
    /// The fixation has lasted long enough for its location to be read.
    Read,
    Done,
}

/// The eyes of one simulated participant, with the measurement error of the participant's eye tracker.
#[derive(Clone, Debug)]
pub struct Eyes {
    random: Stream,
    display_m: [f64; 2],
    fixation_s: f64,
    /// Present systematic offset of the eye tracker, in metres on the display.
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
    /// Simulated eyes that fixate the middle of the display.
    pub fn new(mut random: Stream, display_m: [f64; 2], individual: &ParticipantTraits, offset_size_m: f64) -> Eyes {
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

    /// Starts the trial for the simulated eyes; the first gaze sample is due now.
    pub fn start(&mut self, now: SessionTime) {
        self.started = now;
        self.samples = 0;
        self.blink = self.next_blink(now);
        self.look_at(now, self.goal);
    }

    pub fn due(&self) -> SessionTime {
        self.started + SessionTime(self.samples * 1_000_000_000 / RATE_HZ)
    }

    pub fn postpone(&mut self, by: SessionTime) {
        for time in [&mut self.started, &mut self.leaves, &mut self.lands, &mut self.ends] {
            *time = *time + by;
        }
        self.blink = (self.blink.0 + by, self.blink.1 + by);
        self.reads = self.reads.map(|time| time + by);
    }

    /// Starts a saccade (jump of the eyes) to a point of the display.
    pub fn look_at(&mut self, now: SessionTime, point: [f64; 2]) {
        self.from = self.position(now);
        let landing = |goal: f64, length_m: f64, random: &mut Stream| goal + normal(random) * LANDING_M / length_m;
        self.goal = [
            landing(point[0], self.display_m[0], &mut self.random),
            landing(point[1], self.display_m[1], &mut self.random),
        ];
        let dx = (self.goal[0] - self.from[0]) * self.display_m[0];
        let dy = (self.goal[1] - self.from[1]) * self.display_m[1];
        // Saccade duration (main sequence): 20 ms plus 2 ms per degree; one degree is 35 mm at a distance of 2 m.
        let saccade_s = 0.02 + 0.002 * dx.hypot(dy) / 0.035;
        let fixation_s = (self.fixation_s * (0.35 * normal(&mut self.random)).exp()).max(SHORTEST_FIXATION_S);
        self.leaves = now;
        self.lands = now + SessionTime::from_secs_f64(saccade_s);
        self.reads = Some(self.lands + SessionTime::from_secs_f64(READING_S));
        self.ends = self.lands + SessionTime::from_secs_f64(fixation_s);
    }

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

    /// Restarts the time needed for reading, because the content at the fixated location has just changed.
    pub(crate) fn look_again(&mut self, now: SessionTime) {
        let read = now + SessionTime::from_secs_f64(READING_S);
        self.reads = Some(read);
        self.ends = self.ends.max(read);
    }

    /// Keeps the present fixation until `until`; the participant reads nothing more during the fixation.
    pub(crate) fn rest_until(&mut self, until: SessionTime) {
        self.reads = None;
        self.ends = self.ends.max(until);
    }

    pub(crate) fn has_landed(&self, now: SessionTime) -> bool {
        now >= self.lands && !self.is_closed(now)
    }

    /// True point of gaze, as fractions of the display's width and height.
    pub fn position(&self, now: SessionTime) -> [f64; 2] {
        let duration = self.lands.secs_since(self.leaves);
        let part = if duration > 0.0 { (now.secs_since(self.leaves) / duration).min(1.0) } else { 1.0 };
        // Saccades accelerate and decelerate smoothly.
        let part = part * part * (3.0 - 2.0 * part);
        [0, 1].map(|axis| self.from[axis] + (self.goal[axis] - self.from[axis]) * part)
    }

    /// The gaze sample that is due, with the simulated eye tracker's offset, noise and confidence.
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
        // Rounding to four decimals changes less than the accuracy of eye trackers, and shortens the log.
        let rounded = |value: f64| (value * 1e4).round() / 1e4;
        GazeSample::new(rounded(seen[0]), rounded(seen[1]), rounded(confidence))
    }

    fn is_closed(&self, now: SessionTime) -> bool {
        now >= self.blink.0 && now < self.blink.1
    }

    fn next_blink(&mut self, now: SessionTime) -> (SessionTime, SessionTime) {
        let wait_s = -BLINK_EVERY_S * (1.0 - self.random.random::<f64>()).ln();
        let length_s = BLINK_S[0] + (BLINK_S[1] - BLINK_S[0]) * self.random.random::<f64>();
        // A second blink occasionally follows a blink immediately.
        let wait_s = if chance(&mut self.random, 0.05) { 0.1 } else { wait_s.max(0.3) };
        let shut = now + SessionTime::from_secs_f64(wait_s);
        (shut, shut + SessionTime::from_secs_f64(length_s))
    }
}

/// The schedule of the simulated eye tracker's drop-outs in one trial.
#[derive(Clone, Debug)]
pub struct GazeDropoutSchedule {
    random: Stream,
    every_s: f64,
    /// Natural logarithms of the shortest and the longest duration of a drop-out in seconds.
    lengths: [f64; 2],
    /// Beginning and end of the present or next drop-out; `None` before the first gaze sample.
    next: Option<[SessionTime; 2]>,
}

impl GazeDropoutSchedule {
    /// A schedule of drop-outs from the mean time between drop-outs, and the shortest and longest drop-out, in seconds.
    pub fn new(every_s: f64, [shortest_s, longest_s]: [f64; 2], random: Stream) -> GazeDropoutSchedule {
        GazeDropoutSchedule { random, every_s, lengths: [shortest_s.ln(), longest_s.ln()], next: None }
    }

    /// Whether the gaze sample that is due `now` is lost in a drop-out. The function must be called in the order of the
    /// samples' times.
    pub fn swallows(&mut self, now: SessionTime) -> bool {
        loop {
            let [begin, end] =
                *self.next.get_or_insert_with(|| after(now, self.every_s, self.lengths, &mut self.random));
            if now < end {
                return now >= begin;
            }
            self.next = Some(after(end, self.every_s, self.lengths, &mut self.random));
        }
    }
}

fn after(time: SessionTime, every_s: f64, [shortest, longest]: [f64; 2], random: &mut Stream) -> [SessionTime; 2] {
    let wait_s = -every_s * (1.0 - random.random::<f64>()).ln();
    let length_s = (shortest + (longest - shortest) * random.random::<f64>()).exp();
    let begin = time + SessionTime::from_secs_f64(wait_s);
    [begin, begin + SessionTime::from_secs_f64(length_s)]
}
