//! The robot, the simulated participant and the scripted wizard of a running session, and its freeze probes: they are
//! made from the settings of a trial, are told what they can notice, and act.

use std::sync::Arc;

use crate::engine::SessionEngine;
use crate::event::SignalEndReason;
#[cfg(not(feature = "physics"))]
use crate::features::{Feature, MissingFeature};
use crate::gaze_check::RunningGazeCheck;
use crate::probe_sampling::{aspect, questions};
use crate::probes::{DueProbeEvent, ProbeEvent, ProbeSubject, of_trial, upcoming};
#[cfg(feature = "physics")]
use crate::settings::ParticipantKind;
use crate::settings::{ArmKind, RobotSpec};
use crate::tracker::GazeGapSpec;
use crate::wall_display::AnswerDevice;
use crate::{Event, SessionSpec, TimestampedEvent, offers};
#[cfg(feature = "physics")]
use tomcom_arm::body::SimulatedArm;
#[cfg(feature = "physics")]
use tomcom_arm::reaching::ReachingBehaviour;
use tomcom_arm::real_arm::ArmOrder;
use tomcom_arm::worker::RobotTaskExecutor;
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::SignalKind;
use tomcom_core::communication::offer::OfferedAdvice;
use tomcom_core::communication::recommendation::SignalReason;
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, Kitchen, KitchenChange, Press};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::robot::{ArmStage, RobotEvent};
use tomcom_people::participant::SimulatedParticipant;
use tomcom_people::participant::eyes::GazeDropoutSchedule;
use tomcom_people::participant::population::Experience;
use tomcom_people::wizard::ScriptedWizard;

/// In a study plan, one simulated participant has several trials and improves with practice.
pub(super) fn simulated_participant(kitchen: Arc<Kitchen>, spec: &SessionSpec, trial: u64) -> SimulatedParticipant {
    let person = spec.step.as_ref().map_or(trial, |step| u64::from(step.participant));
    let trials = spec.step.as_ref().and_then(|step| step.period).map_or(0, |period| period.saturating_sub(1));
    // Presses of earlier trials are practice; about half of a trial's presses are the human's.
    let presses = f64::from(trials) * f64::from(spec.trial.presses) / 2.0;
    let population = spec.participant.population.clone().unwrap_or_default();
    SimulatedParticipant::new(kitchen, &population, spec.seed, person, trial, Experience { trials, presses })
}

pub(super) fn scripted_wizard(kitchen: &Arc<Kitchen>, spec: &SessionSpec, trial: u64) -> Option<ScriptedWizard> {
    if !spec.scripts_wizard() {
        return None;
    }
    let script = ScriptedWizard::new(kitchen.clone(), spec.wizard.clone(), spec.highlights(kitchen), spec.seed, trial);
    Some(if spec.script_reads_offers() { script.reading_offers(spec.seed, trial) } else { script })
}

pub(super) fn gaze_gaps(spec: &SessionSpec, trial: u64) -> Option<GazeDropoutSchedule> {
    let GazeGapSpec { every_s, shortest_s, longest_s } = *spec.tracker.gaps.as_ref()?;
    Some(GazeDropoutSchedule::new(every_s, [shortest_s, longest_s], stream(spec.seed, "tracker's gaps", trial)))
}

/// # Panics
///
/// The settings ask for an arm with simulated physics, and this build has none.
pub(super) fn trial_robot(kitchen: &Kitchen, spec: &SessionSpec, trial: u64) -> RobotTaskExecutor {
    let RobotSpec { press_s, press_spread, initiative_s, .. } = spec.robot;
    let robot = RobotTaskExecutor::new(press_s, press_spread, initiative_s, spec.seed, trial);
    match spec.robot.arm {
        ArmKind::Timed => robot,
        ArmKind::Physics => with_physics(robot, kitchen, spec, trial),
        ArmKind::Ur(_) => robot.with_real_arm(),
    }
}

