//! The dialogue with an external concept: questions from requests for advice, and recommendations from answers.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::happenings::Happening;
use super::kitchen_description::{describe, true_values};
use super::{
    DialogueOutcome, ExternalEvent, MOST_FAULTS, MindDialogue, MindFault, MindRole, PROTOCOL, ToldBelief, check_belief,
    malformed, parsed, recorded_text,
};
use crate::advisor::AdviceRequest;
use crate::{Event, Session};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::{DecisionPoint, RobotIntent};
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_core::communication::settings::ExternalMind;
use tomcom_core::communication::{Signal, unavailable};
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::{WORTH_TELLING, rounded};

/// The first question, which is answered with `name` and `protocol`.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ConceptBegin {
    ask: &'static str,
    id: u64,
    protocol: u32,
    role: MindRole,
    /// For the program's random numbers: of the trial, and below 2^53.
    seed: u64,
    cost_of_communication: f64,
    signal_shown_s: f64,
    kitchen: Value,
}

/// A question for advice.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ConceptQuestion<'a> {
    ask: &'static str,
    id: u64,
    /// The trial's clock.
    time_s: f64,
    /// Presses of both agents so far.
    presses: u32,
    /// The true value of every aspect.
    state: BTreeMap<String, String>,
    robot: ToldRobot,
    since: &'a [Happening],
    signals: &'a [Signal],
    /// Our estimate of the participant's belief, if the settings tell it.
    #[serde(skip_serializing_if = "Option::is_none")]
    estimate: Option<ToldBelief>,
}

/// What the robot is doing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct ToldRobot {
    /// The button that it is about to press, and in how many seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    button: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    in_s: Option<f64>,
    /// Whether the wizard stopped or holds it.
    still: bool,
}

/// The answer to the first question.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct BeginAnswer {
    id: u64,
    protocol: u32,
    name: String,
}

/// An answer to a question for advice: a value for each signal in their order, or the signal to send, or neither.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConceptAnswer {
    id: u64,
    #[serde(default)]
    values: Option<Vec<f64>>,
    #[serde(default)]
    send: Option<Signal>,
    #[serde(default)]
    reason: Option<String>,
    #[serde(default)]
    belief: Option<ToldBelief>,
}

/// Only the number of an answer.
#[derive(Deserialize)]
pub(super) struct AnswerId {
    pub id: u64,
}

/// A question that is not answered yet.
#[derive(Clone, Debug)]
struct PendingQuestion {
    id: u64,
    seq: u64,
    time: SessionTime,
    signals: Vec<Signal>,
}

/// The dialogue of one session with its external concept.
#[derive(Clone, Debug)]
pub struct ConceptDialogue {
    kitchen: Arc<Kitchen>,
    mind: ExternalMind,
    cost_of_communication: f64,
    began: bool,
    asked: u64,
    pending: Option<PendingQuestion>,
    /// Numbers of earlier questions that have no answer yet, each with the event that it was about.
    unanswered: BTreeMap<u64, u64>,
    /// Since when no question was answered, and whether that was told.
    silent: Option<(SessionTime, bool)>,
    faults: u64,
    is_over: bool,
}

impl MindDialogue for ConceptDialogue {
    fn mind(&self) -> &ExternalMind {
        &self.mind
    }

    fn has_begun(&self) -> bool {
        self.began
    }

    fn failed(&mut self, fault: MindFault, found: &str) -> DialogueOutcome {
        if self.is_over {
            return DialogueOutcome::default();
        }
        self.is_over |= fault.is_final();
        let event = self.fault(fault, found);
        self.after(vec![event])
    }
}

impl ConceptDialogue {
    pub fn new(session: &Session, mind: &ExternalMind) -> ConceptDialogue {
        ConceptDialogue {
            kitchen: session.kitchen.clone(),
            mind: mind.clone(),
            cost_of_communication: session.spec.assistant.cost_of_communication,
            began: false,
            asked: 0,
            pending: None,
            unanswered: BTreeMap::new(),
            silent: None,
            faults: 0,
            is_over: false,
        }
    }

