//! What signals would do, and did, in simulated trials: those that concepts would have sent in an unassisted trial, and
//! the usefulness of those that were sent.
//!
//! All values of the concepts' parameters are swept in one replay. The planner runs once per decision; all costs of
//! communication are then applied to the same benefits. A benefit has to be known only where it can exceed a cost at
//! which its signal may be sent.
//!
//! The usefulness of a signal is judged by a twin: the trial is run again from its recording; at every signal the run
//! is copied, and the copy continues with the same random streams and without this or any later signal, until the false
//! beliefs that the signal is about have ended. The signal is useful if the twin has more errors from these beliefs
//! than the trial had until the beliefs ended there. A proposal of k presses is useful if the twin has more errors in
//! its next k presses, whatever their cause, so that a prevented slip counts, too.

use std::collections::VecDeque;
use std::path::Path;

use crate::prevention::{HypotheticalSignal, TrialGroundTruth};
use crate::roc::{CONCEPTS, ConceptPreventionCounts, LEAST_COST, parameters};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{Concept, ConceptName, TomConcept};
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::recommendation::{SignalOption, aspects_told};
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::signal::SignalRepeatRule;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, KitchenChange};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::FalseBeliefEpisode;
use tomcom_core::mind::RecordedEstimate;
use tomcom_session::admit::is_external;
use tomcom_session::advisor::{AdviceRequest, leads_to_advice};
use tomcom_session::apply::ApplyError;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless::SimulatedRobotOperator;
use tomcom_session::log::{LogReader, event_line};
use tomcom_session::settings::Condition;
use tomcom_session::watcher::follows_at_once;
use tomcom_session::{AppliedEvent, Event, Session, TimestampedEvent, TrialPhase};

#[derive(Debug)]
struct SweptConcept {
    concept: ConceptName,
    parameter: f64,
    repeats: SignalRepeatRule,
    sent: Vec<HypotheticalSignal>,
}

/// Replays a session, and evaluates all communication concepts whenever the assistant is asked for advice.
#[derive(Debug)]
pub struct ConceptSweep {
    pub follower: SessionFollower,
    planner: Planner,
    tom: TomConcept,
    pub(super) cost: CostToGo,
    swept_concepts: Vec<SweptConcept>,
    /// Sequence number and time of the event after which the concepts are evaluated, once all events of the same time
    /// have been applied.
    pending: Option<(u64, SessionTime)>,
}

impl ConceptSweep {
    pub fn new(session: Session, cost: CostToGo) -> ConceptSweep {
        let (kitchen, spec) = (session.kitchen.clone(), &session.spec);
        // The planner computes as accurately as the smallest of the analysed costs of communication requires.
        let assistant = AssistantSpec { cost_of_communication: LEAST_COST, ..spec.assistant.clone() };
        let swept = |concept: ConceptName, parameter: f64| SweptConcept {
            concept,
            parameter,
            repeats: SignalRepeatRule::default(),
            sent: Vec::new(),
        };
        let of_concept = |concept: ConceptName| parameters(concept).into_iter().map(move |one| swept(concept, one));
        let signalling = CONCEPTS.into_iter().filter(|concept| *concept != ConceptName::Dev);
        ConceptSweep {
            planner: Planner::new(kitchen.clone(), &spec.human, assistant, session.seed()),
            tom: TomConcept::new(kitchen, 0.0),
            follower: SessionFollower::new(session, cost.clone()),
            cost,
            swept_concepts: signalling.flat_map(of_concept).collect(),
            pending: None,
        }
    }

    pub fn apply(&mut self, stamped: &TimestampedEvent) -> Result<KitchenChange, ApplyError> {
        if self.pending.is_some_and(|(_, time)| !follows_at_once(stamped, time)) {
            self.evaluate();
        }
        let AppliedEvent { change, .. } = self.follower.apply(stamped)?;
        if stamped.event.is_sample() {
            return Ok(change);
        }
        let session = &self.follower.session;
        for swept in &mut self.swept_concepts {
            if matches!(stamped.event, Event::TrialStarted) {
                swept.repeats = SignalRepeatRule::default();
            }
            swept.repeats.update(&session.kitchen, session.state, self.follower.filter.belief());
        }
        if leads_to_advice(session, &stamped.event) {
            self.pending = Some((stamped.seq, stamped.time));
        }
        Ok(change)
    }

