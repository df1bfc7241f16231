//! Table of the presses of both agents, for the CSV file of actions.

use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use tomcom_core::kitchen::{Agent, Kitchen, Press};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_core::mind::rounded;

/// A recorded press of either agent with its time and number.
#[derive(Clone, Copy, Debug)]
pub struct RecordedPress {
    /// Sequence number of the press in the log.
    pub seq: u64,
    /// Time of the press on the trial's clock, in seconds.
    pub time_s: f64,
    /// The press with the states before and after it.
    pub press: Press,
    /// Number of the press among the presses of its agent, from 1.
    pub number: u32,
    /// Time since this agent's previous press, without pauses, in seconds.
    pub since_s: Option<f64>,
    /// Log probability of a human press under the estimated belief, in nats.
    pub log_p: Option<f64>,
}

/// Judgement of a human press: error, cause, raters' codes.
#[derive(Clone, Copy, Debug)]
pub struct PressAnalysis<'a> {
    /// The judged press: its regret, whether it was an error, and the error's cause.
    pub judged: &'a JudgedPress,
    /// Number of the error sequence to which the press belongs, in the trial, from 1.
    pub sequence: Option<usize>,
    /// Cause of a person's error according to the assistant's belief estimate.
    pub by_estimate: Option<ErrorCause>,
    /// Codes that two raters gave to the error.
    pub codes: [Option<&'a ErrorCauseCode>; 2],
    /// Consensus code of the two raters, where that code determines the cause of the error.
    pub shared: Option<&'a ErrorCauseCode>,
    /// Beginning of the false belief behind the error, on the trial's clock in seconds, where it is known.
    pub false_since_s: Option<f64>,
    /// End of the false belief behind the error, on the trial's clock in seconds; `None` if the belief is not corrected
    /// before the trial's end.
    pub false_until_s: Option<f64>,
}

/// Row of the table of actions: a press with its analysis.
#[derive(Clone, Copy, Debug)]
pub struct ActionRow<'a> {
    /// Name of the recording in tables.
    pub recording: &'a str,
    /// The kitchen of the recording.
    pub kitchen: &'a Kitchen,
    /// The recorded press.
    pub recorded: &'a RecordedPress,
    /// Analysis of a human press; `None` for presses of the robot.
    pub analysis: Option<PressAnalysis<'a>>,
}

impl ActionRow<'_> {
    fn judged(&self) -> Option<&JudgedPress> {
        Some(self.analysis?.judged)
    }

    /// State aspects of the false belief behind the press; the second only if it takes two false beliefs to explain the
    /// press.
    fn targets(&self) -> [Option<String>; 2] {
        let label = |target: FalseBeliefTarget| target.label(self.kitchen);
        match self.judged().and_then(|press| press.cause) {
            Some(ErrorCause::Belief { target, with, .. }) => [Some(label(target)), with.map(label)],
            _ => [None, None],
        }
    }

    /// Difference between the press's log probability under the false belief and under the truth, in nats; `None` for
    /// causes from raters.
    fn gain_nats(&self) -> Option<f64> {
        match self.judged()?.cause? {
            ErrorCause::Belief { gain_nats, .. } => Some(rounded(gain_nats)).filter(|gain| gain.is_finite()),
            ErrorCause::Slip | ErrorCause::Planning => None,
        }
    }

    fn code(&self, code: impl Fn(&PressAnalysis) -> Option<ErrorCauseCode>) -> CsvCell<'static> {
        let code = self.analysis.as_ref().and_then(code);
        let words = |code: &ErrorCauseCode| {
            let kind = code.kind().name();
            code.aspect().map_or(kind.to_string(), |aspect| format!("{kind} {aspect}"))
        };
        code.as_ref().map(words).into()
    }
}

/// Meanings of table columns whose text is too long for one line of code.
const SECOND_ASPECT: &str =
    "second aspect, if only two false beliefs together explain the error, or if the two raters name different ones";
const RATER: &str = "code of one of the two raters, who were named, settled a consensus or else coded most errors: belief (with location), slip, race, \
                     other or buttons";

fn cause_name(cause: ErrorCause) -> &'static str {
    match cause {
        ErrorCause::Slip => ErrorCauseKind::Slip.name(),
        ErrorCause::Planning => "planning",
        ErrorCause::Belief { .. } => ErrorCauseKind::Belief.name(),
    }
}

