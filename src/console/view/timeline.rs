//! The timeline: one row per kind of event, columns of half a second, the present at the right edge.

use ratatui::layout::Rect;

use super::paint::{Painter, width};
use super::regions::{Regions, ScreenSize};
use super::theme::TextRole;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::console::coding::press;
use crate::console::console_model::ConsoleModel;
use crate::kitchen::Agent;
use crate::session::event::SignalEnd;
use crate::session::{Phase, Session, TimelineEntry, TimelineEvent};

/// Duration of a column, in seconds.
const COLUMN_S: f64 = 0.5;
const LABELS: u16 = 10;
const TITLE: &str = "Timeline";

/// Draws the timeline.
pub fn draw(brush: &mut Painter, regions: &Regions, session: &Session, model: &ConsoleModel) {
    let area = regions.timeline;
    if area.area() == 0 {
        return;
    }
    let is_small = regions.room == ScreenSize::Small;
    let inside = if is_small { area } else { brush.panel(area, &title(session, model), &legend(brush)) };
    let rows: &[&str] = match is_small {
        // Signals, orders and notes share a row.
        true => &["", "human", "robot", "events"],
        false => &["", "human", "robot", "signals", "orders", "notes"],
    };
    let quiet = brush.style(TextRole::Quiet);
    for (row, label) in rows.iter().enumerate() {
        brush.text(inside.x + 1, inside.y + row as u16, LABELS, label, quiet);
    }
    let plot = Rect { x: inside.x + LABELS, width: inside.width.saturating_sub(LABELS + 1), ..inside };
    let back_s = model.timeline_back_s;
    axis(brush, plot, back_s, COLUMN_S);
    let now = column(until(session, model)) - (f64::from(back_s) / COLUMN_S) as i64;
    let newest = session.timeline.iter().rev();
    let entries = newest.map(|entry| (now - column(entry.time), entry));
    let in_view: Vec<Mark> = entries
        .skip_while(|(age, _)| *age < 0)
        .take_while(|(age, _)| *age < i64::from(plot.width))
        .filter_map(|(age, entry)| {
            let (row, sign, role) = mark(brush, session, model, entry)?;
            let row = if is_small { row.min(3) } else { row };
            Some(Mark { x: plot.right() - 1 - age.max(0) as u16, y: plot.y + row, sign, role })
        })
        .filter(|mark| mark.y < plot.bottom())
        .collect();
    place(brush, plot, &in_view);
    if let Some(words) = coding(session, model).filter(|_| is_small) {
        let strong = brush.style(TextRole::Strong);
        brush.text(inside.x + 1, inside.y, inside.width, &format!("{words} "), strong);
    }
}

/// Title, with the rater's position.
fn title(session: &Session, model: &ConsoleModel) -> String {
    coding(session, model).map_or(TITLE.to_string(), |words| format!("{TITLE}: {words}"))
}

/// The rater's position, while errors are coded.
fn coding(session: &Session, model: &ConsoleModel) -> Option<String> {
    let (coding, playback) = (model.coding.as_ref()?, model.playback.as_ref()?);
    let error = session.timeline.iter().rev().find(|entry| model.is_error(entry));
    let press = error.map_or(String::new(), |entry| press(&session.kitchen, &entry.what));
    Some(coding.describe(&session.kitchen, playback.event, &press))
}

/// Time at the right edge: the present, or the last event during a pause.
pub(super) fn until(session: &Session, model: &ConsoleModel) -> SessionTime {
    let last = session.timeline.last().map_or(session.paused_at, |entry| entry.time.max(session.paused_at));
    if session.phase == Phase::Paused { last.min(model.now) } else { model.now }
}

/// A sign in the plot.
struct Mark {
    x: u16,
    y: u16,
    sign: String,
    role: TextRole,
}

/// Draws the signs, the newest first. Several presses in one column share a sign; any other sign whose cell is taken moves to the
/// next free cell towards the past.
fn place(brush: &mut Painter, plot: Rect, marks: &[Mark]) {
    let signs = brush.theme.signs();
    let rank = |mark: &Mark| match mark.sign.as_str() {
        sign if sign == signs.press => 2,
        sign if sign == signs.no_effect => 1,
        _ => 0,
    };
    for wanted in 0..3 {
        for mark in marks.iter().filter(|mark| rank(mark) == wanted) {
            let is_free = |x: &u16| brush.buffer.cell((*x, mark.y)).is_some_and(|cell| cell.symbol() == " ");
            let free = (plot.x..=mark.x).rev().find(is_free);
            let style = brush.style(mark.role);
            match free {
                Some(x) if wanted == 0 || x == mark.x => {
                    brush.text(x, mark.y, 1, &mark.sign, style);
                }
                None if wanted == 0 => {
                    brush.text(plot.x, mark.y, 1, "+", style);
                }
                _ => {}
            }
        }
    }
}

