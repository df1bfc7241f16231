//! Wording of buttons, locations, signals, phases and events as texts for screens and reports.

use crate::event::{SignalEndReason, TrialEndReason};
use crate::gaze_check::GazeCheckEvent;
use crate::plan::PhaseSpec;
use crate::probes::{ProbeEvent, ProbeOrigin, ProbeSubject};
use crate::protocol::ProtocolEvent;
use crate::questionnaire::AnswerValue;
use crate::tracker::{TrackerEvent, TrackerRecording};
use crate::tutorial::TutorialEvent;
use crate::wall_display::AnswerDevice;
use crate::{Session, TimelineEvent, TrialPhase};
use tomcom_core::base::text::count;
use tomcom_core::communication::offer::OfferedCommunication;
use tomcom_core::communication::recommendation::SignalReason;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::gaze::quality::DroppedInputCounts;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, Dish, Kitchen, LocationId, OrderContent, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_core::robot::AbortReason;
use tomcom_core::robot::ArmPhase;
use tomcom_core::robot::IdleReason;
use tomcom_core::robot::SafetyMode;

/// "cutting board", "take rice".
pub fn button(kitchen: &Kitchen, agent: Agent, id: tomcom_core::kitchen::ButtonId) -> String {
    kitchen.button(agent, id).name.replace('_', " ")
}

/// What the robot waits for; `waits_for`: names of the human's buttons; `gave_up`: why it gave up its last useful press,
/// if that is known. In shorter words if the sentence has more signs than `most`, so that the buttons can be read.
pub fn idle(reason: IdleReason, waits_for: &[impl AsRef<str>], gave_up: Option<AbortReason>, most: usize) -> String {
    let buttons: Vec<String> = waits_for.iter().map(|name| name.as_ref().replace('_', " ")).collect();
    match reason {
        IdleReason::NoOrder => "waits for an order".to_string(),
        IdleReason::HumanTurn if buttons.is_empty() => "waits until the human presses".to_string(),
        IdleReason::HumanTurn => {
            let buttons = buttons.join(" or ");
            let told = format!("waits until the human presses {buttons}");
            let short = format!("human's turn: {buttons}");
            match [&told, &short].iter().find(|told| told.chars().count() <= most) {
                Some(told) => told.to_string(),
                None => format!("waits: {buttons}"),
            }
        }
        IdleReason::Skipped => match gave_up {
            Some(AbortReason::Skipped) => "waits: the wizard skipped its press".to_string(),
            Some(reason) => format!("gave up: {}", reason.words()),
            None => "waits: its press was given up".to_string(),
        },
    }
}

pub fn location(name: &str) -> String {
    name.replace('_', " ")
}

/// "slip", "wrong about cooking pot".
pub fn code(code: &ErrorCauseCode) -> String {
    match code {
        ErrorCauseCode::Belief(place) => format!("{} {}", ErrorCauseKind::Belief.title(), location(place)),
        other => other.kind().title().to_string(),
    }
}

/// Why the human's press of this button would have no effect now: "no effect: the cooking pot is empty". It is short,
/// since it stands beside the keys on a terminal with 80 columns.
pub fn no_effect(kitchen: &Kitchen, state: State, id: ButtonId) -> Option<String> {
    let (why, about) = kitchen.no_effect(state, Agent::Human, id)?;
    Some(format!("the press has no effect: {}", because(kitchen, why, about, kitchen.content_label(state, about))))
}

/// `content`: of the location that the reason is about.
pub(super) fn because(kitchen: &Kitchen, why: NoEffectReason, about: LocationId, content: &str) -> String {
    let name = kitchen.location(about).label();
    match why {
        NoEffectReason::HandFull => "the hand is full".to_string(),
        NoEffectReason::HandEmpty => "the hand is empty".to_string(),
        NoEffectReason::BothEmpty => "the hand and the place are empty".to_string(),
        NoEffectReason::PlaceEmpty => format!("the {name} is empty"),
        NoEffectReason::PlaceFull => format!("the {name} is full"),
        NoEffectReason::NotAccepted => "the item is not accepted there".to_string(),
        NoEffectReason::NotStacked => "the items cannot be stacked".to_string(),
        NoEffectReason::NotProcessed => format!("{content} cannot be processed there"),
        NoEffectReason::NoOrder => format!("{name} asks for no dish"),
        NoEffectReason::NotServed => "the item cannot be served there".to_string(),
    }
}

