//! Wording of buttons, locations, signals, phases and events as texts for screens and reports.

use crate::event::TrialEndReason;
use crate::plan::PhaseSpec;
use crate::probes::ProbeSubject;
use crate::{Session, TrialPhase};
use tomcom_core::communication::recommendation::SignalReason;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::gaze::quality::DroppedInputCounts;
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, ButtonId, ContentId, Dish, Kitchen, LocationId, LocationKind,
    OrderContent, State,
};
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind};
use tomcom_core::measures::sequences::THINKS;
use tomcom_core::robot::AbortReason;
use tomcom_core::robot::ArmPhase;
use tomcom_core::robot::IdleReason;

/// "cutting board", "take rice".
pub fn button(kitchen: &Kitchen, agent: Agent, id: tomcom_core::kitchen::ButtonId) -> String {
    kitchen.button(agent, id).name.replace('_', " ")
}

/// What the robot waits for, in fewer and fewer words, all of which name the buttons; `waits_for`: names of the human's
/// buttons; `gave_up`: why it gave up its last useful press, if that is known.
pub fn idle(reason: IdleReason, waits_for: &[impl AsRef<str>], gave_up: Option<AbortReason>) -> Vec<String> {
    let buttons: Vec<String> = waits_for.iter().map(|name| name.as_ref().replace('_', " ")).collect();
    let told = match reason {
        IdleReason::NoOrder => "waits for an order".to_string(),
        IdleReason::HumanTurn if buttons.is_empty() => "waits until the human presses".to_string(),
        IdleReason::HumanTurn => {
            let all = buttons.join(" or ");
            // That it waits is never left out: the presses would be read as the robot's plan.
            return ["waits until the human presses ", "human's turn: ", "waits: "]
                .map(|told| format!("{told}{all}"))
                .into();
        }
        IdleReason::Skipped => match gave_up {
            Some(AbortReason::Skipped) => "waits: the wizard skipped its press".to_string(),
            Some(reason) => format!("gave up: {}", reason.words()),
            None => "waits: its press was given up".to_string(),
        },
    };
    vec![told]
}

/// A duration to a tenth of a second: "2.3 s"; what is shorter is not told as none.
pub fn seconds(seconds: f64) -> String {
    if seconds < 0.1 { "less than 0.1 s".to_string() } else { format!("{seconds:.1} s") }
}

pub fn location(name: &str) -> String {
    name.replace('_', " ")
}

/// What a belief is about: "cooking pot", "recipe of tuna maki (order 1)"; without an order if nobody wants the dish.
pub fn aspect(kitchen: &Kitchen, state: State, aspect: AspectId) -> String {
    let about = &kitchen.aspects[aspect.index()];
    let mut wanted = kitchen.wanted(state);
    let order = wanted.find(|&(_, dish)| about.kind == AspectKind::Recipe(dish)).map(|(order, _)| order);
    let order = order.map_or(String::new(), |order| format!(" ({})", kitchen.location(order).label()));
    format!("{}{order}", location(&about.name))
}

/// What the participant believes and what is true, as far as they differ: of a recipe the items that differ, ingredient
/// against ingredient ("cut salmon", "needs cut tuna"); of a place its content ("empty", "is nori").
pub fn contrast(kitchen: &Kitchen, aspect: AspectId, thinks: usize, truth: usize) -> (String, String) {
    let about = &kitchen.aspects[aspect.index()];
    let items = |index: usize| &kitchen.content(ContentId(about.values[index])).items;
    let only = |of: usize, other: usize| {
        let items = items(of).iter().filter(|item| !items(other).contains(item));
        items.map(|&item| kitchen.content(item).wording.as_str()).collect::<Vec<_>>().join(" + ")
    };
    match about.kind {
        AspectKind::Recipe(_) if thinks != truth => (only(thinks, truth), format!("needs {}", only(truth, thinks))),
        _ => (value(kitchen, aspect, thinks).to_string(), format!("is {}", value(kitchen, aspect, truth))),
    }
}

/// What a belief with this probability of a value is called: "thinks", "may think".
pub fn thinks(p: f64) -> &'static str {
    if p >= THINKS { "thinks" } else { "may think" }
}

/// A false belief in words: "thinks empty, is nori"; "unsure, is nori" if even the likeliest wrong value is less probable
/// than [`THINKS`]. `wrong`: this value and its probability.
pub fn false_belief(kitchen: &Kitchen, aspect: AspectId, wrong: (usize, f64), truth: usize) -> String {
    let (value, truth) = contrast(kitchen, aspect, wrong.0, truth);
    if wrong.1 >= THINKS { format!("thinks {value}, {truth}") } else { format!("unsure, {truth}") }
}

/// A value of an aspect in words; an order without a dish is "no order".
pub fn value(kitchen: &Kitchen, aspect: AspectId, value: usize) -> &str {
    let about = &kitchen.aspects[aspect.index()];
    match about.kind {
        AspectKind::Location(order) if kitchen.location(order).kind == LocationKind::Order => {
            match about.labels[value].as_str() {
                "none" => "no order",
                _ => &about.wordings[value],
            }
        }
        _ => &about.wordings[value],
    }
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
        NoEffectReason::AlreadyProcessed => format!("{content} is done already"),
        NoEffectReason::NeedsOtherStep => format!("{content} needs another step first"),
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

/// What a wizard does with a signal: "show recipe of order 1".
pub fn command(told: &Signal) -> String {
    match told {
        Signal::ShowRecipe(_) => format!("show {}", signal(told)),
        Signal::Highlight(_) | Signal::Propose(_) => signal(told),
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
        _ if session.phase == TrialPhase::Closed && session.ended_early => "ENDED EARLY".to_string(),
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

pub fn arm_phase(phase: ArmPhase) -> &'static str {
    match phase {
        ArmPhase::Rests => "at rest",
        ArmPhase::Retracts => "moving up",
        ArmPhase::Travels => "moving",
        ArmPhase::Hovers => "hovering",
        ArmPhase::Presses => "pressing",
    }
}

pub fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Gaze input that could not be recorded, by kind.
pub fn drops(counts: &DroppedInputCounts) -> String {
    let kinds = [(counts.malformed, "malformed"), (counts.too_frequent, "too frequent"), (counts.overrun, "overrun")];
    kinds.iter().filter(|(n, _)| *n > 0).map(|(n, kind)| format!("{n} {kind}")).collect::<Vec<_>>().join(", ")
}

/// "cutting board", "recipe of tuna maki".
pub fn probe_subject(about: &ProbeSubject) -> String {
    match about {
        ProbeSubject::Location { location: place } => location(place),
        ProbeSubject::Recipe { dish } => format!("recipe of {}", location(dish)),
        ProbeSubject::NextOrder => "the order that is served next".to_string(),
        ProbeSubject::NextPress => "the robot's next press".to_string(),
    }
}
