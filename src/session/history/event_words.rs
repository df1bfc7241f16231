//! What happened, in words: a line of text for each event of a recording, for pipes and plain terminals; and an entry of
//! the list of events, for screens.

use std::collections::BTreeMap;

use super::signal_words;
use super::wording::{self, location as said};
use crate::event::{SignalEndReason, TrialEndReason, WizardScreenContent};
use crate::follower::SessionFollower;
use crate::gaze_check::GazeCheckEvent;
use crate::preflight_checks::{PreflightCheck, PreflightVerdict};
use crate::probes::{ProbeEvent, ProbeOrigin};
use crate::protocol::ProtocolEvent;
use crate::questionnaire::AnswerValue;
use crate::tracker::{TrackerEvent, TrackerRecording};
use crate::tutorial::TutorialEvent;
use crate::wall_display::{AnswerDevice, DisplayEvent};
use crate::{ArmStatus, Event, Session, TimelineEvent, TimestampedEvent, TrialPhase};
use tomcom_core::base::text::{count, printable};
use tomcom_core::communication::concept::{BenefitUnit, ConceptName};
use tomcom_core::communication::offer::OfferedAdvice;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, LocationId, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::{FALSE_BELOW, THINKS};
use tomcom_core::mind::{AspectBelief, AspectEstimate, RecordedBelief, RecordedEstimate};
use tomcom_core::robot::{ArmStage, SafetyMode};

pub const HEADING: &str = " trial time  what happened";

/// The text line for an event that was just applied, with the time on the trial's clock; `None` for events without a
/// line: gaze samples, fixations, blinks, drawn signals, arm motion, estimates without a probable false belief, and
/// changes between normal and reduced speed.
pub fn line(stamped: &TimestampedEvent, follower: &SessionFollower) -> Option<String> {
    let (words, session) = (words(stamped, follower)?, &follower.session);
    Some(match session.phase {
        TrialPhase::Ready => format!("{:>11}  {words}", "before"),
        _ => format!("{:>9} s  {words}", session.trial_clock(stamped.time).in_seconds()),
    })
}

