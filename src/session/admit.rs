//! Preconditions of events: whether a session accepts an event now. Preconditions are checked before an input is taken,
//! and again when an event is applied.

use crate::apply::own_presses;
use crate::event::{SignalEndReason, TrialEndReason};
use crate::probes::{self, ProbeEvent};
use crate::protocol::{self, ProtocolEvent};
use crate::settings::{Condition, ParticipantKind};
use crate::{Event, Session, TrialPhase, film, gaze_check, person_code, tracker};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::{self, Sender, Signal};
use tomcom_core::kitchen::{Agent, ContentId, LocationKind};
use tomcom_core::robot::ArmStage;

/// What a precondition says: nothing, or the reason for which it does not hold.
pub(crate) fn unless(holds: bool, reason: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(reason) }
}

/// Whether the session accepts this event now. The error says why not, in words for the wizard, as in every `admit`.
pub fn admit(session: &Session, event: &Event) -> Result<(), &'static str> {
    let (phase, robot) = (session.phase, &session.robot);
    unless(phase != TrialPhase::Closed, "the session is over")?;
    match event {
        Event::TrialStarted => {
            unless(phase == TrialPhase::Ready, "the trial was started already")?;
            unless(!session.is_calibrating(), "a gaze accuracy check is running")?;
            protocol::admit_trial(session)
        }
        Event::Preflight { .. } => unless(phase == TrialPhase::Ready, "the trial was started already"),
        Event::TrialPaused => unless(session.can_be_paused(), "no trial runs"),
        Event::TrialResumed => {
            unless(phase == TrialPhase::Paused, "the trial is not paused")?;
            unless(!session.can_be_paused(), "the trial goes on by itself after the freeze probe")?;
            unless(!session.is_calibrating(), "a gaze accuracy check is running")
        }
        Event::TrialEnded { reason: TrialEndReason::Aborted } => Err("an aborted trial needs a reason: trial_aborted"),
        Event::TrialEnded { .. } => {
            unless(matches!(phase, TrialPhase::Running | TrialPhase::Paused), "there is no trial to end")
        }
        Event::Gaze(sample) => {
            let finite = sample.x.is_finite() && sample.y.is_finite() && sample.confidence.is_finite();
            unless(finite, "the gaze sample is not a number")
        }
        Event::Marker { note, observer: Some(observer) } => {
            unless(!note.trim().is_empty(), "an observer's remark has words")?;
            unless(person_code::fault(observer).is_none(), "an observer has a code, as participants have")
        }
        Event::MarkerWorded { marker, .. } => {
            let is_open = session.open_marks.iter().any(|(mark, _)| mark == marker);
            unless(is_open, "no time mark of this number waits for words")
        }
        Event::Tracker(event) => tracker::admit(event),
        Event::Film(event) => film::admit(event),
        Event::Calibration(event) => gaze_check::admit(session, event),
        Event::RobotStage { .. } => unless(session.spec.robot.arm.is_real(), "the robot's arm is not a real one"),
        Event::RobotConfirmed { stage } => {
            let is_it = robot.arm.stage.as_ref().is_some_and(|(present, _)| present == stage);
            unless(is_it && stage.asks().is_some(), "the arm asks for no confirmation")?;
            unless(phase != TrialPhase::Running || *stage == ArmStage::Off, "pause the trial first")
        }
        Event::RobotMoves(_) | Event::RobotSafety { .. } | Event::RobotTouched { .. } => unless(
            session.spec.robot.arm.has_joints(),
            "the robot's arm is timed in this session: it is not simulated physically",
        ),
        Event::RobotStopped => unless(!robot.is_stopped_by_wizard(), "the robot is stopped already"),
        Event::RobotResumed => unless(robot.stopped, "the robot is not stopped"),
        Event::SignalShown { by, signal, offer, .. } => {
            admit_signal(session, *by, signal)?;
            let is_there = |seq: u64| session.offers.find(seq).is_some_and(|offer| offer.signal() == Some(signal));
            unless(offer.is_none_or(is_there), "the event names an offer that was not the last one")
        }
        Event::External(_) => unless(session.spec.has_external_mind(), "this session has no external mind"),
        Event::OfferOpened(_) => {
            unless(phase == TrialPhase::Running, "no trial runs")?;
            unless(session.offers.unclosed().is_none(), "an offer is open already")
        }
        Event::OfferClosed { offer, .. } => {
            let is_open = session.offers.unclosed().is_some_and(|open| open.seq == *offer);
            unless(is_open, "the event names an offer that is not open")
        }
        Event::HumanWaits { .. } => unless(phase == TrialPhase::Running, "no trial runs"),
        Event::Advised(_) => {
            unless(phase == TrialPhase::Running, "no trial runs")?;
            unless(session.spec.asks_assistant(), "nobody asks the assistant in this session")
        }
        Event::SignalEnded { .. } => unless(session.shown.is_some(), "no signal is shown to the participant"),
        Event::Probe(event) => probes::admit(session, event),
        Event::Protocol(event) => protocol::admit(session, event),
        Event::KitchenCorrected { location, content } => admit_correction(session, location, content),
        Event::RobotHeld { by } => by_the_wizard(*by).and(unless(!robot.held, "the robot is held already")),
        Event::RobotReleased { by } => by_the_wizard(*by).and(unless(robot.held, "the robot is not held")),
        Event::RobotSkipped { by } => {
            by_the_wizard(*by)?;
            unless(phase == TrialPhase::Running, "the robot's presses can be skipped only while the trial runs")?;
            unless(robot.intention.is_some(), "the robot is not on its way to a press")
        }
        Event::RobotDriven { by, .. } => {
            by_the_wizard(*by)?;
            unless(phase == TrialPhase::Running, "the robot's press can be chosen only while the trial runs")?;
            unless(!robot.stopped, "the robot is stopped: resume it first")
        }
        Event::TrialAborted { .. } => {
            unless(matches!(phase, TrialPhase::Running | TrialPhase::Paused), "no trial runs that could be aborted")
        }
        Event::TrialExcluded { .. } => {
            unless(phase != TrialPhase::Ready, "no trial has begun that could be excluded")?;
            unless(session.excluded.is_none(), "the trial is excluded already")
        }
        Event::TrialIncluded => unless(session.excluded.is_some(), "the trial is not excluded"),
        _ => Ok(()),
    }
}

