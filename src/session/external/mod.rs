//! External minds: programs of other people that take the part of a communication concept or of the participant. Here is
//! what a question says and what an answer may say; the connections (a child process, a socket) are made elsewhere and come in
//! as [`ExternalMinds`].
//!
//! One line of JSON is a question, one line an answer; `tomcom protocol` prints the schema. Whatever comes back is an
//! event from outside ([`ExternalEvent`], and `advised` or `press`), so a recording needs no program to be replayed.

pub mod concept;
pub mod happenings;
pub mod kitchen_description;
pub mod link;
pub mod participant;

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::{Event, Session};
use tomcom_core::communication::settings::ExternalMind;
use tomcom_core::kitchen::{AspectId, Kitchen, State};

/// Version of the protocol: a program answers the first question with the version that it speaks.
pub const PROTOCOL: u32 = 1;
/// The protocol's JSON Schema.
pub const SCHEMA: &str = include_str!("protocol.schema.json");
/// Longest wait for the first answer: an interpreter and its packages have to load.
pub const STARTS_WITHIN_S: f64 = 60.0;
/// Longest line that is read, in bytes: a longer one ends the connection.
pub const LONGEST_LINE: usize = 1 << 20;
/// Number of faults after which a program is given up.
pub const MOST_FAULTS: u64 = 100;
/// Longest text of an answer that is recorded, in characters.
const LONGEST_TEXT: usize = 200;

/// The part that an external mind takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum MindRole {
    Concept,
    Participant,
}

named!(MindRole);

/// A belief that an external mind tells: for some state aspects, the probabilities of their values; what is not named
/// has none.
pub type ToldBelief = BTreeMap<String, BTreeMap<String, f64>>;

/// What came from an external mind, beside its advice or press.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ExternalEvent {
    /// It answered the first question.
    Began { role: MindRole, name: String },
    /// Its belief: a concept's estimate of the participant's, or a participant's own.
    Believes { role: MindRole, for_seq: u64, belief: ToldBelief },
    /// Witness: an answer that came after the next question, and was not used.
    Late { role: MindRole, for_seq: u64, answer: String },
    /// An answer that could not be used, or none: it counts as silence.
    Fault { role: MindRole, fault: MindFault, found: String },
}

/// What is wrong with an external mind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MindFault {
    /// It could not be started or reached.
    NotStarted,
    /// It ended, or its connection did.
    Ended,
    /// It did not answer in time.
    Silent,
    /// Its answer is none of the protocol.
    Malformed,
    /// It answered what had not been asked.
    Unasked,
    /// It was ended after too many faults.
    GivenUp,
}

impl MindFault {
    pub fn words(self) -> &'static str {
        match self {
            MindFault::NotStarted => "could not be started",
            MindFault::Ended => "has ended",
            MindFault::Silent => "does not answer",
            MindFault::Malformed => "gave no valid answer",
            MindFault::Unasked => "answered what was not asked",
            MindFault::GivenUp => "was ended after too many faults",
        }
    }

    /// Whether no further answer can come.
    pub fn is_final(self) -> bool {
        matches!(self, MindFault::NotStarted | MindFault::Ended | MindFault::GivenUp)
    }
}

impl ExternalEvent {
    pub fn role(&self) -> MindRole {
        match self {
            ExternalEvent::Began { role, .. }
            | ExternalEvent::Believes { role, .. }
            | ExternalEvent::Late { role, .. }
            | ExternalEvent::Fault { role, .. } => *role,
        }
    }

    /// In words; `None` for beliefs.
    pub fn words(&self) -> Option<String> {
        let role = self.role().name();
        match self {
            ExternalEvent::Began { name, .. } => Some(format!("external {role} began: {name}")),
            ExternalEvent::Believes { .. } => None,
            ExternalEvent::Late { .. } => Some(format!("external {role} answered too late; the answer is not used")),
            ExternalEvent::Fault { fault, found, .. } => Some(format!("external {role} {}: {found}", fault.words())),
        }
    }
}

/// What to put into the session after a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DialogueOutcome {
    pub events: Vec<Event>,
    /// Whether the connection is to be closed.
    pub ends: bool,
}

/// What the dialogues of both roles have in common. A dialogue has no connection: it makes lines, and takes lines.
pub trait MindDialogue {
    fn mind(&self) -> &ExternalMind;

    /// Whether the first question was answered.
    fn has_begun(&self) -> bool;

    /// The last question was not answered in time, or the connection has ended.
    fn failed(&mut self, fault: MindFault, found: &str) -> DialogueOutcome;
}

/// What a session knows of its external minds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExternalStatus {
    /// The names by which they introduced themselves.
    pub names: BTreeMap<MindRole, String>,
    /// Why one answers no more, in words.
    pub over: BTreeMap<MindRole, String>,
    /// The last belief that each told, by [`MindRole`].
    pub beliefs: BTreeMap<MindRole, ToldBelief>,
    pub faults: u64,
    /// Number of answers that came too late.
    pub late: u64,
}

