//! The dialogue with an external participant: it is told what a person at the display sees, and answers with presses.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::concept::{AnswerId, introduction, line};
use super::link::{Exchange, is_of_no_question};
use super::{
    ExternalEvent, ExternalMinds, MOST_FAULTS, MindConnection, MindFault, MindNews, MindRole, PROTOCOL,
    STARTS_WITHIN_S, ToldBelief, check_belief, recorded_text,
};
use crate::{Event, Session};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::settings::ExternalMind;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, State, StateAspect};
use tomcom_core::mind::{AspectBelief, RecordedBelief, WORTH_TELLING, rounded};

#[derive(Clone, Debug, PartialEq, Serialize)]
struct ParticipantBegin {
    ask: &'static str,
    id: u64,
    protocol: u32,
    role: MindRole,
    seed: u64,
    scene: Value,
}

/// What a participant is told: the display's changing part, and the time. Nothing else has a way to it.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ParticipantQuestion<'a> {
    ask: &'static str,
    id: u64,
    time_s: f64,
    display: &'a Value,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct ParticipantAnswer {
    id: u64,
    #[serde(default)]
    press: Option<String>,
    #[serde(default)]
    after_s: Option<f64>,
    #[serde(default)]
    belief: Option<ToldBelief>,
}

/// Longest time to a press, or to the next question.
const LONGEST_S: f64 = 60.0;
/// Least time to either: so time goes on whatever is answered.
const LEAST_S: f64 = 0.1;

/// What a participant does next, and when.
#[derive(Clone, Debug, PartialEq)]
struct NextMove {
    at: SessionTime,
    /// `None`: it only wants to be asked again.
    press: Option<(String, Option<ToldBelief>)>,
}

/// An external participant that is waited for.
#[derive(Debug)]
pub struct WaitedParticipant {
    mind: ExternalMind,
    connection: MindConnection,
    asked: u64,
    /// What the display showed at the last question.
    shown: Value,
    next: Option<NextMove>,
    /// When it wanted to be asked again: the session's time stands where nothing happens.
    asked_for: SessionTime,
    faults: u64,
}

fn fault(fault: MindFault, found: String) -> Event {
    Event::External(ExternalEvent::Fault { role: MindRole::Participant, fault, found })
}

fn failed(kind: MindFault, found: &str) -> Exchange {
    let event = ExternalEvent::Fault { role: MindRole::Participant, fault: kind, found: recorded_text(found) };
    Exchange { failed: event.words(), events: vec![Event::External(event)] }
}

impl WaitedParticipant {
    /// Starts the program and waits for its first answer.
    pub fn open(session: &Session, command: &str, minds: &dyn ExternalMinds) -> (Option<WaitedParticipant>, Exchange) {
        let mind = ExternalMind::new(command);
        let mut connection = match minds.open(&mind) {
            Ok(connection) => connection,
            Err(found) => return (None, failed(MindFault::NotStarted, &found)),
        };
        let [scene, _] = minds.sight(session);
        let (ask, id, protocol, role, seed) = ("begin", 0, PROTOCOL, MindRole::Participant, session.seed() >> 11);
        let begin = line(&ParticipantBegin { ask, id, protocol, role, seed, scene });
        let answer = match connection.to.send(begin) {
            Ok(()) => connection.from.receive(Duration::from_secs_f64(STARTS_WITHIN_S)),
            Err(found) => MindNews::Over(found),
        };
        let name = match answer {
            MindNews::Line(text) => introduction(&text),
            MindNews::Nothing => Err((MindFault::Silent, format!("no answer within {STARTS_WITHIN_S} s"))),
            MindNews::Over(found) => Err((MindFault::Ended, found)),
        };
        match name {
            Err((kind, found)) => (None, failed(kind, &found)),
            Ok(name) => {
                let began = Event::External(ExternalEvent::Began { role, name });
                let shown = Value::Null;
                let one = WaitedParticipant {
                    mind,
                    connection,
                    asked: 0,
                    shown,
                    next: None,
                    asked_for: SessionTime::ZERO,
                    faults: 0,
                };
                (Some(one), Exchange { events: vec![began], failed: None })
            }
        }
    }

    /// When it presses or wants to be asked again.
    pub fn due(&self) -> Option<SessionTime> {
        self.next.as_ref().map(|next| next.at)
    }

    /// The events of the move that is due.
    pub fn act(&mut self, session: &Session) -> Vec<Event> {
        // The next question comes even if the display stays as it is.
        self.shown = Value::Null;
        let Some(next) = self.next.take() else { return Vec::new() };
        self.asked_for = next.at;
        let Some((button, belief)) = next.press else { return Vec::new() };
        let belief =
            belief.map(|belief| Event::ParticipantBelieves(recorded(&session.kitchen, session.state, &belief)));
        let press = Event::Press { agent: Agent::Human, button, at_ns: None };
        belief.into_iter().chain([press]).collect()
    }

