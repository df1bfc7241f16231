//! `update`: a message comes in, the model changes, and what concerns the session leaves as a command.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind};

use super::arrange::KitchenMap;
use super::beliefs::beliefs;
use super::chord::KeyChord;
use super::coding;
use super::compared::ComparisonKey;
use super::console_message::{ConsoleCommand, ConsoleMessage};
use super::console_model::{ConsoleModel, Dialog, PressedKey};
use super::form::{self, sheet};
use super::hands;
use super::key_action::ManualAction;
use super::key_action::PanelKey;
use super::key_action::{KeyAction, KeyLayer};
use super::notice::NoticeLevel;
use super::panels;
use super::preflight;
use super::sending::{resume_robot, send};
use super::view::dialog::{help_pages, report_rest};
use super::view::regions::Regions;
use crate::communication::Sender;
use crate::history::wording;
use crate::kitchen::{Agent, AspectId};
use crate::session::event::{EndReason, SignalEnd};
use crate::session::offers;
use crate::session::settings::{ParticipantKind, Visibility};
use crate::session::{Event, Phase, Session};

/// A key that the terminal reports again within this time is held down, not pressed again: terminals repeat a held key
/// about every 0.03 s, and no finger is that fast. Only where the terminal does not report repeats as such.
const REPEAT_S: f64 = 0.15;
/// A question is not answered by its own key within this time: longer than the usual delay before key repeat sets in
/// (0.25 to 0.7 s), when a key that stays down can not be told from a second press.
const ANSWER_S: f64 = 0.7;

/// Takes a message at the time `model.now`.
pub fn update(model: &mut ConsoleModel, session: &Session, message: ConsoleMessage) -> Option<ConsoleCommand> {
    match message {
        ConsoleMessage::Key(key) => pressed(model, session, &key),
        ConsoleMessage::Pointer(column, row) => {
            let regions = Regions::showing(model.size, session, model);
            let plan = KitchenMap::new(
                &session.kitchen,
                regions.kitchen_inside(),
                session.spec.participant.kind == ParticipantKind::Keyboard,
            );
            model.pointer = Some(plan.display_point(column, row));
            None
        }
        ConsoleMessage::Click(column, row) => {
            if let Some(taken) = coding::click(model, session, (column, row)) {
                return taken;
            }
            panels::click(model, session, (column, row));
            None
        }
        ConsoleMessage::Wheel(column, row, steps) => {
            panels::wheel(model, session, (column, row), i64::from(steps));
            None
        }
        ConsoleMessage::Resized(columns, rows) => {
            model.size = (columns, rows);
            None
        }
        ConsoleMessage::Focus(focused) => {
            let changed = std::mem::replace(&mut model.focused, focused) != focused;
            model.pressed = None;
            let event = if focused { Event::FocusRegained } else { Event::FocusLost };
            (changed && session.phase != Phase::Closed).then_some(ConsoleCommand::Input(event))
        }
    }
}