#[cfg(feature = "physics")]
fn with_physics(robot: RobotTaskExecutor, kitchen: &Kitchen, spec: &SessionSpec, trial: u64) -> RobotTaskExecutor {
    let hand = match spec.participant.kind {
        ParticipantKind::Simulated => ReachingBehaviour::SIMULATED,
        ParticipantKind::Keyboard | ParticipantKind::Display | ParticipantKind::External => ReachingBehaviour::UNSEEN,
    };
    robot.with_body(SimulatedArm::new(kitchen, hand, spec.seed, trial))
}

#[cfg(not(feature = "physics"))]
fn with_physics(_: RobotTaskExecutor, _: &Kitchen, _: &SessionSpec, _: u64) -> RobotTaskExecutor {
    panic!("{}", MissingFeature(Feature::Physics))
}

impl SessionEngine {
    /// What a real arm is to do now; `None` for other arms. It stands unless the trial runs.
    pub fn arm_order(&self) -> Option<ArmOrder> {
        let order = self.robot.order()?;
        Some(ArmOrder { stands: order.stands || !self.session().is_running(), ..order })
    }

    /// For experiments with the robot's arm.
    pub fn robot(&mut self) -> &mut RobotTaskExecutor {
        &mut self.robot
    }

    pub(crate) fn let_robot_act(&mut self, now: SessionTime) {
        let kitchen = self.session().kitchen.clone();
        let state = self.session().state;
        for event in self.robot.act(&kitchen, &mut self.follower.cost, now, state) {
            self.record_robot(now, event);
        }
    }

    pub(crate) fn record_robot(&mut self, now: SessionTime, event: RobotEvent) {
        let kitchen = self.session().kitchen.clone();
        let name = |button: ButtonId| kitchen.button(Agent::Robot, button).name.clone();
        let event = match event {
            RobotEvent::Intend { button, until, initiative } => {
                Event::RobotIntends { button: name(button), until_ns: until, initiative }
            }
            RobotEvent::Press(button) => {
                Event::Press { agent: Agent::Robot, button: name(button), at_ns: None, button_box: false }
            }
            RobotEvent::Abort(button, reason) => Event::RobotAborts { button: name(button), reason },
            RobotEvent::Idle { reason, waits_for } => {
                let human = &kitchen.buttons[Agent::Human.index()];
                let awaited = human.iter().enumerate().filter(|(index, _)| waits_for >> index & 1 == 1);
                Event::RobotIdles { reason, waits_for: awaited.map(|(_, button)| button.name.clone()).collect() }
            }
            RobotEvent::Move(moment) => Event::RobotMoves(moment),
            RobotEvent::Safety { mode, force_n, joint } => Event::RobotSafety { mode, force_n, joint },
            RobotEvent::Touched { force_n } => Event::RobotTouched { force_n },
        };
        self.record_own(now, event);
    }

    /// Returns the robot's reactions.
    pub(crate) fn tell_robot(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) -> Vec<RobotEvent> {
        let kitchen = self.session().kitchen.clone();
        let now = stamped.time;
        if let Some(press) = change.human_press() {
            self.robot.human_pressed(now, kitchen.button(Agent::Human, press.button).at_m);
        }
        let reaction = match &stamped.event {
            Event::TrialStarted => {
                self.robot.start(now);
                None
            }
            Event::RobotStopped => return self.robot.stop(),
            Event::RobotResumed => self.robot.resume(now),
            Event::RobotHeld { .. } | Event::RobotReleased { .. } => {
                self.robot.hold(matches!(stamped.event, Event::RobotHeld { .. }));
                None
            }
            Event::RobotSkipped { .. } => self.robot.skip(now),
            Event::RobotMoves(sample) => {
                self.robot.arm_moves(sample.phase);
                None
            }
            Event::RobotSafety { .. } | Event::RobotStage { .. } => {
                let robot = &self.follower.session.robot;
                let is_ready = matches!(robot.arm.stage, Some((ArmStage::Ready, _)));
                self.robot.arm_changes(is_ready, robot.arm.mode, robot.stopped)
            }
            Event::Press { agent: Agent::Robot, .. } => {
                if let KitchenChange::Press { press: Press { button, .. }, .. }
                | KitchenChange::UncountedPress { button, .. } = *change
                {
                    self.robot.arm_pressed(button);
                }
                None
            }
            Event::RobotAborts { button, reason } if reason.is_of_physics() => {
                if let Some(button) = kitchen.button_named(Agent::Robot, button) {
                    self.robot.arm_failed(now, button);
                }
                None
            }
            Event::RobotDriven { .. } => {
                let button = self.session().robot.driven_to;
                button.and_then(|button| self.robot.drive(button))
            }
            Event::KitchenCorrected { .. } => {
                let state = self.session().state;
                self.robot.reconsider(&kitchen, &mut self.follower.cost, now, state)
            }
            _ => None,
        };
        reaction.into_iter().collect()
    }

