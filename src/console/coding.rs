//! Coding the errors of a recording: which error one stands at, and what the rater says about it.

use super::message::ConsoleCommand;
use super::model::{ConsoleModel, NoticeLevel};
use super::playback::ReplayKey;
use crate::history::wording;
use crate::kitchen::{Kitchen, LocationId};
use crate::measures::coding::{CauseKind, Code, Codes};
use crate::session::{Session, TimelineEvent};

/// What a key asks of a rater's console.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaterKey {
    /// To the next error, or the one before.
    Next,
    Last,
    /// The participant believed something wrong about this place, or the order there and the recipe of its dish.
    Belief(LocationId),
    /// Another cause.
    Cause(CauseKind),
    /// Nothing is said about the error after all.
    Clear,
}

/// What one rater has said about a recording so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaterSession {
    pub rater: String,
    /// The numbers of the presses that were errors, in order.
    pub errors: Vec<u64>,
    pub codes: Codes,
}

impl RaterSession {
    /// The error at which a replay stands that has applied so many events: the last one until then.
    pub fn at(&self, events: usize) -> Option<usize> {
        self.errors.partition_point(|&press| press < events as u64).checked_sub(1)
    }

    /// Where the rater stands, in words; `press` is the last error until then, in words too.
    pub fn describe(&self, kitchen: &Kitchen, events: usize, press: &str) -> String {
        let (all, coded) = (self.errors.len(), self.codes.0.len());
        let here = match self.at(events) {
            None => format!("before the first of {all} errors"),
            Some(index) => {
                let said = match self.codes.0.get(&self.errors[index]) {
                    None => "not coded".to_string(),
                    Some(code) => describe(kitchen, code),
                };
                format!("error {} of {all}, {press}: {said}", index + 1)
            }
        };
        format!("{}, {here} ({coded} coded)", self.rater)
    }
}

/// A press in words: its button, and whether it did anything.
pub fn press(kitchen: &Kitchen, what: &TimelineEvent) -> String {
    let TimelineEvent::Press { agent, button, effective } = what else { return String::new() };
    let effect = if *effective { "with" } else { "without" };
    format!("\"{}\" {effect} effect", wording::button(kitchen, *agent, *button))
}

fn describe(kitchen: &Kitchen, code: &Code) -> String {
    match code {
        Code::Belief(name) => {
            let label = kitchen.location_named(name).map(|location| kitchen.location(location).label());
            format!("wrong about {}", label.unwrap_or_else(|| name.clone()))
        }
        other => other.kind().name().to_string(),
    }
}

/// Does what a key asks for.
pub fn act(model: &mut ConsoleModel, session: &Session, rate: RaterKey) -> Option<ConsoleCommand> {
    let events = model.playback.as_ref().map_or(0, |playback| playback.event);
    let coding = model.coding.as_mut()?;
    let at = coding.at(events);
    let kitchen = &session.kitchen;
    let code = match rate {
        RaterKey::Next | RaterKey::Last => {
            let to = match rate {
                RaterKey::Next => Some(at.map_or(0, |at| at + 1)),
                _ => at.and_then(|at| at.checked_sub(1)),
            };
            let Some(&press) = to.and_then(|to| coding.errors.get(to)) else {
                model.say(NoticeLevel::Refused, "there is no other error");
                return None;
            };
            return Some(ConsoleCommand::Move(ReplayKey::ToEvent(press)));
        }
        RaterKey::Belief(location) => Some(Code::Belief(kitchen.location(location).name.clone())),
        RaterKey::Cause(kind) => Code::new(kind, None),
        RaterKey::Clear => None,
    };
    let Some(&press) = at.and_then(|at| coding.errors.get(at)) else {
        model.say(NoticeLevel::Refused, "there is no error yet that could be coded");
        return None;
    };
    match code {
        Some(code) => coding.codes.0.insert(press, code),
        None => coding.codes.0.remove(&press),
    };
    // What was said stands beside the error, where an older notice would hide it.
    model.notice = None;
    Some(ConsoleCommand::Code)
}