fn pressed(model: &mut ConsoleModel, session: &Session, key: &KeyEvent) -> Option<ConsoleCommand> {
    let touch = touch(model, key);
    if touch == Touch::Release {
        return None;
    }
    let chord = KeyChord::from_event(key);
    let action = model.keys.find(model.layer, chord).map(|line| line.action.clone());
    match action {
        // Only where the trial is paused, and the robot stands, does the space bar type a space.
        _ if let Some(Dialog::Note(line)) = &model.dialog => {
            let line = line.clone();
            let counts = !chord.ctrl && (key.code != KeyCode::Enter || touch == Touch::Press);
            if counts { hands::write(model, session, line, key.code) } else { None }
        }
        Some(KeyAction::StopRobot) => stop_robot(model, session),
        Some(KeyAction::Quit) if chord.ctrl && touch == Touch::Press && may_leave_for_quit(model) => {
            act(model, session, KeyAction::Quit)
        }
        Some(KeyAction::Move(to)) if model.dialog.is_none() => Some(ConsoleCommand::Move(to)),
        _ if let Some(Dialog::Pick(picker)) = &model.dialog => {
            let picker = picker.clone();
            // A list takes quick typing and held arrows; the key that opened it, and a held enter, answer nothing.
            let counts = !chord.ctrl && (chord.code != KeyCode::Enter || touch == Touch::Press);
            if counts { hands::pick(model, session, picker, chord.code) } else { None }
        }
        action if model.dialog == Some(Dialog::Preflight) => {
            preflight::answer(model, session, chord.code, action, touch == Touch::Press)
        }
        _ if model.dialog == Some(Dialog::Calibration) => {
            super::gaze_targets::answer(model, session, chord.code, touch == Touch::Press)
        }
        _ if touch == Touch::Held => {
            if model.dialog.is_none() {
                model.say(NoticeLevel::Refused, format!("\"{chord}\" is held down: it counts once"));
            }
            None
        }
        action if model.dialog.is_none() && model.playback.is_none() && sheet(session).is_some() => {
            on_sheet(model, session, key.code, action, touch)
        }
        Some(action) if touch == Touch::Again && model.dialog.is_none() && !may_follow_at_once(&action) => {
            model.say(NoticeLevel::Refused, format!("\"{chord}\" may be held down: press again"));
            None
        }
        action if model.dialog.is_some() => answer(model, session, chord, action, touch),
        Some(action) => act(model, session, action),
        None => {
            unknown(model, session, key.code);
            None
        }
    }
}

/// Whether the question of quitting takes the place of the dialog: of those that wait for something else. A check of the
/// gaze is ended first.
fn may_leave_for_quit(model: &ConsoleModel) -> bool {
    matches!(model.dialog, Some(Dialog::Pick(_) | Dialog::Preflight | Dialog::Help | Dialog::Difference(_)))
}

/// A key while a sheet lies in front of the console: of the others, those that help and leave still work.
fn on_sheet(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    action: Option<KeyAction>,
    touch: Touch,
) -> Option<ConsoleCommand> {
    match (form::stroke(code, action == Some(KeyAction::Advance)), action) {
        // Nobody reads a step so fast: the key is still down from the last one. An answer is always taken: one that is lost
        // would put those after it at the wrong items, one too many is seen.
        (Some(form::SheetKey::On), _) if touch == Touch::Again && code != KeyCode::Right => {
            model.say(NoticeLevel::Refused, "not yet: read it, then press the key again");
            None
        }
        (Some(stroke), _) => form::write(model, session, stroke),
        (
            None,
            Some(
                action @ (KeyAction::Help
                | KeyAction::Quit
                | KeyAction::ResumeRobot
                | KeyAction::Hand(ManualAction::Calibrate)),
            ),
        ) => act(model, session, action),
        (None, _) => {
            model.say(
                NoticeLevel::Refused,
                "this key has no meaning before the trial: the last line of the sheet says what has",
            );
            None
        }
    }
}

/// What a report of the terminal says of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Touch {
    /// It went down just now.
    Press,
    /// It was pressed a second time, or is held down since the first and begins to repeat.
    Again,
    /// It is held down.
    Held,
    Release,
}

fn touch(model: &mut ConsoleModel, key: &KeyEvent) -> Touch {
    match key.kind {
        KeyEventKind::Press if model.exact_keys => return Touch::Press,
        KeyEventKind::Press => {}
        kind => {
            model.exact_keys = true;
            return if kind == KeyEventKind::Release { Touch::Release } else { Touch::Held };
        }
    }
    // Only the key that went down last repeats. The wait runs from the press that counted, so that trying again is no way
    // to wait for ever.
    let now = model.clock;
    let last = model.pressed.filter(|last| last.code == key.code);
    let touch = match last.map(|last| (now.secs_since(last.reported), now.secs_since(last.counted))) {
        Some((gap_s, _)) if gap_s < REPEAT_S => Touch::Held,
        Some((_, since_s)) if since_s < ANSWER_S => Touch::Again,
        _ => Touch::Press,
    };
    let counted = last.filter(|_| touch != Touch::Press).map_or(now, |last| last.counted);
    model.pressed = Some(PressedKey { code: key.code, reported: now, counted });
    touch
}

