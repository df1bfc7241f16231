//! The codes of one rater, or of two who settle their differences, while a recording is open.

use crate::analysis::error_list::ListedError;
use crate::history::wording;
use crate::measures::cause_codes::{Code, Codes};
use crate::measures::consensus::Consensus;

/// Who gives the codes.
#[derive(Clone, Debug, PartialEq)]
pub enum CodingParty {
    /// One rater, with this code.
    Rater(String),
    /// Two raters who settle together what they coded differently.
    Pair {
        /// What they agree on, and what they settled earlier.
        consensus: Consensus,
        /// The raters' own codes, in the order of the consensus.
        own: [Codes; 2],
    },
}

/// A step that can be undone: the code of an error before and after it.
#[derive(Clone, Debug, PartialEq)]
struct CodeChange {
    press: u64,
    before: Option<Code>,
    after: Option<Code>,
}

/// The codes of a recording so far.
#[derive(Clone, Debug, PartialEq)]
pub struct RaterSession {
    /// Who gives the codes.
    pub party: CodingParty,
    /// The errors to be coded, in order; of a pair only those that it has to settle.
    pub errors: Vec<ListedError>,
    /// The causes given so far, by press.
    pub codes: Codes,
    /// Other raters who have coded every error of the recording.
    pub finished: Vec<String>,
    /// Row of the list that was chosen with the arrows and not opened yet.
    pub chosen: Option<usize>,
    /// The codes when the recording was opened.
    opened: Codes,
    done: Vec<CodeChange>,
    undone: Vec<CodeChange>,
}

impl RaterSession {
    /// A session at its opening.
    pub fn new(party: CodingParty, errors: Vec<ListedError>, codes: Codes) -> RaterSession {
        let opened = codes.clone();
        let (done, undone) = (Vec::new(), Vec::new());
        RaterSession { party, errors, codes, finished: Vec::new(), chosen: None, opened, done, undone }
    }

    /// Index of the last error among the first `events` events, where the replay stands.
    pub fn at(&self, events: usize) -> Option<usize> {
        self.errors.partition_point(|error| error.press < events as u64).checked_sub(1)
    }

    /// The last error among the first `events` events.
    pub fn present(&self, events: usize) -> Option<&ListedError> {
        self.errors.get(self.at(events)?)
    }

    /// Index of the first error without a code.
    pub fn first_open(&self) -> Option<usize> {
        self.errors.iter().position(|error| self.code(error).is_none())
    }

    /// The code of an error.
    pub fn code(&self, error: &ListedError) -> Option<&Code> {
        self.codes.0.get(&error.press)
    }

    /// Number of errors with a code.
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

    /// Gives an error a code, or takes it away.
    pub fn give(&mut self, press: u64, code: Option<Code>) {
        let before = self.codes.0.get(&press).cloned();
        if before != code {
            self.done.push(CodeChange { press, before, after: code.clone() });
            self.undone.clear();
            self.set(press, code);
        }
    }

    /// Takes the last step back; returns the press that it concerned.
    pub fn undo(&mut self) -> Option<u64> {
        let change = self.done.pop()?;
        self.set(change.press, change.before.clone());
        let press = change.press;
        self.undone.push(change);
        Some(press)
    }

    /// Whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Whether there is an undone step to do again.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Does the last undone step again; returns the press that it concerned.
    pub fn redo(&mut self) -> Option<u64> {
        let change = self.undone.pop()?;
        self.set(change.press, change.after.clone());
        let press = change.press;
        self.done.push(change);
        Some(press)
    }

    fn set(&mut self, press: u64, code: Option<Code>) {
        match code {
            Some(code) => self.codes.0.insert(press, code),
            None => self.codes.0.remove(&press),
        };
    }

    /// Who codes: "R1", "R1 and R2".
    pub fn name(&self) -> String {
        match &self.party {
            CodingParty::Rater(rater) => rater.clone(),
            CodingParty::Pair { consensus, .. } => consensus.raters.join(" and "),
        }
    }

    /// Number of coded errors in words: "12 of 31 coded, 3 since opening".
    pub fn progress(&self) -> String {
        let (what, all, coded) = (self.verb(), self.errors.len(), self.coded());
        let now = match self.coded_now() {
            0 => String::new(),
            now => format!(", {now} since opening"),
        };
        format!("{coded} of {all} {what}{now}")
    }

    /// The code of an error in words, "-" without one.
    pub fn words(code: Option<&Code>) -> String {
        code.map_or("-".to_string(), wording::code)
    }

    /// The raters' own codes of an error: "R1: slip"; empty for a single rater.
    pub fn own(&self, error: &ListedError) -> Vec<String> {
        let CodingParty::Pair { consensus, own } = &self.party else { return Vec::new() };
        let of =
            |(rater, codes): (&String, &Codes)| format!("{rater}: {}", RaterSession::words(codes.0.get(&error.press)));
        consensus.raters.iter().zip(own).map(of).collect()
    }

    /// What comes next once every error has a code.
    pub fn next_step(&self) -> Option<String> {
        if self.first_open().is_some() {
            return None;
        }
        let number = self.errors.len();
        Some(match &self.party {
            CodingParty::Pair { .. } if number == 0 => {
                "nothing to settle: both raters agree on every error".to_string()
            }
            CodingParty::Pair { .. } => format!("all {number} settled; next: tomcom study"),
            CodingParty::Rater(_) if number == 0 => "no error in this recording: nothing to code".to_string(),
            CodingParty::Rater(rater) => {
                let next = match self.finished.first() {
                    None => "another rater codes alone, with --rater".to_string(),
                    Some(other) => format!("tomcom codes compares, --settle {other} {rater} settles"),
                };
                format!("all {number} coded; next: {next}")
            }
        })
    }

    /// What an error is after it got its code.
    fn verb(&self) -> &'static str {
        match self.party {
            CodingParty::Rater(_) => "coded",
            CodingParty::Pair { .. } => "settled",
        }
    }
}
