//! The mouse at the console: the pointer as simulated gaze, clicks on what the view marks as clickable, and the wheel.
//! A click takes the same way through the program as the key with the same action.

use crossterm::event::KeyCode;

use super::arrange::KitchenMap;
use super::chord::KeyChord;
use super::click::ClickAction;
use super::click_question;
use super::coding;
use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog};
use super::form::sheet;
use super::held_keys::{ANSWER_S, KeyPressKind};
use super::key_action::{KeyAction, KeyLayer, RaterAction};
use super::key_press::press;
use super::map_items::KitchenMapElement;
use super::notice::NoticeLevel;
use super::palette;
use super::panel::Panel;
use super::panels;
use super::playback::ReplayAction;
use super::view::click_targets;
use super::view::regions::PanelAreas;
use tomcom_core::kitchen::{Agent, ButtonAction as Use, ButtonId, LocationId};
use tomcom_session::Session;

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
            palette::open(model, session, filter);
            None
        }
        Some(ClickAction::Belief(aspect)) => {
            model.focus_belief(Some(aspect));
            None
        }
        Some(ClickAction::Error(index)) => coding::go_to(model, index),
        Some(ClickAction::Seek(time)) => Some(ConsoleCommand::Move(ReplayAction::ToTime(time))),
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
    if let Some(Dialog::Send(question)) = &model.dialog
        && question.chord == chord
    {
        let question = question.clone();
        let is_double = now.secs_since(question.asked) < DOUBLE_CLICK_S;
        return if is_double { None } else { click_question::confirm(model, session, question) };
    }
    let action = model.keys.find(model.layer, chord).map(|line| line.action.clone());
    let asks = matches!(model.dialog, None | Some(Dialog::Send(_))) && !session.spec.console.click_sends;
    if let Some(action @ (KeyAction::Signal(..) | KeyAction::Accept)) = action.filter(|_| asks) {
        click_question::ask(model, session, chord, &action);
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
    if regions.kitchen_inside().contains(cell.into()) {
        let plan = map(model, session, &regions);
        let thing = plan.spots.iter().find(|spot| spot.cells.contains(cell.into())).map(|spot| spot.thing);
        if let Some(KitchenMapElement::Location(location)) = thing {
            return tell(model, session, location);
        }
    }
    match (model.alone, panel_at(&regions, cell)) {
        (Some(_), _) => model.focus_belief(None),
        (None, panel) => model.alone = panel,
    }
}

/// Shows the key of a kitchen location and what the key does.
fn tell(model: &mut ConsoleModel, session: &Session, location: LocationId) {
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

/// The panel of the console under a screen cell.
fn panel_at(regions: &PanelAreas, cell: (u16, u16)) -> Option<Panel> {
    Panel::ALL.into_iter().find(|panel| regions.panel_area(*panel).contains(cell.into()))
}
