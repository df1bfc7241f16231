//! The recommendation panel: signals ranked by net benefit, the cost of communication, and the reason.

use ratatui::layout::Rect;

use super::paint::{Painter, wrap};
use super::regions::Regions;
use super::theme::TextRole;
use crate::base::words::count;
use crate::communication::Sender;
use crate::communication::concept::ConceptName;
use crate::communication::offer::{OfferWorth, OfferedAct};
use crate::communication::recommendation::{Proposal, Recommendation, SignalOption};
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyAction;
use crate::history::wording;
use crate::session::Session;
use crate::session::admit::may_send;
use crate::session::offers;

/// Width of a gauge in columns; a column is half a saved press, or for ToM a twelfth of the deviation.
const GAUGE: u16 = 12;
const PRESSES_A_COLUMN: f64 = 0.5;
/// Options with a smaller benefit and standard error are not listed, since they would be shown as 0.0 ±0.0.
const NOTHING: f64 = 0.05;
/// Width reserved for the signal ("[a] highlight assembly board"); a gauge is drawn only beside it.
const LONGEST_SIGNAL: u16 = 28;
/// Number of columns below which the cost line is abbreviated.
const NARROW: u16 = 46;

/// Draws the recommendation panel.
pub fn draw(brush: &mut Painter, regions: &Regions, session: &Session, model: &ConsoleModel) {
    let area = regions.recommendation;
    if area.area() == 0 {
        return;
    }
    let inside = brush.panel(area, "Recommendation", remark(session, area.width));
    let Some(advice) = &shown(session) else {
        let quiet = brush.style(TextRole::Quiet);
        for (row, line) in wrap(silence(session), inside.width).iter().enumerate() {
            brush.text(inside.x, inside.y + row as u16, inside.width, line, quiet);
        }
        return;
    };
    // The cost line is always visible; options above it are dropped if there is no room.
    let above = Rect { height: inside.height.saturating_sub(1), ..inside };
    let mut y = proposal(brush, above, advice);
    let (worth_it, not_worth_it): (Vec<&SignalOption>, Vec<&SignalOption>) =
        advice.options.iter().partition(|option| option.net > 0.0);
    for option in worth_it {
        if y >= above.bottom() {
            break;
        }
        y = option_line(brush, above, y, option, session, model, advice);
        if Some(&option.signal) == advice.best.as_ref() {
            y = reason(brush, above, y, advice, session);
        }
    }
    y = cost_line(brush, inside, y, session, advice, model);
    let (useless, not_worth_it): (Vec<&SignalOption>, Vec<&SignalOption>) =
        not_worth_it.into_iter().partition(|option| option.benefit.abs().max(option.standard_error) < NOTHING);
    for option in not_worth_it {
        if y >= inside.bottom() {
            return;
        }
        y = option_line(brush, inside, y, option, session, model, advice);
    }
    if !useless.is_empty() && y < inside.bottom() {
        let what = match session.spec.assistant.concept {
            ConceptName::Tom => "would tell nothing new",
            _ => "would save nothing",
        };
        let text = format!("{} {what}", count(useless.len() as u64, "signal", "signals"));
        let style = brush.style(TextRole::Quiet);
        brush.text(inside.x, y, inside.width, &text, style);
    }
}

/// The recommendation with the open offer in the place of its best signal; where none are made, as it is.
fn shown(session: &Session) -> Option<Recommendation> {
    let advice = session.advice.clone()?;
    if !offers::are_made(session) {
        return Some(advice);
    }
    let silent = Recommendation { best: None, reason: None, proposal: None, ..advice };
    let Some(offer) = session.offers.open() else { return Some(silent) };
    let reason = offer.advice.reason.clone();
    Some(match (&offer.advice.what, offer.advice.worth) {
        (OfferedAct::Signal(signal), Some(OfferWorth { benefit, standard_error, net })) => {
            let offered = SignalOption { signal: signal.clone(), benefit, standard_error, net, rollouts: 0 };
            let others = silent.options.into_iter().filter(|option| option.signal != *signal);
            let options = std::iter::once(offered).chain(others).collect();
            Recommendation { options, best: Some(signal.clone()), reason, ..silent }
        }
        (OfferedAct::Presses(presses), _) => {
            let proposal = Proposal { error: offer.advice.for_seq, presses: presses.clone() };
            Recommendation { proposal: Some(proposal), ..silent }
        }
        (OfferedAct::Signal(_), None) => silent,
    })
}