/// The words of [`line()`]. The follower can have seen later events.
pub fn words(stamped: &TimestampedEvent, follower: &SessionFollower) -> Option<String> {
    let kitchen = &follower.session.kitchen;
    let words = match &stamped.event {
        Event::Gaze(_) | Event::SignalDrawn { .. } | Event::RobotMoves(_) => return None,
        // A belief estimate gets a line only if it contains a probable false belief.
        Event::BeliefEstimated(estimate) => estimated(kitchen, estimate)?,
        Event::TrialStarted => "trial started".to_string(),
        Event::TrialPaused => "trial paused".to_string(),
        Event::TrialResumed => "trial goes on".to_string(),
        Event::TrialEnded { reason: TrialEndReason::Presses } => "trial over: number of presses".to_string(),
        Event::TrialEnded { reason: TrialEndReason::Time } => "trial over: time".to_string(),
        Event::TrialEnded { reason: TrialEndReason::Orders } => "trial over: orders served".to_string(),
        Event::TrialEnded { reason: TrialEndReason::Wizard } => "trial ended by the wizard".to_string(),
        Event::TrialEnded { reason: TrialEndReason::Aborted } => "trial aborted".to_string(),
        Event::TrialAborted { reason } => format!("trial aborted: {reason}"),
        Event::TrialExcluded { reason } => format!("trial excluded: {reason}"),
        Event::TrialIncluded => "trial no longer excluded".to_string(),
        Event::Preflight { checks, overridden } => preflight(checks, *overridden),
        Event::Screen(screen) => on_screen(screen),
        Event::Display(event) => on_display(event),
        Event::Film(event) => event.words(),
        Event::ButtonBox(event) => event.words(),
        Event::Unblinded { concepts } => {
            let names: Vec<&str> = concepts.iter().map(|concept| concept.title()).collect();
            format!("the wizard sees what {} would say", names.join(", "))
        }
        Event::FocusLost => "the terminal lost the keyboard focus".to_string(),
        Event::FocusRegained => "the terminal has the keyboard focus again".to_string(),
        Event::Press { agent, button, .. } => {
            format!("{} presses {}{}", agent.name(), said(button), verdict(stamped, follower))
        }
        Event::OrderShown { order, dish } => format!("{} wants {}", said(order), kitchen.worded(dish)),
        Event::OrderCleared { order } => format!("{} is cleared", said(order)),
        Event::HumanWaits { silent_ns } => {
            format!(
                "participant has pressed nothing for {:.0} s: the assistant is asked again",
                silent_ns.as_secs_f64()
            )
        }
        Event::RobotIntends { button, initiative, .. } => {
            format!("robot sets out for {}{}", said(button), if *initiative { ", by its own initiative" } else { "" })
        }
        Event::RobotAborts { button, reason } => format!("robot gives up {}: {}", said(button), reason.words()),
        Event::RobotIdles { reason, waits_for } => {
            format!("robot {}", wording::idle(*reason, waits_for, None).swap_remove(0))
        }
        // Changes between normal and reduced speed get no line: the arm slows near the hand and speeds up again too
        // often.
        Event::RobotSafety { mode: SafetyMode::Normal | SafetyMode::Reduced, .. } => return None,
        Event::RobotSafety { mode, force_n, joint } => {
            format!("robot's arm: {}", arm_stopped(*mode, *force_n, *joint))
        }
        Event::RobotTouched { force_n } => format!("robot's arm: contact with a person, {force_n:.0} N"),
        Event::RobotStage { stage, found } => format!("robot's arm: {}", arm_stage(*stage, found)),
        Event::RobotConfirmed { stage } => format!("the wizard {}", stage.asks().unwrap_or("confirms")),
        Event::RobotHeld { .. } => "robot held by the wizard before its next press".to_string(),
        Event::RobotReleased { .. } => "robot released by the wizard".to_string(),
        Event::RobotSkipped { .. } => "the wizard skips the robot's press".to_string(),
        Event::RobotDriven { button, .. } => format!("the wizard chose the robot's press: {}", said(button)),
        Event::KitchenCorrected { location, content } => {
            format!("corrected by hand: {} holds {}", said(location), kitchen.worded(content))
        }
        Event::RobotStopped => "robot stopped by the wizard".to_string(),
        Event::RobotResumed => "robot resumed".to_string(),
        Event::Advised(advice) => advised(kitchen, advice, follower.session.spec.assistant.concept.name()),
        // Beliefs get no line.
        Event::External(event) => event.words()?,
        Event::OfferOpened(offer) => offered(offer),
        Event::OfferClosed { reason, .. } => format!("offer closes: {}", reason.words()),
        Event::SignalShown { signal: shown, offer: Some(_), .. } => {
            format!("signal: {} (the offer is taken)", wording::signal(shown))
        }
        Event::SignalShown { signal: shown, .. } => format!("signal: {}", wording::signal(shown)),
        Event::SignalEnded { reason: SignalEndReason::Elapsed } => "signal ends".to_string(),
        Event::SignalEnded { reason: SignalEndReason::TakenBack } => "signal taken back".to_string(),
        Event::SignalEnded { reason: SignalEndReason::Outdated } => "signal out of date".to_string(),
        Event::Marker { note, .. } if note.is_empty() => "marker".to_string(),
        Event::Marker { note, observer: None } => format!("marker: {note}"),
        Event::Marker { note, observer: Some(observer) } => format!("remark of {observer}: {note}"),
        Event::MarkerWorded { note, .. } if note.is_empty() => "a time mark stays without words".to_string(),
        Event::MarkerWorded { note, .. } => mark_worded(&follower.session, note),
        Event::Probe(event) => probe(event),
        Event::Protocol(event) => protocol(event),
        Event::Tracker(event) => tracker(event)?,
        Event::Calibration(event) => calibration(event),
        Event::ClockJumped { by_ms } => format!("the wall clock jumped by {:.1} s", *by_ms as f64 / 1000.0),
        Event::ParticipantBelieves(belief) => believes(kitchen, belief),
        Event::SessionEnded => "session over".to_string(),
    };
    // Control characters are escaped: notes and names of devices can contain them, and they would disturb the terminal.
    Some(printable(&words).into_owned())
}