    /// Asks it, if the display changed and no press is under way.
    pub fn look(&mut self, session: &Session, minds: &dyn ExternalMinds) -> Exchange {
        if !session.is_running() || self.next.as_ref().is_some_and(|next| next.press.is_some()) {
            return Exchange::default();
        }
        let [_, display] = minds.sight(session);
        if display == self.shown {
            return Exchange::default();
        }
        self.shown = display;
        self.next = None;
        self.asked += 1;
        let time_s = session.trial_clock(session.time.max(self.asked_for)).as_secs_f64();
        let question = line(&ParticipantQuestion { ask: "act", id: self.asked, time_s, display: &self.shown });
        let news = self.connection.ask(question, Duration::from_secs_f64(self.mind.wait_s));
        self.take_news(session, news)
    }

    /// What nobody asked for is passed over.
    fn take_news(&mut self, session: &Session, news: MindNews) -> Exchange {
        match news {
            MindNews::Line(text) => {
                let mut taken = self.take(session, &text);
                if taken.failed.is_none() && taken.events.iter().any(is_of_no_question) {
                    let news = self.connection.from.receive(Duration::from_secs_f64(self.mind.wait_s));
                    let Exchange { events, failed } = self.take_news(session, news);
                    taken.events.extend(events);
                    taken.failed = failed;
                }
                taken
            }
            MindNews::Nothing => failed(MindFault::Silent, &format!("no answer within {} s", self.mind.wait_s)),
            MindNews::Over(found) => failed(MindFault::Ended, &found),
        }
    }

    fn take(&mut self, session: &Session, text: &str) -> Exchange {
        match self.next_move(session, text) {
            Ok(next) => {
                self.next = next;
                Exchange::default()
            }
            Err((kind, found)) => {
                self.faults += 1;
                if self.faults >= MOST_FAULTS {
                    return failed(MindFault::GivenUp, &format!("{MOST_FAULTS} faults; the last: {found}"));
                }
                Exchange { events: vec![fault(kind, recorded_text(&found))], failed: None }
            }
        }
    }

    fn next_move(&self, session: &Session, text: &str) -> Result<Option<NextMove>, (MindFault, String)> {
        let malformed = |found: String| (MindFault::Malformed, found);
        let AnswerId { id } = serde_json::from_str(text).map_err(|error| malformed(format!("{error} in {text}")))?;
        if id != self.asked {
            return Err((MindFault::Unasked, format!("an answer to question {id}")));
        }
        let answer: ParticipantAnswer =
            serde_json::from_str(text).map_err(|error| malformed(format!("{error} in {text}")))?;
        if answer.after_s.is_some_and(|after_s| !(0.0..=LONGEST_S).contains(&after_s)) {
            return Err(malformed(format!("after_s that is not from 0 to {LONGEST_S}")));
        }
        let kitchen = &session.kitchen;
        if let Some(belief) = &answer.belief {
            check_belief(kitchen, belief).map_err(malformed)?;
            if let Some(left_out) = kitchen.aspects.iter().find(|aspect| !belief.contains_key(&aspect.name)) {
                return Err(malformed(format!("a belief without {}; right would be every aspect", left_out.name)));
            }
        }
        let now = session.time.max(self.asked_for);
        let at = |after_s: f64| now + SessionTime::from_secs_f64(after_s.max(LEAST_S));
        match answer.press {
            Some(button) if kitchen.button_named(Agent::Human, &button).is_none() => {
                Err(malformed(format!("a press of {button}, which is no button of the human")))
            }
            Some(button) => {
                let press = Some((button, answer.belief));
                Ok(Some(NextMove { at: at(answer.after_s.unwrap_or_default()), press }))
            }
            None => Ok(answer.after_s.map(|after_s| NextMove { at: at(after_s), press: None })),
        }
    }
}

/// A participant's belief as recordings have it.
fn recorded(kitchen: &Kitchen, state: State, belief: &ToldBelief) -> RecordedBelief {
    let of = |(index, aspect): (usize, &StateAspect)| {
        let told = belief.get(&aspect.name)?;
        // The sum can be off by rounding.
        let sum: f64 = told.values().sum();
        let told: BTreeMap<&String, f64> = told.iter().map(|(value, p)| (value, p / sum)).collect();
        let truth = &aspect.labels[kitchen.true_value(state, AspectId(index as u8))];
        let most = told.iter().max_by(|a, b| a.1.total_cmp(b.1)).map(|(value, _)| (*value).clone())?;
        let values: BTreeMap<String, f64> = told
            .iter()
            .filter(|(_, p)| **p >= WORTH_TELLING)
            .map(|(value, &p)| ((*value).clone(), rounded(p)))
            .collect();
        let p_truth = rounded(told.get(truth).copied().unwrap_or_default());
        Some(AspectBelief { aspect: aspect.name.clone(), believes: most, p_truth, values })
    };
    let aspects = kitchen.aspects.iter().enumerate().filter_map(of).collect();
    RecordedBelief { aspects, ..RecordedBelief::default() }
}
