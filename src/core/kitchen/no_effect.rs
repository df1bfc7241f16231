//! Why a press has no effect. The reason follows from the button and the true contents alone, and reveals no more than
//! the display shows: nothing about recipes, and nothing about beliefs.

use serde::Serialize;

use super::action::{ButtonAction, ButtonId};
use super::agent::Agent;
use super::compiled::Kitchen;
use super::location::LocationId;
use super::state::{OrderContent, State};

/// Reason why a press has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoEffectReason {
    /// No effect because the agent's hand holds something, but would have to be empty.
    HandFull,
    /// No effect because the agent's hand is empty, but would have to hold something.
    HandEmpty,
    /// No effect because the agent's hand and the place are both empty.
    BothEmpty,
    /// No effect because the place is empty, but would have to hold something.
    PlaceEmpty,
    /// No effect because the place is occupied, and items cannot be stacked there.
    PlaceFull,
    /// No effect because the place does not accept the content of the hand.
    NotAccepted,
    /// No effect because the content of the hand cannot be stacked on the content of the place.
    NotStacked,
    /// No effect because the content of the place cannot be processed in this way.
    NotProcessed,
    /// No effect because the order location shows no order.
    NoOrder,
    /// No effect because the content of the plate cannot be served for this order. The reason does not say which dish
    /// the content is, or what is wrong with it.
    NotServed,
}

impl Kitchen {
    /// Why a press would have no effect in this state with the true recipes, and the location that the reason is about;
    /// `None` if the press would have an effect.
    pub fn no_effect(&self, state: State, agent: Agent, button: ButtonId) -> Option<(NoEffectReason, LocationId)> {
        if self.press(state, &self.true_recipes(), agent, button).is_some() {
            return None;
        }
        let hand = self.hands[agent.index()];
        let is_empty = |location: LocationId| state.content(location).is_empty();
        Some(match self.button(agent, button).action {
            ButtonAction::Take(_) => (NoEffectReason::HandFull, hand),
            ButtonAction::Trash => (NoEffectReason::HandEmpty, hand),
            ButtonAction::Use(location) => match (is_empty(hand), is_empty(location)) {
                (true, _) => (NoEffectReason::BothEmpty, location),
                (false, true) => (NoEffectReason::NotAccepted, location),
                (false, false) if location == self.board => (NoEffectReason::NotStacked, location),
                (false, false) => (NoEffectReason::PlaceFull, location),
            },
            ButtonAction::Process(process) => {
                let place = self.processes[usize::from(process)].place.unwrap_or(hand);
                match is_empty(place) {
                    true if place == hand => (NoEffectReason::HandEmpty, hand),
                    true => (NoEffectReason::PlaceEmpty, place),
                    false => (NoEffectReason::NotProcessed, place),
                }
            }
            ButtonAction::Serve(order) => match (state.order(order), is_empty(self.plate)) {
                (OrderContent::None | OrderContent::Served, _) => (NoEffectReason::NoOrder, order),
                (OrderContent::Dish(_), true) => (NoEffectReason::PlaceEmpty, self.plate),
                (OrderContent::Dish(_), false) => (NoEffectReason::NotServed, order),
            },
        })
    }
}
