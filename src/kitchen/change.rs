//! What an event changed in the kitchen, with every name resolved.

use super::action::ButtonId;
use super::agent::Agent;
use super::compiled::Kitchen;
use super::location::LocationId;
use super::state::State;

/// A press of either agent, and what it did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// Who pressed.
    pub agent: Agent,
    /// The button, in the list of that agent's buttons.
    pub button: ButtonId,
    /// The kitchen before the press.
    pub before: State,
    /// The kitchen after the press; the same as before if the press had no effect.
    pub after: State,
    /// Whether the button's action was available.
    pub effective: bool,
}

/// What an applied event did to the kitchen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The event does not change the kitchen.
    None,
    /// The trial started with an empty kitchen.
    TrialStarted {
        /// The state until then.
        before: State,
        /// The empty kitchen.
        after: State,
    },
    /// An agent pressed a button during the trial.
    Press {
        /// The press with the states before and after it.
        press: Press,
        /// How many presses each agent has made, this one included, indexed by [`Agent::index`].
        presses: [u32; 2],
    },
    /// A press while no trial ran: it has no effect and does not count.
    UncountedPress {
        /// Who pressed.
        agent: Agent,
        /// The button, in the list of that agent's buttons.
        button: ButtonId,
    },
    /// An order appeared, or stopped showing that it was served.
    Order {
        /// The order's location.
        order: LocationId,
        /// The state before the change.
        before: State,
        /// The state after the change.
        after: State,
    },
    /// The wizard corrected what the program believes of a location.
    Correction {
        /// The location that was corrected.
        location: LocationId,
        /// The state before the correction.
        before: State,
        /// The state after the correction.
        after: State,
    },
}

impl Kitchen {
    /// What a press does to `state` under the true recipes.
    pub fn try_press(&self, state: State, agent: Agent, button: ButtonId) -> Press {
        let after = self.press(state, &self.true_recipes(), agent, button);
        Press { agent, button, before: state, after: after.unwrap_or(state), effective: after.is_some() }
    }
}

impl Press {
    /// The kitchen after the press if it had an effect.
    pub fn result(&self) -> Option<State> {
        self.effective.then_some(self.after)
    }
}

impl Change {
    /// A press of either agent that counts.
    pub fn press(&self) -> Option<Press> {
        match self {
            Change::Press { press, .. } => Some(*press),
            _ => None,
        }
    }

    /// A press of the human that counts.
    pub fn human_press(&self) -> Option<Press> {
        self.press().filter(|press| press.agent == Agent::Human)
    }

    /// The kitchen before and after, if the event concerns the kitchen and changed something.
    pub fn states(&self) -> Option<(State, State)> {
        let (before, after) = match self {
            Change::None | Change::UncountedPress { .. } => return None,
            Change::Press { press, .. } => (press.before, press.after),
            Change::TrialStarted { before, after }
            | Change::Order { before, after, .. }
            | Change::Correction { before, after, .. } => (*before, *after),
        };
        (before != after).then_some((before, after))
    }
}
