//! A session with everything that is derived from it press by press: errors, their causes, and the belief estimate.
//! Live sessions and replays derive these with the same code.

use std::collections::BTreeMap;

use crate::apply::{ApplyError, apply};
use crate::external::happenings::Happenings;
use crate::history::false_beliefs::{
    self, EstimatedFalseBeliefs, FalseBeliefsBefore, HeldFalseBelief, OwnFalseBeliefs,
};
use crate::history::signal_words;
use crate::probes::{ProbeEvent, ProbeSubject, StartedProbe};
use crate::tracker::TrackerEvent;
use crate::wizard_log::WizardLog;
use crate::{AppliedEvent, Event, Session, TimestampedEvent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::signal::SignalRepeatRule;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen, KitchenChange, Press, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorAttributor, ErrorCause};
use tomcom_core::measures::errors::PressJudge;
use tomcom_core::measures::sequences::FalseBeliefTracker;
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::filter::signals::EndedSignal;
use tomcom_core::mind::filter::{BeliefFilter, PressEvidence};
use tomcom_core::mind::observation::{Observation, ObservedEvidence, ProposedPresses};

/// A session with its judged presses, false belief episodes and belief estimate.
#[derive(Clone, Debug)]
pub struct SessionFollower {
    pub session: Session,
    pub judged: Vec<JudgedPress>,
    /// As far as the participant's beliefs are known.
    pub episodes: FalseBeliefTracker,
    own_false_beliefs: OwnFalseBeliefs,
    pub filter: BeliefFilter,
    pub false_beliefs: EstimatedFalseBeliefs,
    pub repeats: SignalRepeatRule,
    pub signals: WizardLog,
    /// `None` if computing times are not measured.
    pub timing: Option<InferenceTiming>,
    /// Judges presses; its caches can serve the next session in the same kitchen.
    pub cost: CostToGo,
    judge: PressJudge,
    attributor: ErrorAttributor,
    /// Last update of the belief estimate.
    updated_at: Option<SessionTime>,
    /// Recorded belief of the participant before its next press.
    belief: Option<Belief>,
    /// Cause that a simulated participant recorded in advance, in case its next press is an error.
    told_cause: Option<ErrorCause>,
    finds_causes: bool,
    estimates: bool,
    /// Before the last counted press of the human.
    pub estimated: Option<PressBeliefEstimate>,
    /// At the beginning of the last freeze probe.
    pub probed: Option<ProbedEstimate>,
    /// What was believed wrong and advised before each error, by the time of the press.
    believed_wrong: BTreeMap<SessionTime, FalseBeliefsBefore>,
    /// What the next question tells an external concept; `None` without one.
    pub(crate) happenings: Option<Happenings>,
}

/// The belief estimate when the task stopped for a freeze probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbedEstimate {
    /// Number of the probe in the trial.
    pub probe: u32,
    pub state: State,
    pub belief: DirichletBelief,
}

/// The belief estimate before a press of the human.
#[derive(Clone, Debug, PartialEq)]
pub struct PressBeliefEstimate {
    /// Sequence number of the press.
    pub press: u64,
    pub state: State,
    pub belief: DirichletBelief,
    /// Likelihood of the press, and quality of the belief samples behind it.
    pub evidence: PressEvidence,
}

impl PressBeliefEstimate {
    /// As the log records it.
    pub fn witness(&self, kitchen: &Kitchen) -> RecordedEstimate {
        RecordedEstimate::new(kitchen, self.press, &self.belief, self.state, self.evidence)
    }
}

/// Computing times of single updates of the belief estimate.
#[derive(Clone, Debug)]
pub struct InferenceTiming {
    /// A monotonic clock of the caller.
    now_ns: fn() -> u64,
    pub gaze_ns: Vec<u64>,
    /// Of updates by a press of human or robot.
    pub action_ns: Vec<u64>,
}

impl InferenceTiming {
    pub fn with_clock(now_ns: fn() -> u64) -> InferenceTiming {
        InferenceTiming { now_ns, gaze_ns: Vec::new(), action_ns: Vec::new() }
    }
}

