//! Why a press has no effect. The reason follows from the button and the true contents alone, and says no more than a look at the
//! display tells: nothing about recipes, and nothing about what somebody believes.

use serde::Serialize;

use super::action::{ButtonAction, ButtonId};
use super::agent::Agent;
use super::compiled::Kitchen;
use super::location::LocationId;
use super::state::{OrderContent, State};

/// Why a press has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoEffect {
    /// The hand holds something, and would have to be empty.
    HandFull,
    /// The hand is empty, and would have to hold something.
    HandEmpty,
    /// Hand and place are empty.
    BothEmpty,
    /// The place is empty, and would have to hold something.
    PlaceEmpty,
    /// The place holds something, and nothing is stacked there.
    PlaceFull,
    /// What the hand holds is not put down there.
    NotAccepted,
    /// What the hand holds is not stacked on what is there.
    NotStacked,
    /// What is there cannot be processed so.
    NotProcessed,
    /// The order's place shows no order.
    NoOrder,
    /// What is on the plate is not served there. Which dish it is, or what is wrong with it, is not said.
    NotServed,
}

impl Kitchen {
    /// Why a press would have no effect in this state with the true recipes; `None` if it would have one. The location is the one
    /// that the reason is about.
    pub fn no_effect(&self, state: State, agent: Agent, button: ButtonId) -> Option<(NoEffect, LocationId)> {
        if self.press(state, &self.true_recipes(), agent, button).is_some() {
            return None;
        }
        let hand = self.hands[agent.index()];
        let is_empty = |location: LocationId| state.content(location).is_empty();
        Some(match self.button(agent, button).action {
            ButtonAction::Take(_) => (NoEffect::HandFull, hand),
            ButtonAction::Trash => (NoEffect::HandEmpty, hand),
            ButtonAction::Use(location) => match (is_empty(hand), is_empty(location)) {
                (true, _) => (NoEffect::BothEmpty, location),
                (false, true) => (NoEffect::NotAccepted, location),
                (false, false) if location == self.board => (NoEffect::NotStacked, location),
                (false, false) => (NoEffect::PlaceFull, location),
            },
            ButtonAction::Process(process) => {
                let place = self.processes[usize::from(process)].place.unwrap_or(hand);
                match is_empty(place) {
                    true if place == hand => (NoEffect::HandEmpty, hand),
                    true => (NoEffect::PlaceEmpty, place),
                    false => (NoEffect::NotProcessed, place),
                }
            }
            ButtonAction::Serve(order) => match (state.order(order), is_empty(self.plate)) {
                (OrderContent::None | OrderContent::Served, _) => (NoEffect::NoOrder, order),
                (OrderContent::Dish(_), true) => (NoEffect::PlaceEmpty, self.plate),
                (OrderContent::Dish(_), false) => (NoEffect::NotServed, order),
            },
        })
    }
}
