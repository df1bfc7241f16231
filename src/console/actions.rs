//! Messages to the console and what each entry of the key table does: events for the session, or why it rejects them.

use super::beliefs::{beliefs, visibility};
use super::console_model::{ComparisonAction, ConsoleCommand, ConsoleMessage, ConsoleModel, Dialog, NoticeLevel};
use super::key_action::{KeyAction, KeyLayer, ManualAction, ViewAction};
use super::key_press::{self, is_right_after_list};
use super::panels::{self, Panel};
use super::possible::effects;
use super::{coding, form, interventions, lists, mouse, preflight, text_input};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_session::admit::{admit, hygiene};
use tomcom_session::event::SignalEndReason;
use tomcom_session::history::wording;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Event, Session, TrialPhase, offers};

/// Sends the signal of the open offer to the participant.
fn accept(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    if is_right_after_list(model) {
        return refuse(model, "signal not sent: enter came right after a list closed; press it again");
    }
    match offers::enter(session, model.now) {
        Ok((offer, event)) => {
            let words = format!("signal sent: {}", offer.signal().map_or(String::new(), wording::signal));
            send(model, session, event, words)
        }
        Err(reason) => refuse(model, format!("signal not sent: {reason}")),
    }
}

pub(super) fn act(model: &mut ConsoleModel, session: &Session, action: KeyAction) -> Option<ConsoleCommand> {
    match action {
        KeyAction::Signal(_, signal) => {
            let words = format!("signal sent: {}", wording::signal(&signal));
            send(model, session, shown(signal), words)
        }
        KeyAction::Accept => accept(model, session),
        KeyAction::Press(button) => {
            let why = wording::no_effect(&session.kitchen, session.state, button).unwrap_or_default();
            let button = session.kitchen.button(Agent::Human, button).name.clone();
            let event = Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false };
            send_telling(model, session, event, NoticeLevel::Refused, why)
        }
        KeyAction::TakeBack => {
            let event = Event::SignalEnded { reason: SignalEndReason::TakenBack };
            send(model, session, event, "the signal is taken back")
        }
        KeyAction::Note(_) if !preset_notes(session) => {
            let key = model.keys.chord_for(&KeyAction::Manual(ManualAction::NoteInWords));
            let types = key.map_or(String::new(), |key| format!("; {key} types one"));
            refuse(model, format!("after a trial of a plan a digit is no note{types}"))
        }
        KeyAction::Note(index) => {
            let note = session.spec.console.notes.get(index)?.clone();
            let words = format!("note recorded: {note}");
            send(model, session, Event::Marker { note, observer: None }, words)
        }
        KeyAction::Advance => advance(model, session),
        KeyAction::ResumeRobot => resume_robot(model, session),
        KeyAction::EndTrial => match session.phase {
            TrialPhase::Running | TrialPhase::Paused => open_dialog(model, Dialog::EndTrial),
            _ => refuse(model, "no trial runs that could be ended"),
        },
        KeyAction::Manual(action) => interventions::act(model, session, action),
        KeyAction::SwitchLayer => {
            let (layer, words) = match model.layer {
                KeyLayer::Wizard => (KeyLayer::Participant, "keys now press the participant's buttons"),
                KeyLayer::Participant => (KeyLayer::Wizard, "keys now send the wizard's signals"),
            };
            model.layer = layer;
            let may_be_seen = |panel: &Panel| panel.may_be_seen(visibility(session, model), model.comparison.is_some());
            model.alone = model.alone.filter(may_be_seen);
            model.say(NoticeLevel::Done, words);
            None
        }
        KeyAction::Look(ViewAction::All) if !panels::is_away(model) => act(model, session, KeyAction::Quit),
        KeyAction::Look(at) => {
            panels::look(model, session, at);
            None
        }
        KeyAction::Belief if visibility(session, model) < WizardVisibility::Belief => {
            refuse(model, "beliefs are not shown in this session")
        }
        KeyAction::Belief => {
            let mut ranked = beliefs(session, model);
            // A replay that stands at the beginning of a false belief opens that one.
            if model.playback.is_some() {
                ranked.sort_by_key(|belief| belief.since != Some(model.now));
            }
            let ranked: Vec<AspectId> = ranked.iter().map(|belief| belief.aspect).collect();
            if ranked.is_empty() {
                model.say(NoticeLevel::Refused, "beliefs are estimated only after the trial's start");
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
            model.help_from = 0;
            open_dialog(model, Dialog::Help(effects(session, model)))
        }
        KeyAction::Palette => {
            lists::open(model, session, "");
            None
        }
        // A replay can be left without a question, for nothing is lost, and a rater's codes are saved after every key;
        // a wizard training asks first.
        KeyAction::Quit if model.playback.is_some() && model.lesson.is_none() => Some(ConsoleCommand::Quit),
        KeyAction::Quit if session.phase == TrialPhase::Closed => Some(ConsoleCommand::Quit),
        KeyAction::Quit => open_dialog(model, Dialog::Quit),
        KeyAction::StopRobot | KeyAction::Move(_) => None,
    }
}