impl SessionFollower {
    pub fn new(session: Session, cost: CostToGo) -> SessionFollower {
        let (kitchen, spec, seed) = (session.kitchen.clone(), &session.spec, session.seed());
        let judge = PressJudge::new(kitchen.clone());
        let attributor = ErrorAttributor::new(spec.human.decision.clone(), seed);
        let filter = BeliefFilter::new(kitchen, spec.human.clone(), seed);
        let happenings = session.spec.external_concept().map(|_| Happenings::default());
        SessionFollower {
            session,
            judged: Vec::new(),
            episodes: FalseBeliefTracker::default(),
            own_false_beliefs: OwnFalseBeliefs::default(),
            filter,
            false_beliefs: EstimatedFalseBeliefs::default(),
            repeats: SignalRepeatRule::default(),
            signals: WizardLog::default(),
            timing: None,
            cost,
            judge,
            attributor,
            updated_at: None,
            belief: None,
            told_cause: None,
            finds_causes: true,
            estimates: true,
            estimated: None,
            probed: None,
            believed_wrong: BTreeMap::new(),
            happenings,
        }
    }

    /// Updated by the time of unknown gaze since the last event.
    pub(crate) fn belief_at(&mut self, now: SessionTime) -> DirichletBelief {
        self.filter.at(now, &mut self.cost)
    }

    /// The estimate from which a request for advice starts: as expected once the participant has read the signal on the
    /// display. Most requests follow an event that has just updated the estimate.
    pub(crate) fn belief_for_advice(&mut self, now: SessionTime) -> DirichletBelief {
        let is_current = self.updated_at.is_some_and(|updated| updated >= now);
        self.filter.foreseen(now, is_current, &mut self.cost)
    }

    pub fn apply(&mut self, stamped: &TimestampedEvent) -> Result<AppliedEvent, ApplyError> {
        let applied = apply(&mut self.session, stamped)?;
        self.signals.note(stamped, &self.session);
        match (&stamped.event, applied.change) {
            (Event::ParticipantBelieves(witness), _) => {
                let session = &self.session;
                self.belief = Belief::of_witness(&session.kitchen, session.state, witness);
                self.told_cause = ErrorCause::recorded(&session.kitchen, session.state, witness);
                if let Some(belief) = &self.belief {
                    let (now, changed_at) = (stamped.time, &session.changed_at);
                    self.episodes.believed(&session.kitchen, now, session.state, belief, changed_at);
                    self.own_false_beliefs.note(session, now, belief, &self.episodes);
                }
            }
            (_, KitchenChange::Press { press, .. }) => match press.agent {
                Agent::Robot => self.judge.others_changed(stamped.time, press.before, press.after),
                Agent::Human => self.human_pressed(stamped, &press),
            },
            (_, KitchenChange::Correction { before, after, .. }) => {
                self.judge.others_changed(stamped.time, before, after)
            }
            _ => {}
        }
        if let Event::Probe(ProbeEvent::Begun { probe, .. }) = stamped.event {
            let (state, belief) = (self.session.state, self.belief_at(stamped.time));
            self.probed = Some(ProbedEstimate { probe, state, belief });
        }
        if let Some(pause) = self.session.probe_pause(stamped) {
            self.judge.postpone(pause);
        }
        if let Some(happenings) = &mut self.happenings {
            let judged = self.judged.last().filter(|press| press.seq == stamped.seq);
            happenings.note(&self.session, stamped, &applied.change, judged);
        }
        self.estimate(stamped, &applied.change);
        if self.estimates {
            self.false_beliefs.note(&self.session, self.filter.belief(), stamped);
        }
        Ok(applied)
    }

    fn estimate(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let Some(what) = self.observed(stamped, change).filter(|_| self.estimates) else { return };
        let observation = Observation { time: stamped.time, what };
        let human_press = change.human_press();
        if human_press.is_some() {
            self.filter.advance(stamped.time, &mut self.cost);
        }
        let belief = human_press.map(|_| self.filter.belief().clone());
        let began = self.timing.as_ref().map(|timing| (timing.now_ns)());
        self.filter.observe(&observation, &mut self.cost);
        self.updated_at = Some(stamped.time);
        if let (Some(timing), Some(began)) = (&mut self.timing, began) {
            let took_ns = (timing.now_ns)().saturating_sub(began);
            match what {
                ObservedEvidence::Gaze { .. } => timing.gaze_ns.push(took_ns),
                ObservedEvidence::Pressed(_) => timing.action_ns.push(took_ns),
                _ => {}
            }
        }
        self.remember(stamped);
        if let (Some(press), Some(belief), Some(evidence)) = (human_press, belief, self.filter.evidence()) {
            self.estimated_wrong(stamped, &press, &belief);
            self.estimated = Some(PressBeliefEstimate { press: stamped.seq, state: press.before, belief, evidence });
        }
    }

