//! The list of signals, ranked by what each would save, with the cost of a signal. The offer itself stands in a line of
//! its own.

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::text_columns::wrap;
use tomcom_core::base::text::count;
use tomcom_core::communication::Sender;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_session::Session;
use tomcom_session::admit::may_send;
use tomcom_session::history::wording;
use tomcom_session::settings::Condition;

/// Width of a benefit bar in columns; a column stands for half a saved press, or for the concept ToM a twelfth of the
/// belief deviation.
const GAUGE: u16 = 12;
const PRESSES_A_COLUMN: f64 = 0.5;
/// Signals whose benefit and standard error are both smaller than this (in presses) are not listed, since they would be
/// shown as 0.0.
pub(super) const NOTHING: f64 = 0.05;
/// Columns reserved for the words of a signal ("[a] highlight assembly board"); a benefit bar is drawn only if these
/// remain.
const LONGEST_SIGNAL: u16 = 28;
/// Text that marks the signal on offer in the list of signals.
const OFFERED: &str = "offered";

/// Draws the list of signals, ranked by benefit.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.recommendation;
    if area.area() == 0 {
        return;
    }
    let inside = brush.panel(area, "Signals by benefit", remark(session));
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let Some(advice) = &session.advice else {
        return quietly(brush, inside, silence(session));
    };
    let (worth_it, not_worth_it): (Vec<&SignalOption>, Vec<&SignalOption>) =
        advice.options.iter().partition(|option| option.net > 0.0);
    // The line with the cost of a signal is always visible; if there is no room, signals above it are left out.
    let above = inside.height.saturating_sub(1).min(worth_it.len() as u16);
    for (row, option) in worth_it.into_iter().take(usize::from(above)).enumerate() {
        option_line(brush, inside, inside.y + row as u16, option, session, model);
    }
    let mut y = inside.y + above;
    cost_line(brush, inside, y, session, advice, model);
    y += 1;
    let (useless, not_worth_it): (Vec<&SignalOption>, Vec<&SignalOption>) =
        not_worth_it.into_iter().partition(|option| option.benefit.abs().max(option.standard_error) < NOTHING);
    for option in not_worth_it {
        if y >= inside.bottom() {
            return;
        }
        option_line(brush, inside, y, option, session, model);
        y += 1;
    }
    if !useless.is_empty() && y < inside.bottom() {
        let signals = count(useless.len() as u64, "signal", "signals");
        let text = match session.spec.assistant.concept {
            ConceptName::Tom => format!("{signals} would change no belief"),
            _ => format!("{signals} would save no press"),
        };
        quietly(brush, Rect { y, height: 1, ..inside }, &text);
    }
}

fn quietly(brush: &mut Painter, area: Rect, text: &str) {
    let quiet = brush.style(TextRole::Quiet);
    for (row, line) in wrap(text, area.width).iter().take(usize::from(area.height)).enumerate() {
        brush.text(area.x, area.y + row as u16, area.width, line, quiet);
    }
}

/// Unit of the numbers in the list of signals, as the remark in the panel's title.
fn remark(session: &Session) -> &'static str {
    match session.spec.assistant.concept {
        ConceptName::TomCom => "presses saved",
        ConceptName::Tom => "deviation of beliefs",
        ConceptName::Dev => "concept DEV",
        ConceptName::None => "no communication concept",
    }
}

/// Why there is no ranked list of signals, in words.
fn silence(session: &Session) -> &'static str {
    match (session.spec.asks_assistant(), session.is_running()) {
        (false, _) => "No advice in this session (shadow = \"off\"): choose the signals yourself.",
        (true, true) => "No advice yet: it begins with the first order or press.",
        (true, false) => "No advice: the assistant advises only while the trial runs.",
    }
}

/// The benefit of a signal in the unit of the communication concept: presses, or belief deviation.
fn worth(option: &SignalOption, session: &Session) -> String {
    match session.spec.assistant.concept {
        ConceptName::Tom => format!("{:>4.2} ", option.benefit),
        // A benefit that rounds to zero is shown as 0.0, never as -0.0.
        _ => format!("{:>4.1} ", if option.benefit.abs() < NOTHING { 0.0 } else { option.benefit }),
    }
}

