//! Locations, storages and buttons from the layout file, which an eye tracker can tell apart on the display.

use toml::Spanned;

use super::contents::IngredientItems;
use super::{KitchenFileKind, Result, in_layout, look, wrong_file};
use crate::kitchen::files::{ButtonSpec, LayoutSpec, PlaceSpec, RecipesSpec, StorageSpec, is_same_key};
use crate::kitchen::parts::{
    Agent, Button, ButtonAction, ContentId, DisplayArea, IngredientStorage, Location, LocationId, LocationKind,
    ProcessingStep,
};
use crate::kitchen::state::MAX_LOCATIONS;

/// Largest number of simultaneous orders; the cost to go is computed for one and for two orders.
const MAX_ORDERS: usize = 2;
/// Least distance between locations on the display, in metres, so that gaze can tell them apart.
const MIN_GAP_M: f64 = 0.15;

pub(super) fn locations(layout: &LayoutSpec) -> Result<Vec<Location>> {
    let location =
        |name: &Spanned<String>, kind, display: &Spanned<DisplayArea>, signal: &Option<Spanned<char>>| Location {
            name: name.get_ref().clone(),
            kind,
            display: *display.get_ref(),
            signal_key: signal.as_ref().map(|key| *key.get_ref()),
            look: None,
        };
    let orders = layout.order.iter().map(|o| (&o.name, location(&o.name, LocationKind::Order, &o.display, &o.signal)));
    let hands = layout
        .hand
        .iter()
        .map(|h| (&h.name, location(&h.name, LocationKind::Hand(*h.agent.get_ref()), &h.display, &h.signal)));
    let places = layout.place.iter().map(|p| (&p.name, location(&p.name, LocationKind::Place, &p.display, &p.signal)));
    let mut locations: Vec<Location> = Vec::new();
    for (name, location) in orders.chain(hands).chain(places) {
        if locations.iter().any(|other| other.name == location.name) {
            let found = format!("the location \"{}\" a second time", location.name);
            return Err(in_layout(name.span(), found, "each name once"));
        }
        locations.push(location);
    }
    if locations.len() > MAX_LOCATIONS {
        let found = format!("{} locations", locations.len());
        return Err(wrong_file(KitchenFileKind::Layout, found, format!("at most {MAX_LOCATIONS}")));
    }
    if layout.order.is_empty() || layout.order.len() > MAX_ORDERS {
        let found = format!("{} orders", layout.order.len());
        return Err(wrong_file(KitchenFileKind::Layout, found, format!("1 to {MAX_ORDERS} tables [[order]]")));
    }
    let first_place = layout.order.len() + layout.hand.len();
    for (location, place) in locations.iter_mut().skip(first_place).zip(&layout.place) {
        location.look = place.look.as_ref().map(|text| look(KitchenFileKind::Layout, text)).transpose()?;
    }
    Ok(locations)
}

/// The locations with a special role: both hands, the board where items are stacked, and the plate from which orders
/// are served.
pub(super) fn roles(layout: &LayoutSpec, locations: &[Location]) -> Result<([LocationId; 2], LocationId, LocationId)> {
    let find = |kind| locations.iter().position(|location| location.kind == kind).map(|index| LocationId(index as u8));
    let hand = |agent: Agent| {
        let count = layout.hand.iter().filter(|hand| *hand.agent.get_ref() == agent).count();
        match (find(LocationKind::Hand(agent)), count) {
            (Some(hand), 1) => Ok(hand),
            _ => {
                let found = format!("{count} hands of the {}", agent.name());
                Err(wrong_file(KitchenFileKind::Layout, found, "one [[hand]] for the human and one for the robot"))
            }
        }
    };
    let only = |which: &str, is: fn(&PlaceSpec) -> bool| {
        let first_place = layout.order.len() + layout.hand.len();
        let mut found = layout.place.iter().enumerate().filter(|(_, place)| is(place));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(LocationId((first_place + index) as u8)),
            (Some(_), Some((_, second))) => {
                let found = format!("a second place with {which} = true, \"{}\"", second.name.get_ref());
                Err(in_layout(second.name.span(), found, "one such place"))
            }
            (None, _) => {
                let found = format!("no place with {which} = true");
                Err(wrong_file(KitchenFileKind::Layout, found, format!("{which} = true at one [[place]]")))
            }
        }
    };
    let hands = [hand(Agent::Human)?, hand(Agent::Robot)?];
    Ok((hands, only("stacks", |place| place.stacks)?, only("serves", |place| place.serves)?))
}

/// Checks that the areas of all locations lie on the display and are far enough apart for an eye tracker.
pub(super) fn check_gaps(layout: &LayoutSpec, locations: &[Location], display_m: [f64; 2]) -> Result<()> {
    let spans = layout.order.iter().map(|order| order.display.span());
    let spans = spans.chain(layout.hand.iter().map(|hand| hand.display.span()));
    let spans: Vec<_> = spans.chain(layout.place.iter().map(|place| place.display.span())).collect();
    for (index, location) in locations.iter().enumerate() {
        let area = location.display;
        if area.x + area.w > 1.0 || area.y + area.h > 1.0 {
            let found = format!("\"{}\" reaches beyond the display", location.name);
            return Err(in_layout(spans[index].clone(), found, "x, y, w and h as fractions within 0 to 1"));
        }
        for other in &locations[..index] {
            let gap = area.gap_m(other.display, display_m);
            if gap < MIN_GAP_M - 1e-9 {
                let found = format!("\"{}\" only {gap:.3} m from \"{}\"", location.name, other.name);
                let remedy = format!("at least {MIN_GAP_M} m between locations, so that gaze can tell them apart");
                return Err(in_layout(spans[index].clone(), found, remedy));
            }
        }
    }
    Ok(())
}

