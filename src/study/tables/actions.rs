//! Table of the presses of both agents, for the CSV file of actions.

use crate::column::{CsvRow, CsvTable, TableCell, TableColumn, columns};
use tomcom_core::kitchen::{Kitchen, Press};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_core::mind::rounded;

#[derive(Clone, Copy, Debug)]
pub struct RecordedPress {
    pub seq: u64,
    pub time_s: f64,
    pub press: Press,
    /// Number of the press among the presses of its agent, from 1.
    pub number: u32,
    /// Time since this agent's previous press, without pauses, in seconds.
    pub since_s: Option<f64>,
    /// Log probability of a human press under the estimated belief, in nats.
    pub log_p: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
pub struct PressAnalysis<'a> {
    pub judged: &'a JudgedPress,
    /// Number of the error sequence to which the press belongs, in the trial, from 1.
    pub sequence: Option<usize>,
    pub by_estimate: Option<ErrorCause>,
    pub codes: [Option<&'a ErrorCauseCode>; 2],
    pub shared: Option<&'a ErrorCauseCode>,
    /// Beginning of the false belief behind the error, on the trial's clock in seconds, where it is known.
    pub false_since_s: Option<f64>,
    /// `None` if the belief is not corrected before the trial's end.
    pub false_until_s: Option<f64>,
}

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

    /// State aspect of the false belief behind the press (0), and of the second one if it takes two to explain the press (1).
    fn target(&self, which: usize) -> Option<String> {
        self.judged()?.cause?.targets().nth(which).map(|target| target.label(self.kitchen))
    }

    /// Between the log probabilities under false belief and truth; `None` for causes from raters.
    fn gain_nats(&self) -> Option<f64> {
        match self.judged()?.cause? {
            ErrorCause::Belief { gain_nats, .. } => Some(rounded(gain_nats)).filter(|gain| gain.is_finite()),
            ErrorCause::Slip | ErrorCause::Planning => None,
        }
    }

    fn code(&self, code: impl Fn(&PressAnalysis) -> Option<ErrorCauseCode>) -> TableCell<'static> {
        let code = self.analysis.as_ref().and_then(code);
        let words = |code: &ErrorCauseCode| {
            let kind = code.kind().name();
            code.aspect().map_or(kind.to_string(), |aspect| format!("{kind} {aspect}"))
        };
        code.as_ref().map(words).into()
    }
}

fn cause_name(cause: ErrorCause) -> &'static str {
    match cause {
        ErrorCause::Slip => ErrorCauseKind::Slip.name(),
        ErrorCause::Planning => "planning",
        ErrorCause::Belief { .. } => ErrorCauseKind::Belief.name(),
    }
}

impl CsvRow for ActionRow<'_> {
    const TABLE: CsvTable = CsvTable::Actions;

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => row.recording;
            "seq", "", "number of the event in the log" => row.recorded.seq;
            "time_s", "s", "time on the trial's clock" => rounded(row.recorded.time_s);
            "agent", "", "human or robot" => row.recorded.press.agent.name();
            "press", "presses", "number of the press among this agent's presses, from 1" => row.recorded.number;
            "button", "", "name of the button"
                => &row.kitchen.button(row.recorded.press.agent, row.recorded.press.button).name;
            "effective", "", "whether the press changed the kitchen" => row.recorded.press.effective;
            "since_s", "s", "time since this agent's previous press, without pauses; empty: its first"
                => row.recorded.since_s.map(rounded);
            "regret", "presses", "regret of a human press: presses of both agents that it loses; empty: the robot's"
                => row.judged().map(|press| press.verdict.regret);
            "excess", "presses", "regret minus that of the human's best press; empty as regret"
                => row.judged().map(|press| press.verdict.excess);
            "race", "", "whether a robot change at the same place was less than 300 ms before; empty as regret"
                => row.judged().map(|press| press.verdict.race);
            "error", "", "whether the press is an error; empty as regret" => row.judged().map(|press| press.verdict.error);
            "cause", "", "cause of an error: belief, planning or slip; source in the trial's beliefs_from; empty: no \
                error, or unknown" => row.judged().and_then(|press| press.cause).map(cause_name);
            "aspect", "", "aspect of the false belief behind a belief related error; empty: no such error" => row.target(0);
            "second_aspect", "", "second aspect, if only two false beliefs together explain the error, or if the two raters name \
                different ones; empty: neither" => row.target(1);
            "gain_nats", "nats", "log p(press | belief) - log p(press | truth); empty: no belief related error, or not computed" => row.gain_nats();
            "sequence", "", "number of a belief related error's sequence in the trial, from 1; empty: no such error"
                => row.analysis.and_then(|analysis| analysis.sequence).map(|number| number as u64);
            "cause_estimated", "", "cause of a person's error by the assistant's estimate: belief or slip; empty: no error, or not of a person"
                => row.analysis.and_then(|analysis| analysis.by_estimate).map(cause_name);
            "rater_1", "", "code of one of the two raters, who were named, settled a consensus or else coded most errors: belief \
                (with location), slip, race, other or buttons; empty: not coded" => row.code(|press| press.codes[0].cloned());
            "rater_2", "", "code of the other rater; empty: not coded" => row.code(|press| press.codes[1].cloned());
            "log_p", "nats", "log probability of the human's press under the estimated belief; empty: the robot's, or no estimate"
                => row.recorded.log_p.map(rounded);
            "consensus", "", "code that the two raters share, where it defines the cause; empty: none"
                => row.code(|press| press.shared.cloned());
            "false_since_s", "s", "beginning of the false belief behind a belief related error, on the trial's clock; \
                empty: not known" => row.analysis.and_then(|press| press.false_since_s).map(rounded);
            "false_until_s", "s", "end of that false belief; empty: not known, or none in the trial"
                => row.analysis.and_then(|press| press.false_until_s).map(rounded);

        }
    }
}
