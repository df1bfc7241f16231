//! Panel navigation by keys and mouse: a single panel at full size, and scrolling back in time. It does not affect the participant;
//! [`super::screen`] records what the wizard's screen shows.

use super::arrange::{KitchenMap, MapElement};
use super::console_model::{ConsoleModel, Dialog};
use super::key_action::KeyLayer;
use super::key_action::PanelKey;
use super::notice::NoticeLevel;
use super::panel::Panel;
use super::view::dialog::help_pages;
use super::view::regions::Regions;
use crate::kitchen::{Agent, ButtonAction as Use, ButtonId, LocationId};
use crate::session::Session;
use crate::session::settings::ParticipantKind;

/// One scroll step: in the timeline in seconds, in the list of events in lines.
const STEP: (u32, usize) = (5, 1);

/// Carries out a panel key.
pub fn look(model: &mut ConsoleModel, session: &Session, look: PanelKey) {
    let visibility = session.spec.console.visibility;
    let may_be_seen = |panel: &Panel| panel.may_be_seen(visibility, model.comparison.is_some());
    let seen: Vec<Panel> = Panel::ALL.into_iter().filter(may_be_seen).collect();
    let at = model.alone.and_then(|alone| seen.iter().position(|panel| *panel == alone));
    match look {
        PanelKey::All => {
            (model.alone, model.events_back, model.timeline_back_s) = (None, 0, 0);
            model.belief_focus = None;
            if let Some(coding) = &mut model.coding {
                coding.chosen = None;
            }
        }
        PanelKey::Next => model.alone = seen.get(at.map_or(0, |at| at + 1)).copied(),
        PanelKey::Last => {
            let before = at.map_or(Some(seen.len() - 1), |at| at.checked_sub(1));
            model.alone = before.and_then(|before| seen.get(before)).copied();
        }
        PanelKey::Back => scroll(model, session, model.alone, 1),
        PanelKey::Forward => scroll(model, session, model.alone, -1),
        PanelKey::Earlier => scroll(model, session, Some(Panel::Timeline), 1),
        PanelKey::Later => scroll(model, session, Some(Panel::Timeline), -1),
    }
}

/// Turns the pages of the help.
pub fn leaf(model: &mut ConsoleModel, look: PanelKey) {
    let is_forward = matches!(look, PanelKey::Next | PanelKey::Forward | PanelKey::Later);
    model.help_from = match is_forward {
        true => (model.help_from + 1).min(help_pages(model)),
        false => model.help_from.saturating_sub(1),
    };
}

/// Scrolls a panel with a time axis, or else the list of events if it is visible.
fn scroll(model: &mut ConsoleModel, session: &Session, panel: Option<Panel>, steps: i64) {
    if matches!(panel, Some(Panel::Timeline | Panel::Comparison)) {
        let back_s = i64::from(model.timeline_back_s) + steps * i64::from(STEP.0);
        let most_s = model.now.secs_since(session.trial_start).max(0.0) as i64;
        model.timeline_back_s = back_s.clamp(0, most_s) as u32;
    } else if matches!(model.alone, None | Some(Panel::Events)) {
        let back = model.events_back as i64 + steps * STEP.1 as i64;
        model.events_back = back.clamp(0, session.timeline.len().saturating_sub(1) as i64) as usize;
    }
}

/// Handles the mouse wheel over a cell.
pub fn wheel(model: &mut ConsoleModel, session: &Session, cell: (u16, u16), steps: i64) {
    if model.dialog == Some(Dialog::Help) {
        leaf(model, if steps > 0 { PanelKey::Back } else { PanelKey::Forward });
        return;
    }
    let regions = Regions::showing(model.size, session, model);
    scroll(model, session, panel_at(&regions, cell), steps);
}

/// Handles a click: on a place it explains the place's key (a click never sends a signal), elsewhere it shows the panel at full
/// size, or all panels again.
pub fn click(model: &mut ConsoleModel, session: &Session, cell: (u16, u16)) {
    if model.dialog.is_some() {
        return;
    }
    let regions = Regions::showing(model.size, session, model);
    if regions.kitchen_inside().contains(cell.into()) {
        let with_keys = session.spec.participant.kind == ParticipantKind::Keyboard;
        let plan = KitchenMap::new(&session.kitchen, regions.kitchen_inside(), with_keys);
        let thing = plan.spots.iter().find(|spot| spot.cells.contains(cell.into())).map(|spot| spot.thing);
        if let Some(MapElement::Location(location)) = thing {
            return tell(model, session, location);
        }
    }
    match (model.alone, panel_at(&regions, cell)) {
        (Some(_), _) => model.alone = None,
        (None, panel) => model.alone = panel,
    }
}

/// Shows the key of a location and its meaning.
fn tell(model: &mut ConsoleModel, session: &Session, location: LocationId) {
    let is_main = |action| matches!(action, Use::Use(at) | Use::Serve(at) if at == location);
    let buttons = &session.kitchen.buttons[Agent::Human.index()];
    let line = model.keys.bindings.iter().find(|line| match (&line.action, model.layer) {
        (super::key_action::KeyAction::Signal(about, _), KeyLayer::Wizard) => *about == location,
        (super::key_action::KeyAction::Press(ButtonId(button)), KeyLayer::Participant) => {
            is_main(buttons[usize::from(*button)].action)
        }
        _ => false,
    });
    let told = line.and_then(|line| Some(format!("{}: {}", line.chords.first()?, line.help)));
    let label = session.kitchen.location(location).label();
    model.say(NoticeLevel::Done, told.unwrap_or_else(|| format!("{label}: no key is about it")));
}

/// The panel under a cell.
fn panel_at(regions: &Regions, cell: (u16, u16)) -> Option<Panel> {
    Panel::ALL.into_iter().find(|panel| regions.panel_area(*panel).contains(cell.into()))
}
