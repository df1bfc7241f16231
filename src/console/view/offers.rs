//! The line of the offer, and the list of signals ranked by what each would save.
//!
//! The offer is the one signal that is worth sending now, with its key, the false belief behind it, and the presses that
//! it saves. Nothing else on the screen is inverse in the colour of signals. Signals that are not worth their cost are
//! listed only where the list has the whole screen.

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::beliefs::{self, BeliefCorrectness, EstimatedBelief, percent};
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::{KeyAction, KeyLayer};
use crate::console::mouse::ClickAction;
use crate::console::panels::Panel;
use crate::console::text_columns::{width, wrap};
use tomcom_core::base::text::{count, printable};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::{BenefitUnit, ConceptName};
use tomcom_core::communication::offer::TAKEN_AFTER;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption, SignalReason};
use tomcom_core::communication::{Sender, Signal, SignalKind};
use tomcom_core::kitchen::{Agent, LocationId};
use tomcom_core::measures::sequences::THINKS;
use tomcom_session::admit::may_send;
use tomcom_session::external::MindRole;
use tomcom_session::history::{belief_track, signal_words, wording};
use tomcom_session::settings::{Condition, WizardVisibility};
use tomcom_session::{Session, TimelineEvent, TrialPhase, offers};

/// The offer as it is drawn: the open offer or, in recordings that have no offers, the best signal.
pub(super) struct ShownOffer<'a> {
    act: Signal,
    /// Benefit and net benefit.
    worth: Option<(f64, f64)>,
    /// When it opened: what it says was so then.
    opened: Option<SessionTime>,
    reason: Option<&'a SignalReason>,
    /// The reason in an external concept's own words.
    words: Option<&'a str>,
}

/// The offer of a signal that is shown to the wizard now, if any.
pub(super) fn shown<'a>(session: &'a Session, model: &ConsoleModel) -> Option<ShownOffer<'a>> {
    if beliefs::visibility(session, model) < WizardVisibility::Recommendation
        || session.spec.trial.condition == Condition::Assistant
        || !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused)
    {
        return None;
    }
    if offers::are_made(session) {
        let offer = session.offers.open()?;
        let worth = offer.advice.worth.map(|worth| (worth.benefit, worth.net));
        let (act, reason) = (offer.advice.what.clone(), offer.advice.reason.as_ref());
        let (opened, words) = (Some(offer.opened), offer.advice.words.as_deref());
        return Some(ShownOffer { act, worth, opened, reason, words });
    }
    let advice = session.advice.as_ref()?;
    let top = advice.top().map(|option| (option.benefit, option.net));
    let (act, worth) = match (&advice.best, &advice.proposal) {
        (Some(signal), _) => (signal.clone(), top),
        (None, Some(proposal)) => (Signal::Propose(proposal.presses.clone()), None),
        (None, None) => return None,
    };
    Some(ShownOffer { act, worth, opened: None, reason: advice.reason.as_ref(), words: advice.words.as_deref() })
}

