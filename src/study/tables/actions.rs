//! Table of the presses of both agents.

use crate::kitchen::{Agent, Kitchen, Press};
use crate::measures::JudgedPress;
use crate::measures::attribution::{Cause, Target};
use crate::measures::coding::{CauseKind, Code};
use crate::mind::witness::rounded;
use crate::study::column::{Column, Table, TableCell, TableRow};

/// A recorded press.
#[derive(Clone, Copy, Debug)]
pub struct RecordedPress {
    /// Log number of the press event.
    pub seq: u64,
    /// Time on the trial clock, in seconds.
    pub time_s: f64,
    pub press: Press,
    /// Number of the press among those of its agent, from 1.
    pub number: u32,
    /// Seconds since this agent's previous press, without pauses.
    pub since_s: Option<f64>,
    /// Log probability of a human press under the estimated belief, in nats.
    pub log_p: Option<f64>,
}

/// Analysis of a human press.
#[derive(Clone, Copy, Debug)]
pub struct PressAnalysis<'a> {
    pub judged: &'a JudgedPress,
    /// Number of the press's error sequence in the trial, from 1.
    pub sequence: Option<usize>,
    /// Cause of a person's error by the assistant's estimate.
    pub by_estimate: Option<Cause>,
    /// Codes of the first two raters.
    pub codes: [Option<&'a Code>; 2],
}

/// A press with its analysis.
#[derive(Clone, Copy, Debug)]
pub struct ActionRow<'a> {
    pub recording: &'a str,
    pub kitchen: &'a Kitchen,
    pub recorded: &'a RecordedPress,
    /// Analysis of a human press; `None` for presses of the robot.
    pub analysis: Option<PressAnalysis<'a>>,
}

impl ActionRow<'_> {
    fn judged(&self) -> Option<&JudgedPress> {
        Some(self.analysis?.judged)
    }

    /// Targets of the false belief behind the press; the second only if the cause needs two false beliefs.
    fn targets(&self) -> [Option<String>; 2] {
        let label = |target: Target| target.label(self.kitchen);
        match self.judged().and_then(|press| press.cause) {
            Some(Cause::Belief { target, with, .. }) => [Some(label(target)), with.map(label)],
            _ => [None, None],
        }
    }

    /// Log probability ratio of the press under belief and truth; `None` for causes from raters.
    fn gain_nats(&self) -> Option<f64> {
        match self.judged()?.cause? {
            Cause::Belief { gain_nats, .. } => Some(rounded(gain_nats)).filter(|gain| gain.is_finite()),
            Cause::Slip => None,
        }
    }

    fn code(&self, rater: usize) -> TableCell<'static> {
        let code = self.analysis.and_then(|analysis| analysis.codes[rater]);
        let words = |code: &Code| {
            let kind = code.kind().name();
            code.aspect().map_or(kind.to_string(), |aspect| format!("{kind} {aspect}"))
        };
        code.map(words).into()
    }
}

fn cause_name(cause: Cause) -> &'static str {
    match cause {
        Cause::Slip => CauseKind::Slip.name(),
        Cause::Belief { .. } => CauseKind::Belief.name(),
    }
}

fn agent_name(agent: Agent) -> &'static str {
    match agent {
        Agent::Human => "human",
        Agent::Robot => "robot",
    }
}

impl TableRow for ActionRow<'_> {
    const TABLE: Table = Table::Actions;

    fn columns() -> Vec<Column<Self>> {
        let cause = "of an error: belief or slip, by what beliefs_from of the trial says; empty where nobody knows";
        let second = "the second one, where it takes two false beliefs to explain it";
        let sequence = "of a belief related error: which error sequence of the trial, from 1";
        let rater = "what the first rater by name says: belief (and about what), slip, race or other";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("seq", "", "number of the event in the log", |row| row.recorded.seq.into()),
            Self::column("time_s", "s", "on the trial's clock", |row| rounded(row.recorded.time_s).into()),
            Self::column("agent", "", "human or robot", |row| agent_name(row.recorded.press.agent).into()),
            Self::column("press", "presses", "which press of this agent it is, from 1", |row| {
                row.recorded.number.into()
            }),
            Self::column("button", "", "name of the button", |row| {
                let press = &row.recorded.press;
                (&row.kitchen.button(press.agent, press.button).name).into()
            }),
            Self::column("effective", "", "it changed the kitchen", |row| row.recorded.press.effective.into()),
            Self::column("since_s", "s", "since this agent's press before", |row| {
                row.recorded.since_s.map(rounded).into()
            }),
            Self::column("regret", "presses", "of the human: presses of both that are lost by it", |row| {
                row.judged().map(|press| press.verdict.regret).into()
            }),
            Self::column("excess", "presses", "regret above that of the best press of the human", |row| {
                row.judged().map(|press| press.verdict.excess).into()
            }),
            Self::column("race", "", "within 300 ms of a change by the robot at the same place", |row| {
                row.judged().map(|press| press.verdict.race).into()
            }),
            Self::column("error", "", "it is an error", |row| row.judged().map(|press| press.verdict.error).into()),
            Self::column("cause", "", cause, |row| row.judged().and_then(|press| press.cause).map(cause_name).into()),
            Self::column("aspect", "", "of a belief related error: what the false belief is about", |row| {
                let [first, _] = row.targets();
                first.into()
            }),
            Self::column("second_aspect", "", second, |row| {
                let [_, second] = row.targets();
                second.into()
            }),
            Self::column("gain_nats", "nats", "log p(press | belief) - log p(press | truth)", |row| {
                row.gain_nats().into()
            }),
            Self::column("sequence", "", sequence, |row| {
                row.analysis.and_then(|analysis| analysis.sequence).map(|number| number as u64).into()
            }),
            Self::column("cause_estimated", "", "of people: belief or slip by the assistant's estimate", |row| {
                row.analysis.and_then(|analysis| analysis.by_estimate).map(cause_name).into()
            }),
            Self::column("rater_1", "", rater, |row| row.code(0)),
            Self::column("rater_2", "", "what the second rater says", |row| row.code(1)),
            Self::column("log_p", "nats", "of the human's press under the estimated belief", |row| {
                row.recorded.log_p.map(rounded).into()
            }),
        ]
    }
}
