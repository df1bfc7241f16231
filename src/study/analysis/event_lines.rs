//! A recording as text, with one line for each event, for pipes and plain terminals.

use tomcom_core::base::text::{count, printable};
use tomcom_core::communication::concept::{BenefitUnit, ConceptName};
use tomcom_core::communication::offer::OfferedAdvice;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_core::mind::{AspectBelief, AspectEstimate, RecordedBelief, RecordedEstimate};
use tomcom_core::robot::SafetyMode;
use tomcom_session::event::{SignalEndReason, TrialEndReason, WizardScreenContent};
use tomcom_session::follower::SessionFollower;

use tomcom_session::history::wording::{self, location as said};
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Event, TimestampedEvent, TrialPhase};

pub const HEADING: &str = " trial time  what happened";

/// The text line for an event that was just applied, with the time on the trial's clock; `None` for events without a
/// line: gaze samples, fixations, blinks, drawn signals, arm motion, estimates without a probable false belief, changes
/// between normal and reduced speed, and recommendations of no communication.
pub fn line(stamped: &TimestampedEvent, follower: &SessionFollower) -> Option<String> {
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
            format!("robot {}", wording::idle(*reason, waits_for, None, usize::MAX))
        }
        // Changes between normal and reduced speed get no line: the arm slows near the hand and speeds up again too
        // often.
        Event::RobotSafety { mode: SafetyMode::Normal | SafetyMode::Reduced, .. } => return None,
        Event::RobotSafety { mode, force_n, joint } => {
            format!("robot's arm: {}", wording::arm_stopped(*mode, *force_n, *joint))
        }
        Event::RobotTouched { force_n } => format!("robot's arm: contact with a person, {force_n:.0} N"),
        Event::RobotHeld { .. } => "robot held by the wizard before its next press".to_string(),
        Event::RobotReleased { .. } => "robot released by the wizard".to_string(),
        Event::RobotSkipped { .. } => "the wizard skips the robot's press".to_string(),
        Event::RobotDriven { button, .. } => format!("the wizard chose the robot's press: {}", said(button)),
        Event::KitchenCorrected { location, content } => {
            format!("corrected by hand: {} holds {}", said(location), kitchen.worded(content))
        }
        Event::RobotStopped => "robot stopped by the wizard".to_string(),
        Event::RobotResumed => "robot resumed".to_string(),
        // A recommendation gets a text line only if it advises a signal.
        Event::Advised(advice) => advised(kitchen, advice, follower.session.spec.assistant.concept.name())?,
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
        Event::Marker { note } if note.is_empty() => "marker".to_string(),
        Event::Marker { note } => format!("marker: {note}"),
        Event::MarkerWorded { marker, note } => format!("words of marker {marker}: {note}"),
        Event::Probe(event) => wording::probe(event),
        Event::Protocol(event) => wording::protocol(event),
        Event::Tracker(event) => wording::tracker(event)?,
        Event::Calibration(event) => wording::calibration(event),
        Event::ClockJumped { by_ms } => format!("the wall clock jumped by {:.1} s", *by_ms as f64 / 1000.0),
        Event::ParticipantBelieves(belief) => believes(kitchen, belief),
        Event::SessionEnded => "session over".to_string(),
    };
    // Control characters are escaped: notes and names of devices can contain them, and they would disturb the terminal.
    let (words, session) = (printable(&words), &follower.session);
    Some(match session.phase {
        TrialPhase::Ready => format!("{:>11}  {words}", "before"),
        _ => format!("{:>9.3} s  {words}", session.trial_clock(stamped.time).as_secs_f64()),
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
    let judged = follower.judged.last().filter(|press| press.seq == stamped.seq);
    match (&stamped.event, judged) {
        (Event::Press { agent: Agent::Human, .. }, None) => " (does not count)".to_string(),
        (_, Some(press)) if press.verdict.error => {
            format!(" ({})", wording::error(&follower.session.kitchen, press))
        }
        (_, Some(press)) if press.verdict.race => " (race with the robot)".to_string(),
        _ => String::new(),
    }
}

fn believes(kitchen: &Kitchen, belief: &RecordedBelief) -> String {
    let wrong = belief.aspects.iter().filter(|aspect| aspect.p_truth < FALSE_BELOW);
    let told = |aspect: &AspectBelief| format!("{} = {}", said(&aspect.aspect), kitchen.worded(&aspect.believes));
    let wrong: Vec<String> = wrong.map(told).collect();
    // The cause that a simulated participant recorded for its press is shown, unless the participant recorded that the
    // press follows from the true state ("as it is").
    let cause = match belief.cause.as_str() {
        "as it is" => String::new(),
        cause => format!(" ({})", said(&worded_cause(kitchen, cause))),
    };
    match wrong.is_empty() {
        true => format!("participant believes nothing wrong{cause}"),
        false => format!("participant believes {}{cause}", wrong.join(", ")),
    }
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
    let told = |aspect: &AspectEstimate| {
        format!("{} = {} (wrong {:.2})", said(&aspect.aspect), kitchen.worded(&aspect.believes), 1.0 - aspect.p_truth)
    };
    let wrong: Vec<String> = wrong.map(told).collect();
    (!wrong.is_empty()).then(|| format!("estimated: participant believes {}", wrong.join(", ")))
}

fn advised(kitchen: &Kitchen, advice: &Recommendation, by: ConceptName) -> Option<String> {
    if let Some(proposal) = &advice.proposal {
        let presses: Vec<String> = proposal.presses.iter().map(|press| said(press)).collect();
        return Some(format!("proposed after the error: {}", presses.join(", ")));
    }
    let best = advice.best.as_ref()?;
    let what = wording::signal(best);
    // An external concept can name a signal without its value.
    let worth = advice.options.iter().find(|option| option.signal == *best).map(|option| match by.unit() {
        BenefitUnit::Deviation => format!(", belief off by {:.2}", option.benefit),
        BenefitUnit::Presses | BenefitUnit::None if option.rollouts == 0 => {
            format!(", saves {:.1} presses", option.benefit)
        }
        BenefitUnit::Presses | BenefitUnit::None => {
            format!(", saves {:.1} presses (±{:.1})", option.benefit, option.standard_error)
        }
    });
    let reason = advice.reason.as_ref().map(|reason| wording::reason(kitchen, reason).words());
    let reason = reason.or_else(|| advice.words.clone()).map_or(String::new(), |reason| format!(": {reason}"));
    Some(format!("advised: {what}{}{reason}", worth.unwrap_or_default()))
}

fn offered(offer: &OfferedAdvice) -> String {
    let unseen = if offer.visible { "" } else { " (not visible to a wizard)" };
    format!("offer: {}{unseen}", wording::offered(&offer.what))
}