impl ShownOffer<'_> {
    pub(super) fn place(&self, session: &Session) -> Option<LocationId> {
        self.act.location(&session.kitchen)
    }

    /// Label of the offer with its keys: " enter SHOW RECIPE OF ORDER 1 [q] ".
    fn label(&self, session: &Session, model: &ConsoleModel) -> String {
        let words = wording::command(&self.act);
        if self.act.kind() == SignalKind::Proposal {
            return format!(" {words} ");
        }
        let own = self.place(session).and_then(|place| model.keys.of_signal(place));
        let own = own.map_or(String::new(), |key| format!(" [{key}]"));
        // The enter key is named only where it sends the offer: not in dialogs, replays, pauses, nor where the wizard
        // may not send.
        let is_free = model.playback.is_none() && model.dialog.is_none() && session.is_running();
        let is_free = is_free && may_send(session, Sender::Wizard).is_ok();
        let enter = model.keys.chord_for(&KeyAction::Accept).filter(|_| is_free);
        let enter = enter.map_or(String::new(), |key| format!("{key}  "));
        format!(" {enter}{}{own} ", words.to_uppercase())
    }

    /// What the offered signal saves, and what of it is left after its cost: "saves ≈ 4.2 presses, net +2.7".
    fn saves(&self, brush: &Painter, session: &Session) -> String {
        let Some((benefit, net)) = self.worth else { return String::new() };
        match session.spec.assistant.concept.name().unit() {
            BenefitUnit::Deviation => format!("belief deviation {benefit:.2}"),
            BenefitUnit::Presses | BenefitUnit::None => {
                let about = if brush.theme.unicode { "≈" } else { "about" };
                format!("saves {about} {benefit:.1} presses, net {net:+.1}")
            }
        }
    }

    /// Which signal on the participant's display the offered one would replace. The recommendation already counts the
    /// signal on the display as read, so that an offer is worth sending beyond it.
    fn replaces(&self, session: &Session) -> Option<String> {
        let shown = session.shown.as_ref().filter(|_| self.act.kind() != SignalKind::Proposal)?;
        Some(format!("replaces {}", wording::signal(&shown.signal)))
    }

    /// Reasons for the offer, most important first: what the participant believed and what was true when the offer opened,
    /// how certain that was and for how long, the wrong press or the press that is left out, and when it was so. The
    /// belief panel has what is believed now.
    fn because(&self, session: &Session, model: &ConsoleModel) -> Vec<String> {
        let Some(reason) = self.reason else {
            let words = self.words.map(|words| printable(words).into_owned());
            return words.into_iter().chain(self.replaces(session)).collect();
        };
        let kitchen = &session.kitchen;
        let aspect = kitchen.aspect_named(&reason.aspect);
        let values = aspect.and_then(|aspect| {
            let about = &kitchen.aspects[aspect.index()];
            Some((aspect, about.value_named(&reason.believes)?, about.value_named(&reason.truth)?))
        });
        let (believes, truth) = match values {
            Some((aspect, believes, truth)) => wording::contrast(kitchen, aspect, believes, truth),
            None => {
                let worded = wording::reason(kitchen, reason);
                (worded.believes, format!("is {}", worded.truth))
            }
        };
        let since = self.opened.zip(aspect).and_then(|(opened, aspect)| {
            let since = belief_track::wrong_since(model.belief.until(opened), aspect.index())?;
            Some(session.trial_clock_at(opened) - session.trial_clock_at(since))
        });
        let mut said = vec![format!("{} {believes}, {truth}", wording::thinks(reason.p_believes))];
        said.extend(self.replaces(session));
        let p = percent(reason.p_believes);
        said.push(match since {
            _ if reason.p_believes < UNLIKELY => format!("{p}: unlikely, but costly"),
            Some(since) => format!("{p} for {since}"),
            None => p,
        });
        said.extend(match (&reason.prevents, &reason.instead) {
            (Some(button), _) => Some(match self.opened.and_then(|opened| pressed_since(session, button, opened)) {
                Some(at) => format!("{} was pressed at {at}", wording::location(button)),
                None => format!("next error: {}", wording::location(button)),
            }),
            (None, Some(button)) => Some(format!("waits instead of: {}", wording::location(button))),
            (None, None) => None,
        });
        said.extend(self.opened.map(|opened| format!("as of {}", session.trial_clock_at(opened))));
        said
    }
}

/// When the human has pressed a button since this time, on the trial's clock.
fn pressed_since(session: &Session, button: &str, since: SessionTime) -> Option<SessionTime> {
    let wanted = session.kitchen.button_named(Agent::Human, button)?;
    let is_it = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { agent: Agent::Human, button, .. } if *button == wanted);
    let later = session.timeline.iter().rev().take_while(|entry| entry.time > since);
    later.filter(|entry| is_it(&entry.what)).last().map(|entry| session.trial_clock_at(entry.time))
}

/// Probability of a wrong value below which an offer is worth its cost only since the belief would be costly.
const UNLIKELY: f64 = 0.25;
/// Words of the line of the offer while no signal is worth its cost.
const NOTHING_TO_SAY: &str = "nothing worth saying";