/// The words of an event at which a replay stops, also of events without a line.
pub fn step_words(stamped: &TimestampedEvent, follower: &SessionFollower) -> String {
    words(stamped, follower).unwrap_or_else(|| match &stamped.event {
        Event::RobotSafety { mode, .. } => format!("robot's arm: {} speed", mode.name().to_lowercase()),
        Event::External(event) => format!("external {} answers", event.role().name()),
        Event::Tracker(TrackerEvent::Fixation { duration_ms, .. }) => format!("fixation of {duration_ms:.0} ms"),
        Event::Tracker(TrackerEvent::Blink { closed, .. }) => {
            format!("blink {}", if *closed { "begins" } else { "ends" })
        }
        event => event.kind().replace('_', " "),
    })
}

fn preflight(checks: &[PreflightCheck], overridden: bool) -> String {
    let not_ok = checks.iter().filter(|check| check.verdict != PreflightVerdict::Ok);
    let not_ok: Vec<String> = not_ok.map(|check| format!("{} ({})", check.name, check.found)).collect();
    match (not_ok.is_empty(), overridden) {
        (true, _) => format!("preflight: {} ok", count(checks.len() as u64, "check", "checks")),
        (false, true) => format!("preflight overridden: {}", not_ok.join(", ")),
        (false, false) => format!("preflight: not ok: {}", not_ok.join(", ")),
    }
}

fn on_display(event: &DisplayEvent) -> String {
    match event {
        DisplayEvent::Connected { width_px, height_px } => {
            format!("the participant's display is there, {width_px} x {height_px}")
        }
        DisplayEvent::Lost => "the participant's display is gone".to_string(),
        DisplayEvent::Drawn { cue, .. } => format!("the participant's display drew event {cue}"),
    }
}

fn on_screen(screen: &WizardScreenContent) -> String {
    let dialog = screen.dialog.as_ref().map_or(String::new(), |dialog| format!(", {dialog} open"));
    format!("the wizard sees {} ({}{dialog})", screen.panels.join(", "), screen.room)
}

fn verdict(stamped: &TimestampedEvent, follower: &SessionFollower) -> String {
    match (&stamped.event, follower.judgement(stamped.seq).map(|(_, press)| press)) {
        (Event::Press { agent: Agent::Human, .. }, None) => " (does not count)".to_string(),
        (_, Some(press)) if press.verdict.error => {
            format!(" (error, {})", verdict_words(&follower.session.kitchen, press))
        }
        (_, Some(press)) if press.verdict.race => " (race with the robot)".to_string(),
        _ => String::new(),
    }
}

fn believes(kitchen: &Kitchen, belief: &RecordedBelief) -> String {
    let wrong = belief.aspects.iter().filter(|aspect| aspect.p_truth < FALSE_BELOW);
    let told = |one: &AspectBelief| held(kitchen, &one.aspect, &one.believes, &one.values);
    let wrong: Vec<String> = wrong.map(told).collect();
    // Why a simulated participant presses so, unless that follows from the true state ("as it is").
    let cause = match belief.cause.as_str() {
        "as it is" => String::new(),
        cause => format!("; reason: {}", said(&worded_cause(kitchen, cause))),
    };
    match wrong.is_empty() {
        true => format!("participant believes nothing wrong{cause}"),
        false => format!("participant believes {}{cause}", wrong.join(", ")),
    }
}