/// Where a button acts: at its own location, or in the agent's hand.
pub fn place(kitchen: &Kitchen, agent: Agent, id: tomcom_core::kitchen::ButtonId) -> LocationId {
    let hand = kitchen.hands[agent.index()];
    match kitchen.button(agent, id).action {
        ButtonAction::Use(location) | ButtonAction::Serve(location) => location,
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand),
        ButtonAction::Take(_) | ButtonAction::Trash => hand,
    }
}

/// "recipe of order 1".
pub fn signal(signal: &Signal) -> String {
    match signal {
        Signal::ShowRecipe(order) => format!("recipe of {}", location(order)),
        Signal::Highlight(place) => format!("highlight {}", location(place)),
        Signal::Propose(presses) => proposal(presses),
    }
}

/// "press take rice, then cooking pot".
pub fn proposal(presses: &[String]) -> String {
    let presses: Vec<String> = presses.iter().map(|press| location(press)).collect();
    format!("press {}", presses.join(", then "))
}

pub fn offered(what: &OfferedCommunication) -> String {
    match what {
        OfferedCommunication::Signal(told) => signal(told),
        OfferedCommunication::Presses(presses) => proposal(presses),
    }
}

/// With contents in the words of screens; the recorded reason has the names of the log.
pub fn reason(kitchen: &Kitchen, reason: &SignalReason) -> SignalReason {
    let worded = |name: &str| kitchen.worded(name).to_string();
    SignalReason { believes: worded(&reason.believes), truth: worded(&reason.truth), ..reason.clone() }
}

pub fn sender(by: Sender) -> &'static str {
    match by {
        Sender::Wizard => "wizard",
        Sender::Assistant => "assistant",
    }
}

/// "cooked rice + nori + cut tuna".
pub fn recipe(session: &Session, order: LocationId) -> Option<String> {
    let OrderContent::Dish(wanted) = session.state.order(order) else { return None };
    Some(dish(&session.kitchen, session.kitchen.dish(wanted)))
}

pub fn dish(kitchen: &Kitchen, dish: &Dish) -> String {
    let stack = kitchen.content(dish.stack());
    let names: Vec<&str> = stack.items.iter().map(|&item| kitchen.content(item).wording.as_str()).collect();
    names.join(" + ")
}

/// Phase of the study's protocol and phase of the trial.
pub fn stage(session: &Session) -> String {
    match session.study_phase().map(PhaseSpec::phase) {
        Some(around) if !around.has_trial() && session.phase != TrialPhase::Closed => around.name().to_uppercase(),
        _ => phase(session.phase).to_string(),
    }
}

pub fn phase(phase: TrialPhase) -> &'static str {
    match phase {
        TrialPhase::Ready => "READY",
        TrialPhase::Running => "RUNNING",
        TrialPhase::Paused => "PAUSED",
        TrialPhase::Over(TrialEndReason::Aborted) => "ABORTED",
        TrialPhase::Over(_) => "TRIAL OVER",
        TrialPhase::Closed => "CLOSED",
    }
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

/// Also who caused it.
pub fn happening(kitchen: &Kitchen, what: &TimelineEvent) -> (&'static str, String) {
    match what {
        TimelineEvent::Press { agent, button: id, before, after, no_effect } => {
            let did = match no_effect {
                Some((why, about)) => Some(because(kitchen, *why, *about, "that")),
                None => press_effect(kitchen, *agent, *id, (*before, *after)),
            };
            let did = did.map_or(String::new(), |did| format!(": {did}"));
            (agent.name(), format!("{}{did}", button(kitchen, *agent, *id)))
        }
        TimelineEvent::Signal { by, signal: shown } => (sender(*by), signal(shown)),
        TimelineEvent::SignalEnded(SignalEndReason::TakenBack) => ("wizard", "took the signal back".to_string()),
        TimelineEvent::SignalEnded(SignalEndReason::Elapsed | SignalEndReason::Outdated) => {
            ("", "the signal is over".to_string())
        }
        TimelineEvent::Served { order } => ("", format!("{} is served", kitchen.location(*order).label())),
        TimelineEvent::OrderShown { order } => ("", format!("{} appears", kitchen.location(*order).label())),
        TimelineEvent::Marker(note) if note.is_empty() => ("note", "time mark".to_string()),
        TimelineEvent::Marker(note) => ("note", note.clone()),
        TimelineEvent::RobotStopped => ("wizard", "stopped the robot".to_string()),
        TimelineEvent::ArmStopped { mode, force_n, joint } => ("robot", arm_stopped(*mode, *force_n, *joint)),
        TimelineEvent::ArmTouched { force_n } => ("robot", format!("contact with a person, {force_n:.0} N")),
        TimelineEvent::RobotResumed => ("wizard", "resumed the robot".to_string()),
        TimelineEvent::RobotHeld => ("wizard", "held the robot".to_string()),
        TimelineEvent::RobotReleased => ("wizard", "released the robot".to_string()),
        TimelineEvent::RobotSkipped(id) => ("wizard", format!("skipped {}", button(kitchen, Agent::Robot, *id))),
        TimelineEvent::RobotDriven(id) => {
            ("wizard", format!("chose the robot's press: {}", button(kitchen, Agent::Robot, *id)))
        }
        TimelineEvent::Corrected { location } => {
            ("wizard", format!("corrected {}", kitchen.location(*location).label()))
        }
        TimelineEvent::Probe(event) => ("", probe(event)),
        TimelineEvent::Excluded(reason) => ("trial", format!("excluded: {reason}")),
        TimelineEvent::Included => ("trial", "no longer excluded".to_string()),
        TimelineEvent::Focus(false) => ("console", "lost the keyboard focus".to_string()),
        TimelineEvent::Focus(true) => ("console", "has the keyboard focus again".to_string()),
        TimelineEvent::Trial(phase) => ("trial", trial(*phase).to_string()),
    }
}