/// Draws the line of the offer, or why there is no offer.
pub fn draw_offer(
    brush: &mut Painter,
    regions: &PanelAreas,
    session: &Session,
    model: &ConsoleModel,
    believed: &[EstimatedBelief],
) {
    let area = regions.offer;
    if area.area() == 0 {
        return;
    }
    // A click on the offer's line right after the offer has closed gets a notice that the offer has closed.
    let takes = model.layer == KeyLayer::Wizard && model.playback.is_none() && offers::are_made(session);
    if let Some(chord) = model.keys.chord_for(&KeyAction::Accept).filter(|_| takes) {
        brush.target(area, ClickAction::Key(chord));
    }
    let Some(offer) = shown(session, model) else {
        let words = closed(session, model).unwrap_or_else(|| why_no_offer(session, model, believed));
        brush.text(area.x + 1, area.y, area.width - 1, &words, TextRole::Quiet);
        return;
    };
    let badge = brush.theme.badge(TextRole::Signal);
    let end = brush.styled(area.x, area.y, area.width, &offer.label(session, model), badge);
    let saves = offer.saves(brush, session);
    let right = area.right().saturating_sub(1);
    if end + width(&saves) < right {
        brush.text_right(right, area.y, width(&saves), &saves, TextRole::Strong);
    }
    // The reason stands in a line of its own, or between the label and the saving.
    let (mut x, y, limit) = match area.height {
        1 => (end + 1, area.y, right.saturating_sub(width(&saves) + 2)),
        _ => (area.x + 1, area.y + 1, right),
    };
    for (index, words) in offer.because(session, model).iter().enumerate() {
        let words = if index == 0 { words.clone() } else { format!(" · {words}") };
        let words = if brush.theme.unicode { words } else { words.replace('·', "-") };
        let role = if index == 0 { TextRole::FalseBelief } else { TextRole::Text };
        if index == 0 || x + width(&words) <= limit {
            x = brush.text(x, y, limit.saturating_sub(x), &words, role);
        }
    }
}

/// The offer that has just closed and why, as long as the key still takes it; then it is told in the timeline alone.
fn closed(session: &Session, model: &ConsoleModel) -> Option<String> {
    let last = session.offers.last().filter(|last| last.offer.advice.visible && offers::are_made(session))?;
    let may_see = beliefs::visibility(session, model) == WizardVisibility::Recommendation;
    if !may_see || session.age(last.closed, model.now) > TAKEN_AFTER || !session.is_running() {
        return None;
    }
    let is_taken = last.offer.used.is_some() || model.playback.is_some() || may_send(session, Sender::Wizard).is_err();
    let key = model.keys.chord_for(&KeyAction::Accept).filter(|_| !is_taken);
    let still = key.map_or(String::new(), |key| format!("; {key} still sends it"));
    Some(format!("{}: {}{still}", wording::signal(&last.offer.advice.what), last.reason.words()))
}

/// What the line of the offer says while nothing is on offer. While the trial runs, its text changes only when a belief
/// becomes false or true, or an external concept has something to say.
fn why_no_offer(session: &Session, model: &ConsoleModel, believed: &[EstimatedBelief]) -> String {
    if let Some(over) = session.external.over.get(&MindRole::Concept) {
        return over.clone();
    }
    let may_see = beliefs::visibility(session, model) == WizardVisibility::Recommendation;
    // In a session it would draw the wizard to a signal that is not worth its cost.
    let none_advised = || signal_words::none_advised(session).filter(|_| may_see && model.playback.is_some());
    if session.spec.trial.condition == Condition::Assistant {
        let why = session.shown.as_ref().filter(|_| may_see).and_then(|shown| {
            let reason = shown.reason.as_ref().map(|reason| wording::reason(&session.kitchen, reason));
            let reason = reason.map(|reason| {
                let thought = if reason.p_believes < THINKS { "may have thought" } else { "thought" };
                format!("{thought} {}, is {}", reason.believes, reason.truth)
            });
            let why = reason.or_else(|| shown.words.as_deref().map(|words| printable(words).into_owned()))?;
            Some(format!("The assistant's {}: {why}", wording::signal(&shown.signal)))
        });
        let why = why.or_else(none_advised);
        return why.unwrap_or_else(|| "The assistant sends the signals, without the wizard".to_string());
    }
    if !session.spec.asks_assistant() {
        return "The assistant does not advise in this session (shadow = \"off\")".to_string();
    }
    match session.phase {
        TrialPhase::Running | TrialPhase::Paused => {}
        TrialPhase::Ready => return "The assistant advises while the trial runs".to_string(),
        TrialPhase::Closed if !session.is_trial_over() => {
            return "The session was left before its trial was over".to_string();
        }
        TrialPhase::Over(_) | TrialPhase::Closed => return "The trial is over".to_string(),
    }
    let advice = session.advice.as_ref().filter(|_| may_see);
    if let Some(words) = advice.and_then(|advice| advice.words.as_deref()) {
        return printable(words).into_owned();
    }
    if let Some(why) = none_advised() {
        return why;
    }
    match believed.iter().filter(|belief| belief.standing == BeliefCorrectness::False).count() as u64 {
        0 => NOTHING_TO_SAY.to_string(),
        number if session.spec.assistant.concept.name().unit() == BenefitUnit::Presses => {
            let cheap = if number == 1 { "costs" } else { "cost" };
            format!("{NOTHING_TO_SAY}: {} {cheap} less than a signal", count(number, "false belief", "false beliefs"))
        }
        number => format!("{NOTHING_TO_SAY}; {}", count(number, "false belief", "false beliefs")),
    }
}

