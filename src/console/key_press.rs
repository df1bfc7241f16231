//! Handling of a pressed key: whether it counts as a press or is held, and which part of the console takes it (dialog,
//! sheet or main view).

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind};

use super::actions::{act, differ, refuse, send_telling};
use super::chord::KeyChord;
use super::console_model::{ComparisonAction, ConsoleCommand, ConsoleModel, Dialog, NoticeLevel, PressedKey};
use super::form::{self, SheetKey, sheet};
use super::key_action::{KeyAction, KeyLayer, ManualAction, RaterAction, ViewAction};
use super::lists::{self, ListCursor, ListReply, PickerKind, ReasonFor};
use super::possible::acts_on_sheet;
use super::view::dialog::report_rest;
use super::view::help::help_pages;
use super::{gaze_check, interventions, mouse, panels, preflight, probe_keys};
use tomcom_session::event::TrialEndReason;
use tomcom_session::{Event, Session, TrialPhase};

pub(super) fn key(model: &mut ConsoleModel, session: &Session, key: &KeyEvent) -> Option<ConsoleCommand> {
    match touch(model, key) {
        KeyPressKind::Release => None,
        touch => {
            if touch == KeyPressKind::Press {
                model.forget_notice();
            }
            press(model, session, key.code, KeyChord::from_event(key), touch)
        }
    }
}

/// Handles a key that is pressed or held, or a mouse click that stands for a key. `code` is the key as it was typed,
/// with capitals.
pub(super) fn press(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    chord: KeyChord,
    touch: KeyPressKind,
) -> Option<ConsoleCommand> {
    let action = model.keys.find(model.layer, chord).map(|line| line.action.clone());
    if let Some(Dialog::Send(confirmation)) = model.dialog.clone().filter(|_| action != Some(KeyAction::StopRobot)) {
        match chord.code {
            KeyCode::Enter if touch == KeyPressKind::Press => return mouse::confirm(model, session, confirmation),
            KeyCode::Enter => return None,
            KeyCode::Esc => {
                model.dialog = None;
                return None;
            }
            // Every other key closes the question and keeps its own meaning.
            _ => model.dialog = None,
        }
    }
    match action {
        // A trial goes on by itself after a freeze probe, even while a note is typed.
        Some(KeyAction::StopRobot) if session.is_running() => stop_robot(model, session),
        // In text input, where the robot stands, the space bar types a space instead of stopping it; likewise among the
        // typed words of a reason.
        Some(KeyAction::StopRobot) if types_reason(model, session) => in_list(model, session, (code, chord), touch),
        _ if matches!(model.dialog, Some(Dialog::Note(_) | Dialog::Reason(..) | Dialog::Answer(_))) => {
            in_text(model, session, (code, chord), touch)
        }
        Some(KeyAction::StopRobot) => stop_robot(model, session),
        Some(KeyAction::Quit) if chord.ctrl && touch == KeyPressKind::Press && may_leave_for_quit(model) => {
            act(model, session, KeyAction::Quit)
        }
        Some(KeyAction::Move(to)) if model.dialog.is_none() => Some(ConsoleCommand::Move(to)),
        _ if matches!(model.dialog, Some(Dialog::Pick(_) | Dialog::Palette(_))) => {
            in_list(model, session, (code, chord), touch)
        }
        action if model.dialog == Some(Dialog::Preflight) => {
            preflight::answer(model, session, chord.code, action, touch == KeyPressKind::Press)
        }
        _ if model.dialog == Some(Dialog::Calibration) => {
            gaze_check::answer(model, session, chord.code, touch == KeyPressKind::Press)
        }
        Some(action) if touch == KeyPressKind::Held && goes_on(model, session, &action) => act(model, session, action),
        // Digits of a number follow one another quickly: the number 11 is two presses, not a held key.
        _ if touch == KeyPressKind::Held && !probe_keys::takes_digit(model, session, code) => {
            if model.dialog.is_none() || reopens(model, action.as_ref()) {
                model.say(NoticeLevel::Refused, format!("the key \"{chord}\" is held down: it counts as one press"));
            }
            None
        }
        action if model.dialog.is_none() && model.playback.is_none() && sheet(session).is_some() => {
            let code = if chord.ctrl && matches!(code, KeyCode::Char(_)) { KeyCode::Null } else { code };
            on_sheet(model, session, code, action, touch)
        }
        Some(action) if touch == KeyPressKind::Again && model.dialog.is_none() && !may_follow_at_once(&action) => {
            ask_again(model, chord)
        }
        action if model.dialog.is_some() => answer(model, session, chord, action, touch),
        Some(action) => act(model, session, action),
        None => {
            unknown(model, session, chord);
            None
        }
    }
}