/// "cooking pot = empty"; "cooking pot = unsure" where no value is probable.
fn held(kitchen: &Kitchen, aspect: &str, believes: &str, values: &BTreeMap<String, f64>) -> String {
    let is_thought = values.get(believes).is_some_and(|p| *p >= THINKS);
    format!("{} = {}", said(aspect), if is_thought { kitchen.worded(believes) } else { "unsure" })
}

/// The cause of a press as a simulated participant recorded it, in words: "believes cooking_pot: cooked rice".
fn worded_cause(kitchen: &Kitchen, cause: &str) -> String {
    let worded = |part: &str| match part.split_once(": ") {
        Some((about, content)) => format!("{about}: {}", kitchen.worded(content)),
        None => part.to_string(),
    };
    cause.split(", ").map(worded).collect::<Vec<_>>().join(", ")
}

fn estimated(kitchen: &Kitchen, estimate: &RecordedEstimate) -> Option<String> {
    let wrong = estimate.aspects.iter().filter(|aspect| aspect.p_truth < FALSE_BELOW);
    let told = |one: &AspectEstimate| {
        let held = held(kitchen, &one.aspect, &one.believes, &one.values);
        format!("{held} (wrong {:.2})", 1.0 - one.p_truth)
    };
    let wrong: Vec<String> = wrong.map(told).collect();
    (!wrong.is_empty()).then(|| format!("estimated before the press: participant believes {}", wrong.join(", ")))
}

fn advised(kitchen: &Kitchen, advice: &Recommendation, by: ConceptName) -> String {
    if let Some(proposal) = &advice.proposal {
        let presses: Vec<String> = proposal.presses.iter().map(|press| said(press)).collect();
        return format!("proposed after the error: {}", presses.join(", "));
    }
    let Some(best) = &advice.best else {
        return format!("advised: {}", signal_words::not_advised(by.unit(), advice));
    };
    let what = wording::signal(best);
    // An external concept can name a signal without its value.
    let worth = advice.options.iter().find(|option| option.signal == *best).map(|option| worth(option, by));
    let reason = advice.reason.as_ref().map(|reason| wording::reason(kitchen, reason).words());
    let reason = reason.or_else(|| advice.words.clone()).map_or(String::new(), |reason| format!(": {reason}"));
    format!("advised: {what}{}{reason}", worth.unwrap_or_default())
}

fn worth(option: &SignalOption, by: ConceptName) -> String {
    match by.unit() {
        BenefitUnit::Deviation => format!(", belief off by {:.2}", option.benefit),
        BenefitUnit::Presses | BenefitUnit::None if option.rollouts == 0 => {
            format!(", saves {:.1} presses", option.benefit)
        }
        BenefitUnit::Presses | BenefitUnit::None => {
            format!(", saves {:.1} presses (±{:.1})", option.benefit, option.standard_error)
        }
    }
}

fn offered(offer: &OfferedAdvice) -> String {
    let unseen = if offer.visible { "" } else { " (not visible to a wizard)" };
    format!("offer: {}{unseen}", wording::signal(&offer.what))
}

/// An entry of the list of events: who caused it, and what happened.
pub fn happening(kitchen: &Kitchen, what: &TimelineEvent) -> (&'static str, String) {
    match what {
        TimelineEvent::Press { agent, button: id, before, after, no_effect } => {
            let did = match no_effect {
                Some((why, about)) => Some(wording::because(kitchen, *why, *about, "that")),
                None => press_effect(kitchen, *agent, *id, (*before, *after)),
            };
            let did = did.map_or(String::new(), |did| format!(": {did}"));
            (agent.name(), format!("{}{did}", wording::button(kitchen, *agent, *id)))
        }
        TimelineEvent::Served { order } => ("", format!("{} is served", kitchen.location(*order).label())),
        TimelineEvent::OrderShown { order } => ("", format!("{} appears", kitchen.location(*order).label())),
        TimelineEvent::RobotSkipped(id) => {
            ("wizard", format!("skipped {}", wording::button(kitchen, Agent::Robot, *id)))
        }
        TimelineEvent::Trial(phase) => ("trial", trial(*phase).to_string()),
        TimelineEvent::Noted(event) => noted(event),
    }
}

