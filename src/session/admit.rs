//! Preconditions of events: whether a session accepts an event now. Preconditions are checked before an input is taken,
//! and again when an event is applied.

use crate::event::{SignalEndReason, TrialEndReason};
use crate::probes::{self, ProbeEvent};
use crate::protocol::{self, ProtocolEvent};
use crate::settings::{Condition, ParticipantKind};
use crate::{Event, Session, TimelineEvent, TrialPhase, film, gaze_check, person_code, tracker};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::{self, Sender, Signal};
use tomcom_core::kitchen::{Agent, ContentId, LocationKind};
use tomcom_core::robot::ArmStage;

/// What a precondition says: nothing, or the reason for which it does not hold.
pub(crate) fn unless(holds: bool, reason: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(reason) }
}

fn refuse_if(refused: bool, reason: &'static str) -> Result<(), &'static str> {
    unless(!refused, reason)
}

/// Whether the session accepts this event now. The error says why not, in words for the wizard, as in every `admit`.
pub fn admit(session: &Session, event: &Event) -> Result<(), &'static str> {
    let phase = session.phase;
    refuse_if(phase == TrialPhase::Closed, "the session is over")?;
    match event {
        Event::TrialStarted => {
            refuse_if(phase != TrialPhase::Ready, "the trial was started already")?;
            refuse_if(session.is_calibrating(), "a gaze accuracy check is running")?;
            protocol::admit_trial(session)
        }
        Event::Preflight { .. } => refuse_if(phase != TrialPhase::Ready, "the trial was started already"),
        Event::TrialPaused => refuse_if(!session.can_be_paused(), "no trial runs"),
        Event::TrialResumed => {
            refuse_if(phase != TrialPhase::Paused, "the trial is not paused")?;
            refuse_if(session.can_be_paused(), "the trial goes on by itself after the freeze probe")?;
            refuse_if(session.is_calibrating(), "a gaze accuracy check is running")
        }
        Event::TrialEnded { reason: TrialEndReason::Aborted } => Err("an aborted trial needs a reason: trial_aborted"),
        Event::TrialEnded { .. } => {
            refuse_if(!matches!(phase, TrialPhase::Running | TrialPhase::Paused), "there is no trial to end")
        }
        Event::Gaze(sample) => {
            let finite = sample.x.is_finite() && sample.y.is_finite() && sample.confidence.is_finite();
            refuse_if(!finite, "the gaze sample is not a number")
        }
        Event::Marker { note, observer: Some(observer) } => {
            refuse_if(note.trim().is_empty(), "an observer's remark has words")?;
            refuse_if(person_code::fault(observer).is_some(), "an observer has a code, as participants have")
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
            let is_it = session.robot.arm.stage.as_ref().is_some_and(|(present, _)| present == stage);
            unless(is_it && stage.asks().is_some(), "the arm asks for no confirmation")?;
            refuse_if(phase == TrialPhase::Running && *stage != ArmStage::Off, "pause the trial first")
        }
        Event::RobotMoves(_) | Event::RobotSafety { .. } | Event::RobotTouched { .. } => refuse_if(
            !session.spec.robot.arm.has_joints(),
            "the robot's arm is timed in this session: it is not simulated physically",
        ),
        Event::RobotStopped => refuse_if(session.robot.is_stopped_by_wizard(), "the robot is stopped already"),
        Event::RobotResumed => refuse_if(!session.robot.stopped, "the robot is not stopped"),
        Event::SignalShown { by, signal, offer, .. } => {
            admit_signal(session, *by, signal)?;
            let is_there = |seq: u64| session.offers.find(seq).is_some_and(|offer| offer.signal() == Some(signal));
            refuse_if(offer.is_some_and(|seq| !is_there(seq)), "the event names an offer that was not the last one")
        }
        Event::External(_) => unless(session.spec.has_external_mind(), "this session has no external mind"),
        Event::OfferOpened(_) => {
            refuse_if(phase != TrialPhase::Running, "no trial runs")?;
            refuse_if(session.offers.unclosed().is_some(), "an offer is open already")
        }
        Event::OfferClosed { offer, .. } => {
            let is_open = session.offers.unclosed().is_some_and(|open| open.seq == *offer);
            refuse_if(!is_open, "the event names an offer that is not open")
        }
        Event::HumanWaits { .. } => refuse_if(phase != TrialPhase::Running, "no trial runs"),
        Event::Advised(_) => {
            refuse_if(phase != TrialPhase::Running, "no trial runs")?;
            refuse_if(!session.spec.asks_assistant(), "nobody asks the assistant in this session")
        }
        Event::SignalEnded { .. } => refuse_if(session.shown.is_none(), "no signal is shown to the participant"),
        Event::Probe(event) => probes::admit(session, event),
        Event::Protocol(event) => protocol::admit(session, event),
        other => admit_intervention(session, other),
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
    refuse_if(session.phase != TrialPhase::Running, "signals are sent while the trial runs")
}

fn admit_signal(session: &Session, by: Sender, signal: &Signal) -> Result<(), &'static str> {
    may_send_now(session, by)?;
    if matches!(signal, Signal::Propose(_)) && session.spec.assistant.concept != ConceptName::Dev {
        return Err("only DEV proposes presses");
    }
    if matches!(signal, Signal::Propose(_)) && by != Sender::Assistant {
        return Err("proposed presses are sent by the assistant");
    }
    let highlighted = signal.location(&session.kitchen).filter(|_| matches!(signal, Signal::Highlight(_)));
    if highlighted.is_some_and(|location| !session.highlights().holds(location)) {
        return Err("the session does not highlight this location");
    }
    match communication::unavailable(&session.kitchen, session.state, signal) {
        Some(reason) => Err(reason),
        None => Ok(()),
    }
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
    let is_own = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { agent: Agent::Human, .. });
    let last = session.timeline.iter().rfind(|entry| is_own(&entry.what));
    last.is_some_and(|last| session.age(last.time, now).as_secs_f64() < pace_s)
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

