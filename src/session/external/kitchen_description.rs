//! The kitchen as an external concept is told it, once.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use tomcom_core::kitchen::{
    Agent, AspectId, Button, ButtonAction, ContentId, Dish, Kitchen, Location, LocationKind, ProcessingStep, State,
    StateAspect,
};

/// Locations, buttons, recipes, and the aspects about which somebody can have a belief. Names are those of the layout and
/// the recipe file.
pub fn describe(kitchen: &Kitchen) -> Value {
    let content = |id: ContentId| &kitchen.content(id).name;
    let location = |location: &Location| {
        let kind = match location.kind {
            LocationKind::Order => "order",
            LocationKind::Hand(Agent::Human) => "human_hand",
            LocationKind::Hand(Agent::Robot) => "robot_hand",
            LocationKind::Place => "place",
        };
        json!({ "name": location.name, "kind": kind })
    };
    // The first value of a recipe is true.
    let aspect = |aspect: &StateAspect| json!({ "name": aspect.name, "values": aspect.labels });
    // What a press does, and at which location, or with which item or processing step.
    let button = |button: &Button| {
        let (does, with) = match button.action {
            ButtonAction::Take(item) => ("take", content(item)),
            ButtonAction::Use(location) => ("use", &kitchen.location(location).name),
            ButtonAction::Process(step) => ("process", &kitchen.processes[usize::from(step)].name),
            ButtonAction::Serve(order) => ("serve", &kitchen.location(order).name),
            ButtonAction::Trash => return json!({ "name": button.name, "does": "trash" }),
        };
        json!({ "name": button.name, "does": does, "with": with })
    };
    let [human_buttons, robot_buttons] =
        Agent::BOTH.map(|agent| kitchen.buttons[agent.index()].iter().map(button).collect::<Value>());
    // The items of the true recipe.
    let dish = |dish: &Dish| {
        let items: Value = kitchen.content(dish.stack()).items.iter().map(|&item| content(item).as_str()).collect();
        json!({ "name": dish.name, "items": items })
    };
    // Without a place it is done in the hand of the agent who presses.
    let step = |step: &ProcessingStep| {
        let place = step.place.map(|place| &kitchen.location(place).name);
        let by: Value = Agent::BOTH.into_iter().filter(|agent| step.agents[agent.index()]).map(Agent::name).collect();
        let makes: BTreeMap<_, _> = step.steps.iter().map(|&(from, to)| (content(from), content(to))).collect();
        json!({ "name": step.name, "place": place, "by": by, "makes": makes })
    };
    json!({
        "name": kitchen.name,
        "locations": kitchen.locations.iter().map(location).collect::<Value>(),
        "aspects": kitchen.aspects.iter().map(aspect).collect::<Value>(),
        "human_buttons": human_buttons,
        "robot_buttons": robot_buttons,
        "dishes": kitchen.dishes.iter().map(dish).collect::<Value>(),
        "steps": kitchen.processes.iter().map(step).collect::<Value>(),
    })
}

/// The true value of every aspect, by its name.
pub fn true_values(kitchen: &Kitchen, state: State) -> BTreeMap<String, String> {
    let of = |index: usize| {
        let aspect = &kitchen.aspects[index];
        (aspect.name.clone(), aspect.labels[kitchen.true_value(state, AspectId(index as u8))].clone())
    };
    (0..kitchen.aspects.len()).map(of).collect()
}
