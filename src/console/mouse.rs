//! The mouse at the console: the pointer as simulated gaze, clicks on what the view marks as clickable, and the wheel.
//! A click takes the same way through the program as the key with the same action.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::actions::{act, refusal, refuse, shown};
use super::chord::KeyChord;
use super::console_model::{ConsoleCommand, ConsoleModel, Dialog, NoticeLevel, ReplayAction};
use super::form::sheet;
use super::key_action::{KeyAction, KeyLayer, RaterAction};
use super::key_press::{ANSWER_S, KeyPressKind, press};
use super::kitchen_map::{KitchenMap, KitchenMapAreas, KitchenMapElement};
use super::panels::{self, Panel};
use super::view::click_targets;
use super::view::regions::PanelAreas;
use super::{coding, lists};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::offer::Offer;
use tomcom_core::kitchen::{Agent, AspectId, ButtonAction as Use, ButtonId, LocationId};
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Session, offers};

/// Longest time between the two clicks of a double click, in seconds: the second click of a double click does not
/// confirm a question.
const DOUBLE_CLICK_S: f64 = 0.25;

/// Remembers the point of the wall display under the mouse pointer, which can stand for the participant's gaze.
pub(super) fn point(model: &mut ConsoleModel, session: &Session, (column, row): (u16, u16)) {
    let regions = PanelAreas::showing(model.size, session, model);
    model.pointer = Some(map(model, session, &regions).display_point(column, row));
}

fn map(model: &ConsoleModel, session: &Session, regions: &PanelAreas) -> KitchenMap {
    KitchenMap::for_session(session, model.coding.is_some(), regions.kitchen_inside())
}

/// Handles a click: on a click target, does what its key does; on a place of the kitchen, tells the place's key;
/// elsewhere, shows the panel at full size, or all panels again.
pub(super) fn click(model: &mut ConsoleModel, session: &Session, cell: (u16, u16)) -> Option<ConsoleCommand> {
    // A click that only gives this window the keyboard focus has no other effect.
    if !model.focused {
        return None;
    }
    model.forget_notice();
    let targets = click_targets(session, model);
    // Of overlapping click targets, the one that was drawn last counts.
    let target = targets.iter().rev().find(|target| target.cells.contains(cell.into()));
    match target.map(|target| target.action) {
        Some(ClickAction::Key(chord)) => key(model, session, chord),
        Some(ClickAction::Row(row)) => choose(model, session, row),
        Some(ClickAction::Palette(filter)) => {
            lists::open(model, session, filter);
            None
        }
        Some(ClickAction::Belief(aspect)) => {
            model.focus_belief(Some(aspect));
            None
        }
        Some(ClickAction::Error(index)) => coding::go_to(model, index),
        Some(ClickAction::Seek(to)) => Some(ConsoleCommand::Move(to)),
        None => {
            let is_covered = model.playback.is_none() && sheet(session).is_some();
            if model.dialog.is_none() && !is_covered {
                look(model, session, cell);
            }
            None
        }
    }
}

/// Handles a click that stands for a key. A click on a signal opens the question whether to send it; a second click
/// confirms.
fn key(model: &mut ConsoleModel, session: &Session, chord: KeyChord) -> Option<ConsoleCommand> {
    let now = model.clock;
    if let Some(Dialog::Send(confirmation)) = &model.dialog
        && confirmation.chord == chord
    {
        let confirmation = confirmation.clone();
        let is_double = now.secs_since(confirmation.asked) < DOUBLE_CLICK_S;
        return if is_double { None } else { confirm(model, session, confirmation) };
    }
    let action = model.keys.find(model.layer, chord).map(|line| line.action.clone());
    let asks = matches!(model.dialog, None | Some(Dialog::Send(_))) && !session.spec.console.click_sends;
    if let Some(action @ (KeyAction::Signal(..) | KeyAction::Accept)) = action.filter(|_| asks) {
        ask(model, session, chord, &action);
        return None;
    }
    let last = model.clicked.replace((chord, now));
    let is_again = last.is_some_and(|(last, at)| last == chord && now.secs_since(at) < ANSWER_S);
    press(model, session, chord.code, chord, if is_again { KeyPressKind::Again } else { KeyPressKind::Press })
}

/// Moves the cursor to a row of the open list; chooses the row if the cursor was already there.
fn choose(model: &mut ConsoleModel, session: &Session, row: usize) -> Option<ConsoleCommand> {
    let cursor = match &mut model.dialog {
        Some(Dialog::Pick(picker)) => &mut picker.cursor,
        Some(Dialog::Palette(cursor)) => cursor,
        _ => return None,
    };
    if cursor.at == row {
        return press(model, session, KeyCode::Enter, KeyChord::plain(KeyCode::Enter), KeyPressKind::Press);
    }
    cursor.at = row;
    None
}

/// Handles a click on the panels outside all click targets.
fn look(model: &mut ConsoleModel, session: &Session, cell: (u16, u16)) {
    let regions = PanelAreas::showing(model.size, session, model);
    let KitchenMapAreas { orders, places } = regions.kitchen_inside();
    if orders.contains(cell.into()) || places.contains(cell.into()) {
        let plan = map(model, session, &regions);
        let thing = plan.spots.iter().find(|spot| spot.cells.contains(cell.into())).map(|spot| spot.thing);
        if let Some(KitchenMapElement::Location(location)) = thing {
            return explain_place(model, session, location);
        }
    }
    match (model.alone, panel_at(&regions, cell)) {
        (Some(_), _) => model.focus_belief(None),
        (None, panel) => (model.alone, model.focus) = (panel, panel),
    }
}

