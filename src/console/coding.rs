//! Coding the errors of a recording: which error one stands at, and what the rater says about it.

use super::console_message::ConsoleCommand;
use super::console_model::ConsoleModel;
use super::key_action::RaterKey;
use super::notice::NoticeLevel;
use super::playback::ReplayKey;
use crate::history::wording;
use crate::kitchen::Kitchen;
use crate::measures::cause_codes::Code;
use crate::session::{Session, TimelineEvent};

/// A press in words: its button, and whether it did anything.
pub fn press(kitchen: &Kitchen, what: &TimelineEvent) -> String {
    let TimelineEvent::Press { agent, button, no_effect } = what else { return String::new() };
    let effect = if no_effect.is_none() { "with" } else { "without" };
    format!("\"{}\" {effect} effect", wording::button(kitchen, *agent, *button))
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
