//! The dialogue with an external participant: it is told what a person at the display sees, and answers with presses.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::concept::{AnswerId, introduction, line};
use super::{
    DialogueOutcome, ExternalEvent, MOST_FAULTS, MindDialogue, MindFault, MindRole, PROTOCOL, ToldBelief, check_belief,
    malformed, parsed, recorded_text,
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

/// The dialogue of one session with its external participant.
#[derive(Clone, Debug)]
pub struct ParticipantDialogue {
    mind: ExternalMind,
    began: bool,
    asked: u64,
    /// Whether the last question still waits for its answer.
    waits: bool,
    /// When the last question was asked: moves are timed from there.
    asked_at: SessionTime,
    /// Whether it was told that the last question has no answer for long.
    told_silence: bool,
    /// What the display showed at the last question.
    shown: Value,
    next: Option<NextMove>,
    /// When it wanted to be asked again: the session's time stands where nothing happens.
    asked_for: SessionTime,
    faults: u64,
    is_over: bool,
}

impl MindDialogue for ParticipantDialogue {
    fn mind(&self) -> &ExternalMind {
        &self.mind
    }

    fn has_begun(&self) -> bool {
        self.began
    }

    /// Too many faults end the dialogue, as does the end of the connection.
    fn failed(&mut self, kind: MindFault, found: &str) -> DialogueOutcome {
        if self.is_over {
            return DialogueOutcome::default();
        }
        self.faults += 1;
        let given_up = self.faults >= MOST_FAULTS;
        self.is_over = given_up || kind.is_final();
        if self.is_over {
            self.next = None;
        }
        let (fault, found) = match given_up {
            true => (MindFault::GivenUp, format!("{MOST_FAULTS} faults; the last: {found}")),
            false => (kind, found.to_string()),
        };
        let event = ExternalEvent::Fault { role: MindRole::Participant, fault, found: recorded_text(&found) };
        DialogueOutcome { events: vec![Event::External(event)], ends: self.is_over }
    }
}

impl ParticipantDialogue {
    pub fn new(command: &str) -> ParticipantDialogue {
        ParticipantDialogue {
            mind: ExternalMind::new(command),
            began: false,
            asked: 0,
            waits: false,
            asked_at: SessionTime::ZERO,
            told_silence: false,
            shown: Value::Null,
            next: None,
            asked_for: SessionTime::ZERO,
            faults: 0,
            is_over: false,
        }
    }

    /// The first question.
    pub fn begin(&self, session: &Session, scene: Value) -> String {
        let (role, seed) = (MindRole::Participant, session.seed() >> 11);
        line(&ParticipantBegin { ask: "begin", id: 0, protocol: PROTOCOL, role, seed, scene })
    }

    /// When it presses or wants to be asked again, while the trial runs.
    pub fn due(&self, session: &Session) -> Option<SessionTime> {
        self.next.as_ref().filter(|_| session.is_running()).map(|next| next.at)
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
        let press = Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false };
        belief.into_iter().chain([press]).collect()
    }

    /// The next question, if the display changed, and neither a press nor an answer is under way.
    pub fn question(&mut self, session: &Session, now: SessionTime, display: impl FnOnce() -> Value) -> Option<String> {
        let is_pressing = self.next.as_ref().is_some_and(|next| next.press.is_some());
        if !session.is_running() || !self.began || self.waits || is_pressing || self.is_over {
            return None;
        }
        let display = display();
        if display == self.shown {
            return None;
        }
        (self.shown, self.next) = (display, None);
        self.asked += 1;
        self.asked_at = now.max(self.asked_for);
        (self.waits, self.told_silence) = (true, false);
        let time_s = session.trial_clock(self.asked_at).as_secs_f64();
        Some(line(&ParticipantQuestion { ask: "act", id: self.asked, time_s, display: &self.shown }))
    }

    /// The fault of a program that leaves a question unanswered for long; told once a question.
    pub fn silence(&mut self, now: SessionTime) -> DialogueOutcome {
        let is_long = self.waits && now.secs_since(self.asked_at) >= self.mind.wait_s;
        if !is_long || self.is_over || std::mem::replace(&mut self.told_silence, true) {
            return DialogueOutcome::default();
        }
        self.failed(MindFault::Silent, &format!("no answer for {:.0} s", self.mind.wait_s))
    }

    /// The events of a line that came back.
    pub fn take(&mut self, session: &Session, text: &str) -> DialogueOutcome {
        if self.is_over {
            return DialogueOutcome::default();
        }
        if !self.began {
            return match introduction(text) {
                Ok(name) => {
                    self.began = true;
                    let began = Event::External(ExternalEvent::Began { role: MindRole::Participant, name });
                    DialogueOutcome { events: vec![began], ends: false }
                }
                Err((kind, found)) => self.failed(kind, &found),
            };
        }
        match self.next_move(session, text) {
            Ok(next) => {
                (self.next, self.waits) = (next, false);
                DialogueOutcome::default()
            }
            Err((kind, found)) => {
                // A wrong answer is one to wait: only an answer to no question leaves the question open.
                self.waits &= kind == MindFault::Unasked;
                self.failed(kind, &found)
            }
        }
    }

    fn next_move(&self, session: &Session, text: &str) -> Result<Option<NextMove>, (MindFault, String)> {
        let AnswerId { id } = parsed(text)?;
        if id != self.asked || !self.waits {
            return Err((MindFault::Unasked, format!("an answer to question {id}")));
        }
        let answer: ParticipantAnswer = parsed(text)?;
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
        let at = |after_s: f64| self.asked_at + SessionTime::from_secs_f64(after_s.max(LEAST_S));
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
