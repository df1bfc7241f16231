//! Signals that communication concepts would have sent in an unassisted trial, for all values of the concepts'
//! parameters in one replay. The planner runs once per decision; all costs of communication are then applied to the
//! same benefits. A benefit has to be known only where it can exceed a cost at which its signal may be sent.

use crate::concept_totals::ConceptPreventionCounts;
use crate::prevention::{HypotheticalSignal, TrialGroundTruth};
use crate::roc::{CONCEPTS, LEAST_COST, parameters};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::{Concept, ConceptName};
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::recommendation::{SignalOption, aspects_told};
use tomcom_core::communication::signal::SignalRepeatRule;
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::TomConcept;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, KitchenChange};
use tomcom_session::advisor::leads_to_advice;
use tomcom_session::advisor::AdviceRequest;
use tomcom_session::apply::ApplyError;
use tomcom_session::follower::SessionFollower;
use tomcom_session::watcher::follows_at_once;
use tomcom_session::{AppliedEvent, Event, Session, TimestampedEvent};

/// A concept with one value of its parameter, and the signals that the concept would have sent.
#[derive(Debug)]
struct SweptConcept {
    concept: ConceptName,
    parameter: f64,
    /// Rule that says which signals the concept may not repeat yet.
    repeats: SignalRepeatRule,
    sent: Vec<HypotheticalSignal>,
}

/// Replays a session, and evaluates all communication concepts whenever the assistant is asked for advice.
#[derive(Debug)]
pub struct ConceptSweep {
    /// The replayed session with the belief estimate.
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
    /// The replay of a session, before the session's first event.
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

    /// Applies one event of the replayed session.
    ///
    /// # Errors
    /// The errors of [`SessionFollower::apply`].
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

    /// Asks every communication concept for its signal in the session's present state.
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
