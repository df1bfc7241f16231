//! The signals that can be sent to the participant, when each signal is available, and the rule against repeats.

use serde::{Deserialize, Serialize};

use super::recommendation::aspects_told;
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{Agent, AspectId, Kitchen, LocationId, LocationKind, OrderContent, State};
use crate::measures::matching::{ComparedContent, SignalKind};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::observation::MOST_PROPOSED;

/// A signal to the participant, which names locations as the layout does.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Signal {
    /// Shows the recipe of the dish that this order location wants, as picture and words.
    ShowRecipe(String),
    /// Highlights a location, to direct attention to its content.
    Highlight(String),
    /// Proposes the human's next presses, the next one first, by the names of their buttons. Only the concept DEV makes
    /// proposals; a proposal reveals nothing about contents and recipes.
    Propose(Vec<String>),
}

impl Signal {
    /// The signal's kind.
    pub fn kind(&self) -> SignalKind {
        match self {
            Signal::ShowRecipe(_) => SignalKind::Recipe,
            Signal::Highlight(_) => SignalKind::Highlight,
            Signal::Propose(_) => SignalKind::Proposal,
        }
    }

    /// The signal in the form that the matching of communications compares.
    pub fn compared(&self, kitchen: &Kitchen) -> ComparedContent {
        ComparedContent { kind: self.kind(), target: self.location(kitchen) }
    }

    /// The things that the signal names: one location, or the buttons of a proposal.
    pub fn names(&self) -> &[String] {
        match self {
            Signal::ShowRecipe(name) | Signal::Highlight(name) => std::slice::from_ref(name),
            Signal::Propose(presses) => presses,
        }
    }

    /// Name of the location that the signal is about; `None` for proposed presses.
    pub fn target(&self) -> Option<&str> {
        match self {
            Signal::ShowRecipe(name) | Signal::Highlight(name) => Some(name),
            Signal::Propose(_) => None,
        }
    }

    /// The location that the signal is about; `None` for proposed presses, and if the kitchen has no such location.
    pub fn location(&self, kitchen: &Kitchen) -> Option<LocationId> {
        kitchen.location_named(self.target()?)
    }
}

/// The sender of a signal: wizard or assistant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sender {
    /// The wizard: the person at the console, or the script in that person's place.
    Wizard,
    /// The assistant: a communication concept that sends signals by itself.
    Assistant,
}

/// The locations that highlights may be about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HighlightSet(u32);

impl HighlightSet {
    /// Every location.
    pub const ALL: HighlightSet = HighlightSet(u32::MAX);

    /// All shared places and the robot's hand. People see their own hand best.
    pub fn usual(kitchen: &Kitchen) -> HighlightSet {
        let own = kitchen.hands[Agent::Human.index()];
        HighlightSet(!(1 << own.index()))
    }

    /// The paper's locations, where "coordination conflicts" are possible: the robot's hand and the assembly board (paper,
    /// section "Design of communication signals").
    pub fn of_paper(kitchen: &Kitchen) -> HighlightSet {
        HighlightSet(1 << kitchen.hands[Agent::Robot.index()].index() | 1 << kitchen.board.index())
    }

    /// The locations with these names; the kitchen need not have all of them.
    pub fn named<'a>(kitchen: &Kitchen, names: impl IntoIterator<Item = &'a str>) -> HighlightSet {
        let locations = names.into_iter().filter_map(|name| kitchen.location_named(name));
        HighlightSet(locations.fold(0, |bits, location| bits | 1 << location.index()))
    }

    /// Whether highlights may be about this location.
    pub fn holds(self, location: LocationId) -> bool {
        self.0 >> location.index() & 1 == 1
    }
}

/// The signal about each location, from which wizard, ToM-Com and ToM choose, in the order of the locations: recipes
/// for orders, and highlights for those of the other locations that may be highlighted.
pub fn signals(kitchen: &Kitchen, highlights: HighlightSet) -> Vec<(LocationId, Signal)> {
    let signal = |id: LocationId| {
        let location = kitchen.location(id);
        let signal = match location.kind {
            LocationKind::Order => Signal::ShowRecipe(location.name.clone()),
            _ if highlights.holds(id) => Signal::Highlight(location.name.clone()),
            _ => return None,
        };
        Some((id, signal))
    };
    kitchen.location_ids().filter_map(signal).collect()
}

/// The signals that can be sent in this state of the kitchen.
pub fn available(kitchen: &Kitchen, state: State, highlights: HighlightSet) -> Vec<Signal> {
    let all = signals(kitchen, highlights).into_iter().map(|(_, signal)| signal);
    all.filter(|signal| unavailable(kitchen, state, signal).is_none()).collect()
}