/// Remark in the title: the concept and the unit of its numbers.
fn remark(session: &Session, columns: u16) -> &'static str {
    let is_narrow = columns < NARROW;
    match session.spec.assistant.concept {
        ConceptName::TomCom if is_narrow => "net presses",
        ConceptName::TomCom => "ToM-Com, net presses saved",
        ConceptName::Tom if is_narrow => "above threshold",
        ConceptName::Tom => "ToM, above threshold",
        ConceptName::Dev if is_narrow => "after an error",
        ConceptName::Dev => "DEV, presses after an error",
        ConceptName::None => "no concept",
    }
}

/// Draws the proposed presses; returns the row below.
fn proposal(brush: &mut Painter, inside: Rect, advice: &Recommendation) -> u16 {
    let Some(proposal) = &advice.proposal else { return inside.y };
    let lines = wrap(&proposed(proposal), inside.width);
    for (row, line) in lines.iter().enumerate().take(usize::from(inside.height)) {
        let style = brush.style(TextRole::Strong);
        brush.text(inside.x, inside.y + row as u16, inside.width, line, style);
    }
    (inside.y + lines.len() as u16).min(inside.bottom())
}

fn proposed(proposal: &Proposal) -> String {
    let presses: Vec<String> = proposal.presses.iter().map(|press| wording::location(press)).collect();
    format!("error: next would be good {} (no signal says so)", presses.join(", then "))
}

/// Reason why there is no recommendation.
fn silence(session: &Session) -> &'static str {
    match (session.spec.asks_assistant(), session.is_running()) {
        (false, _) => "None: nobody asks the assistant in this session (shadow = \"off\"). The signals are yours.",
        (true, true) => "None yet: it comes after the first order or press.",
        (true, false) => "None: the assistant advises while the trial runs.",
    }
}

/// Text without a recommended signal: no signal is worth its cost, or the recommended signal has been sent.
fn nothing(session: &Session, advice: &Recommendation) -> &'static str {
    match session.signalled_at.is_some_and(|sent| sent >= advice.for_ns) {
        true => "sent",
        false => "say nothing",
    }
}

/// Age of the recommendation.
fn age(session: &Session, advice: &Recommendation, model: &ConsoleModel) -> String {
    format!("  {:.1} s old", session.age(advice.for_ns, model.now).as_secs_f64())
}

/// Net benefit of an option in the concept's unit.
fn worth(option: &SignalOption, session: &Session) -> String {
    match session.spec.assistant.concept {
        ConceptName::Tom => format!("{:+.2} ", option.net),
        _ => format!("{:+.1} ±{:.1} ", option.net, option.standard_error),
    }
}

/// The key of an option's signal, if it has one.
fn key(option: &SignalOption, session: &Session, model: &ConsoleModel) -> Option<KeyChord> {
    let location = session.kitchen.location_named(option.signal.target());
    location.and_then(|location| model.keys.mark(location)).filter(|_| may_send(session, Sender::Wizard).is_ok())
}

