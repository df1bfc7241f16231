//! The kitchen as an external concept is told it, once.

use std::collections::BTreeMap;

use serde::Serialize;

use tomcom_core::kitchen::{Agent, AspectId, Button, ButtonAction, ContentId, Kitchen, LocationKind, State};

/// Locations, buttons, recipes, and the aspects about which somebody can have a belief. Names are those of the layout and
/// the recipe file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KitchenDescription {
    pub name: String,
    pub locations: Vec<DescribedLocation>,
    /// State aspects: the content of each location, and the recipe of each dish. The first value of a recipe is true.
    pub aspects: Vec<DescribedAspect>,
    pub human_buttons: Vec<DescribedButton>,
    pub robot_buttons: Vec<DescribedButton>,
    pub dishes: Vec<DescribedDish>,
    pub steps: Vec<DescribedStep>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedLocation {
    pub name: String,
    pub kind: &'static str,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedAspect {
    pub name: String,
    pub values: Vec<String>,
}

/// A button: what a press does, and at which location, or with which item or processing step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedButton {
    pub name: String,
    pub does: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedDish {
    pub name: String,
    /// The items of the true recipe.
    pub items: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedStep {
    pub name: String,
    /// `None`: in the hand of the agent who presses.
    pub place: Option<String>,
    pub by: Vec<&'static str>,
    /// What the step makes of each item.
    pub makes: BTreeMap<String, String>,
}

impl KitchenDescription {
    pub fn new(kitchen: &Kitchen) -> KitchenDescription {
        let content = |id: ContentId| kitchen.content(id).name.clone();
        let button = |button: &Button| {
            let (does, with) = match button.action {
                ButtonAction::Take(item) => ("take", Some(content(item))),
                ButtonAction::Use(location) => ("use", Some(kitchen.location(location).name.clone())),
                ButtonAction::Process(step) => ("process", Some(kitchen.processes[usize::from(step)].name.clone())),
                ButtonAction::Trash => ("trash", None),
                ButtonAction::Serve(order) => ("serve", Some(kitchen.location(order).name.clone())),
            };
            DescribedButton { name: button.name.clone(), does, with }
        };
        let [human_buttons, robot_buttons] =
            Agent::BOTH.map(|agent| kitchen.buttons[agent.index()].iter().map(button).collect());
        let kind = |kind: LocationKind| match kind {
            LocationKind::Order => "order",
            LocationKind::Hand(Agent::Human) => "human_hand",
            LocationKind::Hand(Agent::Robot) => "robot_hand",
            LocationKind::Place => "place",
        };
        KitchenDescription {
            name: kitchen.name.clone(),
            locations: (kitchen.locations.iter())
                .map(|location| DescribedLocation { name: location.name.clone(), kind: kind(location.kind) })
                .collect(),
            aspects: (kitchen.aspects.iter())
                .map(|aspect| DescribedAspect { name: aspect.name.clone(), values: aspect.labels.clone() })
                .collect(),
            human_buttons,
            robot_buttons,
            dishes: (kitchen.dishes.iter())
                .map(|dish| DescribedDish {
                    name: dish.name.clone(),
                    items: kitchen.content(dish.stack()).items.iter().map(|&item| content(item)).collect(),
                })
                .collect(),
            steps: (kitchen.processes.iter())
                .map(|step| DescribedStep {
                    name: step.name.clone(),
                    place: step.place.map(|place| kitchen.location(place).name.clone()),
                    by: (Agent::BOTH.into_iter()).filter(|agent| step.agents[agent.index()]).map(Agent::name).collect(),
                    makes: step.steps.iter().map(|&(from, to)| (content(from), content(to))).collect(),
                })
                .collect(),
        }
    }
}

/// The true value of every aspect, by its name.
pub fn true_values(kitchen: &Kitchen, state: State) -> BTreeMap<String, String> {
    let of = |index: usize| {
        let aspect = &kitchen.aspects[index];
        (aspect.name.clone(), aspect.labels[kitchen.true_value(state, AspectId(index as u8))].clone())
    };
    (0..kitchen.aspects.len()).map(of).collect()
}