    /// Whether the last question still waits for its answer.
    pub fn is_waiting(&self) -> bool {
        !self.is_over && (!self.began || self.pending.is_some())
    }

    /// The first question.
    pub fn begin(&self, session: &Session) -> String {
        line(&ConceptBegin {
            ask: "begin",
            id: 0,
            protocol: PROTOCOL,
            role: MindRole::Concept,
            seed: session.seed() >> 11,
            cost_of_communication: self.cost_of_communication,
            signal_shown_s: session.spec.signals.shown_s,
            kitchen: describe(&session.kitchen),
        })
    }

    /// The question for a request for advice; an earlier one that has no answer is given up.
    pub fn question(&mut self, request: &AdviceRequest) -> (String, Vec<Event>) {
        let DecisionPoint { seq, time, presses, situation, signals, .. } = request.moment();
        // What the rule against repeats allows, and can be sent in this state.
        let can_be_sent = |signal: &&Signal| unavailable(&self.kitchen, situation.state, signal).is_none();
        let signals: Vec<Signal> = signals.iter().filter(can_be_sent).cloned().collect();
        self.asked += 1;
        if let Some(earlier) = self.pending.take() {
            self.unanswered.insert(earlier.id, earlier.seq);
        }
        let events = self.told_silence(time);
        let kitchen = &self.kitchen;
        let button = |id| kitchen.button(Agent::Robot, id).name.clone();
        let robot = match situation.robot {
            RobotIntent::Busy { button: id, remaining_s, .. } => {
                ToldRobot { button: Some(button(id)), in_s: Some(rounded(remaining_s)), still: false }
            }
            RobotIntent::Free => ToldRobot::default(),
            RobotIntent::Still => ToldRobot { still: true, ..ToldRobot::default() },
        };
        let question = ConceptQuestion {
            ask: "signal",
            id: self.asked,
            time_s: request.clock_s,
            presses,
            state: true_values(kitchen, situation.state),
            robot,
            since: &request.since,
            signals: &signals,
            estimate: self.mind.estimate.then(|| told_estimate(kitchen, situation.belief)),
        };
        let question = line(&question);
        self.pending = Some(PendingQuestion { id: self.asked, seq, time, signals });
        (question, events)
    }

    /// The fault of a program that has left questions unanswered for long; told once per silence.
    fn told_silence(&mut self, now: SessionTime) -> Vec<Event> {
        let (since, is_told) = *self.silent.get_or_insert((now, false));
        if is_told || self.unanswered.is_empty() || now.secs_since(since) < self.mind.wait_s {
            return Vec::new();
        }
        self.silent = Some((since, true));
        vec![self.fault(MindFault::Silent, &format!("no answer for {:.0} s", now.secs_since(since)))]
    }

    /// The events of a line that came back.
    pub fn take(&mut self, text: &str) -> DialogueOutcome {
        if self.is_over {
            return DialogueOutcome::default();
        }
        let taken = if self.began { self.answer(text) } else { self.introduced(text) };
        let events = taken.unwrap_or_else(|(fault, found)| vec![self.fault(fault, &found)]);
        self.after(events)
    }

    /// Gives a program up that makes too many faults.
    fn after(&mut self, mut events: Vec<Event>) -> DialogueOutcome {
        if self.faults >= MOST_FAULTS && !self.is_over {
            self.is_over = true;
            events.push(self.fault(MindFault::GivenUp, &format!("{MOST_FAULTS} faults")));
        }
        DialogueOutcome { events, ends: self.is_over }
    }

    fn fault(&mut self, fault: MindFault, found: &str) -> Event {
        self.faults += 1;
        Event::External(ExternalEvent::Fault { role: MindRole::Concept, fault, found: recorded_text(found) })
    }

    fn introduced(&mut self, text: &str) -> Result<Vec<Event>, (MindFault, String)> {
        let name = introduction(text)?;
        self.began = true;
        Ok(vec![Event::External(ExternalEvent::Began { role: MindRole::Concept, name })])
    }