/// What the participant falsely believes about a location and what is true, if there is a false belief.
pub(super) fn thinks(session: &Session, believed: &[EstimatedBelief], place: LocationId) -> Option<(String, String)> {
    let wrong = believed.iter().find(|belief| {
        belief.standing == BeliefCorrectness::False && beliefs::place(session, belief.aspect) == Some(place)
    })?;
    Some(wording::contrast(&session.kitchen, wrong.aspect, wrong.thinks, wrong.truth))
}

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

pub fn draw_signals(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.recommendation;
    if area.area() == 0 {
        return;
    }
    let inside = brush.panel(area, "Signals by benefit", remark(session));
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let Some(advice) = &session.advice else {
        return quietly(brush, inside, why_no_list(session));
    };
    // An open offer holds still while the benefit of its signal changes.
    let offered = session.offers.open().and_then(|offer| offer.signal());
    let (worth_it, not_worth_it): (Vec<&SignalOption>, Vec<&SignalOption>) =
        advice.options.iter().partition(|option| option.net > 0.0 || offered == Some(&option.signal));
    // The line with the cost of a signal is always visible; if there is no room, signals above it are left out.
    let above = inside.height.saturating_sub(1).min(worth_it.len() as u16);
    for (row, option) in worth_it.into_iter().take(usize::from(above)).enumerate() {
        option_line(brush, inside, inside.y + row as u16, option, session, model);
    }
    let mut y = inside.y + above;
    cost_line(brush, inside, y, session, advice, model);
    y += 1;
    let is_shown = |option: &&SignalOption| option.benefit.abs().max(option.standard_error) >= NOTHING;
    let is_alone = model.alone == Some(Panel::Recommendation);
    for option in not_worth_it.into_iter().filter(|option| is_alone && is_shown(option)) {
        if y >= inside.bottom() {
            return;
        }
        option_line(brush, inside, y, option, session, model);
        y += 1;
    }
}

fn quietly(brush: &mut Painter, area: Rect, text: &str) {
    for (row, line) in wrap(text, area.width).iter().take(usize::from(area.height)).enumerate() {
        brush.text(area.x, area.y + row as u16, area.width, line, TextRole::Quiet);
    }
}

/// Unit of the numbers in the list of signals, as the remark in the panel's title.
fn remark(session: &Session) -> &'static str {
    match session.spec.assistant.concept.name().unit() {
        BenefitUnit::Presses => "presses saved",
        BenefitUnit::Deviation => "deviation of beliefs",
        BenefitUnit::None => session.spec.assistant.concept.name().title(),
    }
}

/// Why there is no ranked list of signals, in words.
fn why_no_list(session: &Session) -> &'static str {
    match (session.spec.asks_assistant(), session.is_running()) {
        (false, _) => "No advice in this session (shadow = \"off\"): choose the signals yourself.",
        (true, true) => "No advice yet: it begins with the first order or press.",
        (true, false) => "No advice: the assistant advises only while the trial runs.",
    }
}