    fn evaluate(&mut self) {
        let Some((seq, time)) = self.pending.take().filter(|_| self.follower.session.is_running()) else { return };
        let question = AdviceRequest::from_follower(&mut self.follower, seq, time);
        let session = &self.follower.session;
        let (kitchen, state) = (&session.kitchen, session.state);
        let highlights = session.highlights();
        let moment = question.moment();
        let allowed: Vec<Vec<Signal>> =
            self.swept_concepts.iter().map(|swept| swept.repeats.allowed(kitchen, highlights)).collect();
        let least_cost = |signal: &Signal| least_cost(&self.swept_concepts, &allowed, signal);
        let benefits = self.planner.benefits(&mut self.cost, &moment, least_cost);
        let deviations = self.tom.advise(&mut self.cost, &moment).options;
        let press = session.presses[Agent::Human.index()] as usize;
        for (swept, allowed) in self.swept_concepts.iter_mut().zip(&allowed) {
            let options: &[SignalOption] = match swept.concept {
                ConceptName::TomCom => &benefits,
                _ => &deviations,
            };
            let best = options.iter().find(|option| allowed.contains(&option.signal));
            if let Some(option) = best.filter(|option| option.benefit > swept.parameter) {
                swept.repeats.shown(kitchen, state, &option.signal);
                swept.sent.push(HypotheticalSignal {
                    time,
                    press,
                    aspects: aspects_told(kitchen, state, &option.signal),
                });
            }
        }
    }

    /// Number of errors that each concept would have prevented with each parameter value, given the trial's true errors
    /// and false beliefs; to be called after the last event.
    pub fn swept(&self, truth: &TrialGroundTruth) -> Vec<ConceptPreventionCounts> {
        let signalled = self.swept_concepts.iter().map(|swept| ConceptPreventionCounts {
            concept: swept.concept,
            parameter: swept.parameter,
            count: truth.count_signals(&swept.sent),
        });
        let proposed = parameters(ConceptName::Dev).into_iter().map(|parameter| ConceptPreventionCounts {
            concept: ConceptName::Dev,
            parameter,
            count: truth.count_proposals(parameter as usize),
        });
        signalled.chain(proposed).collect()
    }
}

/// Smallest swept cost of communication at which ToM-Com may send this signal now, in presses; infinite if none may. A
/// false belief lasts for many presses, and each cost below its signal's benefit sends the signal once.
fn least_cost(swept_concepts: &[SweptConcept], allowed: &[Vec<Signal>], signal: &Signal) -> f64 {
    let of_planner = swept_concepts.iter().zip(allowed).filter(|(swept, _)| swept.concept == ConceptName::TomCom);
    let may_send = of_planner.filter(|(_, allowed)| allowed.contains(signal));
    may_send.map(|(swept, _)| swept.parameter).fold(f64::INFINITY, f64::min)
}

enum SignalScope {
    /// The signal can prevent errors that follow from false beliefs about these state aspects.
    Beliefs(Vec<AspectId>),
    Presses(usize),
}

struct TwinResult {
    time: SessionTime,
    scope: SignalScope,
    errors: u64,
}

/// Number of useful signals of a recorded trial of a simulated participant. `estimates`: those of the recording.
/// `cost`: the cost to go of the trial's kitchen, whose caches may be filled. `None` if the trial cannot be run again: the
/// program version that recorded it had other simulated participants, or this build lacks the robot's arm.
pub(super) fn useful_signals(
    recording: &Path,
    estimates: VecDeque<RecordedEstimate>,
    cost: CostToGo,
) -> FileResult<Option<u64>> {
    let mut log = LogReader::open(recording)?;
    let (kitchen, header) = (log.kitchen.clone(), log.header.clone());
    if header.session.require_built().is_err() {
        return Ok(None);
    }
    let mut again = SessionEngine::for_header(kitchen, &header, cost).with_recorded_estimates(estimates);
    let (mut produced, mut twins) = (VecDeque::new(), Vec::new());
    while let Some(line) = log.next_line()? {
        if produced.is_empty() {
            produced.extend(run_to(&mut again, &line.stamped, &mut twins));
        }
        let same = produced.pop_front().is_some_and(|one: TimestampedEvent| event_line(&one) == line.text);
        if !same {
            return Ok(None);
        }
    }
    let trial = again.into_follower();
    let is_useful = |one: &&TwinResult| one.errors > errors_after(&trial, one.time, &one.scope);
    Ok(Some(twins.iter().filter(is_useful).count() as u64))
}

