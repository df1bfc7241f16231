//! The change of the kitchen's state by an event, with every name resolved.

use super::action::ButtonId;
use super::agent::Agent;
use super::compiled::Kitchen;
use super::location::LocationId;
use super::state::State;

/// A press of a button by either agent, with the state before and after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// The agent that pressed.
    pub agent: Agent,
    /// The pressed button, as an index into that agent's buttons.
    pub button: ButtonId,
    /// The state of the kitchen before the press.
    pub before: State,
    /// The state of the kitchen after the press; the same as before if the press had no effect.
    pub after: State,
    /// Whether the button's action was available in the state before, so that the press had an effect.
    pub effective: bool,
}

/// What an event of the session changed in the kitchen's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenChange {
    /// The event does not change the kitchen.
    None,
    /// The trial started with an empty kitchen.
    TrialStarted {
        /// The state of the kitchen before the trial started.
        before: State,
        /// The state of the empty kitchen.
        after: State,
    },
    /// An agent pressed a button during the trial.
    Press {
        /// The press with the states before and after it.
        press: Press,
        /// How many presses each agent has made, this press included, indexed by [`Agent::index`].
        presses: [u32; 2],
    },
    /// An agent pressed a button while no trial ran; such a press has no effect and does not count.
    UncountedPress {
        /// The agent that pressed.
        agent: Agent,
        /// The pressed button, as an index into that agent's buttons.
        button: ButtonId,
    },
    /// An order appeared, or an order that had been served disappeared.
    Order {
        /// The location of the order.
        order: LocationId,
        /// The state of the kitchen before the order changed.
        before: State,
        /// The state of the kitchen after the order changed.
        after: State,
    },
    /// The wizard corrected the content of a location in the program's state, which differed from the real one.
    Correction {
        /// The location that was corrected.
        location: LocationId,
        /// The state of the kitchen before the wizard's correction.
        before: State,
        /// The state of the kitchen after the wizard's correction.
        after: State,
    },
}

impl Kitchen {
    /// The press of this button by this agent in `state`, with its effect under the true recipes.
    pub fn try_press(&self, state: State, agent: Agent, button: ButtonId) -> Press {
        let after = self.press(state, &self.true_recipes(), agent, button);
        Press { agent, button, before: state, after: after.unwrap_or(state), effective: after.is_some() }
    }
}

impl Press {
    /// The state of the kitchen after the press; `None` if the press had no effect.
    pub fn result(&self) -> Option<State> {
        self.effective.then_some(self.after)
    }
}

impl KitchenChange {
    /// The press of either agent that made the change; `None` if the event is no press that counts.
    pub fn press(&self) -> Option<Press> {
        match self {
            KitchenChange::Press { press, .. } => Some(*press),
            _ => None,
        }
    }

    /// The press of the human that made the change; `None` if the event is no press of the human that counts.
    pub fn human_press(&self) -> Option<Press> {
        self.press().filter(|press| press.agent == Agent::Human)
    }

    /// The state of the kitchen before and after the event; `None` if the event did not change it.
    pub fn states(&self) -> Option<(State, State)> {
        let (before, after) = match self {
            KitchenChange::None | KitchenChange::UncountedPress { .. } => return None,
            KitchenChange::Press { press, .. } => (press.before, press.after),
            KitchenChange::TrialStarted { before, after }
            | KitchenChange::Order { before, after, .. }
            | KitchenChange::Correction { before, after, .. } => (*before, *after),
        };
        (before != after).then_some((before, after))
    }
}