/// Whether a second press within the delay of key repeat counts where the terminal does not tell it from a held key. What
/// does the opposite the second time does not, nor does what is written down each time.
fn may_follow_at_once(action: &KeyAction) -> bool {
    let once = [ManualAction::HoldRobot, ManualAction::SkipPress].map(KeyAction::Hand);
    !matches!(action, KeyAction::Advance | KeyAction::SwitchLayer | KeyAction::Note(_)) && !once.contains(action)
}

/// The space bar: works in every view, and does nothing twice.
fn stop_robot(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    if session.robot.is_stopped_by_wizard() {
        return None;
    }
    send(model, session, Event::RobotStopped, NoticeLevel::Alarm, "the robot is stopped")
}

fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    chord: KeyChord,
    action: Option<KeyAction>,
    touch: Touch,
) -> Option<ConsoleCommand> {
    let dialog = model.dialog.clone()?;
    if let (Dialog::Help, Some(KeyAction::Look(look))) = (&dialog, &action)
        && *look != PanelKey::All
        && help_pages(model) > 0
    {
        panels::leaf(model, *look);
        return None;
    }
    if let (Dialog::Difference(_), Some(KeyAction::Differ(step @ (ComparisonKey::Next | ComparisonKey::Last)))) =
        (&dialog, &action)
    {
        differ(model, session, *step);
        differ(model, session, ComparisonKey::Open);
        return None;
    }
    if matches!(dialog, Dialog::Report(_)) {
        report(model, chord.code, action);
        return None;
    }
    let again = match dialog {
        Dialog::Quit => action == Some(KeyAction::Quit),
        Dialog::EndTrial => action == Some(KeyAction::EndTrial),
        _ => false,
    };
    // A nervous second press ends no trial.
    let goes_on = matches!(session.phase, Phase::Running | Phase::Paused);
    if again && (goes_on || touch == Touch::Again) {
        return None;
    }
    model.dialog = None;
    let yes = chord == KeyChord::char('y') || again;
    match dialog {
        Dialog::Quit if yes => Some(ConsoleCommand::Quit),
        Dialog::EndTrial if yes => Some(ConsoleCommand::Input(Event::TrialEnded { reason: EndReason::Wizard })),
        _ => None,
    }
}

/// A report is not closed by a key that was meant for what went before: only by enter, and by the key that quits.
fn report(model: &mut ConsoleModel, code: KeyCode, action: Option<KeyAction>) {
    match (code, action) {
        (KeyCode::Enter, _) | (_, Some(KeyAction::Quit)) => model.dialog = None,
        (_, Some(KeyAction::Look(PanelKey::Back | PanelKey::Last | PanelKey::Earlier))) => {
            model.help_from = model.help_from.saturating_sub(1)
        }
        (_, Some(KeyAction::Look(PanelKey::Forward | PanelKey::Next | PanelKey::Later))) => {
            model.help_from = (model.help_from + 1).min(report_rest(model));
        }
        _ => {}
    }
}

/// Sends the signal of the offer that the wizard has read.
fn accept(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    match offers::enter(session, model.now) {
        Ok((offer, event)) => {
            let words = format!("sent: {}", offer.signal().map_or(String::new(), wording::signal));
            send(model, session, event, NoticeLevel::Done, &words)
        }
        Err(reason) => {
            model.say(NoticeLevel::Refused, format!("not sent: {reason}"));
            None
        }
    }
}

