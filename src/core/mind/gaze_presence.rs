//! Accounts for the time in which the gaze is known or unknown.
//!
//! A sample stands for the time since the previous sample, at most `max_sample_s`, and its confidence decides which
//! share of that time counts as known. Time without known gaze is a blink up to `blink_s`: certainly without reading.
//! After that the gaze is unknown. A blink uses up an allowance that known time restores, so that a stream with a few
//! good samples among many bad ones is not mistaken for a stream with many blinks. At the start of a trial the
//! allowance is zero: without a tracker all time is unknown.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::mind::model::HumanModel;

/// The time that a gaze sample covers, and the gap before that time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GazeSampleSpan {
    /// Time of unknown gaze before the gaze sample, in seconds.
    pub unknown_before_s: f64,
    /// Time that the gaze sample covers, in seconds.
    pub covers_s: f64,
    /// Share of the covered time in which the gaze is known.
    pub known: f64,
}

/// Accounts for the time in which the gaze is known or unknown.
#[derive(Clone, Debug)]
pub struct UnknownGazeTimer {
    blink_s: f64,
    max_sample_s: f64,
    /// Session time at which the last gaze sample was taken, whether it was usable or not.
    last: Option<SessionTime>,
    /// Time of the last sample with known gaze, or start of the trial.
    dark_since: SessionTime,
    /// Remaining allowance of missing gaze that counts as a blink, in seconds.
    allowance_s: f64,
    /// Session time up to which unknown time has been accounted for.
    accounted: SessionTime,
    /// Share of the time of the last sample with known gaze that counts as unknown, 0 to 1.
    unknown: f64,
    /// Whether the tracker finds the display in its view; true until the tracker reports that it does not.
    pub display_in_view: bool,
}

impl UnknownGazeTimer {
    /// The state of the account before the start of a trial.
    pub fn new(model: &HumanModel) -> UnknownGazeTimer {
        UnknownGazeTimer {
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

    /// Records the start of the trial or the end of a pause: time before `now` is ignored, and the next gaze sample
    /// does not cover it.
    pub fn rest(&mut self, now: SessionTime) {
        (self.last, self.dark_since) = (None, now);
    }

    /// Shifts all stored times by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.last = self.last.map(|last| last + by);
        self.dark_since = self.dark_since + by;
        self.accounted = self.accounted + by;
    }

    /// Session time at which the unknown time after the last sample with known gaze starts.
    fn unknown_from(&self) -> SessionTime {
        self.dark_since + SessionTime::from_secs_f64(self.allowance_s)
    }

    /// Time of unknown gaze up to `now` that has not been accounted for yet, in seconds. Afterwards that time counts as
    /// accounted for.
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

    /// Accounts for a gaze sample taken at session time `taken`; the share `known` of its time counts as known gaze.
    pub fn sample(&mut self, sample: &GazeSample, known: f64, taken: SessionTime) -> GazeSampleSpan {
        let covers_s = self.last.map_or(self.max_sample_s, |last| taken.secs_since(last)).min(self.max_sample_s);
        self.last = Some(self.last.map_or(taken, |last| last.max(taken)));
        if known <= 0.0 || !(sample.x.is_finite() && sample.y.is_finite()) {
            return GazeSampleSpan { unknown_before_s: self.pass(taken), covers_s, known: 0.0 };
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
        GazeSampleSpan { unknown_before_s, covers_s, known }
    }
}
