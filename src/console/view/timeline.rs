//! What happened, over time: the timeline, and the position in a recording.
//!
//! The timeline is on the trial's clock, which stands during pauses: one row per kind of event, columns of half a second,
//! the present at the right edge.

use ratatui::layout::Rect;

use super::gaze::GazeLoss;
use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::beliefs::visibility;
use crate::console::console_model::{ConsoleModel, ReplayAction};
use crate::console::key_action::KeyAction;
use crate::console::mouse::ClickAction;
use crate::console::text_columns::width;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::offer::{Offer, OfferKeyKind, TAKEN_AFTER};
use tomcom_core::kitchen::Agent;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent, TrialPhase, offers};

/// Time that one terminal column of the timeline stands for, in seconds.
const COLUMN_S: f64 = 0.5;
/// Possible intervals between the labels of the time axis, in seconds, and columns that a label needs.
const TICKS_S: [f64; 4] = [10.0, 20.0, 30.0, 60.0];
const LABEL_COLUMNS: f64 = 8.0;
const LABELS: u16 = 10;

pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.timeline;
    if area.area() == 0 {
        return;
    }
    let is_small = regions.screen_size == ScreenSize::Small;
    let inside = if is_small { area } else { brush.panel(area, "Timeline", &legend(brush)) };
    let rows: &[&str] = match is_small {
        // In a low timeline, signals, orders and notes share a row.
        true => &["", "human", "robot", "events"],
        // A rater's timeline shows no signals.
        false if model.coding.is_some() => &["", "human", "robot", "orders", "notes"],
        false if has_offers(inside, session, model) => &["", "human", "robot", "signals", "orders", "notes", "offers"],
        false => &["", "human", "robot", "signals", "orders", "notes"],
    };
    for (row, label) in rows.iter().enumerate().take(usize::from(inside.height)) {
        brush.text(inside.x + 1, inside.y + row as u16, LABELS, label, TextRole::Quiet);
    }
    let plot = Rect { x: inside.x + LABELS, width: inside.width.saturating_sub(LABELS + 1), ..inside };
    axis(brush, plot, session, model, COLUMN_S);
    let newest = session.timeline.iter().rev().filter(|entry| entry.time <= model.now);
    let entries = newest.map(|entry| (columns_ago(session, model, entry.time, COLUMN_S), entry));
    let row_of = |row: u16| match is_small {
        true => row.min(3),
        false if model.coding.is_some() && row > 3 => row - 1,
        false => row,
    };
    let in_view: Vec<Mark> = entries
        .skip_while(|(age, _)| *age < 0)
        .take_while(|(age, _)| *age < i64::from(plot.width))
        .filter_map(|(age, entry)| {
            let (row, sign, role) = mark(brush, session, model, entry)?;
            let row = row_of(row);
            Some(Mark { x: plot.right() - 1 - age.max(0) as u16, y: plot.y + row, sign, role })
        })
        .filter(|mark| mark.y < plot.bottom())
        .collect();
    place(brush, plot, &in_view);
    let notes = Rect { y: plot.y + row_of(5), height: 1, ..plot };
    gaze_losses(brush, notes.intersection(plot), session, model, !is_small);
    if rows.len() > 6 {
        offers(brush, Rect { y: plot.y + 6, height: 1, ..plot }, session, model);
    }
    if model.playback.is_some() && model.lesson.is_none() {
        for x in plot.x..plot.right() {
            let ago = i64::from(plot.right() - 1 - x);
            let to = ReplayAction::ToTime(column_end(session, model, ago));
            brush.target(Rect { x, width: 1, ..plot }, ClickAction::Seek(to));
        }
    }
}

/// Whether the timeline has room for a row of offers, and the wizard may see them.
fn has_offers(inside: Rect, session: &Session, model: &ConsoleModel) -> bool {
    let may_see = visibility(session, model) == WizardVisibility::Recommendation;
    inside.height > 6 && may_see && offers::are_made(session)
}

/// What the timeline says after an offer whose signal was not sent.
const MISSED: &str = "missed";