/// Selects another difference between wizard and assistant, or shows what each of them knew at the selected difference.
pub(super) fn differ(model: &mut ConsoleModel, session: &Session, step: ComparisonAction) {
    let Some(compared) = &mut model.comparison else { return };
    compared.choose(step);
    match compared.chosen() {
        None => model.say(NoticeLevel::Refused, "signals of wizard and assistant do not differ so far"),
        Some((at, seen)) if step == ComparisonAction::Open => {
            let told = seen.opened(&session.kitchen, &seen.differences[at]);
            model.dialog = Some(Dialog::Details("What wizard and assistant knew", told));
        }
        Some(_) => {}
    }
}

fn advance(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let (event, words) = match session.phase {
        TrialPhase::Ready => return preflight::start(model, session),
        TrialPhase::Running => (Event::TrialPaused, "the trial is paused"),
        TrialPhase::Paused => (Event::TrialResumed, "the trial runs"),
        TrialPhase::Over(_) => return form::leave(model, session),
        TrialPhase::Closed => return refuse(model, "the session is over"),
    };
    send(model, session, event, words)
}

/// Whether digits record preset notes now. After a trial of a plan they do not: there a digit that was meant for the
/// questionnaire to come would be a note.
pub(super) fn preset_notes(session: &Session) -> bool {
    session.protocol.is_none() || !matches!(session.phase, TrialPhase::Over(_))
}

/// The event of a signal that the wizard sends without an offer.
pub(super) fn shown(signal: Signal) -> Event {
    Event::SignalShown { by: Sender::Wizard, signal, offer: None }
}

/// Why the session would reject an event now; `None` if it would accept it.
pub(super) fn refusal(session: &Session, now: SessionTime, event: &Event) -> Option<String> {
    admit(session, event).map_err(str::to_string).and_then(|()| hygiene(session, now, event)).err()
}

/// Sends an event if the session accepts it now, and says in these words what is done; else a notice tells the wizard why
/// not.
pub(super) fn send(
    model: &mut ConsoleModel,
    session: &Session,
    event: Event,
    words: impl Into<String>,
) -> Option<ConsoleCommand> {
    send_telling(model, session, event, NoticeLevel::Done, words)
}

/// Sends an event as [`send`] does, with a notice of this level.
pub(super) fn send_telling(
    model: &mut ConsoleModel,
    session: &Session,
    event: Event,
    level: NoticeLevel,
    words: impl Into<String>,
) -> Option<ConsoleCommand> {
    if let Some(reason) = refusal(session, model.now, &event) {
        return refuse(model, reason);
    }
    let words = words.into();
    match words.is_empty() {
        true => model.notice = None,
        false => model.say(level, words),
    }
    Some(ConsoleCommand::Input(event))
}

/// Tells the wizard why a key has no effect now.
pub(super) fn refuse(model: &mut ConsoleModel, reason: impl Into<String>) -> Option<ConsoleCommand> {
    model.say(NoticeLevel::Refused, reason);
    None
}

pub(super) fn open_dialog(model: &mut ConsoleModel, dialog: Dialog) -> Option<ConsoleCommand> {
    model.dialog = Some(dialog);
    None
}

/// Releases the robot after a stop.
pub(super) fn resume_robot(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let words =
        if session.robot.held { "the robot is no longer stopped, but still held" } else { "the robot continues" };
    send(model, session, Event::RobotResumed, words)
}

/// Handles a message to the console at the time `model.now`.
pub fn update(model: &mut ConsoleModel, session: &Session, message: ConsoleMessage) -> Option<ConsoleCommand> {
    mouse::expire(model, session);
    interventions::expire(model, session);
    match message {
        ConsoleMessage::Key(key) => key_press::key(model, session, &key),
        ConsoleMessage::Pointer(column, row) => {
            mouse::point(model, session, (column, row));
            None
        }
        ConsoleMessage::Click(column, row) => mouse::click(model, session, (column, row)),
        ConsoleMessage::Wheel(column, row, steps) => mouse::wheel(model, session, (column, row), i64::from(steps)),
        ConsoleMessage::Resized(columns, rows) => {
            model.size = (columns, rows);
            None
        }
        ConsoleMessage::Paste(text) => text_input::paste(model, session, text.as_deref()),
        ConsoleMessage::Focus(focused) => {
            let changed = std::mem::replace(&mut model.focused, focused) != focused;
            model.pressed = None;
            let event = if focused { Event::FocusRegained } else { Event::FocusLost };
            (changed && session.phase != TrialPhase::Closed).then_some(ConsoleCommand::Input(event))
        }
    }
}
