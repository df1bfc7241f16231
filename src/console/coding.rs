//! The rater's actions at the console: going from error to error in a recording, and coding the cause of each error.

use super::console_message::ConsoleCommand;
use super::console_model::ConsoleModel;
use super::key_action::RaterAction;
use super::notice::NoticeLevel;
use super::playback::ReplayAction;
use tomcom_core::measures::raters::ErrorCauseCode;
use tomcom_session::Session;

/// Carries out an action of the rater's keys.
pub fn act(model: &mut ConsoleModel, session: &Session, rate: RaterAction) -> Option<ConsoleCommand> {
    let events = model.playback.as_ref().map_or(0, |playback| playback.event);
    let coding = model.coding.as_mut()?;
    let at = coding.at(events);
    let chosen = coding.chosen.take().filter(|chosen| Some(*chosen) != at);
    let code = match rate {
        RaterAction::Next => return go(model, chosen.or(Some(at.map_or(0, |at| at + 1)))),
        RaterAction::Last => return go(model, at.and_then(|at| at.checked_sub(1))),
        RaterAction::ChooseLater | RaterAction::ChooseEarlier => {
            let last = coding.errors.len().checked_sub(1)?;
            let from = chosen.or(at);
            coding.chosen = Some(match rate {
                RaterAction::ChooseLater => from.map_or(0, |from| (from + 1).min(last)),
                _ => from.map_or(0, |from| from.saturating_sub(1)),
            });
            return None;
        }
        RaterAction::Undo => return undone(model, false),
        RaterAction::Redo => return undone(model, true),
        RaterAction::Belief(location) => Some(ErrorCauseCode::Belief(session.kitchen.location(location).name.clone())),
        RaterAction::Cause(kind) => ErrorCauseCode::new(kind, None),
        RaterAction::Clear => None,
    };
    if let Some(error) = chosen.and_then(|chosen| coding.errors.get(chosen)) {
        let words =
            format!("no code given: error {} is only selected; enter goes to it, esc deselects it", error.error);
        coding.chosen = chosen;
        model.say(NoticeLevel::Refused, words);
        return None;
    }
    let Some(press) = coding.present(events).map(|error| error.press) else {
        model.say(NoticeLevel::Refused, "there is no error before this point of the recording");
        return None;
    };
    coding.give(press, code);
    Some(ConsoleCommand::Code { press })
}

/// Moves the replay to the error with this index, if there is one.
fn go(model: &mut ConsoleModel, to: Option<usize>) -> Option<ConsoleCommand> {
    let errors = model.coding.as_ref().map(|coding| &coding.errors)?;
    let Some(error) = to.and_then(|to| errors.get(to)) else {
        model.say(NoticeLevel::Refused, "the recording has no other error");
        return None;
    };
    Some(ConsoleCommand::Move(ReplayAction::ToEvent(error.press)))
}

/// Undoes the rater's last change of a code, or redoes it.
fn undone(model: &mut ConsoleModel, again: bool) -> Option<ConsoleCommand> {
    let coding = model.coding.as_mut()?;
    let press = if again { coding.redo() } else { coding.undo() };
    if press.is_none() {
        let nothing = if again {
            "no undone change of a code that could be redone"
        } else {
            "no code was changed since the recording was opened"
        };
        model.say(NoticeLevel::Refused, nothing);
    }
    press.map(|press| ConsoleCommand::Code { press })
}

/// Moves the replay to the error with this index in the list.
pub(super) fn go_to(model: &mut ConsoleModel, index: usize) -> Option<ConsoleCommand> {
    if let Some(coding) = &mut model.coding {
        coding.chosen = None;
    }
    go(model, Some(index))
}
