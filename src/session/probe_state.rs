//! State of the freeze probes of a trial.

use super::probe_event::{ProbeDelayReason, ProbeEndReason, ProbeOrigin, ProbeQuestion};
use super::probe_schedule::ScheduledProbe;
use super::wall_display::AnswerDevice;
use tomcom_core::base::time::SessionTime;

/// All freeze probes of a trial: the present one, past ones, and the schedule.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialProbes {
    /// The freeze probe for which the task stands still now, from its event `begun` to its event `ended`.
    pub open: Option<StartedProbe>,
    /// The freeze probes that have ended.
    pub over: Vec<StartedProbe>,
    /// A freeze probe that is due and has not begun.
    pub waiting: Option<WaitingProbe>,
    /// Numbers of the cancelled freeze probes, each with the reason for which the probe had to wait.
    pub dropped: Vec<(u32, ProbeDelayReason)>,
    /// The scheduled freeze probes of the trial, whose times were drawn at its start.
    pub schedule: Vec<ScheduledProbe>,
    /// Number of scheduled freeze probes that have become due.
    pub came_due: usize,
    /// The highest number of a freeze probe so far.
    pub numbered: u32,
    /// Session time at which the last signal was shown.
    pub signalled_at: Option<SessionTime>,
    /// Session time at which the last freeze probe ended.
    pub ended_at: Option<SessionTime>,
}

/// A freeze probe that is due and has not begun.
#[derive(Clone, Debug, PartialEq)]
pub struct WaitingProbe {
    /// Number of the freeze probe within the trial, counted from 1.
    pub number: u32,
    /// Whether the schedule or the wizard caused the probe.
    pub origin: ProbeOrigin,
    /// Whether the belief estimate influences the choice of the probe's questions.
    pub uses_estimate: bool,
    /// Time at which the probe became due, on the trial's clock.
    pub since: SessionTime,
    /// Why the freeze probe has to wait, once its delay is recorded.
    pub reason: Option<ProbeDelayReason>,
}

/// A freeze probe that has begun.
#[derive(Clone, Debug, PartialEq)]
pub struct StartedProbe {
    /// Number of the freeze probe within the trial, counted from 1.
    pub number: u32,
    /// Whether the schedule or the wizard caused the probe.
    pub origin: ProbeOrigin,
    /// Whether the belief estimate influenced the choice of the probe's questions.
    pub uses_estimate: bool,
    /// The questions of the freeze probe.
    pub questions: Vec<ProbeQuestion>,
    /// Index of the probe's question that is shown now.
    pub shown: Option<usize>,
    /// The participant's answers so far, one for each question of the probe.
    pub answers: Vec<Option<ProbeAnswer>>,
    /// Session time at which the task was frozen.
    pub begun: SessionTime,
    /// Session time at which the shown question appeared.
    pub asked_at: SessionTime,
    /// The wizard's reason for skipping the remaining questions, if the wizard did.
    pub skipped: Option<String>,
    /// Why and when the questions of the freeze probe ended.
    pub closed: Option<(ProbeEndReason, SessionTime)>,
    /// Session time at which the wizard paused the freeze probe, if the probe is paused.
    pub paused_since: Option<SessionTime>,
    /// Session times of start and end of each finished pause of the freeze probe.
    pub pauses: Vec<(SessionTime, SessionTime)>,
}

/// The participant's answer to a question of a freeze probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeAnswer {
    /// The answer that the participant chose; `None`: "I don't know".
    pub answer: Option<String>,
    /// The participant's confidence in the answer, from 1 to 3.
    pub confidence: Option<u8>,
    /// Response time: from the appearance of the question to the answer, without pauses.
    pub took: SessionTime,
    /// Where the answer was entered: on the display or at the console.
    pub on: AnswerDevice,
}

impl StartedProbe {
    /// Whether the wizard paused the freeze probe.
    pub fn is_paused(&self) -> bool {
        self.paused_since.is_some()
    }

    /// The probe's shown question, which waits for an answer, with its index.
    pub fn question(&self) -> Option<(usize, &ProbeQuestion)> {
        let shown = self.shown.filter(|&shown| self.closed.is_none() && self.answers[shown].is_none())?;
        Some((shown, &self.questions[shown]))
    }

    /// Time from `at` to `now` without the pauses of the freeze probe.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = self.paused_since.unwrap_or(now).min(now);
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// Session time at which the duration `after` will have passed since `at`, if no further pause comes.
    pub fn when(&self, at: SessionTime, after: SessionTime) -> SessionTime {
        let paused = self.pauses.iter().map(|&(from, until)| until - from.max(at));
        paused.fold(at + after, |when, pause| when + pause)
    }
}