/// Runs up to a recorded event, and a twin for every signal before it. Recommendations and estimates are taken from the
/// log.
fn run_to(
    again: &mut SessionEngine,
    recorded: &TimestampedEvent,
    twins: &mut Vec<TwinResult>,
) -> Vec<TimestampedEvent> {
    let is_signal = match &recorded.event {
        Event::SignalShown { .. } => true,
        Event::Advised(advice) => {
            let may_act = advice.best.is_some() || advice.proposal.is_some();
            may_act && again.session().spec.trial.condition == Condition::Assistant
        }
        _ => false,
    };
    let before = is_signal.then(|| again.clone());
    let mut events = Vec::new();
    if is_external(again.session(), &recorded.event) {
        events = again.input(recorded.time, recorded.event.clone()).events;
    } else {
        // The participant can act without an event, so the next due action is tried until an event occurs.
        while events.is_empty() && again.next_due().is_some_and(|due| due <= recorded.time) {
            events = again.fire();
        }
    }
    let _ = again.take_questions();
    let shown = events.iter().find_map(|stamped| match &stamped.event {
        Event::SignalShown { signal, .. } => Some((stamped.time, signal)),
        _ => None,
    });
    if let (Some(before), Some((time, signal))) = (before, shown) {
        twins.push(twin(before.unassisted(), time, signal));
    }
    events
}

/// Continues without further signals until the false beliefs that the signal is about have ended.
fn twin(mut engine: SessionEngine, time: SessionTime, signal: &Signal) -> TwinResult {
    let session = engine.session();
    let scope = match signal {
        Signal::Propose(presses) => SignalScope::Presses(presses.len()),
        signal => SignalScope::Beliefs(aspects_told(&session.kitchen, session.state, signal)),
    };
    let presses = engine.judged().len();
    let mut attendant = SimulatedRobotOperator::default();
    while engine.session().phase == TrialPhase::Running || engine.session().is_frozen() {
        attendant.step(&mut engine);
        let _ = engine.take_questions();
        // The belief is over once the twin's recorded beliefs, which are recorded before each press, say so.
        let is_over = match &scope {
            SignalScope::Beliefs(told) => {
                let corrected = open_at(engine.follower(), time, told).all(|episode| episode.corrected.is_some());
                corrected && engine.judged().len() > presses
            }
            SignalScope::Presses(next) => engine.judged().len() >= presses + next,
        };
        if is_over {
            break;
        }
    }
    let errors = errors_after(engine.follower(), time, &scope);
    TwinResult { time, scope, errors }
}

fn open_at<'a>(
    follower: &'a SessionFollower,
    time: SessionTime,
    told: &'a [AspectId],
) -> impl Iterator<Item = &'a FalseBeliefEpisode> {
    let is_open =
        move |episode: &&FalseBeliefEpisode| episode.began <= time && episode.corrected.is_none_or(|end| end > time);
    follower.episodes.all().filter(|episode| told.contains(&episode.aspect)).filter(is_open)
}

/// Of beliefs: errors from those that are false at this time, until each is corrected.
fn errors_after(follower: &SessionFollower, time: SessionTime, scope: &SignalScope) -> u64 {
    let after = follower.judged.iter().filter(|press| press.time > time);
    let errors = match scope {
        SignalScope::Beliefs(told) => {
            let kitchen = &follower.session.kitchen;
            let open: Vec<&FalseBeliefEpisode> = open_at(follower, time, told).collect();
            let is_from_open = |press: &&JudgedPress| {
                let Some(ErrorCause::Belief { target, .. }) = press.cause else { return false };
                target.aspects(kitchen).any(|aspect| {
                    let mut about = open.iter().filter(|episode| episode.aspect == aspect);
                    about.any(|episode| episode.corrected.is_none_or(|end| press.time <= end))
                })
            };
            after.filter(is_from_open).count()
        }
        SignalScope::Presses(next) => after.take(*next).filter(|press| press.verdict.error).count(),
    };
    errors as u64
}