    /// Moves a simulated participant's hand in time for the next press.
    pub(crate) fn let_hand_follow(&mut self, now: SessionTime) {
        if let Some((button, at)) = self.participant.as_ref().and_then(SimulatedParticipant::next_press) {
            let button_m = self.session().kitchen.button(Agent::Human, button).at_m;
            self.robot.human_means(now, button_m, at);
        }
    }

    /// Only what a participant can notice.
    pub(crate) fn tell_participant(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let Some(participant) = &mut self.participant else { return };
        let session = &self.follower.session;
        let (now, state) = (stamped.time, session.state);
        if let Some(press) = change.press() {
            participant.on_press(now, &press);
        }
        match &stamped.event {
            Event::TrialStarted => participant.on_trial_start(now, state),
            Event::SignalShown { signal, .. } => {
                if let Some(shown) = &session.shown {
                    participant.on_signal(now, shown.location, signal);
                }
            }
            Event::SignalEnded { reason } => participant.on_signal_end(*reason == SignalEndReason::Outdated),
            Event::Calibration(_) => {
                participant.on_target(now, session.calibration.as_ref().and_then(RunningGazeCheck::target))
            }
            _ => {}
        }
    }

    pub(crate) fn review_offer(&mut self, now: SessionTime) {
        while let Some(mut event) = offers::due(self.session(), now) {
            // A recommendation states a reason for its first option only; if two orders want the same dish, the offer
            // may be about the other order. An external concept has reasons of its own.
            if let Event::OfferOpened(advice) = &mut event
                && advice.words.is_none()
                && advice.reason.is_none()
            {
                let session = &self.follower.session;
                advice.reason = SignalReason::for_signal(&session.kitchen, session.state, self.belief(), &advice.what);
            }
            self.record_own(now, event);
        }
    }

    /// Only what a wizard sees: kitchen, presses, gaze, and offers if they are shown.
    pub(crate) fn tell_wizard(&mut self, stamped: &TimestampedEvent, change: &KitchenChange) {
        let Some(wizard) = &mut self.wizard else { return };
        let session = &self.follower.session;
        let (now, state) = (stamped.time, session.state);
        if let Some(press) = change.human_press() {
            let judged = self.follower.judged.last().filter(|press| press.seq == stamped.seq);
            let is_error = judged.is_some_and(|press| press.verdict.error);
            return wizard.on_human_press(now, &press, is_error, &mut self.follower.cost);
        }
        match &stamped.event {
            Event::TrialStarted => wizard.on_trial_start(state),
            Event::Gaze(sample) => {
                let location = session.looked_at();
                let sees_present = location.is_some_and(|location| session.sees_present_content(location));
                wizard.on_gaze(sample.taken(now), location, sees_present.then_some(state));
            }
            Event::SignalShown { .. } => {
                if let Some(location) = session.shown.as_ref().and_then(|shown| shown.location) {
                    wizard.on_signal(now, location, state);
                }
            }
            Event::OfferOpened(OfferedAdvice { what, visible: true, .. }) if what.kind() != SignalKind::Proposal => {
                wizard.on_offer(now, stamped.seq);
            }
            _ => {
                if let Some((before, after)) = change.states() {
                    wizard.on_change(now, before, after);
                }
            }
        }
    }

