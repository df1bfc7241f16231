//! Sends events to the session, or tells the wizard why the session rejects them.

use super::console_message::ConsoleCommand;
use super::console_model::ConsoleModel;
use super::notice::NoticeLevel;
use tomcom_core::base::time::SessionTime;
use tomcom_session::admit::{admit, hygiene};
use tomcom_session::{Event, Session};

/// Why the session would reject an event now; `None` if it would accept it.
pub(super) fn refusal(session: &Session, now: SessionTime, event: &Event) -> Option<String> {
    admit(session, event).map_err(str::to_string).and_then(|()| hygiene(session, now, event)).err()
}

/// Sends an event if the session accepts it now; else a notice tells the wizard why not.
pub(super) fn send(
    model: &mut ConsoleModel,
    session: &Session,
    event: Event,
    level: NoticeLevel,
    words: &str,
) -> Option<ConsoleCommand> {
    if let Some(reason) = refusal(session, model.now, &event) {
        return refuse(model, &reason);
    }
    match words {
        "" => model.notice = None,
        words => model.say(level, words),
    }
    Some(ConsoleCommand::Input(event))
}

/// Tells the wizard why a key has no effect now.
pub(super) fn refuse(model: &mut ConsoleModel, reason: &str) -> Option<ConsoleCommand> {
    model.say(NoticeLevel::Refused, reason);
    None
}

/// Releases the robot after a stop.
pub(super) fn resume_robot(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let words =
        if session.robot.held { "the robot is no longer stopped, but still held" } else { "the robot continues" };
    send(model, session, Event::RobotResumed, NoticeLevel::Done, words)
}