fn option_line(
    brush: &mut Painter,
    inside: Rect,
    y: u16,
    option: &SignalOption,
    session: &Session,
    model: &ConsoleModel,
    advice: &Recommendation,
) -> u16 {
    let is_best = Some(&option.signal) == advice.best.as_ref();
    let role = if is_best { TextRole::Strong } else { TextRole::Quiet };
    let worth = worth(option, session);
    let mut x = brush.parts(inside.x, y, inside.width, &[(worth.as_str(), role)]);
    let (chord, words) = (key(option, session, model), wording::signal(&option.signal));
    let key = chord.map_or(String::new(), |chord| format!("[{}] ", chord.name()));
    // The words of a signal have priority over its gauge.
    if inside.right().saturating_sub(x) >= GAUGE + 1 + LONGEST_SIGNAL {
        x = gauge(brush, x, y, option, session, role);
    }
    let parts = [(key.as_str(), TextRole::Signal), (words.as_str(), role)];
    let end = brush.parts(x, y, inside.right().saturating_sub(x), &parts);
    if let Some(chord) = chord.filter(|_| model.playback.is_none()) {
        brush.key_target(x, y, end, chord);
    }
    y + 1
}

/// Draws the benefit as a bar: solid up to one standard error below, open up to one above, with a line at the cost.
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

/// Draws the reason for the best option, shortened to the available room; returns the row below.
fn reason(brush: &mut Painter, inside: Rect, y: u16, advice: &Recommendation, session: &Session) -> u16 {
    let (Some(reason), Some(option)) = (&advice.reason, advice.top()) else { return y };
    let reason = wording::reason(&session.kitchen, reason);
    let saves = match session.spec.assistant.concept {
        ConceptName::Tom => String::new(),
        _ => format!("; saves {:.1} presses, net {:+.1}", option.benefit, option.net),
    };
    let (columns, rows) = (inside.width.saturating_sub(2), usize::from(inside.bottom().saturating_sub(y)));
    let said = [reason.words() + &saves, reason.words(), reason.taken() + &saves, reason.taken()];
    let mut lines = said.iter().map(|words| wrap(words, columns)).find(|lines| lines.len() <= rows);
    if lines.is_none() {
        // If even the shortest text does not fit, its last visible line is marked as continued.
        let all = wrap(&said[3], columns);
        lines = rows.checked_sub(1).map(|last| [&all[..last], &[all[last..].join(" ")]].concat());
    }
    let style = brush.style(TextRole::Text);
    let lines = lines.unwrap_or_default();
    for (row, line) in lines.iter().enumerate() {
        brush.text(inside.x + 2, y + row as u16, columns, line, style);
    }
    y + lines.len() as u16
}

/// Draws the cost of communication and the age of the recommendation.
fn cost_line(
    brush: &mut Painter,
    inside: Rect,
    y: u16,
    session: &Session,
    advice: &Recommendation,
    model: &ConsoleModel,
) -> u16 {
    let silence = match advice.best.is_none() && advice.proposal.is_none() {
        true => format!("{}; ", nothing(session, advice)),
        false => String::new(),
    };
    let price = session.spec.assistant.price();
    let left = match session.spec.assistant.concept {
        ConceptName::Tom => format!("{silence}threshold {price:.2}"),
        ConceptName::Dev | ConceptName::None => silence.trim_end_matches("; ").to_string(),
        ConceptName::TomCom if inside.width < NARROW => format!("{silence}costs {price:.1}"),
        ConceptName::TomCom => format!("{silence}a signal costs {price:.1}"),
    };
    let role = if advice.best.is_none() { TextRole::Strong } else { TextRole::Quiet };
    let accept = model
        .keys
        .chord_for(&KeyAction::Accept)
        .filter(|_| advice.best.is_some() && may_send(session, Sender::Wizard).is_ok());
    let accept = accept.map_or(String::new(), |chord| format!("  [{}] accepts", chord.name()));
    brush.parts(inside.x, y, inside.width, &[(left.as_str(), role), (accept.as_str(), TextRole::Signal)]);
    let style = brush.style(TextRole::Quiet);
    brush.text_right(inside.right(), y, inside.width, &age(session, advice, model), style);
    y + 1
}
