//! The engine runs a session: it raises the session's own events when they are due, accepts events from outside, and
//! returns every event once, stamped and in order, for the log.
//!
//! At equal times the order of sources is timers, robot, simulated participant, scripted wizard, probes; immediate
//! consequences of an event are applied before anything else. The module `headless` jumps from one due time to the
//! next, `live` sleeps until then, and verification uses the recorded times.
//!
//! A pause stops clock, robot, orders and participant; pending events are postponed by its length. Presses during a
//! pause are recorded and do not count. The signals of a scripted wizard and of the assistant are internal events, so a
//! verification repeats them; those of a person are external. A recommendation is an external event (`advised`): it is
//! computed at once in headless runs, by a thread in live ones.
//!
//! The engine has no clock: the caller passes the time, so that live sessions, simulations and verifications use the
//! same code.

mod agents;

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use crate::admit::{admit, hygiene};
use crate::advisor::{AdviceRequest, Advisor, leads_to_advice};
use crate::apply::{ApplyError, silence_so_far};
use crate::engine::agents::{gaze_gaps, scripted_wizard, simulated_participant, trial_robot};
use crate::event::{SignalEndReason, TrialEndReason};
use crate::follower::SessionFollower;
use crate::orders::OrderList;
use crate::probes::ProbeEvent;
use crate::protocol::ProtocolEvent;
use crate::settings::ParticipantKind;
use crate::{
    AppliedEvent, Event, LogHeader, Session, SessionEffect, SessionSpec, Timer, TimestampedEvent, TrialPhase, offers,
    proposals,
};
use tomcom_arm::worker::RobotTaskExecutor;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_people::participant::eyes::GazeDropoutSchedule;
use tomcom_people::participant::{ParticipantAction, SimulatedParticipant};
use tomcom_people::wizard::{ScriptedWizard, WizardAction};

#[derive(Clone, Debug)]
pub struct SessionEngine {
    follower: SessionFollower,
    timers: TimerQueue,
    orders: OrderList,
    robot: RobotTaskExecutor,
    participant: Option<SimulatedParticipant>,
    gaps: Option<GazeDropoutSchedule>,
    wizard: Option<ScriptedWizard>,
    next_seq: u64,
    /// Events that the caller has not got yet.
    out: Vec<TimestampedEvent>,
    /// The latest event after which advice is requested, until its immediate consequences are applied.
    to_ask: Option<(u64, SessionTime)>,
    /// The latest request, until it is answered.
    asked: Option<AdviceRequest>,
    /// Requests that the caller has not got yet.
    questions: Vec<AdviceRequest>,
    /// Estimates of a recorded trial that is run again without an estimate of its own, the next press first.
    recorded_estimates: VecDeque<RecordedEstimate>,
}

#[derive(Clone, Debug, PartialEq)]
#[must_use = "the events belong into the log, also when the input was refused"]
pub struct InputResult {
    /// What was due before, the event itself if it was accepted, and its consequences.
    pub events: Vec<TimestampedEvent>,
    /// Why the event was refused, in words for the wizard.
    pub refused: Option<String>,
}

/// Source of the engine's next internal event; of sources due at once, the earlier variant goes first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Source {
    Timer,
    Robot,
    Participant,
    Wizard,
    Probe,
}

