//! Actions of the console: what each entry of the key table does.

use super::beliefs::{beliefs, visibility};
use super::coding;
use super::compared::ComparisonAction;
use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog};
use super::form;
use super::hands;
use super::held_keys::is_right_after_list;
use super::key_action::{KeyAction, KeyLayer};
use super::notice::NoticeLevel;
use super::palette;
use super::panel::Panel;
use super::panels;
use super::possible::effects;
use super::preflight;
use super::sending::{resume_robot, send};
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_session::event::SignalEndReason;
use tomcom_session::history::wording;
use tomcom_session::offers;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Event, Session, TrialPhase};

/// Sends the signal of the open offer to the participant.
fn accept(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    if is_right_after_list(model) {
        model.say(NoticeLevel::Refused, "signal not sent: enter came right after a list closed; press it again");
        return None;
    }
    match offers::enter(session, model.now) {
        Ok((offer, event)) => {
            let words = format!("signal sent: {}", offer.signal().map_or(String::new(), wording::signal));
            send(model, session, event, NoticeLevel::Done, &words)
        }
        Err(reason) => {
            model.say(NoticeLevel::Refused, format!("signal not sent: {reason}"));
            None
        }
    }
}

/// Carries out the action of a key at the console.
pub(super) fn act(model: &mut ConsoleModel, session: &Session, action: KeyAction) -> Option<ConsoleCommand> {
    match action {
        KeyAction::Signal(_, signal) => {
            let words = format!("signal sent: {}", wording::signal(&signal));
            send(
                model,
                session,
                Event::SignalShown { by: Sender::Wizard, signal, offer: None },
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
        KeyAction::TakeBack => send(
            model,
            session,
            Event::SignalEnded { reason: SignalEndReason::TakenBack },
            NoticeLevel::Done,
            "the signal is taken back",
        ),
        KeyAction::Note(index) => {
            let note = session.spec.console.notes.get(index)?.clone();
            let words = format!("note recorded: {note}");
            send(model, session, Event::Marker { note }, NoticeLevel::Done, &words)
        }
        KeyAction::Advance => advance(model, session),
        KeyAction::ResumeRobot => resume_robot(model, session),
        KeyAction::EndTrial => match session.phase {
            TrialPhase::Running | TrialPhase::Paused => {
                model.dialog = Some(Dialog::EndTrial);
                None
            }
            _ => {
                model.say(NoticeLevel::Refused, "no trial runs that could be ended");
                None
            }
        },
        KeyAction::Hand(hand) => hands::act(model, session, hand),
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
        KeyAction::Look(at) => {
            panels::look(model, session, at);
            None
        }
        KeyAction::Belief if visibility(session, model) < WizardVisibility::Belief => {
            model.say(NoticeLevel::Refused, "beliefs are not shown in this session");
            None
        }
        KeyAction::Belief => {
            let ranked: Vec<AspectId> = beliefs(session, model).iter().map(|belief| belief.aspect).collect();
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
            (model.dialog, model.help_from) = (Some(Dialog::Help(effects(session, model))), 0);
            None
        }
        KeyAction::Palette => {
            palette::open(model, session, "");
            None
        }
        // A replay can be left without a question, for nothing is lost, and a rater's codes are saved after every key;
        // a wizard training asks first.
        KeyAction::Quit if model.playback.is_some() && model.lesson.is_none() => Some(ConsoleCommand::Quit),
        KeyAction::Quit if session.phase == TrialPhase::Closed => Some(ConsoleCommand::Quit),
        KeyAction::Quit => {
            model.dialog = Some(Dialog::Quit);
            None
        }
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
            model.dialog = Some(Dialog::Difference(seen.opened(&session.kitchen, &seen.differences[at])));
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
        TrialPhase::Closed => {
            model.say(NoticeLevel::Refused, "the session is over");
            return None;
        }
    };
    send(model, session, event, NoticeLevel::Done, words)
}
