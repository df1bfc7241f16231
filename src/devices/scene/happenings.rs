//! Text log of events, and the net benefit of signals, for Rerun.

use super::entity_content::{self, EntityData, MarkShape, SceneColour, SceneLogLevel, SeriesStyle, slug};
use super::{EntityUpdate, moment_on_clock};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::BenefitUnit;
use tomcom_core::communication::offer::{OfferCloseReason, OfferedAdvice};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal, signals};
use tomcom_core::kitchen::Agent;
use tomcom_core::measures::JudgedPress;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::{event_words, signal_words, wording};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::wizard_log::{ShownSignalRecord, signal_verdicts};
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent, TimestampedEvent};

/// Path of the error marks below the belief curves.
const ERROR_MARKS: &str = "human/errors/marks";
/// Path of the line at the cost of communication, in the plot of net benefits.
const COST_LINE: &str = "assistant/benefit/cost_line";

/// Path of the marks of the signals that were sent, at their value, in the plot of net benefits.
const SENT_MARKS: &str = "assistant/benefit/sent";

/// Path of the page of all signals, and its text without any.
const SIGNAL_PAGE: &str = "signals/page";
const NO_SIGNAL: &str = "No signal was shown.";
/// Number of signals on the page while the trial runs. The page is written whole after each signal: a page of all of them
/// would let a stream grow with the square of their number.
const NEWEST: usize = 30;
/// Path of the entity with all lines of the text log.
const HAPPENED: &str = "happened";
/// Largest number of characters of a line of the text log, which the viewer would cut at the edge of its view.
const LINE: usize = 76;

fn benefit(signal: &Signal) -> String {
    format!("assistant/benefit/{}", slug(signal.target().unwrap_or_default()))
}

/// Entity updates with the names and colours of curves and marks.
pub fn fixed(session: &Session) -> Vec<EntityUpdate> {
    let (kitchen, assistant) = (&session.kitchen, &session.spec.assistant);
    let line = |entity: String, name: String, colour: SceneColour| {
        EntityUpdate::new(entity, EntityData::Line(SeriesStyle::new(name, colour)))
    };
    let mut rows: Vec<EntityUpdate> = signals(kitchen, session.spec.highlights(kitchen))
        .iter()
        .zip(entity_content::CURVES.into_iter().cycle())
        .map(|((_, signal), colour)| line(benefit(signal), wording::signal(signal), colour))
        .collect();
    let worth = match assistant.concept.name().unit() {
        BenefitUnit::Deviation => format!("0: the threshold of {}", assistant.price()),
        BenefitUnit::Presses | BenefitUnit::None => format!("0: saves its cost of {} presses", assistant.price()),
    };
    rows.push(line(COST_LINE.to_string(), worth, entity_content::SIGNAL));
    let marks = SeriesStyle::new("errors", entity_content::ERROR);
    rows.push(EntityUpdate::new(ERROR_MARKS, EntityData::Marks(marks, MarkShape::Cross)));
    let sent = SeriesStyle::new("sent", entity_content::SIGNAL);
    rows.push(EntityUpdate::new(SENT_MARKS, EntityData::Marks(sent, MarkShape::Diamond)));
    rows.push(EntityUpdate::new(SIGNAL_PAGE, EntityData::Page(NO_SIGNAL.to_string())));
    rows
}

fn say(entity: &str, level: SceneLogLevel, text: String, colour: SceneColour) -> EntityUpdate {
    EntityUpdate::new(entity, EntityData::Words { level, text, colour })
}

/// Only the lines of the text log among these updates, in the order of time and broken where the viewer would cut them.
pub fn in_order(rows: &[EntityUpdate]) -> Vec<EntityUpdate> {
    let line = |row: &EntityUpdate| {
        let EntityData::Words { level, text, colour } = &row.shown else { return None };
        Some(say(HAPPENED, *level, broken(text), *colour))
    };
    rows.iter().filter_map(line).collect()
}

/// A text in lines of whole words.
fn broken(text: &str) -> String {
    let (mut broken, mut length) = (String::new(), 0);
    for word in text.split(' ') {
        let letters = word.chars().count();
        if length > 0 && length + 1 + letters > LINE {
            broken.push('\n');
            length = 0;
        } else if !broken.is_empty() {
            broken.push(' ');
            length += 1;
        }
        broken.push_str(word);
        length += letters;
    }
    broken
}

