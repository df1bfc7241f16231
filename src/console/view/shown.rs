//! Panel of the participant's side: the signal on the display, its content and its remaining time.

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyAction;
use crate::console::text_columns::{width, wrap};
use tomcom_core::communication::Signal;
use tomcom_session::history::wording;
use tomcom_session::{Session, ShownSignal, TrialPhase, proposals};

/// Draws the panel that tells which signal the participant sees now.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.shown;
    if area.area() == 0 {
        return;
    }
    if regions.room == ScreenSize::Small {
        brush.parts(area.x, area.y, area.width, &[(" display  ", TextRole::Quiet)]);
        line(brush, area.x + 10, area.y, area.width.saturating_sub(11), session, model);
        return;
    }
    let back = model.keys.chord_for(&KeyAction::TakeBack).map(|key| format!("{key} takes the signal back"));
    let remark = session.shown.as_ref().and(back).unwrap_or_default();
    let inside = brush.panel(area, "On the participant's display", &remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    line(brush, x, inside.y, columns, session, model);
    if let Some(shown) = &session.shown {
        let style = brush.style(TextRole::Text);
        for (row, text) in wrap(&says(session, &shown.signal), columns).iter().take(2).enumerate() {
            brush.text(x, inside.y + 1 + row as u16, columns, text, style);
        }
    }
}

/// Draws the present signal with its remaining time in one line.
fn line(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, model: &ConsoleModel) {
    let start = model.keys.chord_for(&KeyAction::Advance).filter(|_| session.phase == TrialPhase::Ready);
    if let Some(key) = start {
        let key = key.to_string();
        let parts = [("press ", TextRole::Strong), (&key, TextRole::Signal), (" to start the trial", TextRole::Strong)];
        brush.parts(x, y, columns, &parts);
        return;
    }
    let Some(shown) = &session.shown else {
        brush.parts(x, y, columns, &[("no signal, only the kitchen", TextRole::Quiet)]);
        return;
    };
    let title = match (&shown.signal, columns > 60) {
        (Signal::ShowRecipe(_), true) => says(session, &shown.signal),
        _ => wording::signal(&shown.signal),
    };
    let (left_s, share) = left(session, shown, model);
    let bar = if columns < 44 { 4 } else { 8 };
    let room = columns.saturating_sub(bar + 7);
    let end = brush.parts(x, y, room, &[(&title, TextRole::Signal)]);
    let by = format!(" by {}", wording::sender(shown.by));
    if end + width(&by) <= x + room {
        brush.parts(end, y, room, &[(&by, TextRole::Quiet)]);
    }
    let at = brush.bar(x + columns - bar - 6, y, bar, share, TextRole::Signal);
    brush.parts(at, y, 6, &[(&format!(" {left_s:>3.1} s"), TextRole::Text)]);
}

/// Remaining time of a signal in seconds, and as a share of its duration.
fn left(session: &Session, shown: &ShownSignal, model: &ConsoleModel) -> (f64, f64) {
    let now = if session.is_running() { model.now } else { session.paused_at };
    let left_s = shown.until.secs_since(now);
    (left_s, left_s / shown.until.secs_since(shown.since).max(1e-3))
}

/// Content of the signal that the participant sees, in words.
fn says(session: &Session, signal: &Signal) -> String {
    let kitchen = &session.kitchen;
    let Some(location) = signal.location(kitchen) else {
        // Of proposed presses, only those that the participant has not made yet are shown.
        return proposals::left(session)
            .map_or(String::new(), |left| format!("proposed next: {}", wording::proposal(left)));
    };
    let content = kitchen.content_label(session.state, location);
    match signal {
        Signal::ShowRecipe(_) => match wording::recipe(session, location) {
            Some(recipe) => format!("{content} = {recipe}"),
            None => format!("{}: {content}", kitchen.location(location).label()),
        },
        Signal::Highlight(_) | Signal::Propose(_) => {
            format!("highlight: {} holds {content}", kitchen.location(location).label())
        }
    }
}