pub fn arm_stopped(mode: SafetyMode, force_n: Option<f64>, joint: Option<u8>) -> String {
    let mode = mode.name().to_lowercase();
    match (force_n, joint) {
        (Some(force_n), _) => format!("{mode}: contact with a person, {force_n:.0} N"),
        (None, Some(joint)) => format!("{mode}: joint {joint} does not follow its command"),
        (None, None) => mode,
    }
}

pub fn arm_phase(phase: ArmPhase) -> &'static str {
    match phase {
        ArmPhase::Rests => "at rest",
        ArmPhase::Retracts => "moving up",
        ArmPhase::Travels => "moving",
        ArmPhase::Hovers => "hovering",
        ArmPhase::Presses => "pressing",
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

/// `None` for fixations and blinks, which are too frequent.
pub fn tracker(event: &TrackerEvent) -> Option<String> {
    Some(match event {
        TrackerEvent::Connected { device } => format!("eye tracker connected: {device}"),
        TrackerEvent::Lost { reason } => format!("eye tracker lost: {reason}"),
        TrackerEvent::DisplayFound => "eye tracker detects the display tags".to_string(),
        TrackerEvent::DisplayLost => "eye tracker does not detect the display tags".to_string(),
        TrackerEvent::OtherSurfaces { names } => format!("eye tracker detects other surfaces: {}", quoted(names)),
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
        TrackerEvent::Dropped(counts) => format!("gaze input dropped so far: {}", drops(counts)),
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

pub fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Gaze input that could not be recorded, by kind.
pub fn drops(counts: &DroppedInputCounts) -> String {
    let kinds = [(counts.malformed, "malformed"), (counts.too_frequent, "too frequent"), (counts.overrun, "overrun")];
    kinds.iter().filter(|(n, _)| *n > 0).map(|(n, kind)| format!("{n} {kind}")).collect::<Vec<_>>().join(", ")
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

/// The cost of the press compared with the human's best press, and the cause where it is known.
pub fn error(kitchen: &Kitchen, press: &JudgedPress) -> String {
    let because = match press.cause {
        None => String::new(),
        Some(ErrorCause::Slip) => "; cause: slip".to_string(),
        Some(ErrorCause::Planning) => "; cause: planning error".to_string(),
        Some(ErrorCause::Belief { target, with: None, .. }) => {
            format!("; cause: false belief about {}", target.label(kitchen))
        }
        Some(ErrorCause::Belief { target, with: Some(other), .. }) => {
            format!("; cause: false belief about {} and {}", target.label(kitchen), other.label(kitchen))
        }
    };
    format!("error, costs {}{because}", count(press.verdict.excess.unsigned_abs(), "press", "presses"))
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

/// A name from the log, without underscores.
fn said(name: &str) -> String {
    name.replace('_', " ")
}

/// "cutting board", "recipe of tuna maki".
pub fn probe_subject(about: &ProbeSubject) -> String {
    match about {
        ProbeSubject::Location { location } => said(location),
        ProbeSubject::Recipe { dish } => format!("recipe of {}", said(dish)),
        ProbeSubject::NextOrder => "the order that is served next".to_string(),
        ProbeSubject::NextPress => "the robot's next press".to_string(),
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
            let about: Vec<String> = questions.iter().map(|question| probe_subject(&question.about)).collect();
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