/// The signal that was sent at a time, with its number: "signal 2: recipe of order 1, by the assistant; saves …".
pub fn numbered(follower: &SessionFollower, sent: SessionTime) -> Option<String> {
    let nth = follower.signals.shown.iter().rposition(|shown| shown.time == sent)?;
    let words = signal_words::sent(follower, &follower.signals.shown[nth]).join("; ");
    Some(format!("signal {}: {words}", nth + 1))
}

/// Who did what, in words; of an error without effect only the button, since the reason of the error says why.
pub fn told(session: &Session, entry: &TimelineEntry, is_error: bool) -> (&'static str, String) {
    match entry.what {
        TimelineEvent::Press { agent: Agent::Human, button, no_effect: Some(_), .. } if is_error => {
            (Agent::Human.name(), wording::button(&session.kitchen, Agent::Human, button))
        }
        _ => event_words::happening(&session.kitchen, &entry.what),
    }
}

/// A line of the text log for a new entry of the timeline; presses that were judged errors are marked.
pub fn entry(
    session: &Session,
    entry: &TimelineEntry,
    pressed: Option<JudgedPressShown<'_>>,
    follower: &SessionFollower,
) -> EntityUpdate {
    let is_error = pressed.is_some_and(|pressed| pressed.press.verdict.error);
    let (who, text) = told(session, entry, is_error);
    let text = if who.is_empty() { text } else { format!("{who}: {text}") };
    match &entry.what {
        &TimelineEvent::Press { agent, no_effect, .. } => {
            let entity = format!("{}/presses", agent.name());
            match pressed.filter(|_| agent == Agent::Human) {
                Some(judged) if judged.press.verdict.race => {
                    let text = format!("{text} (race with the robot, no error)");
                    say(&entity, SceneLogLevel::Warning, text, entity_content::HUMAN)
                }
                Some(error) if error.press.verdict.error => {
                    let text = format!("ERROR {}, {text}: {}", error.number, error.why(session));
                    say(&entity, SceneLogLevel::Error, text, entity_content::ERROR)
                }
                _ if no_effect.is_none() => {
                    say(&entity, SceneLogLevel::Info, text, entity_content::agent_colour(agent))
                }
                _ => say(&entity, SceneLogLevel::Warning, text, entity_content::agent_colour(agent)),
            }
        }
        TimelineEvent::Noted(Event::SignalShown { by, .. }) => {
            let told = numbered(follower, entry.time).unwrap_or(text);
            let entity = match by {
                Sender::Wizard => "wizard/signals",
                Sender::Assistant => "assistant/signals",
            };
            say(entity, SceneLogLevel::Info, told, entity_content::SIGNAL)
        }
        TimelineEvent::Noted(Event::SignalEnded { .. }) => {
            say("wizard/signals", SceneLogLevel::Warning, text, entity_content::SIGNAL)
        }
        TimelineEvent::Noted(Event::RobotSafety { .. } | Event::RobotStage { .. }) => {
            say("robot/events", SceneLogLevel::Error, text, entity_content::ERROR)
        }
        TimelineEvent::Noted(Event::RobotTouched { .. }) => {
            say("robot/events", SceneLogLevel::Warning, text, entity_content::ROBOT)
        }
        _ if who == "wizard" || who == "note" => say("wizard/hands", SceneLogLevel::Info, text, entity_content::SIGNAL),
        _ => say("trial/events", SceneLogLevel::Info, text, entity_content::QUIET),
    }
}

pub fn protocol(event: &ProtocolEvent) -> EntityUpdate {
    say("trial/events", SceneLogLevel::Info, event_words::protocol(event), entity_content::QUIET)
}

/// Words of a time mark, whose own line has none.
pub fn mark_worded(session: &Session, note: &str) -> EntityUpdate {
    let text = format!("note: {}", event_words::mark_worded(session, note));
    say("wizard/hands", SceneLogLevel::Info, text, entity_content::SIGNAL)
}