/// Draws each offer from its opening to its close: the key of its signal, then a line, in the colour of signals if the
/// signal was sent, and a tick where the wizard accepted the offer; after an offer that was not used, that it was missed.
fn offers(brush: &mut Painter, row: Rect, session: &Session, model: &ConsoleModel) {
    let column = |time| i64::from(row.right()) - 1 - columns_ago(session, model, time, COLUMN_S);
    let closed = session.offers.closed().iter().map(|closed| (&closed.offer, closed.closed, true));
    let open = session.offers.unclosed().map(|offer| (offer, model.now, false));
    let signs = brush.theme.signs();
    let is_seen = |offer: &Offer| offer.advice.visible && offer.opened <= model.now;
    let mut seen = closed.chain(open).filter(|(offer, ..)| is_seen(offer)).peekable();
    while let Some((offer, end, is_closed)) = seen.next() {
        let (from, to) = (column(offer.opened), column(end.min(model.now)));
        if to < i64::from(row.x) || from >= i64::from(row.right()) {
            continue;
        }
        let used = offer.used.filter(|used| used.at <= model.now);
        let role = if used.is_some() { TextRole::Signal } else { TextRole::Quiet };
        let key = offer.signal().map_or("!".to_string(), |signal| signal_sign(session, model, signal));
        let is_taken = used.is_some_and(|used| used.how == OfferKeyKind::Taken);
        for at in from.max(row.x.into())..=to.min(i64::from(row.right()) - 1) {
            let sign = match at {
                at if at == from => key.as_str(),
                at if at == to && is_taken => signs.served,
                _ => signs.frame[4],
            };
            brush.text(at as u16, row.y, 1, sign, role);
        }
        // While the key still takes a closed offer, the offer is not missed. A part of the word would be read as a key.
        let is_missed = is_closed && used.is_none() && session.age(end, model.now) > TAKEN_AFTER;
        // Right after the close the word stands over the end of the line.
        let after = (to + 2).min(i64::from(row.right().saturating_sub(width(MISSED))));
        let next = seen.peek().map_or(row.right().into(), |(next, ..)| column(next.opened));
        if is_missed && after >= i64::from(row.x) && after + i64::from(width(MISSED)) <= next {
            brush.text(after as u16, row.y, row.right() - after as u16, MISSED, role);
        }
    }
}

/// Draws each loss of gaze between the notes, as far as they leave room: an alarm, then, where no signals share the row
/// (`has_line`), a line as long as it lasts.
fn gaze_losses(brush: &mut Painter, row: Rect, session: &Session, model: &ConsoleModel, has_line: bool) {
    let column = |time| i64::from(row.right()) - 1 - columns_ago(session, model, time, COLUMN_S);
    let is_in_trial = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
    let present = GazeLoss::now(session, model.now).filter(|_| is_in_trial);
    let present = present.map(|loss| [loss.since.unwrap_or_default().max(session.trial_start), model.now]);
    for [since, until] in session.gaze.losses.iter().copied().chain(present) {
        let (from, to) = (column(since), column(until));
        let mut sign = if from < i64::from(row.x) { brush.theme.signs().frame[4] } else { "!" };
        for at in from.max(row.x.into())..=to.min(i64::from(row.right()) - 1) {
            let cell = (at as u16, row.y);
            let is_free = row.contains(cell.into()) && brush.buffer.cell(cell).is_some_and(|cell| cell.symbol() == " ");
            if is_free && (has_line || sign == "!") {
                brush.text(at as u16, row.y, 1, sign, TextRole::Alarm);
                sign = brush.theme.signs().frame[4];
            }
        }
    }
}

/// Number of timeline columns between a session time and the right end, the present or an earlier time, on the trial's clock.
pub(super) fn columns_ago(session: &Session, model: &ConsoleModel, time: SessionTime, column_s: f64) -> i64 {
    let column = |time: SessionTime| (time.as_secs_f64() / column_s) as i64;
    let now = session.trial_clock(model.now);
    let back = (f64::from(model.timeline_back_s) / column_s) as i64;
    column(now) - column(now - session.age(time, model.now)) - back
}

/// Session time at the end of the column that is `ago` columns before the right end.
fn column_end(session: &Session, model: &ConsoleModel, ago: i64) -> SessionTime {
    // Binary search: the number of columns before the right end falls as the session time rises.
    let (mut from, mut until) = (session.trial_start.0, model.now.0);
    while from < until {
        let middle = until - (until - from) / 2;
        match columns_ago(session, model, SessionTime(middle), COLUMN_S) >= ago {
            true => from = middle,
            false => until = middle - 1,
        }
    }
    SessionTime(from)
}

/// A sign in the timeline, with its cell and style: a press, a signal, an order or a note.
struct Mark {
    x: u16,
    y: u16,
    sign: String,
    role: TextRole,
}