/// Handles a key of an open text input. Keys with ctrl and a held enter key do not count.
fn in_text(
    model: &mut ConsoleModel,
    session: &Session,
    (code, chord): (KeyCode, KeyChord),
    touch: KeyPressKind,
) -> Option<ConsoleCommand> {
    if chord.ctrl || (code == KeyCode::Enter && touch != KeyPressKind::Press) {
        return None;
    }
    if let Some(Dialog::Note(line) | Dialog::Reason(_, _, line) | Dialog::Answer(line)) = &mut model.dialog
        && !matches!(code, KeyCode::Enter | KeyCode::Esc)
    {
        line.key(code);
        return None;
    }
    match (model.dialog.take(), code) {
        // The reasons for waiving the criterion stand on the sheet below.
        (Some(Dialog::Reason(what, ..)), KeyCode::Esc) if what != ReasonFor::Waive => {
            interventions::ask(model, PickerKind::Reason(what))
        }
        (_, KeyCode::Esc) => None,
        (Some(Dialog::Note(line)), _) => interventions::save_note(model, session, line.text()),
        (Some(Dialog::Reason(what, reason, line)), _) => interventions::word_reason(model, session, what, reason, line),
        (Some(Dialog::Answer(line)), _) => form::give_answer(model, session, line),
        _ => None,
    }
}

/// Handles a key of an open list. Quick typing and held arrow keys count; a held enter key, and keys with ctrl such as
/// the one that opened the list, do not.
fn in_list(
    model: &mut ConsoleModel,
    session: &Session,
    (code, chord): (KeyCode, KeyChord),
    touch: KeyPressKind,
) -> Option<ConsoleCommand> {
    if chord.ctrl {
        // The key that opened the list may still be held down.
        if touch == KeyPressKind::Press && model.keys.find(model.layer, chord).is_some() {
            model.say(NoticeLevel::Refused, format!("a list is open: esc closes it, then press {chord}"));
        }
        return None;
    }
    if chord.code == KeyCode::Enter && touch != KeyPressKind::Press {
        return None;
    }
    match model.dialog.clone() {
        Some(Dialog::Pick(picker)) => interventions::pick(model, session, picker, code),
        Some(Dialog::Palette(cursor)) => choose(model, session, cursor, chord.code),
        _ => None,
    }
}

/// Whether the words of a reason are being typed in the list of reasons.
fn types_reason(model: &ConsoleModel, session: &Session) -> bool {
    matches!(&model.dialog, Some(Dialog::Pick(list)) if list.takes_words(session) && !list.cursor.filter.is_empty())
}

/// Handles a key of the palette. The chosen action is carried out as if its key were pressed; but signals are never
/// sent from a list, so for them a notice tells the key.
fn choose(
    model: &mut ConsoleModel,
    session: &Session,
    mut cursor: ListCursor,
    code: KeyCode,
) -> Option<ConsoleCommand> {
    if let Some((to, _)) = lists::place(model, &cursor).filter(|_| code == KeyCode::Enter) {
        (model.dialog, model.answered) = (None, Some(model.clock));
        return Some(ConsoleCommand::Move(to));
    }
    let (left, events) = (lists::actions(model, &cursor), lists::events(model, &cursor));
    let reply = cursor.key(left.len() + events.len(), code);
    let event = cursor.at.checked_sub(left.len()).and_then(|at| events.get(at)).filter(|_| reply == ListReply::Taken);
    if let Some(&&(to, _)) = event {
        (model.dialog, model.answered) = (None, Some(model.clock));
        return Some(ConsoleCommand::Move(to));
    }
    let chosen = left.get(cursor.at).filter(|_| reply == ListReply::Taken);
    let chosen = chosen.and_then(|line| Some((line.action.clone(), *line.chords.first()?, line.help.clone())));
    model.dialog = Some(Dialog::Palette(cursor)).filter(|_| reply == ListReply::Open);
    let (action, chord, help) = chosen?;
    model.answered = Some(model.clock);
    lists::remember(model, &action);
    match action {
        KeyAction::Signal(..) | KeyAction::Accept => {
            model.say(NoticeLevel::Done, format!("press {chord} to {help}: signals are not sent from a list"));
            None
        }
        _ => press(model, session, chord.code, chord, KeyPressKind::Press),
    }
}