/// A press of the human as it was judged.
#[derive(Clone, Copy, Debug)]
pub struct JudgedPressShown<'a> {
    /// Of an error, its number among the errors of the trial, from 1.
    pub number: usize,
    pub press: &'a JudgedPress,
}

impl JudgedPressShown<'_> {
    /// Why the press was an error, with its cost and its cause.
    pub fn why(&self, session: &Session) -> String {
        let explained = ExplainedError::among(session, std::slice::from_ref(self.press));
        explained.iter().map(|error| error.told_without_press(None)).collect()
    }
}

/// The judgement of the press in this event, if it is one that counts.
pub fn judged<'a>(stamped: &TimestampedEvent, follower: &'a SessionFollower) -> Option<JudgedPressShown<'a>> {
    let (index, press) = follower.judgement(stamped.seq)?;
    let number = follower.judged[..=index].iter().filter(|press| press.verdict.error).count();
    Some(JudgedPressShown { number, press })
}

/// The line at the cost of communication, which is known before any advice.
pub fn cost_line() -> EntityUpdate {
    EntityUpdate::new(COST_LINE, EntityData::Value(0.0))
}

pub fn mark() -> EntityUpdate {
    EntityUpdate::new(ERROR_MARKS, EntityData::Value(0.0))
}

/// The signals whose net benefit is shown.
#[derive(Clone, Debug, Default)]
pub struct AdviceScene {
    /// The signals that were advised or sent so far: a curve begins where its signal is the first time, so that plot and
    /// legend have only those.
    advised: Vec<Signal>,
    /// Those whose curves have a value now, with it: a signal that can be sent no more has none.
    valued: Vec<(Signal, f64)>,
}

impl AdviceScene {
    /// Ends the curves of signals without a value, other than these.
    fn keep(&mut self, has_value: impl Fn(&Signal) -> bool) -> Vec<EntityUpdate> {
        let (kept, over): (Vec<_>, Vec<_>) = self.valued.drain(..).partition(|(signal, _)| has_value(signal));
        self.valued = kept;
        // The curve is drawn up to its last row with a value.
        let ends = |(signal, net): &(Signal, f64)| {
            [EntityData::Value(*net), EntityData::NoValue].map(|shown| EntityUpdate::new(benefit(signal), shown))
        };
        over.iter().flat_map(ends).collect()
    }

    /// A signal was sent: its value by the last advice is marked on its curve, which lasts until the next advice, also if
    /// the signal was never advised.
    pub fn sent(&mut self, sent: &Signal, follower: &SessionFollower) -> Vec<EntityUpdate> {
        let record = follower.signals.shown.iter().rfind(|shown| shown.signal == *sent);
        let Some(net) = record.and_then(|record| record.worth.as_ref()).map(|worth| worth.net) else {
            return self.keep(|signal| signal != sent);
        };
        if !self.advised.contains(sent) {
            self.advised.push(sent.clone());
        }
        self.valued.retain(|(signal, _)| signal != sent);
        self.valued.push((sent.clone(), net));
        [benefit(sent), SENT_MARKS.to_string()].map(|entity| EntityUpdate::new(entity, EntityData::Value(net))).into()
    }

    /// The trial is over.
    pub fn ended(&mut self) -> Vec<EntityUpdate> {
        self.keep(|_| false)
    }

    /// Entity updates with the net benefits of signals, and with the recommendation in words.
    pub fn follow(&mut self, advice: &Recommendation, told: &str) -> Vec<EntityUpdate> {
        if let Some(best) = advice.best.as_ref().filter(|best| !self.advised.contains(best)) {
            self.advised.push(best.clone());
        }
        let advised = &self.advised;
        let drawn = advice.options.iter().filter(|option| advised.contains(&option.signal));
        let drawn: Vec<_> = drawn.collect();
        let mut rows = self.keep(|signal| drawn.iter().any(|option| option.signal == *signal));
        rows.extend(
            drawn.iter().map(|option| EntityUpdate::new(benefit(&option.signal), EntityData::Value(option.net))),
        );
        self.valued = drawn.into_iter().map(|option| (option.signal.clone(), option.net)).collect();
        rows.push(cost_line());
        if !told.is_empty() {
            let text = format!("assistant {told}");
            rows.push(say("assistant/advice", SceneLogLevel::Info, text, entity_content::SIGNAL));
        }
        rows
    }
}