/// Whether the condition of the trial allows signals of this sender.
pub fn may_send(session: &Session, by: Sender) -> Result<(), &'static str> {
    match (session.spec.trial.condition, by) {
        (Condition::None, _) => Err("nobody sends signals in the unassisted condition"),
        (Condition::Wizard, Sender::Assistant) => Err("the wizard sends the signals in this condition"),
        (Condition::Assistant, Sender::Wizard) => Err("the assistant sends the signals in this condition"),
        _ => Ok(()),
    }
}

/// What never allows signals comes before what does not allow them now.
pub(crate) fn may_send_now(session: &Session, by: Sender) -> Result<(), &'static str> {
    may_send(session, by)?;
    unless(session.phase == TrialPhase::Running, "signals are sent while the trial runs")
}

fn admit_signal(session: &Session, by: Sender, signal: &Signal) -> Result<(), &'static str> {
    may_send_now(session, by)?;
    if let Signal::Propose(_) = signal {
        unless(session.spec.assistant.concept == ConceptName::Dev, "only DEV proposes presses")?;
        unless(by == Sender::Assistant, "proposed presses are sent by the assistant")?;
    }
    let highlighted = signal.location(&session.kitchen).filter(|_| matches!(signal, Signal::Highlight(_)));
    let may_be = highlighted.is_none_or(|location| session.highlights().holds(location));
    unless(may_be, "the session does not highlight this location")?;
    communication::unavailable(&session.kitchen, session.state, signal).map_or(Ok(()), Err)
}

/// Rules for the wizard's keys, such as the cool-down between signals; they do not apply to events in recordings.
pub fn hygiene(session: &Session, now: SessionTime, event: &Event) -> Result<(), String> {
    let Event::SignalShown { by: Sender::Wizard, signal, .. } = event else { return Ok(()) };
    if session.spec.scripts_wizard() {
        return Err("the scripted wizard sends the signals in this session".to_string());
    }
    if session.shown.as_ref().is_some_and(|shown| shown.by == Sender::Wizard && shown.signal == *signal) {
        return Err("this signal is shown already".to_string());
    }
    let (cool_down_s, since) = (session.spec.signals.cool_down_s, session.signalled_at);
    match since.map(|since| now.secs_since(since)).filter(|&age_s| age_s < cool_down_s) {
        Some(age_s) => {
            // Rounded down, so that the age is never that of a signal that could be sent.
            let age_s = (10.0 * age_s).floor() / 10.0;
            Err(format!("too soon: the last signal is {age_s:.1} s ago, signals need {cool_down_s} s between them"))
        }
        None => Ok(()),
    }
}