    fn answer(&mut self, text: &str) -> Result<Vec<Event>, (MindFault, String)> {
        // Whatever it says, it is not silent.
        self.silent = None;
        let AnswerId { id } = parsed(text)?;
        if let Some(for_seq) = self.unanswered.remove(&id) {
            let (role, answer) = (MindRole::Concept, recorded_text(text));
            return Ok(vec![Event::External(ExternalEvent::Late { role, for_seq, answer })]);
        }
        let Some(pending) = self.pending.take_if(|pending| pending.id == id) else {
            return Err((MindFault::Unasked, format!("an answer to question {id}")));
        };
        self.unanswered.clear();
        let answer: ConceptAnswer = parsed(text)?;
        if let Some(belief) = &answer.belief {
            check_belief(&self.kitchen, belief).map_err(malformed)?;
        }
        let advice = self.advice(&pending, &answer).map_err(malformed)?;
        let (role, for_seq) = (MindRole::Concept, pending.seq);
        let belief = answer.belief.map(|belief| Event::External(ExternalEvent::Believes { role, for_seq, belief }));
        Ok(belief.into_iter().chain([Event::Advised(advice)]).collect())
    }

    fn advice(&self, pending: &PendingQuestion, answer: &ConceptAnswer) -> Result<Recommendation, String> {
        let words = answer.reason.as_deref().map(recorded_text).filter(|words| !words.is_empty());
        let silent = Recommendation { words, ..Recommendation::silent(pending.seq, pending.time) };
        match (&answer.values, &answer.send) {
            (Some(_), Some(_)) => Err("values and a signal to send; right would be one of them".to_string()),
            (None, None) => Ok(silent),
            (None, Some(signal)) if pending.signals.contains(signal) => {
                Ok(Recommendation { best: Some(signal.clone()), ..silent })
            }
            (None, Some(signal)) => Err(format!("the signal {signal:?}, which is not among those of the question")),
            (Some(values), None) => {
                if values.len() != pending.signals.len() || values.iter().any(|value| !value.is_finite()) {
                    let (found, right) = (values.len(), pending.signals.len());
                    return Err(format!("{found} values; right would be {right} numbers, one for each signal"));
                }
                let option = |(signal, &value): (&Signal, &f64)| SignalOption {
                    signal: signal.clone(),
                    benefit: rounded(value),
                    standard_error: 0.0,
                    net: rounded(value - self.cost_of_communication),
                    rollouts: 0,
                };
                let mut options: Vec<SignalOption> = pending.signals.iter().zip(values).map(option).collect();
                // The sort is stable, so that signals of equal value keep the layout's order.
                options.sort_by(|a, b| b.benefit.total_cmp(&a.benefit));
                let best = options.first().filter(|option| option.net > 0.0).map(|option| option.signal.clone());
                Ok(Recommendation { options, best, ..silent })
            }
        }
    }
}

/// The program's name from its answer to the first question.
pub(super) fn introduction(text: &str) -> Result<String, (MindFault, String)> {
    let answer: BeginAnswer = serde_json::from_str(text)
        .map_err(|error| malformed(format!("{error} in the answer to the first question: {text}")))?;
    if answer.id != 0 {
        return Err((MindFault::Unasked, format!("an answer to question {}, before the first", answer.id)));
    }
    if answer.protocol != PROTOCOL {
        return Err(malformed(format!("protocol {}; right would be {PROTOCOL}", answer.protocol)));
    }
    Ok(recorded_text(&answer.name))
}

/// The expected probabilities of an estimate, of every value that has at least [`WORTH_TELLING`].
fn told_estimate(kitchen: &Kitchen, belief: &DirichletBelief) -> ToldBelief {
    let of = |index: usize| {
        let aspect = &kitchen.aspects[index];
        let values = aspect.labels.iter().zip(belief.aspects[index].mean()).filter(|(_, p)| **p >= WORTH_TELLING);
        (aspect.name.clone(), values.map(|(label, &p)| (label.clone(), rounded(p))).collect())
    };
    (0..kitchen.aspects.len()).map(of).collect()
}

/// A question as a line, without its end.
pub(super) fn line(question: &impl Serialize) -> String {
    // Maps of these types have texts as keys, and their numbers are finite, so nothing can fail.
    serde_json::to_string(question).unwrap_or_default()
}