fn act(model: &mut ConsoleModel, session: &Session, action: KeyAction) -> Option<ConsoleCommand> {
    match action {
        KeyAction::Signal(_, signal) => {
            let words = format!("shown: {}", wording::signal(&signal));
            send(
                model,
                session,
                Event::SignalShown { by: Sender::Wizard, signal, accepted: None, offer: None },
                NoticeLevel::Done,
                &words,
            )
        }
        KeyAction::Accept => accept(model, session),
        KeyAction::Press(button) => {
            let why = wording::no_effect(&session.kitchen, session.state, button).unwrap_or_default();
            let button = session.kitchen.button(Agent::Human, button).name.clone();
            send(model, session, Event::Press { agent: Agent::Human, button, at_ns: None }, NoticeLevel::Refused, &why)
        }
        KeyAction::TakeBack => {
            send(model, session, Event::SignalEnded { reason: SignalEnd::TakenBack }, NoticeLevel::Done, "taken back")
        }
        KeyAction::Note(index) => {
            let note = session.spec.console.notes.get(index)?.clone();
            let words = format!("marked: {note}");
            send(model, session, Event::Marker { note }, NoticeLevel::Done, &words)
        }
        KeyAction::Advance => advance(model, session),
        KeyAction::ResumeRobot => resume_robot(model, session),
        KeyAction::EndTrial => match session.phase {
            Phase::Running | Phase::Paused => {
                model.dialog = Some(Dialog::EndTrial);
                None
            }
            _ => {
                model.say(NoticeLevel::Refused, "there is no trial to end");
                None
            }
        },
        KeyAction::Hand(hand) => hands::act(model, session, hand),
        KeyAction::SwitchLayer => {
            let (layer, words) = match model.layer {
                KeyLayer::Wizard => (KeyLayer::Participant, "from now on, keys press the participant's buttons"),
                KeyLayer::Participant => (KeyLayer::Wizard, "from now on, keys send the wizard's signals"),
            };
            model.layer = layer;
            model.say(NoticeLevel::Done, words);
            None
        }
        KeyAction::Look(at) => {
            panels::look(model, session, at);
            None
        }
        KeyAction::Belief if session.spec.console.visibility < Visibility::Belief => {
            model.say(NoticeLevel::Refused, "the belief is not shown in this session");
            None
        }
        KeyAction::Belief => {
            let ranked: Vec<AspectId> = beliefs(session, model).iter().map(|belief| belief.aspect).collect();
            if ranked.is_empty() {
                model.say(NoticeLevel::Refused, "the belief is estimated from the trial's start on");
            }
            model.focus_next_belief(&ranked);
            None
        }
        KeyAction::Differ(step) => {
            differ(model, session, step);
            None
        }
        KeyAction::Rate(rate) => coding::act(model, session, rate),
        KeyAction::Help => {
            (model.dialog, model.help_from) = (Some(Dialog::Help), 0);
            None
        }
        KeyAction::Quit if model.playback.is_some() || session.phase == Phase::Closed => Some(ConsoleCommand::Quit),
        KeyAction::Quit => {
            model.dialog = Some(Dialog::Quit);
            None
        }
        KeyAction::StopRobot | KeyAction::Move(_) => None,
    }
}

/// Another difference between wizard and assistant, or what each knew at this one.
fn differ(model: &mut ConsoleModel, session: &Session, step: ComparisonKey) {
    let Some(compared) = &mut model.comparison else { return };
    compared.choose(step);
    match compared.chosen() {
        None => model.say(NoticeLevel::Refused, "they do not differ yet"),
        Some((at, seen)) if step == ComparisonKey::Open => {
            model.dialog = Some(Dialog::Difference(seen.opened(&session.kitchen, &seen.differences[at])));
        }
        Some(_) => {}
    }
}

fn advance(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let (event, words) = match session.phase {
        Phase::Ready => return preflight::start(model, session),
        Phase::Running => (Event::TrialPaused, "paused"),
        Phase::Paused => (Event::TrialResumed, "the trial runs"),
        Phase::Over(_) => return form::leave(model, session),
        Phase::Closed => {
            model.say(NoticeLevel::Refused, "the session is over");
            return None;
        }
    };
    send(model, session, event, NoticeLevel::Done, words)
}

/// A key without a meaning here: says so if it has one in the other layer.
fn unknown(model: &mut ConsoleModel, session: &Session, code: KeyCode) {
    let KeyCode::Char(key) = code else { return };
    let other = if model.layer == KeyLayer::Wizard { KeyLayer::Participant } else { KeyLayer::Wizard };
    let chord = KeyChord { code, ctrl: false };
    if model.keys.find(other, chord).is_some() {
        let whose = if other == KeyLayer::Wizard { "wizard" } else { "participant" };
        model.say(NoticeLevel::Refused, format!("\"{key}\" is a key of the {whose}: switch with tab"));
    } else if (model.playback.is_none() || model.coding.is_some()) && session.phase != Phase::Closed {
        model.say(NoticeLevel::Refused, format!("\"{key}\" has no meaning: ? shows the keys"));
    }
}
