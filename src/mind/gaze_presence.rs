//! Which part of the time the gaze is known, and which it is not.
//!
//! A sample stands for the time since the one before it, at most `max_sample_s`, and of that for the share that its confidence
//! leaves known. Time without known gaze is a blink up to `blink_s`: known to be without reading. After that the gaze is unknown. A
//! blink uses up an allowance that known time restores, so that a stream with a few good samples among many bad ones is not
//! taken for one with many blinks. At the start of a trial there is none: without a tracker all time is unknown.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::mind::model::HumanModel;

/// Time of a sample, and of the gap before it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoveredTime {
    /// Unknown time before the sample, in seconds.
    pub unknown_before_s: f64,
    /// Time that the sample covers, in seconds.
    pub covers_s: f64,
    /// Share of it in which the gaze is known.
    pub known: f64,
}

/// Accounts for known and unknown time.
#[derive(Clone, Debug)]
pub struct GazePresence {
    blink_s: f64,
    max_sample_s: f64,
    /// Time at which the last sample was taken, whether it was usable or not.
    last: Option<SessionTime>,
    /// Time of the last sample with known gaze, or start of the trial.
    dark_since: SessionTime,
    /// What is left for blinks, in seconds.
    allowance_s: f64,
    /// Time up to which unknown time has been accounted for.
    accounted: SessionTime,
    /// Unknown share of the last sample with known gaze.
    unknown: f64,
    /// Whether the tracker finds the display in its view; assumed until it reports that it does not.
    pub display_in_view: bool,
}

impl GazePresence {
    /// Presence before the trial's start.
    pub fn new(model: &HumanModel) -> GazePresence {
        GazePresence {
            blink_s: model.looking.blink_s,
            max_sample_s: model.perception.max_sample_s,
            last: None,
            dark_since: SessionTime::ZERO,
            allowance_s: 0.0,
            accounted: SessionTime::ZERO,
            unknown: 1.0,
            display_in_view: true,
        }
    }

    /// Notes the start of the trial or the end of a pause: time before `now` is not accounted for, and the next sample does
    /// not cover it.
    pub fn rest(&mut self, now: SessionTime) {
        (self.last, self.dark_since) = (None, now);
    }

    /// Moves all times on, because the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.last = self.last.map(|last| last + by);
        self.dark_since = self.dark_since + by;
        self.accounted = self.accounted + by;
    }

    /// Start of the unknown time after the last sample with known gaze.
    fn unknown_from(&self) -> SessionTime {
        self.dark_since + SessionTime::from_secs_f64(self.allowance_s)
    }

    /// Unknown time up to `now` that has not been accounted for, in seconds. Without a known sample until then, it is final.
    pub fn pass(&mut self, now: SessionTime) -> f64 {
        let from = self.unknown_from().max(self.accounted);
        if now <= from {
            return 0.0;
        }
        self.accounted = now;
        now.secs_since(from)
    }

    /// The share of the gaze at `now` that is unknown.
    pub fn unknown_share(&self, now: SessionTime) -> f64 {
        if now > self.unknown_from() { 1.0 } else { self.unknown }
    }

    /// Accounts for a sample taken at session time `taken`, whose gaze is known to the share `known`.
    pub fn sample(&mut self, sample: &GazeSample, known: f64, taken: SessionTime) -> CoveredTime {
        let covers_s = self.last.map_or(self.max_sample_s, |last| taken.secs_since(last)).min(self.max_sample_s);
        self.last = Some(self.last.map_or(taken, |last| last.max(taken)));
        if known <= 0.0 || !(sample.x.is_finite() && sample.y.is_finite()) {
            return CoveredTime { unknown_before_s: self.pass(taken), covers_s, known: 0.0 };
        }
        let begin = taken - SessionTime::from_secs_f64(covers_s);
        let unknown_before_s = self.pass(begin);
        // Unknown time that was accounted for before this sample arrived stays unknown.
        let covers_s = match self.accounted > begin {
            true => covers_s.min(taken.secs_since(self.accounted)),
            false => covers_s,
        };
        let left_s = (self.allowance_s - begin.secs_since(self.dark_since)).max(0.0);
        self.allowance_s = (left_s + known * covers_s).min(self.blink_s);
        self.dark_since = self.dark_since.max(taken);
        self.unknown = 1.0 - known;
        CoveredTime { unknown_before_s, covers_s, known }
    }
}