    pub(crate) fn probe_due(&self) -> Option<SessionTime> {
        let rule = upcoming(self.session()).map(|(due, _)| due);
        [rule, self.answer_due()].into_iter().flatten().min()
    }

    fn answer_due(&self) -> Option<SessionTime> {
        let (participant, session) = (self.participant.as_ref()?, self.session());
        let open = session.probes.open.as_ref().filter(|open| !open.is_paused())?;
        let (shown, _) = open.question()?;
        let after_s = participant.answers_after_s(open.number, shown as u32 + 1);
        Some(open.when(open.asked_at, SessionTime::from_secs_f64(after_s)).max(session.time))
    }

    /// An answer at the last possible time still counts.
    pub(crate) fn review_probe(&mut self, now: SessionTime) {
        loop {
            let rule = upcoming(self.session()).filter(|(due, _)| *due <= now);
            let answer = self.answer_due().filter(|due| *due <= now);
            match (rule, answer) {
                (Some((due, what)), answer) if answer.is_none_or(|answer| due < answer) => self.probe(now, what),
                (_, Some(_)) => self.let_participant_answer(now),
                _ => return,
            }
        }
    }

    fn probe(&mut self, now: SessionTime, what: DueProbeEvent) {
        let (probe, origin, uses_estimate) = match what {
            DueProbeEvent::Event(event) => return self.record_own(now, Event::Probe(event)),
            DueProbeEvent::Begin { probe, origin, uses_estimate } => (probe, origin, uses_estimate),
        };
        let is_wrong = uses_estimate.then(|| self.believed_wrong(now));
        let session = self.session();
        let Some(spec) = of_trial(&session.spec) else { return };
        let questions = questions(session, spec, probe, is_wrong.as_deref());
        if let Some(belief) = self.participant.as_ref().map(|one| one.believes(session.state)) {
            self.record_own(now, Event::ParticipantBelieves(belief));
        }
        self.record_own(now, Event::Probe(ProbeEvent::Begun { probe, origin, uses_estimate, questions }));
    }

    /// For each state aspect, whether the estimate says that the belief about it is false.
    fn believed_wrong(&mut self, now: SessionTime) -> Vec<bool> {
        let belief = self.follower.belief_at(now);
        let session = self.session();
        let is_wrong = |index| belief.p_truth(&session.kitchen, session.state, AspectId(index as u8)) < FALSE_BELOW;
        (0..session.kitchen.aspects.len()).map(is_wrong).collect()
    }

    fn let_participant_answer(&mut self, now: SessionTime) {
        let (Some(participant), session) = (&self.participant, self.session()) else { return };
        let Some(open) = &session.probes.open else { return };
        let Some((shown, asked)) = open.question() else { return };
        let (probe, question) = (open.number, shown as u32 + 1);
        let kitchen = &session.kitchen;
        let aspect = aspect(kitchen, &asked.about);
        let answer = match (&asked.about, aspect) {
            (_, Some(aspect)) => participant.answer(session.state, aspect, &asked.choices, (probe, question)),
            (ProbeSubject::NextOrder, _) => participant.next_order().map(|order| kitchen.location(order).name.clone()),
            // Simulated participants do not answer questions about the robot's next press, since they do not predict
            // the robot's presses.
            _ => None,
        };
        let asks_confidence = of_trial(&session.spec).is_some_and(|spec| spec.confidence);
        let confidence = aspect.filter(|_| asks_confidence && answer.is_some()).map(|one| participant.confidence(one));
        let on = AnswerDevice::Display;
        self.record_own(now, Event::Probe(ProbeEvent::Answered { probe, question, answer, confidence, on }));
    }
}