/// The words of a note.
pub fn note(what: &TimelineEvent) -> Option<String> {
    match what {
        TimelineEvent::Noted(Event::Marker { note, observer }) => Some(noted_words(note, observer.as_deref())),
        _ => None,
    }
}

/// A note in words, an observer's with the observer's code.
pub fn noted_words(note: &str, observer: Option<&str>) -> String {
    match (note, observer) {
        ("", _) => "time mark".to_string(),
        (note, None) => note.to_string(),
        (note, Some(observer)) => format!("{observer}: {note}"),
    }
}

/// The words of a time mark, which were typed later, with the time that they are about.
pub fn mark_worded(session: &Session, note: &str) -> String {
    let worded = TimelineEvent::Noted(Event::Marker { note: note.to_string(), observer: None });
    let mark = session.timeline.iter().rev().find(|entry| entry.what == worded);
    let at = mark.map_or(String::new(), |mark| format!(" at {}", session.trial_clock_at(mark.time)));
    format!("words of the time mark{at}: {note}")
}

/// Why the arm stands that the wizard did not stop.
pub fn why_stopped(arm: &ArmStatus) -> String {
    match arm.unready().filter(|_| !arm.mode.is_stopped()) {
        Some((stage, found)) => arm_stage(stage, found),
        None => arm_stopped(arm.mode, arm.stopped_by_n, arm.stopped_by_joint),
    }
}

/// How far a real arm is with being set up, and what was found.
pub fn arm_stage(stage: ArmStage, found: &str) -> String {
    let words = match stage {
        ArmStage::Lost => "no connection",
        ArmStage::Off => "no power",
        ArmStage::Starts => "starts",
        ArmStage::Untried => "waits for its dry run",
        ArmStage::DryRun => "dry run",
        ArmStage::Tried => "dry run done",
        ArmStage::Ready => "ready",
        ArmStage::Stopped => "does not run",
    };
    if found.is_empty() { words.to_string() } else { format!("{words}: {found}") }
}

fn noted(event: &Event) -> (&'static str, String) {
    match event {
        Event::SignalShown { by, signal, .. } => (wording::sender(*by), wording::signal(signal)),
        Event::SignalEnded { .. } => ("wizard", "took the signal back".to_string()),
        Event::Marker { note, observer } => ("note", noted_words(note, observer.as_deref())),
        Event::RobotStopped => ("wizard", "stopped the robot".to_string()),
        Event::RobotSafety { mode, force_n, joint } => ("robot", arm_stopped(*mode, *force_n, *joint)),
        Event::RobotTouched { force_n } => ("robot", format!("contact with a person, {force_n:.0} N")),
        Event::RobotStage { stage, found } => ("robot", arm_stage(*stage, found)),
        Event::RobotResumed => ("wizard", "resumed the robot".to_string()),
        Event::RobotHeld { .. } => ("wizard", "held the robot".to_string()),
        Event::RobotReleased { .. } => ("wizard", "released the robot".to_string()),
        Event::RobotDriven { button, .. } => ("wizard", format!("chose the robot's press: {}", said(button))),
        Event::KitchenCorrected { location, .. } => ("wizard", format!("corrected {}", said(location))),
        Event::Probe(event) => ("", probe(event)),
        Event::Tracker(event) => ("gaze", tracker(event).unwrap_or_default()),
        Event::TrialExcluded { reason } => ("trial", format!("excluded: {reason}")),
        Event::TrialIncluded => ("trial", "no longer excluded".to_string()),
        Event::FocusLost => ("console", "lost the keyboard focus".to_string()),
        Event::FocusRegained => ("console", "has the keyboard focus again".to_string()),
        // Others are not noted.
        other => ("", other.kind().replace('_', " ")),
    }
}