    /// Gaze samples are skipped, since no advice is requested after them.
    fn remember(&mut self, stamped: &TimestampedEvent) {
        let (kitchen, state) = (&self.session.kitchen, self.session.state);
        if let Some(EndedSignal { location, read }) = self.filter.take_signal_over() {
            self.repeats.over(location, read);
        }
        match &stamped.event {
            Event::Gaze(_) | Event::Probe(_) => return,
            Event::TrialStarted => self.repeats = SignalRepeatRule::default(),
            Event::SignalShown { signal, .. } => self.repeats.shown(kitchen, state, signal),
            _ => {}
        }
        self.repeats.update(kitchen, state, self.filter.belief());
    }

    /// `None` if the event is no evidence.
    pub fn observed(&self, stamped: &TimestampedEvent, change: &KitchenChange) -> Option<ObservedEvidence> {
        match *change {
            KitchenChange::TrialStarted { after, .. } => return Some(ObservedEvidence::Started { state: after }),
            KitchenChange::Press { press, .. } => return Some(ObservedEvidence::Pressed(press)),
            KitchenChange::Order { after, .. } | KitchenChange::Correction { after, .. } => {
                return Some(ObservedEvidence::Displayed { state: after });
            }
            KitchenChange::None | KitchenChange::UncountedPress { .. } => {}
        }
        // An event during a freeze probe is no such observation: the kitchen is not on the display, and the probe's
        // pause says nothing about the human's silence.
        let is_frozen = self.session.is_frozen();
        match &stamped.event {
            Event::TrialPaused | Event::TrialResumed if is_frozen => None,
            Event::TrialPaused => Some(ObservedEvidence::Paused),
            Event::TrialResumed => Some(ObservedEvidence::Resumed),
            // The belief filter does not use gaze samples that are late, duplicate or out of order; they are recorded
            // only.
            Event::Gaze(_) if self.session.gaze.fault.is_some() => None,
            Event::Gaze(sample) => {
                let taken = sample.taken(stamped.time);
                let evidence = ObservedEvidence::Gaze { sample: self.session.corrected(*sample), taken };
                self.session.had_kitchen_on_display(taken).then_some(evidence)
            }
            Event::Tracker(TrackerEvent::DisplayLost) => Some(ObservedEvidence::DisplayInView(false)),
            Event::Tracker(TrackerEvent::DisplayFound | TrackerEvent::Lost { .. }) => {
                Some(ObservedEvidence::DisplayInView(true))
            }
            Event::Probe(ProbeEvent::Begun { .. }) => Some(ObservedEvidence::Frozen),
            Event::Probe(ProbeEvent::Ended { .. }) => {
                let over = self.session.probes.over.last()?;
                let teaches = self.session.spec.probes.as_ref().map_or(0.0, |probes| probes.teaches);
                Some(ObservedEvidence::Thawed { by: stamped.time - over.begun, asked: self.asked_about(over), teaches })
            }
            Event::SignalShown { signal: Signal::Propose(presses), .. } => {
                let button = |name: &String| self.session.kitchen.button_named(Agent::Human, name);
                Some(ObservedEvidence::Proposed(ProposedPresses::new(presses.iter().filter_map(button))))
            }
            Event::SignalShown { .. } => {
                Some(ObservedEvidence::Told { location: self.session.shown.as_ref()?.location? })
            }
            Event::SignalEnded { .. } if self.session.spec.human.signal.takes_time() => {
                Some(ObservedEvidence::EndedSignal)
            }
            _ => None,
        }
    }

