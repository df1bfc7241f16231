//! Confirmation of mouse clicks that send: a click on a signal or on the offer asks the wizard first, unless the
//! session file says `click_sends = true`.

use crossterm::event::KeyCode;

use super::chord::KeyChord;
use super::click::SendConfirmation;
use super::console_actions::act;
use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog};
use super::key_action::KeyAction;
use super::notice::NoticeLevel;
use super::sending::refusal;
use tomcom_core::communication::offer::Offer;
use tomcom_core::communication::{Sender, Signal};
use tomcom_session::offers;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Event, Session};

/// Asks the wizard whether to send a clicked signal or the clicked offer's signal; or says why the signal cannot be
/// sent.
pub(super) fn ask(model: &mut ConsoleModel, session: &Session, chord: KeyChord, action: &KeyAction) {
    let asked = match action {
        KeyAction::Signal(_, signal) => match refusal(session, model.now, &shown(signal)) {
            None => Ok((signal.clone(), None)),
            Some(reason) => Err(reason),
        },
        _ => offers::enter(session, model.now)
            .and_then(|(offer, _)| Ok((offer.signal().cloned().ok_or("no signal is on offer")?, Some(offer.seq)))),
    };
    match asked {
        Ok((signal, offer)) => {
            model.notice = None;
            model.dialog =
                Some(Dialog::Send(SendConfirmation { chord, signal, offer, asked: model.clock, asked_at: model.now }));
        }
        Err(reason) => model.say(NoticeLevel::Refused, format!("signal not sent: {reason}")),
    }
}

/// Time after which the question whether to send closes, in seconds: a later enter key is probably not an answer to it.
const WAITS_S: f64 = 5.0;

/// Closes the question whether to send a clicked signal once it is too old, or once a newer offer has opened that the
/// wizard sees: from then on, enter accepts that offer. A hidden offer leaves the question open, since a notice would
/// tell a blinded wizard that the assistant recommends something.
pub fn expire(model: &mut ConsoleModel, session: &Session) {
    let Some(Dialog::Send(question)) = &model.dialog else { return };
    let is_late = model.clock.secs_since(question.asked) > WAITS_S;
    // In a training the settings hide offers that the recorded wizard saw.
    let is_shown = session.spec.console.visibility == WizardVisibility::Recommendation;
    let is_newer = |offer: &Offer| offer.opened > question.asked_at && Some(offer.seq) != question.offer;
    let is_other = session.offers.open().is_some_and(|offer| is_shown && offer.advice.visible && is_newer(offer));
    if is_late || is_other {
        let why = if is_late { "the click was not confirmed in time" } else { "another signal is on offer now" };
        model.dialog = None;
        model.say(NoticeLevel::Refused, format!("signal not sent: {why}; click again"));
    }
}

/// A key while the console asks whether to send a clicked signal: enter sends if it is newly pressed (not held), esc
/// cancels.
pub(super) fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    is_press: bool,
) -> Option<ConsoleCommand> {
    match model.dialog.clone() {
        Some(Dialog::Send(question)) if code == KeyCode::Enter && is_press => confirm(model, session, question),
        Some(Dialog::Send(_)) if code == KeyCode::Esc => {
            model.dialog = None;
            None
        }
        _ => None,
    }
}

/// Sends the clicked signal. After a click on an offer, nothing is sent if that offer has closed meanwhile.
pub(super) fn confirm(
    model: &mut ConsoleModel,
    session: &Session,
    question: SendConfirmation,
) -> Option<ConsoleCommand> {
    model.dialog = None;
    let now_meant = offers::enter(session, model.now).ok().map(|(offer, _)| offer.seq);
    match question.offer {
        Some(offer) if now_meant != Some(offer) => {
            model.say(NoticeLevel::Refused, "signal not sent: the clicked offer has closed");
            None
        }
        Some(_) => act(model, session, KeyAction::Accept),
        None => {
            let location = question.signal.location(&session.kitchen)?;
            act(model, session, KeyAction::Signal(location, question.signal))
        }
    }
}

fn shown(signal: &Signal) -> Event {
    Event::SignalShown { by: Sender::Wizard, signal: signal.clone(), offer: None }
}
