//! The last minute, one row per kind of event, in columns of half a second; now is at the right edge.

use ratatui::layout::Rect;

use super::paint::{Brush, width};
use super::regions::{Regions, Room};
use super::theme::Role;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::console::keys::NOTES;
use crate::console::model::Model;
use crate::kitchen::Agent;
use crate::session::event::SignalEnd;
use crate::session::{Entry, Happening, Phase, Session};

/// The width of a column in seconds.
const COLUMN_S: f64 = 0.5;
const LABELS: u16 = 10;

/// Draws the timeline.
pub fn draw(brush: &mut Brush, regions: &Regions, session: &Session, model: &Model) {
    let area = regions.timeline;
    let is_small = regions.room == Room::Small;
    let inside = if is_small { area } else { brush.panel(area, "Timeline", &legend(brush)) };
    let rows: &[&str] = match is_small {
        true => &["", "human", "robot", "wizard"],
        false => &["", "human", "robot", "signals", "orders", "notes"],
    };
    let quiet = brush.style(Role::Quiet);
    for (row, label) in rows.iter().enumerate() {
        brush.text(inside.x + 1, inside.y + row as u16, LABELS, label, quiet);
    }
    let plot = Rect { x: inside.x + LABELS, width: inside.width.saturating_sub(LABELS + 1), ..inside };
    axis(brush, plot);
    let now = column(model.now);
    for entry in session.timeline.iter().rev() {
        let age = now - column(entry.time);
        if age >= i64::from(plot.width) {
            break;
        }
        let Some((row, sign, role)) = mark(brush, session, model, entry) else { continue };
        let row = if is_small { row.min(3) } else { row };
        let (x, y) = (plot.right() - 1 - age.max(0) as u16, plot.y + row);
        let style = brush.style(role);
        if y < plot.bottom() && is_louder(brush, x, y, &sign) {
            brush.text(x, y, 1, &sign, style);
        }
    }
}

fn legend(brush: &Brush) -> String {
    let signs = brush.theme.signs();
    format!("{} press  {} no effect  {} error  {} served", signs.press, signs.no_effect, signs.error, signs.served)
}

fn column(time: SessionTime) -> i64 {
    (time.as_secs_f64() / COLUMN_S) as i64
}

/// Two events in one column: the one that matters more stays.
fn is_louder(brush: &Brush, x: u16, y: u16, sign: &str) -> bool {
    let signs = brush.theme.signs();
    let rank = |sign: &str| match sign {
        " " => 0,
        sign if sign == signs.press => 1,
        sign if sign == signs.no_effect => 2,
        _ => 3,
    };
    brush.buffer.cell((x, y)).is_none_or(|cell| rank(cell.symbol()) <= rank(sign))
}

fn axis(brush: &mut Brush, plot: Rect) {
    let quiet = brush.style(Role::Quiet);
    let every = (10.0 / COLUMN_S) as u16;
    let line = brush.theme.signs().frame[4];
    for x in plot.x..plot.right() {
        brush.text(x, plot.y, 1, line, quiet);
    }
    brush.text_right(plot.right(), plot.y, 4, " now", quiet);
    let mut tick = 1;
    while tick * every + 4 < plot.width {
        let label = format!(" -{} s ", u32::from(tick) * 10);
        let x = plot.right() - 1 - tick * every;
        brush.text(x.saturating_sub(width(&label) / 2), plot.y, 8, &label, quiet);
        tick += 1;
    }
}

/// Row, sign and meaning of an entry of the timeline.
fn mark(brush: &Brush, session: &Session, model: &Model, entry: &Entry) -> Option<(u16, String, Role)> {
    let signs = brush.theme.signs();
    Some(match &entry.what {
        Happening::Press { agent, effective, .. } => {
            let row = if *agent == Agent::Human { 1 } else { 2 };
            let role = if *agent == Agent::Human { Role::Human } else { Role::Robot };
            match (model.is_error(entry), effective) {
                (true, _) => (row, signs.error.to_string(), Role::Alarm),
                (false, false) => (row, signs.no_effect.to_string(), role),
                (false, true) => (row, signs.press.to_string(), role),
            }
        }
        Happening::RobotStopped => (2, signs.stopped.to_string(), Role::Alarm),
        Happening::RobotResumed => (2, signs.to.to_string(), Role::Robot),
        Happening::Signal { signal, .. } => (3, signal_sign(session, model, signal), Role::Signal),
        Happening::SignalEnded(SignalEnd::TakenBack) => (3, signs.taken_back.to_string(), Role::Signal),
        Happening::SignalEnded(SignalEnd::Elapsed) => return None,
        Happening::Served { .. } => (4, signs.served.to_string(), Role::Strong),
        Happening::OrderShown { .. } => (4, "+".to_string(), Role::Quiet),
        Happening::Marker(note) => {
            let number = NOTES.iter().position(|known| known == note).map(|index| (index + 1).to_string());
            (5, number.unwrap_or("*".to_string()), Role::Strong)
        }
        Happening::Trial(Phase::Paused) => (5, signs.pause.to_string(), Role::Strong),
        Happening::Trial(_) => (5, signs.to.to_string(), Role::Strong),
    })
}

/// The key of the signal, as it stands in the kitchen.
fn signal_sign(session: &Session, model: &Model, signal: &Signal) -> String {
    let location = session.kitchen.location_named(signal.target());
    let from_layout = location.and_then(|id| session.kitchen.location(id).signal_key).map(|key| key.to_string());
    let bound = location.and_then(|id| model.keys.of_signal(id)).map(|chord| chord.to_string());
    bound.or(from_layout).unwrap_or("!".to_string())
}