    /// The locations about which a probe asked, as a bit set.
    fn asked_about(&self, probe: &StartedProbe) -> u32 {
        let asked = probe.questions.iter().take(probe.shown.map_or(0, |shown| shown + 1));
        let locations = asked.filter_map(|question| match &question.about {
            ProbeSubject::Location { location } => self.session.kitchen.location_named(location),
            _ => None,
        });
        locations.fold(0, |bits, location| bits | 1 << location.index())
    }

    /// Without attribution of errors to causes by likelihood, which takes too long in a running session: only causes that
    /// a simulated participant recorded are known.
    pub fn without_causes(self) -> SessionFollower {
        SessionFollower { finds_causes: false, ..self }
    }

    /// With the estimate as it is now: updates take most of the time of a session of which only presses and errors
    /// count.
    pub fn without_estimate(self) -> SessionFollower {
        SessionFollower { estimates: false, ..self }
    }

    /// What was believed wrong just before the error at this time: by a simulated participant itself, and by the estimate.
    pub fn believed_wrong(&self, error: SessionTime) -> Option<&FalseBeliefsBefore> {
        self.believed_wrong.get(&error)
    }

    /// Of an error, what the estimate before the press has as believed wrong.
    fn estimated_wrong(&mut self, stamped: &TimestampedEvent, press: &Press, belief: &DirichletBelief) {
        let cause = self.judgement(stamped.seq).and_then(|(_, judged)| judged.cause);
        let Some(found) = self.believed_wrong.get_mut(&stamped.time) else { return };
        let about = false_beliefs::aspects_of(&self.session.kitchen, press, cause);
        let since = |aspect| self.false_beliefs.before(aspect, stamped.time).map(|held| held.began);
        let values = |aspect| belief.aspect(aspect).mean();
        found.estimate = HeldFalseBelief::among(&self.session, press.before, &about, values, since);
    }

    fn human_pressed(&mut self, stamped: &TimestampedEvent, press: &Press) {
        let kitchen = self.session.kitchen.clone();
        let number = self.session.all_presses();
        let verdict = self.judge.human_pressed(&mut self.cost, stamped.time, press);
        // The participant's belief is recorded before every press and belongs to the next press only.
        let (belief, told) = (self.belief.take(), self.told_cause.take());
        let cause = belief.as_ref().filter(|_| verdict.error).and_then(|belief| {
            let found = || self.attributor.cause(&kitchen, &mut self.cost, belief, press, number);
            told.or_else(|| self.finds_causes.then(found))
        });
        if let Some(cause) = cause {
            self.episodes.erred(&kitchen, cause);
        }
        if verdict.error {
            let about = false_beliefs::aspects_of(&kitchen, press, cause);
            let since = |aspect| self.own_false_beliefs.began(aspect).filter(|began| *began < stamped.time);
            let own = |belief: &Belief| {
                let values = |aspect| belief.distribution(aspect);
                HeldFalseBelief::among(&self.session, press.before, &about, values, since)
            };
            let participant = belief.as_ref().map(own).unwrap_or_default();
            let none_advised = signal_words::none_advised(&self.session);
            let found = FalseBeliefsBefore { participant, none_advised, ..FalseBeliefsBefore::default() };
            self.believed_wrong.insert(stamped.time, found);
        }
        let belief_known = belief.is_some();
        let (seq, time, button, before) = (stamped.seq, stamped.time, press.button, press.before);
        self.judged.push(JudgedPress { seq, time, button, before, verdict, belief_known, cause });
    }

    /// The judgement of the press in the event with this number, with its index; `None` if it does not count.
    pub fn judgement(&self, seq: u64) -> Option<(usize, &JudgedPress)> {
        let index = self.judged.binary_search_by_key(&seq, |press| press.seq).ok()?;
        Some((index, &self.judged[index]))
    }

    /// When what shows in a judged press, such as an error, ends: with the human's next press; `None`: with the recording.
    pub fn judged_until(&self, index: usize) -> Option<SessionTime> {
        self.judged.get(index + 1).map(|next| next.time)
    }

    /// Number of judged presses whose cost to go is not proven.
    pub fn unproven(&self) -> usize {
        self.judged.iter().filter(|press| !press.verdict.is_proven).count()
    }

    pub fn errors(&self) -> usize {
        self.judged.iter().filter(|press| press.verdict.error).count()
    }
}