/// What a press with an effect took, put or made: "takes cooked rice", "puts nori"; `None` where the button's name says
/// it.
fn press_effect(kitchen: &Kitchen, agent: Agent, button: ButtonId, (before, after): (State, State)) -> Option<String> {
    let content = |state: State, at: LocationId| kitchen.content_label(state, at);
    let hand = kitchen.hands[agent.index()];
    match kitchen.button(agent, button).action {
        ButtonAction::Take(_) => None,
        ButtonAction::Use(_) if before.content(hand).is_empty() => Some(format!("takes {}", content(after, hand))),
        ButtonAction::Use(place) if before.content(place).is_empty() => Some(format!("puts {}", content(before, hand))),
        ButtonAction::Use(_) => Some(format!("stacks {}", content(before, hand))),
        ButtonAction::Process(process) => {
            let place = kitchen.processes[usize::from(process)].place.unwrap_or(hand);
            Some(format!("makes {}", content(after, place)))
        }
        ButtonAction::Trash => Some(format!("discards {}", content(before, hand))),
        ButtonAction::Serve(order) => Some(format!("serves {}", content(before, order))),
    }
}

/// "over: time is up".
pub fn trial(phase: TrialPhase) -> &'static str {
    match phase {
        TrialPhase::Ready => "ready",
        TrialPhase::Running => "runs",
        TrialPhase::Paused => "paused",
        TrialPhase::Over(TrialEndReason::Presses) => "over: all presses made",
        TrialPhase::Over(TrialEndReason::Time) => "over: time is up",
        TrialPhase::Over(TrialEndReason::Orders) => "over: all orders served",
        TrialPhase::Over(TrialEndReason::Wizard) => "ended by the wizard",
        TrialPhase::Over(TrialEndReason::Aborted) => "aborted by the wizard",
        TrialPhase::Closed => "closed",
    }
}

/// "protective stop: contact with a person, 98 N".
pub fn arm_stopped(mode: SafetyMode, force_n: Option<f64>, joint: Option<u8>) -> String {
    let mode = mode.name().to_lowercase();
    stop_cause(force_n, joint).map_or(mode.clone(), |cause| format!("{mode}: {cause}"))
}

/// Why the arm stopped itself, as far as that is recorded.
pub fn stop_cause(force_n: Option<f64>, joint: Option<u8>) -> Option<String> {
    match (force_n, joint) {
        (Some(force_n), _) => Some(format!("contact with a person, {force_n:.0} N")),
        (None, Some(joint)) => Some(format!("joint {joint} does not follow its command")),
        (None, None) => None,
    }
}