fn admit_intervention(session: &Session, event: &Event) -> Result<(), &'static str> {
    let (phase, robot) = (session.phase, &session.robot);
    match event {
        Event::KitchenCorrected { location, content } => admit_correction(session, location, content),
        Event::RobotHeld { by } => by_the_wizard(*by).and(refuse_if(robot.held, "the robot is held already")),
        Event::RobotReleased { by } => by_the_wizard(*by).and(refuse_if(!robot.held, "the robot is not held")),
        Event::RobotSkipped { by } => {
            by_the_wizard(*by)?;
            refuse_if(phase != TrialPhase::Running, "the robot's presses can be skipped only while the trial runs")?;
            refuse_if(robot.intention.is_none(), "the robot is not on its way to a press")
        }
        Event::RobotDriven { by, .. } => {
            by_the_wizard(*by)?;
            refuse_if(phase != TrialPhase::Running, "the robot's press can be chosen only while the trial runs")?;
            refuse_if(robot.stopped, "the robot is stopped: resume it first")
        }
        Event::TrialAborted { .. } => {
            refuse_if(!matches!(phase, TrialPhase::Running | TrialPhase::Paused), "no trial runs that could be aborted")
        }
        Event::TrialExcluded { .. } => {
            refuse_if(phase == TrialPhase::Ready, "no trial has begun that could be excluded")?;
            refuse_if(session.excluded.is_some(), "the trial is excluded already")
        }
        Event::TrialIncluded => refuse_if(session.excluded.is_none(), "the trial is not excluded"),
        _ => Ok(()),
    }
}

fn by_the_wizard(by: Sender) -> Result<(), &'static str> {
    unless(by == Sender::Wizard, "only the wizard can hold the robot, skip its presses and choose them")
}

fn admit_correction(session: &Session, location: &str, content: &str) -> Result<(), &'static str> {
    if !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused) {
        return Err("the kitchen can be corrected only during a trial");
    }
    if session.is_frozen() {
        // The probe's questions are about the kitchen as it was when the task was frozen.
        return Err("the kitchen can be corrected only after the freeze probe");
    }
    let kitchen = &session.kitchen;
    let place = kitchen.location_named(location).ok_or("the kitchen has no location with this name")?;
    let what = kitchen.content_named(content).ok_or("the kitchen has no content with this name")?;
    match () {
        () if kitchen.location(place).kind == LocationKind::Order => {
            Err("orders are shown by the program, and cannot be corrected")
        }
        () if session.state.content(place) == what => Err("the program assumes this content already"),
        () if what != ContentId::EMPTY && !kitchen.accepts(place, what) => Err("this content cannot be at this place"),
        () => Ok(()),
    }
}