/// Whether the question of quitting may replace the open dialog. A gaze accuracy check or a text input has to be ended
/// first.
fn may_leave_for_quit(model: &ConsoleModel) -> bool {
    matches!(
        model.dialog,
        Some(Dialog::Pick(_) | Dialog::Palette(_) | Dialog::Preflight | Dialog::Help(_) | Dialog::Details(..))
    )
}

/// Handles a key while a sheet covers the console: besides the sheet's own keys, only those for help, for leaving, and
/// for repairs work.
fn on_sheet(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    action: Option<KeyAction>,
    touch: KeyPressKind,
) -> Option<ConsoleCommand> {
    match (form::stroke(session, code, action == Some(KeyAction::Advance)), action) {
        // A confirming key within the key repeat delay probably is still held from the previous step, and is refused.
        // Answers are always taken: a lost answer would shift the following answers to wrong items unnoticed, but an
        // additional one is seen.
        (Some(SheetKey::Confirm | SheetKey::Leave), _) if touch == KeyPressKind::Again => {
            refuse(model, "key pressed too soon: read the text, then press the key again")
        }
        (Some(stroke), _) => form::write(model, session, stroke),
        (None, Some(action)) if acts_on_sheet(session, &action) => act(model, session, action),
        (None, _) => refuse(model, "this key has no effect here: the last line of the sheet names the keys"),
    }
}

/// Whether the action goes on while its key is held: it only moves about in the list of errors or in a panel.
fn goes_on(model: &ConsoleModel, session: &Session, action: &KeyAction) -> bool {
    let moves = matches!(
        action,
        KeyAction::Rate(RaterAction::ChooseLater | RaterAction::ChooseEarlier)
            | KeyAction::Look(ViewAction::Back | ViewAction::Forward | ViewAction::Earlier | ViewAction::Later)
    );
    moves && model.dialog.is_none() && (model.playback.is_some() || sheet(session).is_none())
}

/// Whether the key is the one that opened the question on the screen, whether to quit or to end the trial.
fn reopens(model: &ConsoleModel, action: Option<&KeyAction>) -> bool {
    match model.dialog {
        Some(Dialog::Quit) => action == Some(&KeyAction::Quit),
        Some(Dialog::EndTrial) => action == Some(&KeyAction::EndTrial),
        _ => false,
    }
}

/// Says that a key did not count, since it cannot be told from one that is held down.
fn ask_again(model: &mut ConsoleModel, chord: KeyChord) -> Option<ConsoleCommand> {
    refuse(model, format!("the key \"{chord}\" may still be held down: press it again"))
}

/// Stops the robot (space bar), in every view; has no effect if the wizard has stopped the robot already.
fn stop_robot(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    if session.robot.is_stopped_by_wizard() {
        return None;
    }
    send_telling(model, session, Event::RobotStopped, NoticeLevel::Alarm, "the robot is stopped")
}

fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    chord: KeyChord,
    action: Option<KeyAction>,
    touch: KeyPressKind,
) -> Option<ConsoleCommand> {
    let dialog = model.dialog.clone()?;
    if let (Dialog::Help(_), Some(KeyAction::Look(look))) = (&dialog, &action)
        && *look != ViewAction::All
        && help_pages(model) > 0
    {
        panels::leaf(model, *look);
        return None;
    }
    if let (Dialog::Details(..), Some(KeyAction::Differ(step @ (ComparisonAction::Next | ComparisonAction::Last)))) =
        (&dialog, &action)
    {
        differ(model, session, *step);
        differ(model, session, ComparisonAction::Open);
        return None;
    }
    if matches!(dialog, Dialog::Report(_)) {
        report(model, chord.code, action);
        return None;
    }
    let again = reopens(model, action.as_ref());
    // The key that opened the question answers it with yes, but not while it may still be held down.
    if again && touch == KeyPressKind::Again {
        return ask_again(model, chord);
    }
    model.dialog = None;
    let yes = chord == KeyChord::char('y') || again;
    match dialog {
        Dialog::Quit if yes => Some(ConsoleCommand::Quit),
        Dialog::EndTutorial if yes => form::end_tutorial(model, session),
        Dialog::EndTrial if yes => Some(ConsoleCommand::Input(Event::TrialEnded { reason: TrialEndReason::Wizard })),
        _ => None,
    }
}