/// Shows the key of a kitchen location and what the key does.
fn explain_place(model: &mut ConsoleModel, session: &Session, location: LocationId) {
    let is_main = |action| matches!(action, Use::Use(at) | Use::Serve(at) if at == location);
    let buttons = &session.kitchen.buttons[Agent::Human.index()];
    let line = model.keys.bindings.iter().find(|line| match (&line.action, model.layer) {
        (KeyAction::Signal(about, _) | KeyAction::Rate(RaterAction::Belief(about)), KeyLayer::Wizard) => {
            *about == location
        }
        (KeyAction::Press(ButtonId(button)), KeyLayer::Participant) => is_main(buttons[usize::from(*button)].action),
        _ => false,
    });
    let told = line.and_then(|line| Some(format!("{}: {}", line.chords.first()?, line.help)));
    let label = session.kitchen.location(location).label();
    model.say(NoticeLevel::Done, told.unwrap_or_else(|| format!("{label}: no key belongs to this place")));
}

/// Handles the mouse wheel: in a list or a help text it acts as an arrow key; over a panel it scrolls that panel.
pub(super) fn wheel(
    model: &mut ConsoleModel,
    session: &Session,
    cell: (u16, u16),
    steps: i64,
) -> Option<ConsoleCommand> {
    if matches!(model.dialog, Some(Dialog::Pick(_) | Dialog::Palette(_) | Dialog::Report(_) | Dialog::Help(_))) {
        let arrow = if steps > 0 { KeyCode::Up } else { KeyCode::Down };
        return press(model, session, arrow, KeyChord::plain(arrow), KeyPressKind::Press);
    }
    let regions = PanelAreas::showing(model.size, session, model);
    panels::scroll(model, session, panel_at(&regions, cell), steps);
    None
}

fn panel_at(regions: &PanelAreas, cell: (u16, u16)) -> Option<Panel> {
    Panel::ALL.into_iter().find(|panel| regions.panel_area(*panel).contains(cell.into()))
}

/// Action of a mouse click on the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClickAction {
    Key(KeyChord),
    /// Move the cursor to this row of the open list (counted among the rows that match the filter); choose the row if
    /// the cursor is already there.
    Row(usize),
    /// Open the list of all actions (the palette) with this filter text; for hints that several keys share.
    Palette(&'static str),
    Belief(AspectId),
    /// While a rater codes errors: go to the error with this index in the list.
    Error(usize),
    /// Go to a time of the recording.
    Seek(ReplayAction),
}

/// Screen cells that can be clicked, with the action of a click.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClickTarget {
    pub cells: Rect,
    pub action: ClickAction,
}

/// The question whether to send a clicked signal; the signal is sent once the wizard confirms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SendConfirmation {
    pub chord: KeyChord,
    pub signal: Signal,
    /// Sequence number of the clicked offer; `None` if a signal was clicked that is not on offer.
    pub offer: Option<u64>,
    /// Time of the click, on the console's own clock ([`super::console_model::ConsoleModel::clock`]).
    pub asked: SessionTime,
    /// Session time of the click; in a training the session does not run on the console's clock.
    pub asked_at: SessionTime,
}

/// Asks the wizard whether to send a clicked signal or the clicked offer's signal; or says why the signal cannot be
/// sent.
pub(super) fn ask(model: &mut ConsoleModel, session: &Session, chord: KeyChord, action: &KeyAction) {
    let asked = match action {
        KeyAction::Signal(_, signal) => match refusal(session, model.now, &shown(signal.clone())) {
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
    let Some(Dialog::Send(confirmation)) = &model.dialog else { return };
    let is_late = model.clock.secs_since(confirmation.asked) > WAITS_S;
    // In a training the settings hide offers that the recorded wizard saw.
    let is_shown = session.spec.console.visibility == WizardVisibility::Recommendation;
    let is_newer = |offer: &Offer| offer.opened > confirmation.asked_at && Some(offer.seq) != confirmation.offer;
    let is_other = session.offers.open().is_some_and(|offer| is_shown && offer.advice.visible && is_newer(offer));
    if is_late || is_other {
        let why = if is_late { "the click was not confirmed in time" } else { "another signal is on offer now" };
        model.dialog = None;
        model.say(NoticeLevel::Refused, format!("signal not sent: {why}; click again"));
    }
}

/// Sends the clicked signal. After a click on an offer, nothing is sent if that offer has closed meanwhile.
pub(super) fn confirm(
    model: &mut ConsoleModel,
    session: &Session,
    confirmation: SendConfirmation,
) -> Option<ConsoleCommand> {
    model.dialog = None;
    let now_meant = offers::enter(session, model.now).ok().map(|(offer, _)| offer.seq);
    match confirmation.offer {
        Some(offer) if now_meant != Some(offer) => refuse(model, "signal not sent: the clicked offer has closed"),
        Some(_) => act(model, session, KeyAction::Accept),
        None => {
            let location = confirmation.signal.location(&session.kitchen)?;
            act(model, session, KeyAction::Signal(location, confirmation.signal))
        }
    }
}
