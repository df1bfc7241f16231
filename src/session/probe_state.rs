//! State of the freeze probes of a trial.

use super::probe_event::{ProbeBlock, ProbeEnd, ProbeOrigin, ProbeQuestion};
use super::probe_schedule::ScheduledProbe;
use super::wall_display::Answering;
use crate::base::time::SessionTime;

/// The freeze probes of a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProbeBook {
    /// The probe for which the task stands still, from `begun` to `ended`.
    pub open: Option<OpenProbe>,
    /// The probes that are over.
    pub over: Vec<OpenProbe>,
    /// A probe that is due and has not begun.
    pub waiting: Option<WaitingProbe>,
    /// Numbers of the dropped probes, and what they waited for.
    pub dropped: Vec<(u32, ProbeBlock)>,
    /// The scheduled probes of the trial, whose times were drawn at its start.
    pub schedule: Vec<ScheduledProbe>,
    /// How many of the scheduled ones have become due.
    pub came_due: usize,
    /// The highest number of a probe so far.
    pub numbered: u32,
    /// When the last signal was shown.
    pub signalled_at: Option<SessionTime>,
    /// When the last probe ended.
    pub ended_at: Option<SessionTime>,
}

/// A probe that is due and has not begun.
#[derive(Clone, Debug, PartialEq)]
pub struct WaitingProbe {
    /// Its number.
    pub number: u32,
    /// Who wanted it.
    pub origin: ProbeOrigin,
    /// Whether the belief estimate has a part in the choice of its questions.
    pub uses_estimate: bool,
    /// When it became due, on the trial's clock.
    pub since: SessionTime,
    /// What it waits for, once that is recorded.
    pub reason: Option<ProbeBlock>,
}

/// A probe that has begun.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenProbe {
    /// Its number.
    pub number: u32,
    /// Who wanted it.
    pub origin: ProbeOrigin,
    /// Whether the belief estimate had a part in the choice of its questions.
    pub uses_estimate: bool,
    /// Its questions.
    pub questions: Vec<ProbeQuestion>,
    /// Index of the shown question.
    pub shown: Option<usize>,
    /// The answers so far, by question.
    pub answers: Vec<Option<ProbeAnswer>>,
    /// When the task came to a stand, in session time.
    pub begun: SessionTime,
    /// When the shown question appeared, in session time.
    pub asked_at: SessionTime,
    /// Why the wizard skipped the rest, if it did.
    pub skipped: Option<String>,
    /// Why and when the questions ended.
    pub closed: Option<(ProbeEnd, SessionTime)>,
    /// When the wizard paused the probe, if it is paused.
    pub paused_since: Option<SessionTime>,
    /// Start and end of each finished pause of the probe.
    pub pauses: Vec<(SessionTime, SessionTime)>,
}

/// An answer to a question.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeAnswer {
    /// The choice; `None`: "I don't know".
    pub answer: Option<String>,
    /// How sure the participant is, 1 to 3.
    pub confidence: Option<u8>,
    /// Time from the question to the answer, without pauses.
    pub took: SessionTime,
    /// Where it was entered.
    pub on: Answering,
}

impl OpenProbe {
    /// Whether the wizard paused the probe.
    pub fn is_paused(&self) -> bool {
        self.paused_since.is_some()
    }

    /// The question that waits for an answer, with its index.
    pub fn question(&self) -> Option<(usize, &ProbeQuestion)> {
        let shown = self.shown.filter(|&shown| self.closed.is_none() && self.answers[shown].is_none())?;
        Some((shown, &self.questions[shown]))
    }

    /// Time from `at` to `now` without the pauses of the probe.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = self.paused_since.unwrap_or(now).min(now);
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// Session time at which `after` has passed since `at`, if no further pause comes.
    pub fn when(&self, at: SessionTime, after: SessionTime) -> SessionTime {
        let paused = self.pauses.iter().map(|&(from, until)| until - from.max(at));
        paused.fold(at + after, |when, pause| when + pause)
    }
}