/// Free area in the timeline's title line, between title and legend.
pub(super) fn title_room(brush: &Painter, regions: &Regions, session: &Session, model: &ConsoleModel) -> Option<Rect> {
    let area = regions.timeline;
    if regions.room == ScreenSize::Small || area.area() == 0 {
        return None;
    }
    let from = area.x + 1 + width(&title(session, model)) + 2;
    let until = area.right().saturating_sub(width(&legend(brush)) + 4);
    Some(Rect { x: from, y: area.y, width: until.saturating_sub(from), height: 1 })
}

fn legend(brush: &Painter) -> String {
    let signs = brush.theme.signs();
    format!("{} press  {} no effect  {} error  {} served", signs.press, signs.no_effect, signs.error, signs.served)
}

fn column(time: SessionTime) -> i64 {
    (time.as_secs_f64() / COLUMN_S) as i64
}

/// Draws the time axis in the first row; the right end is the present or `back_s` seconds ago.
pub(super) fn axis(brush: &mut Painter, plot: Rect, back_s: u32, column_s: f64) {
    let quiet = brush.style(TextRole::Quiet);
    let every = (10.0 / column_s) as u16;
    let line = brush.theme.signs().frame[4];
    let thin = brush.style(TextRole::Frame);
    for x in plot.x..plot.right() {
        brush.text(x, plot.y, 1, line, thin);
    }
    let end = if back_s == 0 { " now".to_string() } else { format!(" -{back_s} s") };
    brush.text_right(plot.right(), plot.y, 8, &end, quiet);
    let mut tick = 1;
    while tick * every + 4 < plot.width {
        let label = format!(" -{} s ", back_s + u32::from(tick) * 10);
        let x = plot.right() - 1 - tick * every;
        brush.text(x.saturating_sub(width(&label) / 2), plot.y, 8, &label, quiet);
        tick += 1;
    }
}

/// Row, sign and meaning of an entry of the timeline.
fn mark(
    brush: &Painter,
    session: &Session,
    model: &ConsoleModel,
    entry: &TimelineEntry,
) -> Option<(u16, String, TextRole)> {
    let signs = brush.theme.signs();
    Some(match &entry.what {
        TimelineEvent::Press { agent, effective, .. } => {
            let row = if *agent == Agent::Human { 1 } else { 2 };
            let role = if *agent == Agent::Human { TextRole::Human } else { TextRole::Robot };
            match (model.is_error(entry), effective) {
                (true, _) => (row, signs.error.to_string(), TextRole::Alarm),
                (false, false) => (row, signs.no_effect.to_string(), role),
                (false, true) => (row, signs.press.to_string(), role),
            }
        }
        TimelineEvent::ArmTouched { .. } => (2, signs.touched.to_string(), TextRole::Alarm),
        TimelineEvent::RobotStopped | TimelineEvent::ArmStopped { .. } => {
            (2, signs.stopped.to_string(), TextRole::Alarm)
        }
        TimelineEvent::RobotResumed | TimelineEvent::RobotReleased => (2, signs.to.to_string(), TextRole::Robot),
        TimelineEvent::RobotHeld => (2, signs.pause.to_string(), TextRole::Robot),
        TimelineEvent::RobotSkipped(_) => (2, signs.taken_back.to_string(), TextRole::Robot),
        TimelineEvent::RobotDriven(_) => (2, signs.by_hand.to_string(), TextRole::Signal),
        TimelineEvent::Corrected { .. } => (4, signs.by_hand.to_string(), TextRole::Signal),
        TimelineEvent::Signal { signal, .. } => (3, signal_sign(session, model, signal), TextRole::Signal),
        TimelineEvent::SignalEnded(SignalEnd::TakenBack) => (3, signs.taken_back.to_string(), TextRole::Signal),
        TimelineEvent::SignalEnded(SignalEnd::Elapsed) => return None,
        TimelineEvent::Served { .. } => (4, signs.served.to_string(), TextRole::Strong),
        TimelineEvent::OrderShown { .. } => (4, "+".to_string(), TextRole::Quiet),
        TimelineEvent::Excluded(_) => (5, signs.error.to_string(), TextRole::Signal),
        TimelineEvent::Included => (5, signs.served.to_string(), TextRole::Signal),
        TimelineEvent::Focus(false) => (5, "!".to_string(), TextRole::Alarm),
        TimelineEvent::Focus(true) => return None,
        TimelineEvent::Marker(note) => {
            let number =
                session.spec.console.notes.iter().position(|known| known == note).map(|index| (index + 1).to_string());
            (5, number.unwrap_or("*".to_string()), TextRole::Strong)
        }
        TimelineEvent::Trial(Phase::Paused) => (5, signs.pause.to_string(), TextRole::Strong),
        TimelineEvent::Trial(_) => (5, signs.to.to_string(), TextRole::Strong),
    })
}

/// The key of the signal, as shown in the kitchen.
fn signal_sign(session: &Session, model: &ConsoleModel, signal: &Signal) -> String {
    let location = session.kitchen.location_named(signal.target());
    location.and_then(|id| model.keys.mark(id)).map_or("!".to_string(), |chord| chord.to_string())
}