/// The benefit of a signal in the unit of the communication concept: presses, or belief deviation.
fn worth(option: &SignalOption, session: &Session) -> String {
    match session.spec.assistant.concept.name().unit() {
        BenefitUnit::Deviation => format!("{:>4.2} ", option.benefit),
        // A benefit that rounds to zero is shown as 0.0, never as -0.0.
        _ => format!("{:>4.1} ", if option.benefit.abs() < NOTHING { 0.0 } else { option.benefit }),
    }
}

/// The key of a listed signal, if the wizard may send it.
fn key(option: &SignalOption, session: &Session, model: &ConsoleModel) -> Option<KeyChord> {
    let location = option.signal.location(&session.kitchen);
    location.and_then(|location| model.keys.of_signal(location)).filter(|_| may_send(session, Sender::Wizard).is_ok())
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
    let mut x = brush.text(inside.x, y, inside.width, worth.as_str(), role);
    let (chord, words) = (key(option, session, model), wording::signal(&option.signal));
    let key = chord.map_or(String::new(), |chord| format!("[{}] ", chord.name()));
    // The words of a signal have priority over its benefit bar.
    if inside.right().saturating_sub(x) >= GAUGE + 1 + LONGEST_SIGNAL {
        x = gauge(brush, x, y, option, session, role);
    }
    let parts = [(key.as_str(), TextRole::Signal), (words.as_str(), role)];
    let end = brush.parts(x, y, inside.right().saturating_sub(x), &parts);
    if is_offered && end + 2 + OFFERED.len() as u16 <= inside.right() {
        brush.text_right(inside.right(), y, OFFERED.len() as u16, OFFERED, TextRole::Signal);
    }
    if let Some(chord) = chord.filter(|_| model.playback.is_none()) {
        brush.key_target(x, y, end, chord);
    }
}

/// Draws a signal's benefit as a bar: filled up to one standard error below the benefit, open up to one above it, with
/// a line at the cost.
fn gauge(brush: &mut Painter, x: u16, y: u16, option: &SignalOption, session: &Session, role: TextRole) -> u16 {
    let signs = brush.theme.signs();
    let cost = session.spec.assistant.price();
    let a_column = match session.spec.assistant.concept.name().unit() {
        BenefitUnit::Deviation => 1.0 / f64::from(GAUGE),
        BenefitUnit::Presses | BenefitUnit::None => PRESSES_A_COLUMN,
    };
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
        brush.text(x + index, y, 1, sign, role);
    }
    x + GAUGE + 1
}

fn cost_line(
    brush: &mut Painter,
    inside: Rect,
    y: u16,
    session: &Session,
    advice: &Recommendation,
    model: &ConsoleModel,
) {
    let price = session.spec.assistant.price();
    let concept = session.spec.assistant.concept.name();
    let left = match concept.unit() {
        BenefitUnit::Deviation => format!("{price:>4.2} threshold for a signal"),
        BenefitUnit::Presses => format!("{price:>4.1} cost of a signal"),
        BenefitUnit::None if concept == ConceptName::Dev => {
            "DEV proposes presses after an error: see the line of the offer".to_string()
        }
        BenefitUnit::None => String::new(),
    };
    // An external concept has a name of its own.
    let name =
        session.external.names.get(&MindRole::Concept).map_or(String::new(), |name| format!("{}: ", printable(name)));
    let left = format!("{name}{left}");
    let end = brush.text(inside.x, y, inside.width, &left, TextRole::Quiet);
    // A recommendation that the assistant has already sent by itself is marked as sent.
    let is_sent = session.spec.trial.condition == Condition::Assistant
        && session.signalled_at.is_some_and(|sent| sent >= advice.for_ns);
    let age_s = session.age(advice.for_ns, model.now).as_secs_f64();
    let age = if is_sent { format!("sent, {age_s:.1} s old") } else { format!("{age_s:.1} s old") };
    brush.text_right(inside.right(), y, inside.right().saturating_sub(end + 1), &age, TextRole::Quiet);
}