/// Draws the signs of the timeline, the newest first. Several presses in one column share a sign; any other sign whose
/// cell is taken moves to the next free cell towards the past.
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
            // Errors are told from orders and notes at a glance.
            let is_error = mark.sign == signs.error;
            let style = if is_error { brush.theme.badge(mark.role) } else { brush.style(mark.role) };
            match free {
                Some(x) if wanted == 0 || x == mark.x => {
                    brush.styled(x, mark.y, 1, &mark.sign, style);
                }
                None if wanted == 0 => {
                    brush.styled(plot.x, mark.y, 1, "+", style);
                }
                _ => {}
            }
        }
    }
}

fn legend(brush: &Painter) -> String {
    let signs = brush.theme.signs();
    format!("{} press  {} no effect  {} error  {} served", signs.press, signs.no_effect, signs.error, signs.served)
}

/// Draws the time axis in the first row: the trial's clock, with the present or an earlier time at the right end.
pub(super) fn axis(brush: &mut Painter, plot: Rect, session: &Session, model: &ConsoleModel, column_s: f64) {
    let back = SessionTime::from_secs_f64(f64::from(model.timeline_back_s));
    ticks(brush, Rect { height: 1, ..plot }, session.trial_clock(model.now) - back, column_s);
}

/// Draws a time axis in full tens of seconds of the trial's clock; `end` is the time at its right end.
pub(super) fn ticks(brush: &mut Painter, line: Rect, end: SessionTime, column_s: f64) {
    let rule = brush.theme.signs().frame[4].repeat(usize::from(line.width));
    brush.text(line.x, line.y, line.width, &rule, TextRole::Frame);
    let column = |seconds: f64| (seconds / column_s) as i64;
    let last = column(end.as_secs_f64());
    let is_wide = |step_s: &f64| step_s / column_s >= LABEL_COLUMNS;
    let step_s = TICKS_S.into_iter().find(is_wide).unwrap_or(TICKS_S[TICKS_S.len() - 1]);
    let mut tick = (end.as_secs_f64() / step_s).floor();
    while tick >= 0.0 {
        let back = last - column(tick * step_s);
        let label = format!(" {} ", SessionTime::from_secs_f64(tick * step_s));
        let x = i64::from(line.right()) - 1 - back - i64::from(width(&label) / 2);
        if x < i64::from(line.x) {
            return;
        }
        let x = (x as u16).min(line.right().saturating_sub(width(&label)));
        brush.text(x, line.y, width(&label), &label, TextRole::Quiet);
        tick -= 1.0;
    }
}

/// Row, sign and style of an entry of the timeline.
fn mark(
    brush: &Painter,
    session: &Session,
    model: &ConsoleModel,
    entry: &TimelineEntry,
) -> Option<(u16, String, TextRole)> {
    let signs = brush.theme.signs();
    Some(match &entry.what {
        TimelineEvent::Press { agent, no_effect, .. } => {
            let row = if *agent == Agent::Human { 1 } else { 2 };
            let role = if *agent == Agent::Human { TextRole::Human } else { TextRole::Robot };
            match (model.error(entry).is_some(), no_effect.is_none()) {
                (true, _) => (row, signs.error.to_string(), TextRole::Alarm),
                (false, false) => (row, signs.no_effect.to_string(), role),
                (false, true) => (row, signs.press.to_string(), role),
            }
        }
        TimelineEvent::RobotSkipped(_) => (2, signs.taken_back.to_string(), TextRole::Robot),
        TimelineEvent::Served { .. } => (4, signs.served.to_string(), TextRole::Strong),
        TimelineEvent::OrderShown { .. } => (4, "+".to_string(), TextRole::Quiet),
        TimelineEvent::Trial(TrialPhase::Over(_)) => (5, signs.frame[5].to_string(), TextRole::Strong),
        TimelineEvent::Trial(TrialPhase::Paused) => (5, signs.pause.to_string(), TextRole::Strong),
        TimelineEvent::Trial(_) => (5, signs.to.to_string(), TextRole::Strong),
        TimelineEvent::Noted(event) => match event {
            Event::RobotTouched { .. } => (2, signs.touched.to_string(), TextRole::Alarm),
            Event::RobotStopped | Event::RobotSafety { .. } | Event::RobotStage { .. } => {
                (2, signs.stopped.to_string(), TextRole::Alarm)
            }
            Event::RobotResumed | Event::RobotReleased { .. } => (2, signs.to.to_string(), TextRole::Robot),
            Event::RobotHeld { .. } => (2, signs.pause.to_string(), TextRole::Robot),
            Event::RobotDriven { .. } => (2, signs.by_hand.to_string(), TextRole::Signal),
            Event::KitchenCorrected { .. } => (4, signs.by_hand.to_string(), TextRole::Signal),
            Event::SignalShown { signal, .. } => (3, signal_sign(session, model, signal), TextRole::Signal),
            Event::SignalEnded { .. } => (3, signs.taken_back.to_string(), TextRole::Signal),
            Event::Probe(ProbeEvent::Begun { .. }) => (5, "?".to_string(), TextRole::Strong),
            Event::Probe(ProbeEvent::Ended { .. }) => (5, signs.to.to_string(), TextRole::Strong),
            Event::TrialExcluded { .. } => (5, signs.dash.to_string(), TextRole::Signal),
            Event::TrialIncluded => (5, signs.served.to_string(), TextRole::Signal),
            Event::FocusLost | Event::Tracker(TrackerEvent::Lost { .. }) => (5, "!".to_string(), TextRole::Alarm),
            Event::Tracker(TrackerEvent::Connected { .. }) => (5, signs.to.to_string(), TextRole::Gaze),
            Event::Marker { note, .. } => {
                let notes = &session.spec.console.notes;
                let number = notes.iter().position(|known| known == note).map(|index| (index + 1).to_string());
                (5, number.unwrap_or("*".to_string()), TextRole::Strong)
            }
            _ => return None,
        },
    })
}

