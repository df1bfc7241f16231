//! Locations and storages on the participant's display, where contents are shown and presses happen.

use serde::Serialize;

use tomcom_core::kitchen::{Agent, ButtonAction, Kitchen};

/// A location or a storage on the participant's display, by its index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SceneElement {
    /// A location, by its index in the scene.
    Location(usize),
    /// A storage, by its index in the scene.
    Storage(usize),
}

/// The location or storage where a press of an agent happens.
pub(super) fn spot(kitchen: &Kitchen, agent: Agent, action: ButtonAction) -> SceneElement {
    let hand = kitchen.hands[agent.index()];
    let location = match action {
        ButtonAction::Take(item) => {
            let is_it =
                |storage: &tomcom_core::kitchen::IngredientStorage| storage.agent == agent && storage.item == item;
            // Every button that takes an item belongs to a storage (`src/core/kitchen/compile/buttons.rs`).
            match kitchen.storages.iter().position(is_it) {
                Some(storage) => return SceneElement::Storage(storage),
                None => hand,
            }
        }
        ButtonAction::Use(location) => location,
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand),
        ButtonAction::Trash => hand,
        ButtonAction::Serve(order) => order,
    };
    SceneElement::Location(location.index())
}