/// Why a signal cannot be sent now; `None` if the signal can be sent. Only an order that wants a dish has a recipe to
/// show, and the first press of a proposal must have an effect.
pub fn unavailable(kitchen: &Kitchen, state: State, signal: &Signal) -> Option<&'static str> {
    if let Signal::Propose(presses) = signal {
        return not_proposable(kitchen, state, presses);
    }
    let Some(location) = signal.location(kitchen) else { return Some("no such location") };
    match (signal, kitchen.location(location).kind) {
        (Signal::ShowRecipe(_), LocationKind::Order) => match state.order(location) {
            OrderContent::Dish(_) => None,
            _ => Some("there is no order whose recipe could be shown"),
        },
        (Signal::ShowRecipe(_), _) => Some("only an order has a recipe"),
        (Signal::Highlight(_), LocationKind::Order) => Some("an order cannot be highlighted"),
        (Signal::Highlight(_) | Signal::Propose(_), _) => None,
    }
}

fn not_proposable(kitchen: &Kitchen, state: State, presses: &[String]) -> Option<&'static str> {
    let button = |name: &String| kitchen.button_named(Agent::Human, name);
    let Some(first) = presses.first() else { return Some("no press is proposed") };
    match button(first) {
        _ if presses.len() > MOST_PROPOSED => Some("at most five presses are proposed"),
        _ if presses.iter().any(|name| button(name).is_none()) => Some("the human has no such button"),
        Some(first) if kitchen.press(state, &kitchen.true_recipes(), Agent::Human, first).is_none() => {
            Some("the proposed press would do nothing now")
        }
        _ => None,
    }
}

/// Expected P(truth) above which the human is assumed to know what a signal says.
const KNOWN: f64 = 0.9;
/// Probability of having been read below which a signal was probably missed.
const PROBABLY_READ: f64 = 0.5;

/// The signals that must not be repeated yet. A signal may be repeated once P(truth) of its aspects has passed 0.9 and
/// fallen again, or the truth has changed. Where signals can be missed, a signal that has left the display may also be
/// repeated if it was probably not read, or if P(truth) has not passed 0.9 until then. The planner bounds how often
/// somebody who notices nothing is told in vain, since the expected probability of being noticed falls with each missed
/// signal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalRepeatRule {
    told: [Option<Told>; MAX_LOCATIONS],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    /// Code of the location's content at the time when the signal was shown.
    code: u8,
    was_known: bool,
    /// Probability with which the signal was read before it left the display; `None` while the display shows it.
    read: Option<f64>,
}

impl SignalRepeatRule {
    /// Records that the display shows a signal.
    pub fn shown(&mut self, kitchen: &Kitchen, state: State, signal: &Signal) {
        if let Some(location) = signal.location(kitchen) {
            self.told[location.index()] = Some(Told { code: state.code(location), was_known: false, read: None });
        }
    }

    /// Forgets the last signal about the location, because it was not shown after all.
    pub fn not_shown(&mut self, location: LocationId) {
        self.told[location.index()] = None;
    }

    /// Records that the signal about a location has left the display, and with which probability it was read.
    pub fn over(&mut self, location: LocationId, read: f64) {
        if let Some(told) = &mut self.told[location.index()] {
            told.read = Some(read);
        }
    }

    /// Updates which signals may be repeated, after a change of the estimate or of the true state.
    pub fn update(&mut self, kitchen: &Kitchen, state: State, belief: &DirichletBelief) {
        for (location, signal) in signals(kitchen, HighlightSet::ALL) {
            let slot = &mut self.told[location.index()];
            let Some(told) = slot else { continue };
            let p_truth = |aspect: AspectId| belief.p_truth(kitchen, state, aspect);
            let known = aspects_told(kitchen, state, &signal).into_iter().map(p_truth).fold(1.0, f64::min) > KNOWN;
            let is_forgotten = told.was_known && !known;
            told.was_known |= known;
            let is_missed = told.read.is_some_and(|read| read < PROBABLY_READ || !told.was_known);
            if told.code != state.code(location) || is_forgotten || is_missed {
                *slot = None;
            }
        }
    }

    /// The available signals that the rule against repeats allows now.
    pub fn allowed(&self, kitchen: &Kitchen, highlights: HighlightSet) -> Vec<Signal> {
        let all = signals(kitchen, highlights).into_iter();
        all.filter(|(location, _)| self.told[location.index()].is_none()).map(|(_, signal)| signal).collect()
    }
}