/// The signals that were shown, each with what became of it.
#[derive(Clone, Debug)]
pub struct SignalScene {
    /// Number of signals whose end was told.
    told: usize,
    is_over: bool,
}

impl SignalScene {
    /// In a session that goes on, the signals so far are told already.
    pub fn new(session: &Session) -> SignalScene {
        let is_signal = |entry: &&TimelineEntry| matches!(entry.what, TimelineEvent::Noted(Event::SignalShown { .. }));
        let shown = session.timeline.iter().filter(is_signal).count();
        SignalScene { told: shown.saturating_sub(session.shown.iter().count()), is_over: session.is_trial_over() }
    }

    /// Entity updates after an event that was just applied: a line for a signal that is over, and the page of all.
    pub fn follow(&mut self, session: &Session, follower: &SessionFollower) -> Vec<EntityUpdate> {
        let mut rows = Vec::new();
        let shown = &follower.signals.shown;
        let (told, was_over) = (self.told, self.is_over);
        while shown.get(self.told).and_then(|shown| shown.ended).is_some_and(|ended| ended <= session.time) {
            let signal = wording::signal(&shown[self.told].signal);
            let outcome = signal_words::outcome(follower, self.told);
            let text = format!("signal {} over, {signal}: {outcome}", self.told + 1);
            rows.push(say("signals/over", SceneLogLevel::Info, text, entity_content::SIGNAL));
            self.told += 1;
        }
        self.is_over = session.is_trial_over();
        if self.told > told || self.is_over && !was_over {
            rows.push(EntityUpdate::new(SIGNAL_PAGE, EntityData::WholePage(signal_page(follower, self.told))));
        }
        rows
    }
}

/// The page of the signals: of the newest while the trial runs, of all after it. `over`: number of signals that are over.
fn signal_page(follower: &SessionFollower, over: usize) -> String {
    let (session, verdicts) = (&follower.session, signal_verdicts(follower));
    let told = |(nth, shown): (usize, &ShownSignalRecord)| {
        let at = moment_on_clock(session.trial_clock_at(shown.time));
        let outcome = if nth < over { signal_words::outcome(follower, nth) } else { String::new() };
        let became = [signal_words::judged(follower, verdicts.as_deref(), nth), outcome];
        let became: String = became.iter().filter(|part| !part.is_empty()).map(|part| format!("- {part}\n")).collect();
        format!("**{}**, {at}: {}\n\n{became}\n\n", nth + 1, signal_words::sent(follower, shown).join("; "))
    };
    let shown = &follower.signals.shown;
    let earlier = if session.is_trial_over() { 0 } else { shown.len().saturating_sub(NEWEST) };
    let first = match earlier {
        _ if shown.is_empty() => NO_SIGNAL.to_string(),
        0 => String::new(),
        _ => format!("Signals 1 to {earlier} are told after the trial, and in the log.\n\n"),
    };
    first + &shown.iter().enumerate().skip(earlier).map(told).collect::<String>()
}

/// What the assistant recommends, in words; empty if it recommends nothing.
pub fn advised(session: &Session, advice: &Recommendation) -> String {
    let unit = session.spec.assistant.concept.name().unit();
    let signal = signal_words::advised(&session.kitchen, unit, advice).map(|told| format!("advises: {told}"));
    let proposal =
        advice.proposal.as_ref().map(|proposal| format!("proposes: {}", wording::proposal(&proposal.presses)));
    [signal, proposal].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

pub fn offer_opened(offer: &OfferedAdvice) -> EntityUpdate {
    let unseen = if offer.visible { "" } else { " (not visible to a wizard)" };
    let text = format!("offer to the wizard: {}{unseen}", wording::signal(&offer.what));
    say("assistant/offers", SceneLogLevel::Info, text, entity_content::SIGNAL)
}

pub fn offer_closed(reason: OfferCloseReason) -> EntityUpdate {
    say("assistant/offers", SceneLogLevel::Info, format!("offer closes: {}", reason.words()), entity_content::SIGNAL)
}