/// Checks that no key sends the signals about two locations, and that no signal's key is the space bar.
pub(super) fn check_signal_keys(layout: &LayoutSpec) -> Result<()> {
    let mut seen: Vec<(&str, char)> = Vec::new();
    for (name, key) in layout.signal_keys() {
        let twin = seen.iter().find(|(_, other)| is_same_key(*other, *key.get_ref()));
        if key.get_ref().is_whitespace() || twin.is_some() {
            let whose = twin.map_or(String::new(), |(other, _)| format!(", which \"{other}\" has already"));
            let found = format!("signal = \"{}\" for \"{name}\"{whose}", key.get_ref());
            return Err(in_layout(key.span(), found, "a key of its own that is not the space bar"));
        }
        seen.push((name, *key.get_ref()));
    }
    Ok(())
}

pub(super) fn storages(
    layout: &LayoutSpec,
    spec: &RecipesSpec,
    items: &IngredientItems,
) -> Result<Vec<IngredientStorage>> {
    let one = |storage: &StorageSpec| {
        Ok(IngredientStorage {
            agent: storage.agent,
            item: stored(&storage.ingredient, spec, items)?,
            label: storage.ingredient.get_ref().clone(),
            display: storage.display,
        })
    };
    layout.storage.iter().map(one).collect()
}

pub(super) fn stored(name: &Spanned<String>, spec: &RecipesSpec, items: &IngredientItems) -> Result<ContentId> {
    let ingredient = spec.ingredient.iter().position(|ingredient| ingredient.name.get_ref() == name.get_ref());
    let item = ingredient.and_then(|ingredient| items.ingredient.iter().position(|&of| of == ingredient));
    item.map(|item| ContentId(item as u8 + 1)).ok_or_else(|| {
        let names: Vec<&str> = spec.ingredient.iter().map(|ingredient| ingredient.name.get_ref().as_str()).collect();
        let found = format!("ingredient = \"{}\"", name.get_ref());
        in_layout(name.span(), found, format!("one of {}", names.join(", ")))
    })
}

/// Largest length of the name of an area of buttons on the table, in characters.
const MAX_AREA: usize = 40;

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
                let remedy = "a table [[process]] with this name and a button";
                return Err(wrong_file(KitchenFileKind::Layout, found, remedy));
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
            return Err(in_layout(process.name.span(), found, "a [[process]] of the recipe file"));
        }
    }
    Ok(buttons)
}

fn button(agent: Agent, name: String, action: ButtonAction, spec: &ButtonSpec, others: &[Button]) -> Result<Button> {
    if others.iter().any(|other| other.name == name) {
        let found = format!("a second button \"{name}\" of the {}", agent.name());
        return Err(in_layout(spec.at_m.span(), found, "a name of its own for each button of an agent"));
    }
    let key = match (agent, &spec.key) {
        (Agent::Robot, _) => None,
        (Agent::Human, None) => {
            let found = format!("no key for the human's button \"{name}\"");
            return Err(in_layout(spec.at_m.span(), found, "button = { at_m = [x, y], key = \"k\" }"));
        }
        (Agent::Human, Some(key)) => {
            let has_it = |other: &&Button| other.key.is_some_and(|other| is_same_key(other, *key.get_ref()));
            let twin = others.iter().find(has_it);
            if key.get_ref().is_whitespace() || twin.is_some() {
                let whose = twin.map_or(String::new(), |other| format!(", which \"{}\" has already", other.name));
                let found = format!("the key \"{}\" for \"{name}\"{whose}", key.get_ref());
                return Err(in_layout(key.span(), found, "a key of its own that is not the space bar"));
            }
            Some(*key.get_ref())
        }
    };
    let gamepad = gamepad(agent, &name, spec, others)?;
    let at_m = *spec.at_m.get_ref();
    Ok(Button { name, action, at_m, key, gamepad, colour: spec.colour, area: area(spec)? })
}

/// The checked name of the button's area on the table; `None` if the layout names none.
fn area(spec: &ButtonSpec) -> Result<Option<String>> {
    let Some(area) = &spec.area else { return Ok(None) };
    let name = area.get_ref();
    let is_name = (1..=MAX_AREA).contains(&name.chars().count()) && name.trim() == name;
    if !is_name || name.chars().any(char::is_control) {
        let found = format!("area = {name:?}");
        return Err(in_layout(area.span(), found, "a name of 1 to 40 characters, such as \"storage\""));
    }
    Ok(Some(name.clone()))
}

/// The checked number of the gamepad button; each number may be given to only one of the human's buttons.
fn gamepad(agent: Agent, name: &str, spec: &ButtonSpec, others: &[Button]) -> Result<Option<u8>> {
    let Some(number) = spec.gamepad.as_ref().filter(|_| agent == Agent::Human) else { return Ok(None) };
    if let Some(other) = others.iter().find(|other| other.gamepad == Some(*number.get_ref())) {
        let found = format!("gamepad = {} for \"{name}\", which \"{}\" has already", number.get_ref(), other.name);
        let remedy = "the number of a gamepad button, 0 to 63, each once";
        return Err(in_layout(number.span(), found, remedy));
    }
    Ok(Some(*number.get_ref()))
}