/// The key of a listed signal, if the wizard may send it.
fn key(option: &SignalOption, session: &Session, model: &ConsoleModel) -> Option<KeyChord> {
    let location = option.signal.location(&session.kitchen);
    location.and_then(|location| model.keys.mark(location)).filter(|_| may_send(session, Sender::Wizard).is_ok())
}

fn option_line(
    brush: &mut Painter,
    inside: Rect,
    y: u16,
    option: &SignalOption,
    session: &Session,
    model: &ConsoleModel,
) {
    let offered = session.offers.open().and_then(|offer| offer.signal());
    let is_offered = offered == Some(&option.signal);
    let role = if is_offered { TextRole::Strong } else { TextRole::Quiet };
    let worth = worth(option, session);
    let mut x = brush.parts(inside.x, y, inside.width, &[(worth.as_str(), role)]);
    let (chord, words) = (key(option, session, model), wording::signal(&option.signal));
    let key = chord.map_or(String::new(), |chord| format!("[{}] ", chord.name()));
    // The words of a signal have priority over its benefit bar.
    if inside.right().saturating_sub(x) >= GAUGE + 1 + LONGEST_SIGNAL {
        x = gauge(brush, x, y, option, session, role);
    }
    let parts = [(key.as_str(), TextRole::Signal), (words.as_str(), role)];
    let end = brush.parts(x, y, inside.right().saturating_sub(x), &parts);
    if is_offered && end + 2 + OFFERED.len() as u16 <= inside.right() {
        let style = brush.style(TextRole::Signal);
        brush.text_right(inside.right(), y, OFFERED.len() as u16, OFFERED, style);
    }
    if let Some(chord) = chord.filter(|_| model.playback.is_none()) {
        brush.key_target(x, y, end, chord);
    }
}

/// Draws a signal's benefit as a bar: filled up to one standard error below the benefit, open up to one above it, with
/// a line at the cost.
fn gauge(brush: &mut Painter, x: u16, y: u16, option: &SignalOption, session: &Session, role: TextRole) -> u16 {
    let signs = brush.theme.signs();
    let (cost, of_tom) = (session.spec.assistant.price(), session.spec.assistant.concept == ConceptName::Tom);
    let a_column = if of_tom { 1.0 / f64::from(GAUGE) } else { PRESSES_A_COLUMN };
    let (full, open, line) = (signs.bar_full, signs.bar_empty, signs.frame[5]);
    let column = |worth: f64| worth / a_column;
    let (least, most) = (option.benefit - option.standard_error, option.benefit + option.standard_error);
    for index in 0..GAUGE {
        let at = f64::from(index) + 0.5;
        let (sign, role) = match () {
            () if column(cost).floor() == f64::from(index) => (line, TextRole::Frame),
            () if at <= column(least) => (full, role),
            () if at <= column(most) => (open, role),
            () => (" ", role),
        };
        let style = brush.style(role);
        brush.text(x + index, y, 1, sign, style);
    }
    x + GAUGE + 1
}

/// Draws the line with the cost of a signal and the age of the numbers in the list.
fn cost_line(
    brush: &mut Painter,
    inside: Rect,
    y: u16,
    session: &Session,
    advice: &Recommendation,
    model: &ConsoleModel,
) {
    let price = session.spec.assistant.price();
    let left = match session.spec.assistant.concept {
        ConceptName::Tom => format!("{price:>4.2} threshold for a signal"),
        ConceptName::Dev => "DEV proposes presses after an error: see the line of the offer".to_string(),
        ConceptName::None => String::new(),
        ConceptName::TomCom => format!("{price:>4.1} cost of a signal"),
    };
    let quiet = brush.style(TextRole::Quiet);
    let end = brush.text(inside.x, y, inside.width, &left, quiet);
    // A recommendation that the assistant has already sent by itself is marked as sent.
    let is_sent = session.spec.trial.condition == Condition::Assistant
        && session.signalled_at.is_some_and(|sent| sent >= advice.for_ns);
    let age_s = session.age(advice.for_ns, model.now).as_secs_f64();
    let age = if is_sent { format!("sent, {age_s:.1} s old") } else { format!("{age_s:.1} s old") };
    brush.text_right(inside.right(), y, inside.right().saturating_sub(end + 1), &age, quiet);
}