fn agent_name(agent: Agent) -> &'static str {
    match agent {
        Agent::Human => "human",
        Agent::Robot => "robot",
    }
}

impl CsvRow for ActionRow<'_> {
    const TABLE: CsvTable = CsvTable::Actions;

    fn columns() -> Vec<CsvColumn<Self>> {
        let cause = "cause of an error: belief, planning or slip; source in the trial's beliefs_from; empty: unknown";
        let sequence = "number of a belief related error's sequence in the trial, from 1";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("seq", "", "number of the event in the log", |row| row.recorded.seq.into()),
            Self::column("time_s", "s", "time on the trial's clock", |row| rounded(row.recorded.time_s).into()),
            Self::column("agent", "", "human or robot", |row| agent_name(row.recorded.press.agent).into()),
            Self::column("press", "presses", "number of the press among this agent's presses, from 1", |row| {
                row.recorded.number.into()
            }),
            Self::column("button", "", "name of the button", |row| {
                let press = &row.recorded.press;
                (&row.kitchen.button(press.agent, press.button).name).into()
            }),
            Self::column("effective", "", "whether the press changed the kitchen", |row| {
                row.recorded.press.effective.into()
            }),
            Self::column("since_s", "s", "time since this agent's previous press, without pauses", |row| {
                row.recorded.since_s.map(rounded).into()
            }),
            Self::column("regret", "presses", "regret of a human press: presses of both agents that it loses", |row| {
                row.judged().map(|press| press.verdict.regret).into()
            }),
            Self::column("excess", "presses", "regret minus that of the human's best press", |row| {
                row.judged().map(|press| press.verdict.excess).into()
            }),
            Self::column("race", "", "whether a robot change at the same place was less than 300 ms before", |row| {
                row.judged().map(|press| press.verdict.race).into()
            }),
            Self::column("error", "", "whether the press is an error", |row| {
                row.judged().map(|press| press.verdict.error).into()
            }),
            Self::column("cause", "", cause, |row| row.judged().and_then(|press| press.cause).map(cause_name).into()),
            Self::column("aspect", "", "aspect of the false belief behind a belief related error", |row| {
                let [first, _] = row.targets();
                first.into()
            }),
            Self::column("second_aspect", "", SECOND_ASPECT, |row| {
                let [_, second] = row.targets();
                second.into()
            }),
            Self::column("gain_nats", "nats", "log p(press | belief) - log p(press | truth)", |row| {
                row.gain_nats().into()
            }),
            Self::column("sequence", "", sequence, |row| {
                row.analysis.and_then(|analysis| analysis.sequence).map(|number| number as u64).into()
            }),
        ]
        .into_iter()
        .chain(of_estimate_and_raters())
        .collect()
    }
}

/// Columns with causes according to estimate and raters, and with the duration of the false belief.
fn of_estimate_and_raters<'a>() -> Vec<CsvColumn<ActionRow<'a>>> {
    vec![
        ActionRow::column(
            "cause_estimated",
            "",
            "cause of a person's error by the assistant's estimate: belief or slip",
            |row| row.analysis.and_then(|analysis| analysis.by_estimate).map(cause_name).into(),
        ),
        ActionRow::column("rater_1", "", RATER, |row| row.code(|press| press.codes[0].cloned())),
        ActionRow::column("rater_2", "", "code of the other rater", |row| row.code(|press| press.codes[1].cloned())),
        ActionRow::column("log_p", "nats", "log probability of the human's press under the estimated belief", |row| {
            row.recorded.log_p.map(rounded).into()
        }),
        ActionRow::column("consensus", "", "code that the two raters share, where it defines the cause", |row| {
            row.code(|press| press.shared.cloned())
        }),
        ActionRow::column(
            "false_since_s",
            "s",
            "beginning of the false belief behind a belief related error, on the trial's clock; empty: not known",
            |row| row.analysis.and_then(|press| press.false_since_s).map(rounded).into(),
        ),
        ActionRow::column(
            "false_until_s",
            "s",
            "end of that false belief; empty: not known, or none in the trial",
            |row| row.analysis.and_then(|press| press.false_until_s).map(rounded).into(),
        ),
    ]
}