impl ExternalStatus {
    pub(crate) fn apply(&mut self, event: &ExternalEvent) {
        match event {
            ExternalEvent::Began { role, name } => {
                self.names.insert(*role, name.clone());
                self.over.remove(role);
            }
            ExternalEvent::Believes { role, belief, .. } => {
                self.beliefs.insert(*role, belief.clone());
            }
            ExternalEvent::Late { .. } => self.late += 1,
            ExternalEvent::Fault { role, fault, .. } => {
                self.faults += 1;
                if let Some(words) = event.words().filter(|_| fault.is_final()) {
                    self.over.insert(*role, words);
                }
            }
        }
    }
}

/// The probability that a told belief gives to the true value of each aspect; `None` of aspects that it does not name.
pub fn told_truth(kitchen: &Kitchen, state: State, belief: &ToldBelief) -> Vec<Option<f64>> {
    let of = |index: usize| {
        let aspect = &kitchen.aspects[index];
        let told = belief.get(&aspect.name)?;
        let truth = &aspect.labels[kitchen.true_value(state, AspectId(index as u8))];
        Some(told.get(truth).copied().unwrap_or_default())
    };
    (0..kitchen.aspects.len()).map(of).collect()
}

/// Largest deviation of a distribution's sum from 1.
const SUM_TOLERANCE: f64 = 0.02;

/// Checks a belief: known aspects and values, and probabilities that sum to 1; the text says what was found instead.
fn check_belief(kitchen: &Kitchen, belief: &ToldBelief) -> Result<(), String> {
    for (name, values) in belief {
        let aspect = kitchen.aspect_named(name).ok_or_else(|| format!("a belief about {name}, which is no aspect"))?;
        let labels = &kitchen.aspects[aspect.index()].labels;
        if let Some(value) = values.keys().find(|value| !labels.contains(value)) {
            return Err(format!("a belief that {name} is {value}, which is no value of this aspect"));
        }
        if values.values().any(|p| !(0.0..=1.0).contains(p)) {
            return Err(format!("a belief about {name} with a probability that is not from 0 to 1"));
        }
        let sum: f64 = values.values().sum();
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            return Err(format!("a belief about {name} whose probabilities sum to {sum:.3}"));
        }
    }
    Ok(())
}

/// An answer that is none of the protocol, for this reason.
fn malformed(found: String) -> (MindFault, String) {
    (MindFault::Malformed, found)
}

fn parsed<Answer: DeserializeOwned>(text: &str) -> Result<Answer, (MindFault, String)> {
    serde_json::from_str(text).map_err(|error| malformed(format!("{error} in {text}")))
}

/// Text of an answer as it is recorded: one line, of limited length.
fn recorded_text(text: &str) -> String {
    let line: String = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    line.trim().chars().take(LONGEST_TEXT).collect()
}

/// What comes over a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MindNews {
    /// A line without its end.
    Line(String),
    /// Nothing came in time.
    Nothing,
    /// The connection has ended, and why.
    Over(String),
}

/// The way to an external mind. Dropping it ends the program, with all processes that it started.
pub trait MindWriter: fmt::Debug + Send {
    /// Sends a line, without waiting: what the program does not read in time is an error.
    fn send(&mut self, line: String) -> Result<(), String>;
}

/// The way back.
pub trait MindReader: fmt::Debug + Send {
    /// The next line; waits for it as long as this.
    fn receive(&mut self, wait: Duration) -> MindNews;
}

/// Both ways of a connection.
#[derive(Debug)]
pub struct MindConnection {
    pub to: Box<dyn MindWriter>,
    pub from: Box<dyn MindReader>,
}

impl MindConnection {
    /// Sends a question and waits for what comes back.
    fn ask(&mut self, question: String, wait: Duration) -> MindNews {
        match self.to.send(question) {
            Ok(()) => self.from.receive(wait),
            // The program has more to say about its end than the pipe.
            Err(found) => match self.from.receive(Duration::from_secs(1)) {
                MindNews::Over(why) => MindNews::Over(why),
                _ => MindNews::Over(found),
            },
        }
    }
}

/// Makes connections to external minds, and says what a person in the participant's place would see.
pub trait ExternalMinds: fmt::Debug + Send + Sync {
    fn open(&self, mind: &ExternalMind) -> Result<MindConnection, String>;

    /// The constant part of the participant's display, and its changing part now.
    fn sight(&self, session: &Session) -> [serde_json::Value; 2];
}

/// For sessions without external minds.
#[derive(Clone, Copy, Debug)]
pub struct NoMinds;

impl ExternalMinds for NoMinds {
    fn open(&self, _: &ExternalMind) -> Result<MindConnection, String> {
        Err("this command starts no programs".to_string())
    }

    fn sight(&self, _: &Session) -> [serde_json::Value; 2] {
        [serde_json::Value::Null, serde_json::Value::Null]
    }
}