impl SessionEngine {
    /// `cost` may come from another engine of the same kitchen: its cache never changes results.
    ///
    /// # Panics
    ///
    /// The settings ask for an arm with simulated physics, and this build has none: see `SessionSpec::require_built`.
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, trial: u64, cost: CostToGo) -> SessionEngine {
        let participant = (spec.participant.kind == ParticipantKind::Simulated)
            .then(|| simulated_participant(kitchen.clone(), &spec, trial));
        SessionEngine {
            timers: TimerQueue::default(),
            orders: OrderList::new(kitchen.dishes.len(), &spec, trial),
            robot: trial_robot(&kitchen, &spec, trial),
            participant,
            gaps: gaze_gaps(&spec, trial),
            wizard: scripted_wizard(&kitchen, &spec, trial),
            follower: SessionFollower::new(Session::new(kitchen, spec, trial), cost),
            next_seq: 0,
            out: Vec::new(),
            to_ask: None,
            asked: None,
            questions: Vec::new(),
            recorded_estimates: VecDeque::new(),
        }
    }

    /// Its recommendations come back as [`Event::Advised`].
    pub fn advisor(&self) -> Advisor {
        Advisor::new(self.session(), self.follower.cost.clone())
    }

    /// Requests for advice since the last call, the oldest first.
    pub fn take_questions(&mut self) -> Vec<AdviceRequest> {
        std::mem::take(&mut self.questions)
    }

    /// Without attribution of errors to causes, which takes too long in a running session.
    pub fn without_causes(self) -> SessionEngine {
        SessionEngine { follower: self.follower.without_causes(), ..self }
    }

    /// Without the belief estimate, which takes most of the time of a trial, unless the trial depends on it: for runs whose
    /// log nobody keeps.
    pub fn without_unused_estimate(self) -> SessionEngine {
        let spec = &self.session().spec;
        let is_used = spec.asks_assistant() || spec.probes.is_some();
        if is_used { self } else { SessionEngine { follower: self.follower.without_estimate(), ..self } }
    }

    /// With the estimates that a recording of this trial has, the first press first, unless freeze probes need the
    /// engine's own. Its recommendations must come from the recording, too.
    pub fn with_recorded_estimates(self, recorded_estimates: VecDeque<RecordedEstimate>) -> SessionEngine {
        match self.session().spec.probes {
            Some(_) => self,
            None => SessionEngine { follower: self.follower.without_estimate(), recorded_estimates, ..self },
        }
    }

    pub fn belief(&self) -> &DirichletBelief {
        self.follower.filter.belief()
    }

    pub fn session(&self) -> &Session {
        &self.follower.session
    }

    pub fn judged(&self) -> &[JudgedPress] {
        &self.follower.judged
    }

    /// Time of the next internal event.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.next_source().map(|(time, _)| time)
    }

    /// Raises the next internal event, with its immediate consequences.
    pub fn fire(&mut self) -> Vec<TimestampedEvent> {
        self.fire_next();
        std::mem::take(&mut self.out)
    }

    /// Applies an event from outside, after all internal events that are due before; not earlier than the last event.
    pub fn input(&mut self, time: SessionTime, event: Event) -> InputResult {
        while self.next_due().is_some_and(|due| due <= time) {
            self.fire_next();
        }
        let now = time.max(self.session().time);
        let admitted = admit(self.session(), &event).map_err(str::to_string);
        let admitted = admitted.and_then(|()| hygiene(self.session(), now, &event));
        let taken = admitted.and_then(|()| self.record(now, event).map_err(|error| error.to_string()));
        self.settle(now);
        InputResult { events: std::mem::take(&mut self.out), refused: taken.err() }
    }

    pub fn follower(&self) -> &SessionFollower {
        &self.follower
    }

    /// Without its scripted wizard and, unless freeze probes need it, without the belief estimate: no further signals
    /// are sent.
    pub fn unassisted(self) -> SessionEngine {
        let needs_estimate = self.session().spec.probes.is_some();
        let follower = if needs_estimate { self.follower } else { self.follower.without_estimate() };
        SessionEngine { follower, wizard: None, recorded_estimates: VecDeque::new(), ..self }
    }

    pub fn for_header(kitchen: Arc<Kitchen>, header: &LogHeader, cost: CostToGo) -> SessionEngine {
        SessionEngine::new(kitchen, header.session.clone(), header.trial, cost)
    }

    pub fn into_follower(self) -> SessionFollower {
        self.follower
    }

    fn next_source(&self) -> Option<(SessionTime, Source)> {
        if !self.session().is_running() {
            let simulated = self.participant.as_ref().filter(|_| self.session().spec.participant.simulates_gaze());
            let look = simulated.and_then(|one| Some((one.target_due()?, Source::Participant)));
            let probe = self.probe_due().map(|due| (due, Source::Probe));
            return look.into_iter().chain(probe).min();
        }
        let participant = self.participant.as_ref().and_then(SimulatedParticipant::next_due);
        let sources = [
            (self.timers.next_due(), Source::Timer),
            // A held arm can have been due earlier; its event still gets no earlier time than the last event.
            (self.robot.next_due().map(|due| due.max(self.session().time)), Source::Robot),
            (participant, Source::Participant),
            (self.wizard.as_ref().and_then(ScriptedWizard::next_due), Source::Wizard),
            (self.probe_due(), Source::Probe),
        ];
        sources.into_iter().filter_map(|(due, source)| Some((due?, source))).min()
    }

    fn fire_next(&mut self) {
        let Some((now, source)) = self.next_source() else { return };
        match source {
            Source::Timer => self.fire_timer(now),
            Source::Robot => self.let_robot_act(now),
            Source::Participant => self.let_participant_act(now),
            Source::Wizard => self.let_wizard_act(now),
            Source::Probe => self.review_probe(now),
        }
        self.settle(now);
    }

    fn let_participant_act(&mut self, now: SessionTime) {
        if !self.session().is_running() {
            if let Some(sample) = self.participant.as_mut().and_then(|one| one.look_at_target(now)) {
                self.record_own(now, Event::Gaze(sample));
            }
            return;
        }
        let state = self.session().state;
        let action = self.participant.as_mut().and_then(|one| one.act(now, state));
        match action {
            Some(ParticipantAction::Gaze(sample)) if self.session().spec.participant.simulates_gaze() => {
                if !self.gaps.as_mut().is_some_and(|gaps| gaps.swallows(now)) {
                    self.record_own(now, Event::Gaze(sample));
                }
            }
            // The simulated participant's gaze is not used if an external tracker delivers gaze.
            Some(ParticipantAction::Gaze(_)) | None => {}
            Some(ParticipantAction::Press { button, belief }) => {
                let button = self.session().kitchen.button(Agent::Human, button).name.clone();
                self.record_own(now, Event::ParticipantBelieves(belief));
                self.record_own(now, Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false });
            }
        }
        self.let_hand_follow(now);
    }

    fn let_wizard_act(&mut self, now: SessionTime) {
        let state = self.session().state;
        let event = match self.wizard.as_mut().and_then(|one| one.act(now, state, &mut self.follower.cost)) {
            Some(WizardAction::Send(signal)) => Some(Event::SignalShown { by: Sender::Wizard, signal, offer: None }),
            Some(WizardAction::TakeOffer(offer)) => offers::script_takes(self.session(), now, offer),
            None => None,
        };
        if let Some(event) = event.filter(|event| admit(self.session(), event).is_ok()) {
            self.record_own(now, event);
        }
    }

    /// Applies the immediate consequences of an event, then opens or closes offers and requests advice.
    fn settle(&mut self, now: SessionTime) {
        self.let_follow(now);
        self.review_offer(now);
        if let Some((seq, time)) = self.to_ask.take().filter(|_| self.session().is_running()) {
            let request = AdviceRequest::from_follower(&mut self.follower, seq, time);
            self.asked = Some(request.clone());
            self.questions.push(request);
        }
        self.review_probe(now);
    }

    fn let_follow(&mut self, now: SessionTime) {
        while self.session().is_running() {
            if self.timers.next_due().is_some_and(|due| due <= now) {
                self.fire_timer(now);
                continue;
            }
            let kitchen = self.session().kitchen.clone();
            let state = self.session().state;
            match self.robot.decide(&kitchen, &mut self.follower.cost, now, state) {
                Some(event) => self.record_robot(now, event),
                None => return,
            }
        }
    }

    fn record_own(&mut self, now: SessionTime, event: Event) {
        self.record(now, event).expect("an engine's own events fit its session");
    }

    fn record(&mut self, now: SessionTime, event: Event) -> Result<(), ApplyError> {
        let event = match event {
            Event::Gaze(sample) => Event::Gaze(sample.rounded()),
            other => other,
        };
        let stamped = TimestampedEvent { seq: self.next_seq, time: now, event };
        let AppliedEvent { effects, change } = self.follower.apply(&stamped)?;
        self.next_seq += 1;
        effects.into_iter().for_each(|effect| self.perform(effect));
        self.tell_participant(&stamped, &change);
        self.tell_wizard(&stamped, &change);
        let robots = self.tell_robot(&stamped, &change);
        if self.session().spec.asks_assistant() && leads_to_advice(self.session(), &stamped.event) {
            self.to_ask = Some((stamped.seq, now));
        }
        let advice = match &stamped.event {
            Event::Advised(advice) => {
                self.asked.take_if(|request| request.seq <= advice.for_seq);
                self.acted_on(advice)
            }
            Event::Probe(ProbeEvent::Ended { .. }) => {
                // A recommendation that came while the task stood still was refused. The same request for advice leads
                // to the same recommendation.
                self.questions.extend(self.asked.clone());
                None
            }
            _ => None,
        };
        let estimated = self.follower.estimated.as_ref().filter(|estimated| estimated.press == stamped.seq);
        let recorded = self.recorded_estimates.pop_front_if(|estimate| estimate.press == stamped.seq);
        let estimate = recorded.or_else(|| Some(estimated?.witness(&self.session().kitchen)));
        self.out.push(stamped);
        if let Some(signal) = advice {
            self.record_own(now, signal);
        }
        if let Some(estimate) = estimate {
            self.record_own(now, Event::BeliefEstimated(estimate));
        }
        for event in robots {
            self.record_robot(now, event);
        }
        self.end_outdated_proposal(now);
        self.check_criterion(now);
        self.measure_calibration(now);
        Ok(())
    }

    fn perform(&mut self, effect: SessionEffect) {
        match effect {
            SessionEffect::At { time, timer } => self.timers.set(time, timer),
            SessionEffect::Cancel(timer) => self.timers.cancel(timer),
            SessionEffect::CancelAll => {
                self.timers.pending.clear();
                self.robot.rest();
            }
            SessionEffect::Postpone(by) => {
                self.timers.postpone(by);
                self.robot.postpone(by);
                if let Some(participant) = &mut self.participant {
                    participant.postpone(by);
                }
                if let Some(wizard) = &mut self.wizard {
                    wizard.postpone(by);
                }
            }
        }
    }

    fn fire_timer(&mut self, now: SessionTime) {
        let Some((_, _, timer)) = self.timers.pending.pop_first() else { return };
        let kitchen = self.session().kitchen.clone();
        let event = match timer {
            Timer::ClearOrder(order) => Event::OrderCleared { order: kitchen.location(order).name.clone() },
            Timer::NewOrder(order) => {
                let dish = kitchen.dish(self.orders.draw()).name.clone();
                Event::OrderShown { order: kitchen.location(order).name.clone(), dish }
            }
            Timer::EndSignal => Event::SignalEnded { reason: SignalEndReason::Elapsed },
            Timer::EndTrial => Event::TrialEnded { reason: TrialEndReason::Time },
            Timer::EndTrialByOrders => Event::TrialEnded { reason: TrialEndReason::Orders },
            Timer::EndTrialByPresses => Event::TrialEnded { reason: TrialEndReason::Presses },
            Timer::HumanWaits => Event::HumanWaits { silent_ns: silence_so_far(self.session(), now) },
            Timer::ReviewOffer => return self.review_offer(now),
        };
        self.record_own(now, event);
    }

    fn check_criterion(&mut self, now: SessionTime) {
        let session = self.session();
        let Some((step, protocol)) = session.step() else { return };
        let Some(criterion) = step.criterion.filter(|_| protocol.practice.is_none()) else { return };
        if !matches!(session.phase, TrialPhase::Over(_)) || session.aborted.is_some() {
            return;
        }
        let (orders, presses) = (session.served.len() as u32, session.presses[Agent::Human.index()]);
        let errors = self.follower.errors() as u32;
        let met = criterion.is_met(orders, presses, errors);
        self.record_own(now, Event::Protocol(ProtocolEvent::CriterionChecked { met, orders, presses, errors }));
    }

    fn end_outdated_proposal(&mut self, now: SessionTime) {
        if self.session().is_running() && proposals::is_outdated(self.session()) {
            self.record_own(now, Event::SignalEnded { reason: SignalEndReason::Outdated });
        }
    }

    fn measure_calibration(&mut self, now: SessionTime) {
        let session = self.session();
        let event = session.calibration.as_ref().and_then(|check| check.to_measure(&session.viewing()));
        if let Some(event) = event {
            self.record_own(now, Event::Calibration(event));
        }
    }

    /// The signal that the assistant sends because of its recommendation. An error gets one proposal, as long as it is
    /// the human's last press.
    fn acted_on(&self, advice: &Recommendation) -> Option<Event> {
        let is_last = |error: u64| self.judged().last().is_some_and(|press| press.seq == error);
        let proposal =
            advice.proposal.as_ref().filter(|one| is_last(one.error) && !proposals::was_made(self.session()));
        let proposal = proposal.map(|one| Signal::Propose(one.presses.clone()));
        let signal = advice.best.clone().or(proposal)?;
        let event = Event::SignalShown { by: Sender::Assistant, signal, offer: None };
        admit(self.session(), &event).is_ok().then_some(event)
    }
}

/// Pending timers in the order in which they are due; timers due at once keep the order in which they were set.
#[derive(Clone, Debug, Default)]
struct TimerQueue {
    pending: BTreeSet<(SessionTime, u64, Timer)>,
    set_so_far: u64,
}

impl TimerQueue {
    fn set(&mut self, time: SessionTime, timer: Timer) {
        self.pending.insert((time, self.set_so_far, timer));
        self.set_so_far += 1;
    }

    fn cancel(&mut self, timer: Timer) {
        self.pending.retain(|(_, _, pending)| *pending != timer);
    }

    fn postpone(&mut self, by: SessionTime) {
        let pending = std::mem::take(&mut self.pending);
        self.pending = pending.into_iter().map(|(time, serial, timer)| (time + by, serial, timer)).collect();
    }

    fn next_due(&self) -> Option<SessionTime> {
        self.pending.first().map(|(time, _, _)| *time)
    }
}
