//! What happened, in words: the last presses with the reasons of errors, and the list of all events.

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize, top};
use super::theme::TextRole;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyLayer;
use crate::console::text_columns::width;
use ratatui::layout::Rect;
use tomcom_core::kitchen::Agent;
use tomcom_session::history::event_words;
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent};

/// Columns of the time on the trial's clock, and of the name of whoever acted: the longest is "assistant".
const CLOCK: u16 = 7;
const WHO: u16 = 10;
/// Columns of the labels of panels that are lines, on small terminals.
const LABEL: u16 = 10;

/// Draws the last presses, the newest first.
pub fn draw_presses(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.presses;
    if area.area() == 0 {
        return;
    }
    let inside = match regions.screen_size {
        ScreenSize::Small => {
            brush.text(area.x, area.y, LABEL, " presses", TextRole::Quiet);
            // The clock is right-aligned in columns that include the gap before it.
            Rect { x: area.x + LABEL - 1, width: area.width.saturating_sub(LABEL - 1), ..area }
        }
        _ => brush.panel(area, "Last presses", &hidden(model, "newest first")),
    };
    let is_press = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { .. });
    rows(brush, inside, session, model, is_press);
}

/// Draws the list of events, the newest first; without the presses where their own panel has them.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    if regions.events.area() == 0 {
        return;
    }
    let (has_presses, title) = match regions.presses.area() {
        0 => (true, "Events"),
        _ => (false, "Other events"),
    };
    let inside = brush.panel(regions.events, title, &hidden(model, "newest event first"));
    let is_listed = |what: &TimelineEvent| has_presses || !matches!(what, TimelineEvent::Press { .. });
    rows(brush, inside, session, model, is_listed);
}

fn hidden(model: &ConsoleModel, newest: &str) -> String {
    match model.events_back {
        0 => newest.to_string(),
        back => format!("{back} newer events hidden"),
    }
}

fn rows(
    brush: &mut Painter,
    inside: Rect,
    session: &Session,
    model: &ConsoleModel,
    is_listed: impl Fn(&TimelineEvent) -> bool,
) {
    let newest = session.timeline.iter().rev().skip(model.events_back).filter(|entry| is_listed(&entry.what));
    let mut room = inside;
    for entry in newest {
        if room.height == 0 {
            return;
        }
        (_, room) = top(room, row(brush, room, session, model, entry));
    }
}

/// Draws an entry in the first lines; returns the number of lines, two if the reason of an error needs one of its own.
fn row(brush: &mut Painter, line: Rect, session: &Session, model: &ConsoleModel, entry: &TimelineEntry) -> u16 {
    let at = session.trial_clock(model.now) - session.age(entry.time, model.now);
    // Who reads a recording asks what came first within a second.
    let (clock, at) = match model.playback.is_some() && model.lesson.is_none() {
        true => (CLOCK + 1, at.with_tenths()),
        false => (CLOCK, at.to_string()),
    };
    let (who, what) = event_words::happening(&session.kitchen, &entry.what);
    let role = match &entry.what {
        TimelineEvent::Press { agent: Agent::Human, .. } => TextRole::Human,
        TimelineEvent::Press { agent: Agent::Robot, .. } => TextRole::Robot,
        TimelineEvent::Noted(Event::SignalShown { .. } | Event::SignalEnded { .. }) => TextRole::Signal,
        TimelineEvent::Noted(Event::RobotStopped | Event::RobotSafety { .. } | Event::RobotStage { .. }) => {
            TextRole::Alarm
        }
        TimelineEvent::Noted(Event::RobotTouched { .. }) => TextRole::Robot,
        _ => TextRole::Strong,
    };
    brush.text_right(line.x + clock - 1, line.y, clock - 1, &at, TextRole::Quiet);
    let x = line.x + clock;
    brush.text(x, line.y, WHO - 1, who, role);
    let x = x + WHO;
    let columns = line.right().saturating_sub(x + 1);
    // The reason of an error tells a recipe, which whoever plays the participant at this keyboard has to remember.
    let Some(error) = model.error(entry).filter(|_| model.layer == KeyLayer::Wizard) else {
        brush.text(x, line.y, columns, &what, TextRole::Text);
        return 1;
    };
    // The reason has priority over what the press took or made, and says why a press had no effect.
    let mark = format!("{} ", brush.theme.signs().error);
    let is_told = matches!(entry.what, TimelineEvent::Press { no_effect: Some(_), .. });
    let whole = if is_told { error.press.clone() } else { what };
    let fits = |pressed: &str| width(&mark) + width(pressed) + 2 + width(&error.why) <= columns;
    let pressed: &str = if fits(&whole) { &whole } else { &error.press };
    let gap = if pressed.contains(':') { "; " } else { ": " };
    let parts = [(mark.as_str(), TextRole::Strong), (pressed, TextRole::Text), (gap, TextRole::Quiet)];
    let end = brush.parts(x, line.y, columns, &parts);
    brush.styled(x, line.y, 1, brush.theme.signs().error, brush.theme.badge(TextRole::Strong));
    if fits(pressed) || line.height < 2 {
        brush.text(end, line.y, (x + columns).saturating_sub(end), &error.why, TextRole::Strong);
        return 1;
    }
    let x = line.x + clock;
    brush.text(x, line.y + 1, line.right().saturating_sub(x + 1), &error.why, TextRole::Strong);
    2
}