/// The cost of the press compared with the human's best press, and the cause where it is known: "costs 2 presses; cause
/// (simulated participant): false belief about robot hand".
fn verdict_words(kitchen: &Kitchen, press: &JudgedPress) -> String {
    [Some(cost(press)), cause(kitchen, press)].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

pub(super) fn cost(press: &JudgedPress) -> String {
    format!("costs {}", count(press.verdict.excess.unsigned_abs(), "press", "presses"))
}

/// The cause, which follows from what a simulated participant recorded.
pub(super) fn cause(kitchen: &Kitchen, press: &JudgedPress) -> Option<String> {
    let cause = press.cause?;
    let because = match cause {
        ErrorCause::Slip => "slip".to_string(),
        ErrorCause::Planning => "planning error".to_string(),
        ErrorCause::Belief { .. } => {
            let about: Vec<String> = cause.targets().map(|target| target.label(kitchen)).collect();
            format!("false belief about {}", about.join(" and "))
        }
    };
    Some(format!("cause (simulated participant): {because}"))
}

pub fn protocol(event: &ProtocolEvent) -> String {
    match event {
        ProtocolEvent::ConsentGiven { on: AnswerDevice::Display, .. } => {
            "the participant agrees to be recorded, on the display".to_string()
        }
        ProtocolEvent::ConsentGiven { .. } => "the participant agrees to be recorded".to_string(),
        ProtocolEvent::PhaseStarted { phase, .. } => format!("phase of the study begins: {}", phase.name()),
        ProtocolEvent::Ticked { step, done: true } => format!("step {step} of the phase is done"),
        ProtocolEvent::Ticked { step, done: false } => format!("step {step} of the phase is unticked"),
        ProtocolEvent::Tutorial(event) => tutorial(event),
        ProtocolEvent::ItemShown { item } => format!("questionnaire item {item} is shown"),
        ProtocolEvent::AnswersShown => "all answers to the questionnaire are shown".to_string(),
        // Answers in words and choices can be personal, and people who watch the stream are not the ones who analyse
        // the study.
        ProtocolEvent::ItemAnswered { item, answer: AnswerValue::Number(number) } => {
            format!("questionnaire item {item}: answer {number}")
        }
        ProtocolEvent::ItemAnswered { item, .. } => format!("questionnaire item {item} is answered"),
        ProtocolEvent::ItemSkipped { item } => format!("questionnaire item {item}: no answer"),
        ProtocolEvent::AnswersConfirmed => "the answers to the questionnaire are confirmed".to_string(),
        ProtocolEvent::CriterionChecked { met, orders, presses, errors } => {
            let met = if *met { "met" } else { "not met" };
            let orders = count(*orders, "order", "orders");
            let errors = count(*errors, "error", "errors");
            format!("practice criterion {met}: {orders} served, {errors} in {}", count(*presses, "press", "presses"))
        }
        ProtocolEvent::CriterionWaived { reason } => format!("practice criterion waived: {reason}"),
    }
}

fn tutorial(event: &TutorialEvent) -> String {
    match event {
        TutorialEvent::Shown { step, by } => format!("tutorial: the {} turns to step {step}", by.name()),
        TutorialEvent::Pressed { button } => format!("tutorial: the participant presses {button}"),
        TutorialEvent::CardsHidden { .. } => "tutorial: the recipe cards are hidden".to_string(),
        TutorialEvent::Answered { step, choice } => {
            format!("tutorial: the participant answers question {step} with choice {choice}")
        }
        TutorialEvent::Ended { by } => format!("tutorial: ended by the {}", by.name()),
    }
}

/// `None` for fixations and blinks, which are too frequent.
pub fn tracker(event: &TrackerEvent) -> Option<String> {
    Some(match event {
        TrackerEvent::Connected { device } => format!("eye tracker connected: {device}"),
        TrackerEvent::Lost { reason } => format!("eye tracker lost: {reason}"),
        TrackerEvent::DisplayFound => "eye tracker detects the display tags".to_string(),
        TrackerEvent::DisplayLost => "eye tracker does not detect the display tags".to_string(),
        TrackerEvent::OtherSurfaces { names } => {
            format!("eye tracker detects other surfaces: {}", wording::quoted(names))
        }
        TrackerEvent::SeveralStreams { streams } if streams.is_empty() => {
            "one gaze stream fits the settings".to_string()
        }
        TrackerEvent::SeveralStreams { streams } => {
            format!("{} gaze streams fit the settings: {}", streams.len(), streams.join("; "))
        }
        TrackerEvent::Stamps { fault: Some(fault) } => {
            format!("{}: gaze counts as taken when it arrives", fault.words())
        }
        TrackerEvent::Stamps { fault: None } => "the time stamps of gaze are those of a clock again".to_string(),
        TrackerEvent::Recording { state } => match state {
            TrackerRecording::Begun => "Pupil Capture records the trial",
            TrackerRecording::GoesOn => "Pupil Capture's recording of this trial goes on, and is ended with the trial",
            TrackerRecording::NotBegun => "Pupil Capture started no recording: it is already recording, or cannot",
            TrackerRecording::Ended => "Pupil Capture's recording ended before the trial",
            TrackerRecording::NotAnnotated => {
                "Pupil Capture accepts no annotations: its Annotation plugin does not start"
            }
        }
        .to_string(),
        TrackerEvent::Dropped(counts) => format!("gaze input dropped so far: {}", wording::drops(counts)),
        TrackerEvent::ClockSet { by_s, .. } => {
            format!(
                "the eye tracker's clock was set {} by {:.3} s",
                if *by_s < 0.0 { "back" } else { "ahead" },
                by_s.abs()
            )
        }
        TrackerEvent::Fixation { .. } | TrackerEvent::Blink { .. } => return None,
    })
}

pub fn calibration(event: &GazeCheckEvent) -> String {
    match event {
        GazeCheckEvent::Begun { targets } => format!("gaze accuracy check begins: {} targets", targets.len()),
        GazeCheckEvent::TargetShown { target } => format!("gaze target {} is shown", target + 1),
        GazeCheckEvent::TargetsHidden => "the gaze targets are hidden".to_string(),
        GazeCheckEvent::Measured { found: None } => "gaze accuracy not measured: too few usable samples".to_string(),
        GazeCheckEvent::Measured { found: Some(found) } => format!(
            "gaze accuracy measured: {:.2} deg, {:.2} deg without its offset; precision {:.2} deg",
            found.accuracy_deg, found.corrected_deg, found.precision_deg
        ),
        GazeCheckEvent::Accepted { corrected: true } => "gaze accepted, its offset is subtracted".to_string(),
        GazeCheckEvent::Accepted { corrected: false } => "gaze accepted without correction".to_string(),
        GazeCheckEvent::Carried { corrected: true, .. } => {
            "gaze correction taken over from the previous recording: its offset is subtracted".to_string()
        }
        GazeCheckEvent::Carried { corrected: false, .. } => {
            "gaze taken over from the previous recording, without correction".to_string()
        }
        GazeCheckEvent::Dismissed => "gaze accuracy check cancelled".to_string(),
    }
}

pub fn probe(event: &ProbeEvent) -> String {
    match event {
        ProbeEvent::Requested => "the wizard requests a freeze probe".to_string(),
        ProbeEvent::Delayed { probe, reason } => format!("freeze probe {probe} is delayed: {}", reason.words()),
        ProbeEvent::Dropped { probe, reason } => format!("freeze probe {probe} is dropped: {}", reason.words()),
        ProbeEvent::Begun { probe, origin, questions, .. } => {
            let by = match origin {
                ProbeOrigin::Schedule => "",
                ProbeOrigin::Wizard => ", at the wizard's request",
            };
            let about: Vec<String> = questions.iter().map(|question| wording::probe_subject(&question.about)).collect();
            let questions = count(questions.len() as u64, "question", "questions");
            format!("freeze probe {probe} begins{by}: the task stands still, {questions}: {}", about.join(", "))
        }
        ProbeEvent::Asked { probe, question } => format!("freeze probe {probe} asks question {question}"),
        ProbeEvent::Answered { question, answer: Some(answer), confidence, .. } => {
            let sure = confidence.map_or(String::new(), |step| format!(" (confidence {step} of 3)"));
            format!("answer to probe question {question}: {}{sure}", said(answer))
        }
        ProbeEvent::Answered { question, answer: None, .. } => {
            format!("answer to probe question {question}: I don't know")
        }
        ProbeEvent::Skipped { probe, reason } => {
            format!("the wizard skips the other questions of freeze probe {probe}: {reason}")
        }
        ProbeEvent::Closed { probe, reason } => format!("freeze probe {probe} closes: {}", reason.words()),
        ProbeEvent::Ended { probe } => format!("the task continues after freeze probe {probe}"),
    }
}
