//! Builds the buttons of both agents from the layout file.

use toml::Spanned;

use super::contents::IngredientItems;
use super::places::stored;
use super::spec_error::{KitchenFileKind, Result, wrong, wrong_file};
use crate::kitchen::action::{Button, ButtonAction};
use crate::kitchen::agent::Agent;
use crate::kitchen::layout::{ButtonSpec, LayoutSpec, is_same_key};
use crate::kitchen::location::{Location, LocationId};
use crate::kitchen::process::ProcessingStep;
use crate::kitchen::recipe::RecipesSpec;

/// Largest length of the name of an area of buttons on the table, in characters.
const MAX_AREA: usize = 40;
/// Largest number of a gamepad button; no gamepad or button box has more buttons.
const MAX_GAMEPAD: u8 = 63;

/// The buttons of both agents, each in the order: own storages, places, processing steps, own trash, orders.
pub(super) fn buttons(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &IngredientItems,
    locations: &[Location],
    processes: &[ProcessingStep],
) -> Result<[Vec<Button>; 2]> {
    let located = |name: &Spanned<String>| {
        let index = locations.iter().position(|location| location.name == *name.get_ref());
        LocationId(index.unwrap_or_default() as u8)
    };
    let mut buttons = [Vec::new(), Vec::new()];
    for agent in Agent::BOTH {
        let mut list: Vec<(String, ButtonAction, &ButtonSpec)> = Vec::new();
        for storage in layout.storage.iter().filter(|storage| storage.agent == agent) {
            let item = stored(&storage.ingredient, spec, items)?;
            list.push((format!("take {}", storage.ingredient.get_ref()), ButtonAction::Take(item), &storage.button));
        }
        for place in &layout.place {
            list.push((place.name.get_ref().clone(), ButtonAction::Use(located(&place.name)), &place.button));
        }
        for (index, process) in processes.iter().enumerate().filter(|(_, process)| process.agents[agent.index()]) {
            let button = layout.process.iter().find(|button| *button.name.get_ref() == process.name);
            let Some(button) = button else {
                let found = format!("no button for the process \"{}\" of the recipe file", process.name);
                return Err(wrong_file(
                    KitchenFileKind::Layout,
                    found,
                    "a table [[process]] with this name and a button",
                ));
            };
            list.push((process.name.clone(), ButtonAction::Process(index as u8), &button.button));
        }
        for hand in layout.hand.iter().filter(|hand| *hand.agent.get_ref() == agent) {
            list.push(("trash".to_string(), ButtonAction::Trash, &hand.trash));
        }
        for (index, order) in layout.order.iter().enumerate() {
            list.push((format!("serve {}", index + 1), ButtonAction::Serve(located(&order.name)), &order.serve));
        }
        for (name, action, spec) in list {
            buttons[agent.index()].push(button(agent, name, action, spec, &buttons[agent.index()])?);
        }
    }
    for process in &layout.process {
        if !processes.iter().any(|known| known.name == *process.name.get_ref()) {
            let found = format!("a button for the process \"{}\"", process.name.get_ref());
            return Err(wrong(KitchenFileKind::Layout, process.name.span(), found, "a [[process]] of the recipe file"));
        }
    }
    Ok(buttons)
}

fn button(agent: Agent, name: String, action: ButtonAction, spec: &ButtonSpec, others: &[Button]) -> Result<Button> {
    if others.iter().any(|other| other.name == name) {
        let found = format!("a second button \"{name}\" of the {}", agent.name());
        return Err(wrong(
            KitchenFileKind::Layout,
            spec.at_m.span(),
            found,
            "a name of its own for each button of an agent",
        ));
    }
    let at_m = *spec.at_m.get_ref();
    if !at_m.iter().all(|metres| metres.is_finite()) {
        return Err(wrong(
            KitchenFileKind::Layout,
            spec.at_m.span(),
            "a button at no place",
            "at_m = [x, y] in metres",
        ));
    }
    let key = match (agent, &spec.key) {
        (Agent::Robot, _) => None,
        (Agent::Human, None) => {
            let found = format!("no key for the human's button \"{name}\"");
            return Err(wrong(
                KitchenFileKind::Layout,
                spec.at_m.span(),
                found,
                "button = { at_m = [x, y], key = \"k\" }",
            ));
        }
        (Agent::Human, Some(key)) => {
            let has_it = |other: &&Button| other.key.is_some_and(|other| is_same_key(other, *key.get_ref()));
            let twin = others.iter().find(has_it);
            if key.get_ref().is_whitespace() || twin.is_some() {
                let whose = twin.map_or(String::new(), |other| format!(", which \"{}\" has already", other.name));
                let found = format!("the key \"{}\" for \"{name}\"{whose}", key.get_ref());
                return Err(wrong(
                    KitchenFileKind::Layout,
                    key.span(),
                    found,
                    "a key of its own that is not the space bar",
                ));
            }
            Some(*key.get_ref())
        }
    };
    let gamepad = gamepad(agent, &name, spec, others)?;
    Ok(Button { name, action, at_m, key, gamepad, colour: spec.colour, area: area(spec)? })
}

/// The checked name of the button's area on the table; `None` if the layout names none.
fn area(spec: &ButtonSpec) -> Result<Option<String>> {
    let Some(area) = &spec.area else { return Ok(None) };
    let name = area.get_ref();
    let is_name = (1..=MAX_AREA).contains(&name.chars().count()) && name.trim() == name;
    if !is_name || name.chars().any(char::is_control) {
        let found = format!("area = {name:?}");
        return Err(wrong(
            KitchenFileKind::Layout,
            area.span(),
            found,
            "a name of 1 to 40 characters, such as \"storage\"",
        ));
    }
    Ok(Some(name.clone()))
}

/// The checked number of the gamepad button; each number may be given to only one of the human's buttons.
fn gamepad(agent: Agent, name: &str, spec: &ButtonSpec, others: &[Button]) -> Result<Option<u8>> {
    let Some(number) = spec.gamepad.as_ref().filter(|_| agent == Agent::Human) else { return Ok(None) };
    let twin = others.iter().find(|other| other.gamepad == Some(*number.get_ref()));
    if *number.get_ref() > MAX_GAMEPAD || twin.is_some() {
        let whose = twin.map_or(String::new(), |other| format!(", which \"{}\" has already", other.name));
        let found = format!("gamepad = {} for \"{name}\"{whose}", number.get_ref());
        let remedy = "the number of a gamepad button, 0 to 63, each once";
        return Err(wrong(KitchenFileKind::Layout, number.span(), found, remedy));
    }
    Ok(Some(*number.get_ref()))
}