/// The key of the signal, as shown in the kitchen panel.
pub(super) fn signal_sign(session: &Session, model: &ConsoleModel, signal: &Signal) -> String {
    let location = signal.location(&session.kitchen);
    location.and_then(|id| model.keys.mark(id)).map_or("!".to_string(), |chord| chord.to_string())
}

/// Words before the times while the trial has not started: the longest of all phases.
const BEFORE: &str = " before the trial, ";

pub fn draw_position(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let (area, Some(playback)) = (regions.scrub, &model.playback) else { return };
    if area.area() == 0 {
        return;
    }
    let clock = session.trial_clock(model.now);
    let film = playback.outside_film.map(|outside| format!(" {outside}, "));
    let part = match session.phase {
        _ if let Some(film) = &film => film,
        TrialPhase::Ready => BEFORE,
        TrialPhase::Closed if !session.is_trial_over() => " left early, ",
        TrialPhase::Over(_) | TrialPhase::Closed => " after the trial, ",
        TrialPhase::Running | TrialPhase::Paused => " ",
    };
    let times = format!("{clock} of {} ", playback.trial_length.max(clock));
    let end = format!("{part}{times}");
    brush.text(area.x, area.y, area.width, " recording ", TextRole::Quiet);
    brush.text_right(area.right(), area.y, area.width, &end, TextRole::Quiet);
    let x = area.x + 11;
    // The bar has one length in all phases, so that a place on it always means the same time.
    let columns = area.right().saturating_sub(x + width(BEFORE) + width(&times) + 1);
    let all_s = playback.trial_length.max(clock).as_secs_f64().max(1e-3);
    let share = clock.as_secs_f64() / all_s;
    let line = brush.theme.signs().frame[4].repeat(usize::from(columns));
    brush.text(x, area.y, columns, &line, TextRole::Frame);
    let here = (share.clamp(0.0, 1.0) * f64::from(columns.saturating_sub(1))) as u16;
    brush.text(x, area.y, here, &brush.theme.signs().frame[4].repeat(usize::from(here)), TextRole::Strong);
    for (time, what) in playback.marks.iter() {
        let share = time.as_secs_f64() / all_s;
        let at = (share.clamp(0.0, 1.0) * f64::from(columns.saturating_sub(1))) as u16;
        let role = match what {
            ReplayLandmark::Signal => TextRole::Signal,
            ReplayLandmark::FalseBelief => TextRole::FalseBelief,
            ReplayLandmark::Error => TextRole::Alarm,
            ReplayLandmark::Marker => TextRole::Strong,
        };
        // The mark is the key that goes there.
        let key = model.keys.chord_for(&KeyAction::Move(ReplayAction::On(*what)));
        let key = key.map_or(brush.theme.signs().error.to_string(), |key| key.to_string());
        brush.text(x + at, area.y, 1, &key, role);
    }
    brush.text(x + here, area.y, 1, brush.theme.signs().recording, TextRole::Strong);
    if model.lesson.is_some() {
        return;
    }
    for column in 0..columns {
        let share = f64::from(column) / f64::from(columns.saturating_sub(1).max(1));
        let to = ReplayAction::ToClock(SessionTime::from_secs_f64(playback.trial_length.as_secs_f64() * share));
        brush.target(Rect { x: x + column, width: 1, ..area }, ClickAction::Seek(to));
    }
}
