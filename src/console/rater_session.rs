//! State of coding a recording: the codes of one rater, or of two raters who settle their differences.

use tomcom_core::measures::raters::{ErrorCauseCode, RaterCodes};
use tomcom_core::measures::raters::RaterConsensus;
use tomcom_session::error_list::ListedError;
use tomcom_session::history::wording;

/// Who codes the errors of a recording: one rater, or two raters together.
#[derive(Clone, Debug, PartialEq)]
pub enum CodingRaters {
    /// One rater, who has this name ("R1").
    Rater(String),
    /// Two raters who settle together the errors that they coded differently.
    Pair {
        /// Codes on which the two raters agree, and those that they settled earlier.
        consensus: RaterConsensus,
        /// Codes that each rater gave alone, in the order of the consensus.
        own: [RaterCodes; 2],
    },
}

/// A change of an error's code, which can be undone.
#[derive(Clone, Debug, PartialEq)]
struct CodeChange {
    press: u64,
    before: Option<ErrorCauseCode>,
    after: Option<ErrorCauseCode>,
}

/// State of coding the errors of a recording: the codes so far, and the steps to undo.
#[derive(Clone, Debug, PartialEq)]
pub struct RaterSession {
    /// Whether one rater codes, or two raters settle their differences.
    pub party: CodingRaters,
    /// Errors to be coded, in order of time; for two raters, only those that they have to settle.
    pub errors: Vec<ListedError>,
    /// Codes so far: the causes of errors, by the sequence number of the press.
    pub codes: RaterCodes,
    /// Names of other raters who have coded every error of the recording.
    pub finished: Vec<String>,
    /// Row of the error list that the arrow keys have selected, while the replay does not stand at that error.
    pub chosen: Option<usize>,
    /// Whether all codes are saved beside the log.
    pub is_saved: bool,
    /// Codes of the errors at the time when the recording was opened.
    opened: RaterCodes,
    done: Vec<CodeChange>,
    undone: Vec<CodeChange>,
}

impl RaterSession {
    /// State of coding when a recording is opened.
    pub fn new(party: CodingRaters, errors: Vec<ListedError>, codes: RaterCodes) -> RaterSession {
        let opened = codes.clone();
        let (done, undone) = (Vec::new(), Vec::new());
        RaterSession { party, errors, codes, finished: Vec::new(), chosen: None, is_saved: true, opened, done, undone }
    }

    /// Index of the last error among the first `events` events of the recording, where the replay stands.
    pub fn at(&self, events: usize) -> Option<usize> {
        self.errors.partition_point(|error| error.press < events as u64).checked_sub(1)
    }

    /// The last error among the first `events` events of the recording, where the replay stands.
    pub fn present(&self, events: usize) -> Option<&ListedError> {
        self.errors.get(self.at(events)?)
    }

    /// Index of the first error that has no code yet.
    pub fn first_open(&self) -> Option<usize> {
        self.errors.iter().position(|error| self.code(error).is_none())
    }

    /// The rater's code of an error, if there is one.
    pub fn code(&self, error: &ListedError) -> Option<&ErrorCauseCode> {
        self.codes.0.get(&error.press)
    }

    /// Number of errors that have a rater's code.
    pub fn coded(&self) -> usize {
        self.errors.iter().filter(|error| self.code(error).is_some()).count()
    }

    /// Number of errors whose code was given or changed since the recording was opened.
    pub fn coded_now(&self) -> usize {
        let is_new = |error: &&ListedError| {
            let code = self.code(error);
            code.is_some() && code != self.opened.0.get(&error.press)
        };
        self.errors.iter().filter(is_new).count()
    }

    /// Gives an error a rater's code, or removes the code.
    pub fn give(&mut self, press: u64, code: Option<ErrorCauseCode>) {
        let before = self.codes.0.get(&press).cloned();
        if before != code {
            self.done.push(CodeChange { press, before, after: code.clone() });
            self.undone.clear();
            self.set(press, code);
        }
    }

    /// Undoes the last change of a code; returns the sequence number of the press whose code changed.
    pub fn undo(&mut self) -> Option<u64> {
        let change = self.done.pop()?;
        self.set(change.press, change.before.clone());
        let press = change.press;
        self.undone.push(change);
        Some(press)
    }

    /// Whether the rater has changed a code that can be undone.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Whether the rater has undone a change of a code that can be redone.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Redoes the change that was undone last; returns the sequence number of the press whose code changed.
    pub fn redo(&mut self) -> Option<u64> {
        let change = self.undone.pop()?;
        self.set(change.press, change.after.clone());
        let press = change.press;
        self.done.push(change);
        Some(press)
    }

    fn set(&mut self, press: u64, code: Option<ErrorCauseCode>) {
        match code {
            Some(code) => self.codes.0.insert(press, code),
            None => self.codes.0.remove(&press),
        };
    }

    /// Names of the raters: "R1", "R1 and R2".
    pub fn name(&self) -> String {
        match &self.party {
            CodingRaters::Rater(rater) => rater.clone(),
            CodingRaters::Pair { consensus, .. } => consensus.raters.join(" and "),
        }
    }

    /// Coding progress in words: "12/31 errors coded, 3 since opening".
    pub fn progress(&self) -> String {
        let (what, all, coded) = (self.verb(), self.errors.len(), self.coded());
        match self.coded_now() {
            0 => format!("{coded}/{all} errors {what}"),
            now => format!("{coded}/{all} errors {what}, {now} since opening"),
        }
    }

    /// The rater's code of an error in words; "-" if there is none.
    pub fn words(code: Option<&ErrorCauseCode>) -> String {
        code.map_or("-".to_string(), wording::code)
    }

    /// The code that each of two raters gave an error alone: "R1: slip"; empty for a single rater.
    pub fn own(&self, error: &ListedError) -> Vec<String> {
        let CodingRaters::Pair { consensus, own } = &self.party else { return Vec::new() };
        let of = |(rater, codes): (&String, &RaterCodes)| {
            format!("{rater}: {}", RaterSession::words(codes.0.get(&error.press)))
        };
        consensus.raters.iter().zip(own).map(of).collect()
    }

    /// What the rater can do next, once every error has a code.
    pub fn next_step(&self) -> Option<String> {
        if self.first_open().is_some() {
            return None;
        }
        let number = self.errors.len();
        Some(match &self.party {
            CodingRaters::Pair { .. } if number == 0 => {
                "nothing to settle: both raters agree on every error".to_string()
            }
            CodingRaters::Pair { .. } => "every error is settled; next: tomcom study".to_string(),
            CodingRaters::Rater(_) if number == 0 => "no error in this recording: nothing to code".to_string(),
            CodingRaters::Rater(rater) => {
                let next = match self.finished.first() {
                    None => "a second rater codes independently, with --rater".to_string(),
                    Some(other) => format!("tomcom codes compares, --settle {other} {rater} settles"),
                };
                format!("every error is coded; next: {next}")
            }
        })
    }

    /// Verb for the progress: errors are "coded" by one rater, "settled" by two.
    fn verb(&self) -> &'static str {
        match self.party {
            CodingRaters::Rater(_) => "coded",
            CodingRaters::Pair { .. } => "settled",
        }
    }
}
