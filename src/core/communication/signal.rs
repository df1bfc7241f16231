//! The signals that can be sent to the participant, and when each signal is available.

use serde::{Deserialize, Serialize};

use crate::kitchen::{Agent, Kitchen, LocationId, LocationKind, OrderContent, State};
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

    /// Number of things that the signal tells: the number of presses of a proposal, one for any other signal.
    pub fn contents(&self) -> usize {
        match self {
            Signal::ShowRecipe(_) | Signal::Highlight(_) => 1,
            Signal::Propose(presses) => presses.len(),
        }
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
    let signal = |index: usize| {
        let (id, location) = (LocationId(index as u8), &kitchen.locations[index]);
        let signal = match location.kind {
            LocationKind::Order => Signal::ShowRecipe(location.name.clone()),
            _ if highlights.holds(id) => Signal::Highlight(location.name.clone()),
            _ => return None,
        };
        Some((id, signal))
    };
    (0..kitchen.locations.len()).filter_map(signal).collect()
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
