//! Panel navigation: a single panel at full size, and scrolling back in time. Neither affects the participant;
//! [`super::screen`] records what the wizard's screen shows.

use super::beliefs::visibility;
use super::console_model::ConsoleModel;
use super::key_action::ViewAction;
use super::panel::Panel;
use super::view::help::help_pages;
use tomcom_session::Session;

/// One scroll step: seconds in the timeline, entries in the list of events.
const STEP: (u32, usize) = (5, 1);

/// Carries out a key that changes which panels or which time the screen shows.
pub fn look(model: &mut ConsoleModel, session: &Session, look: ViewAction) {
    let visibility = visibility(session, model);
    let may_be_seen = |panel: &Panel| panel.may_be_seen(visibility, model.comparison.is_some());
    let seen: Vec<Panel> = Panel::ALL.into_iter().filter(may_be_seen).collect();
    let at = model.alone.and_then(|alone| seen.iter().position(|panel| *panel == alone));
    match look {
        ViewAction::All => {
            (model.alone, model.events_back, model.timeline_back_s) = (None, 0, 0);
            model.belief_focus = None;
            if let Some(coding) = &mut model.coding {
                coding.chosen = None;
            }
        }
        ViewAction::Next => model.alone = seen.get(at.map_or(0, |at| at + 1)).copied(),
        ViewAction::Last => {
            let before = at.map_or(Some(seen.len() - 1), |at| at.checked_sub(1));
            model.alone = before.and_then(|before| seen.get(before)).copied();
        }
        ViewAction::Back => scroll(model, session, model.alone, 1),
        ViewAction::Forward => scroll(model, session, model.alone, -1),
        ViewAction::Earlier => scroll(model, session, Some(Panel::Timeline), 1),
        ViewAction::Later => scroll(model, session, Some(Panel::Timeline), -1),
    }
}

/// Turns the pages of the help.
pub fn leaf(model: &mut ConsoleModel, look: ViewAction) {
    let is_forward = matches!(look, ViewAction::Next | ViewAction::Forward | ViewAction::Later);
    model.help_from = match is_forward {
        true => (model.help_from + 1).min(help_pages(model)),
        false => model.help_from.saturating_sub(1),
    };
}

/// Scrolls a panel that has a time axis, or else the list of events if it is visible.
pub(super) fn scroll(model: &mut ConsoleModel, session: &Session, panel: Option<Panel>, steps: i64) {
    if matches!(panel, Some(Panel::Timeline | Panel::Comparison)) {
        let back_s = i64::from(model.timeline_back_s) + steps * i64::from(STEP.0);
        let most_s = model.now.secs_since(session.trial_start).max(0.0) as i64;
        model.timeline_back_s = back_s.clamp(0, most_s) as u32;
    } else if matches!(model.alone, None | Some(Panel::Events)) {
        let back = model.events_back as i64 + steps * STEP.1 as i64;
        model.events_back = back.clamp(0, session.timeline.len().saturating_sub(1) as i64) as usize;
    }
}