/// Whether a person presses sooner after the previous press than the setting `pace_s` allows.
pub(crate) fn is_too_early(session: &Session, now: SessionTime) -> bool {
    let spec = &session.spec;
    let Some(pace_s) = spec.trial.pace_s.filter(|_| spec.participant.kind != ParticipantKind::Simulated) else {
        return false;
    };
    own_presses(session).next().is_some_and(|last| session.age(last, now).as_secs_f64() < pace_s)
}

/// Whether an event comes from outside (wizard, participant, tracker, a real arm) rather than from the running session itself.
pub fn is_external(session: &Session, event: &Event) -> bool {
    let (participant, is_real) = (&session.spec.participant, session.spec.robot.arm.is_real());
    match event {
        Event::TrialStarted
        | Event::TrialPaused
        | Event::TrialResumed
        | Event::RobotStopped
        | Event::RobotResumed
        | Event::RobotHeld { .. }
        | Event::RobotReleased { .. }
        | Event::RobotSkipped { .. }
        | Event::RobotDriven { .. }
        | Event::RobotStage { .. }
        | Event::RobotConfirmed { .. }
        | Event::KitchenCorrected { .. }
        | Event::TrialAborted { .. }
        | Event::TrialExcluded { .. }
        | Event::TrialIncluded
        | Event::Preflight { .. }
        | Event::Screen(_)
        | Event::Display(_)
        | Event::ButtonBox(_)
        | Event::Film(_)
        | Event::Unblinded { .. }
        | Event::SignalDrawn { .. }
        | Event::FocusLost
        | Event::FocusRegained
        | Event::Marker { .. }
        | Event::MarkerWorded { .. }
        | Event::ClockJumped { .. }
        | Event::Advised(_)
        | Event::External(_)
        | Event::Tracker(_)
        | Event::SessionEnded => true,
        Event::Calibration(event) => event.is_external(),
        Event::TrialEnded { reason } => *reason == TrialEndReason::Wizard,
        Event::Probe(event) => match event {
            ProbeEvent::Requested | ProbeEvent::Skipped { .. } => true,
            ProbeEvent::Answered { .. } => participant.kind != ParticipantKind::Simulated,
            _ => false,
        },
        Event::Protocol(event) => !matches!(event, ProtocolEvent::CriterionChecked { .. }),
        Event::SignalShown { by, .. } => *by == Sender::Wizard && !session.spec.scripts_wizard(),
        Event::SignalEnded { reason } => *reason == SignalEndReason::TakenBack,
        Event::ParticipantBelieves(_) => participant.kind != ParticipantKind::Simulated,
        Event::Gaze(_) => !participant.simulates_gaze(),
        Event::Press { agent: Agent::Human, .. } => participant.kind != ParticipantKind::Simulated,
        // A real arm reports what it does.
        Event::Press { agent: Agent::Robot, .. }
        | Event::RobotMoves(_)
        | Event::RobotSafety { .. }
        | Event::RobotTouched { .. } => is_real,
        Event::RobotAborts { reason, .. } => is_real && reason.is_of_physics(),
        Event::OrderShown { .. }
        | Event::OrderCleared { .. }
        | Event::HumanWaits { .. }
        | Event::RobotIntends { .. }
        | Event::RobotIdles { .. }
        | Event::OfferOpened(_)
        | Event::OfferClosed { .. }
        | Event::BeliefEstimated(_) => false,
    }
}

fn by_the_wizard(by: Sender) -> Result<(), &'static str> {
    unless(by == Sender::Wizard, "only the wizard can hold the robot, skip its presses and choose them")
}

fn admit_correction(session: &Session, location: &str, content: &str) -> Result<(), &'static str> {
    let has_begun = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
    unless(has_begun, "the kitchen can be corrected only during a trial")?;
    // The probe's questions are about the kitchen as it was when the task was frozen.
    unless(!session.is_frozen(), "the kitchen can be corrected only after the freeze probe")?;
    let kitchen = &session.kitchen;
    let place = kitchen.location_named(location).ok_or("the kitchen has no location with this name")?;
    let what = kitchen.content_named(content).ok_or("the kitchen has no content with this name")?;
    let is_order = kitchen.location(place).kind == LocationKind::Order;
    unless(!is_order, "orders are shown by the program, and cannot be corrected")?;
    unless(session.state.content(place) != what, "the program assumes this content already")?;
    unless(what == ContentId::EMPTY || kitchen.accepts(place, what), "this content cannot be at this place")
}
