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
mod consequences;
mod due_timers;
mod informing;
mod probing;
mod robot;

use std::sync::Arc;

use self::agents::{gaze_gaps, scripted_wizard, simulated_participant, trial_robot};
use crate::admit::{admit, hygiene};
use crate::advice_moments::leads_to_advice;
use crate::advisor::{AdviceRequest, Advisor};
use crate::apply::ApplyError;
use crate::follower::SessionFollower;
use crate::offers;
use crate::orders::OrderList;
use crate::probes::ProbeEvent;
use crate::settings::ParticipantKind;
use crate::timers::TimerQueue;
use crate::{AppliedEvent, Event, LogHeader, Session, SessionSpec, TimestampedEvent};
use tomcom_arm::worker::RobotTaskExecutor;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_people::participant::eyes::GazeDropoutSchedule;
use tomcom_people::participant::{ParticipantAction, SimulatedParticipant};
use tomcom_people::wizard::{ScriptedWizard, WizardAction};

/// Runs a session: raises due events, accepts external ones, and stamps all of them.
#[derive(Clone, Debug)]
pub struct SessionEngine {
    follower: SessionFollower,
    timers: TimerQueue,
    orders: OrderList,
    robot: RobotTaskExecutor,
    participant: Option<SimulatedParticipant>,
    /// Gaps in the simulated eye tracker's data, if the session has any.
    gaps: Option<GazeDropoutSchedule>,
    /// The scripted wizard of the session, if there is one.
    wizard: Option<ScriptedWizard>,
    next_seq: u64,
    /// Stamped events that the engine has not returned to the caller yet.
    out: Vec<TimestampedEvent>,
    /// The latest event after which advice is requested; the request is made once the event's immediate consequences
    /// have been applied.
    to_ask: Option<(u64, SessionTime)>,
    /// The latest request for advice, until it is answered.
    asked: Option<AdviceRequest>,
    /// Requests for advice that the engine has not returned to the caller yet.
    questions: Vec<AdviceRequest>,
}

/// Result of an event from outside: the events to which it led, or why the event was refused.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "the events belong into the log, also when the input was refused"]
pub struct InputResult {
    /// Events up to the event from outside, and the consequences of that event, in order.
    pub events: Vec<TimestampedEvent>,
    /// Why the event from outside was refused, in words for the wizard.
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
    /// An engine for a session before its first event. Other engines of the same kitchen may have used `cost`: its
    /// cache never changes its results.
    ///
    /// # Panics
    /// The settings ask for an arm with simulated physics, and this build has none, which `SessionSpec::require_built`
    /// checks.
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, trial: u64, cost: CostToGo) -> SessionEngine {
        let orders = OrderList::new(kitchen.dishes.len(), &spec, trial);
        let robot = trial_robot(&kitchen, &spec, trial);
        let participant = (spec.participant.kind == ParticipantKind::Simulated)
            .then(|| simulated_participant(kitchen.clone(), &spec, trial));
        let gaps = gaze_gaps(&spec, trial);
        let wizard = scripted_wizard(&kitchen, &spec, trial);
        let follower = SessionFollower::new(Session::new(kitchen, spec, trial), cost);
        let timers = TimerQueue::default();
        let (out, questions) = (Vec::new(), Vec::new());
        SessionEngine {
            follower,
            timers,
            orders,
            robot,
            participant,
            gaps,
            wizard,
            next_seq: 0,
            out,
            to_ask: None,
            asked: None,
            questions,
        }
    }

    /// The assistant of this session; its recommendations come back as [`Event::Advised`].
    pub fn advisor(&self) -> Advisor {
        Advisor::new(self.session(), self.follower.cost.clone())
    }

    /// Requests for advice since the last call of this function, the oldest first.
    pub fn take_questions(&mut self) -> Vec<AdviceRequest> {
        std::mem::take(&mut self.questions)
    }

    /// This engine without attribution of errors to causes, because attribution takes too long in a running session.
    pub fn without_causes(self) -> SessionEngine {
        SessionEngine { follower: self.follower.without_causes(), ..self }
    }

    /// The present estimate of the human's belief.
    pub fn belief(&self) -> &DirichletBelief {
        self.follower.filter.belief()
    }

    /// Whether the belief about an aspect is false now: by the belief of a simulated participant, else by the estimate.
    pub fn is_false(&self, aspect: AspectId) -> bool {
        let (kitchen, state) = (&self.session().kitchen, self.session().state);
        let p_truth = match &self.participant {
            Some(participant) => participant.beliefs().p_truth(kitchen, state, aspect),
            None => self.belief().p_truth(kitchen, state, aspect),
        };
        p_truth < FALSE_BELOW
    }

    /// The present state of the session.
    pub fn session(&self) -> &Session {
        &self.follower.session
    }

    /// The judged presses of the human so far.
    pub fn judged(&self) -> &[JudgedPress] {
        &self.follower.judged
    }

    /// Session time of the next internal event; `None` while the trial is not running.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.next_source().map(|(time, _)| time)
    }

    /// Raises the next internal event at its due time, with its immediate consequences.
    pub fn fire(&mut self) -> Vec<TimestampedEvent> {
        self.fire_next();
        std::mem::take(&mut self.out)
    }

    /// Applies an event from outside (wizard, participant, tracker) at `time`, after all internal events that are due
    /// before. If `time` is earlier than the last event, the time of the last event is used.
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

    /// The session with everything that is derived from it, such as judged presses and the estimate.
    pub fn follower(&self) -> &SessionFollower {
        &self.follower
    }

    /// This engine without its scripted wizard and, unless freeze probes draw questions by it, without the belief
    /// estimate: no further signals are sent.
    pub fn unassisted(self) -> SessionEngine {
        let needs_estimate = self.session().spec.probes.is_some();
        let follower = if needs_estimate { self.follower } else { self.follower.without_estimate() };
        SessionEngine { follower, wizard: None, ..self }
    }

    /// The engine for the session of a recording's header.
    ///
    /// # Panics
    /// The panics of [`Self::new`].
    pub fn for_header(kitchen: Arc<Kitchen>, header: &LogHeader, cost: CostToGo) -> SessionEngine {
        SessionEngine::new(kitchen, header.session.clone(), header.trial, cost)
    }

    /// The follower of the engine's session, after the end of the session.
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
                self.record_own(now, Event::Press { agent: Agent::Human, button, at_ns: None });
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

    /// Applies the timers that are due, then lets the robot react to the state.
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

    /// Records an event that the engine itself raised.
    fn record_own(&mut self, now: SessionTime, event: Event) {
        self.record(now, event).expect("an engine's own events fit its session");
    }

    /// Stamps and applies an event, performs its effects, informs robot and participant, and queues the event for the
    /// caller.
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
        let estimate = estimated.map(|estimated| estimated.witness(&self.session().kitchen));
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
}