/// Handles a key in a training report, which only enter and the quit key close, so that a key meant for the training
/// does not close it.
fn report(model: &mut ConsoleModel, code: KeyCode, action: Option<KeyAction>) {
    match (code, action) {
        (KeyCode::Enter, _) | (_, Some(KeyAction::Quit)) => model.dialog = None,
        (_, Some(KeyAction::Look(ViewAction::Back | ViewAction::Last | ViewAction::Earlier))) => {
            model.help_from = model.help_from.saturating_sub(1)
        }
        (_, Some(KeyAction::Look(ViewAction::Forward | ViewAction::Next | ViewAction::Later))) => {
            model.help_from = (model.help_from + 1).min(report_rest(model));
        }
        _ => {}
    }
}

/// Handles a key without a meaning in the active layer: a notice says whether it has one in the other layer.
fn unknown(model: &mut ConsoleModel, session: &Session, chord: KeyChord) {
    let KeyCode::Char(_) = chord.code else { return };
    let other = if model.layer == KeyLayer::Wizard { KeyLayer::Participant } else { KeyLayer::Wizard };
    let key = chord.to_string();
    if model.keys.find(other, chord).is_some() {
        let whose = if other == KeyLayer::Wizard { "wizard" } else { "participant" };
        model.say(NoticeLevel::Refused, format!("\"{key}\" is a key of the {whose}: tab switches to these keys"));
    } else if (model.playback.is_none() || model.coding.is_some()) && session.phase != TrialPhase::Closed {
        model.say(NoticeLevel::Refused, format!("the key \"{key}\" does nothing here: ? shows the keys"));
    }
}

/// Largest time between two reports of one key, in seconds, for the key to count as held down: terminals repeat a held
/// key about every 0.03 s, and no finger is that fast. Used only where the terminal does not report repeats as such.
const REPEAT_S: f64 = 0.15;
/// Time in seconds for which a question ignores the key that opened it: longer than the usual delay before key repeat
/// sets in (0.25 to 0.7 s), during which a held key cannot be told from a second press.
pub(super) const ANSWER_S: f64 = 0.7;

/// Meaning of a terminal's key report: newly pressed, pressed again or held, held, or released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeyPressKind {
    Press,
    /// The key was pressed a second time, or has been held since the first press and begins to repeat.
    Again,
    Held,
    Release,
}

/// Classifies a key report of the terminal, and remembers the key for the next report.
pub(super) fn touch(model: &mut ConsoleModel, key: &KeyEvent) -> KeyPressKind {
    match key.kind {
        KeyEventKind::Press if model.exact_keys => return KeyPressKind::Press,
        KeyEventKind::Press => {}
        kind => {
            model.exact_keys = true;
            return if kind == KeyEventKind::Release { KeyPressKind::Release } else { KeyPressKind::Held };
        }
    }
    // Only the key that was pressed last repeats. The waiting time runs from the press that counted, so that repeated
    // attempts do not prolong it.
    let now = model.clock;
    let last = model.pressed.filter(|last| last.code == key.code);
    let touch = match last.map(|last| (now.secs_since(last.reported), now.secs_since(last.counted))) {
        Some((gap_s, _)) if gap_s < REPEAT_S => KeyPressKind::Held,
        Some((_, since_s)) if since_s < ANSWER_S => KeyPressKind::Again,
        _ => KeyPressKind::Press,
    };
    let counted = last.filter(|_| touch != KeyPressKind::Press).map_or(now, |last| last.counted);
    model.pressed = Some(PressedKey { code: key.code, reported: now, counted });
    touch
}

/// Whether a list has closed so recently that an enter key was probably meant for the list.
pub(super) fn is_right_after_list(model: &ConsoleModel) -> bool {
    model.answered.is_some_and(|answered| model.clock.secs_since(answered) < ANSWER_S)
}

/// Whether a second press shortly after the first counts although the terminal cannot tell it from a held key. It does
/// not count for actions that toggle, nor for actions that are recorded each time.
pub(super) fn may_follow_at_once(action: &KeyAction) -> bool {
    let once = [ManualAction::HoldRobot, ManualAction::SkipPress, ManualAction::NoteInWords].map(KeyAction::Manual);
    !matches!(action, KeyAction::Advance | KeyAction::SwitchLayer | KeyAction::Note(_)) && !once.contains(action)
}
