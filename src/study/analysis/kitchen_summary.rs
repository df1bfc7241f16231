//! Summary of a kitchen: its size, its shortest plans, and the tags by which eye trackers find its display.

use std::sync::Arc;

use serde::Serialize;

use tomcom_core::gaze::tags::{CELLS, DisplayTag, DisplayTags};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::parts::SCREEN_LANGUAGE;
use tomcom_core::kitchen::{
    Agent, ButtonId, ContentId, Dish, DishId, Kitchen, LocationId, LocationKind, OrderContent, State,
};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KitchenSummary {
    pub name: String,
    /// Number of combinations of all aspects' values, as text, since it is too large for JSON readers.
    pub states: String,
    pub aspects: Vec<AspectValueCount>,
    pub plans: Vec<ShortestPlanSummary>,
    /// Dishes that the display names or draws otherwise than the others, in words.
    pub remarks: Vec<String>,
    /// Tags in the corners of the wall display for eye trackers; null if there is no room for tags.
    pub tags: Option<DisplayTagLayout>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayTagLayout {
    pub family: &'static str,
    /// Length of the edges of the tags' black squares, in metres.
    pub edge_m: f64,
    pub tags: Vec<DisplayTagGeometry>,
    /// Of the surface that the tags span: top left, top right, bottom right, bottom left, in fractions of the display.
    pub surface: [[f64; 2]; 4],
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayTagGeometry {
    pub id: u16,
    /// Position and size (x, y, w, h) of the tag with its white border, in fractions of the display.
    pub area: [f64; 4],
    /// Corners of the tag's black square, which trackers ask for: top left, top right, bottom right, bottom left, in
    /// fractions of the display. The corners lie at cells 1 and 9 of the tag's 10 cells.
    pub corners: [[f64; 2]; 4],
    /// Rows of the tag's cells, from the top: `#` for black, another character for white.
    pub cells: Vec<String>,
}

impl DisplayTagLayout {
    fn from_tags(tags: &DisplayTags) -> DisplayTagLayout {
        let row = |row: &[bool; CELLS]| row.iter().map(|black| if *black { '#' } else { '.' }).collect();
        let tag = |tag: &DisplayTag| {
            let area = [tag.area.x, tag.area.y, tag.area.w, tag.area.h];
            DisplayTagGeometry {
                id: tag.id,
                area,
                corners: tag.black_corners(),
                cells: tag.cells().iter().map(row).collect(),
            }
        };
        let tags_drawn = tags.corners.iter().map(tag).collect();
        DisplayTagLayout { family: "tag36h11", edge_m: tags.edge_m, tags: tags_drawn, surface: tags.hull() }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AspectValueCount {
    pub name: String,
    pub values: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShortestPlanSummary {
    pub recipe: String,
    pub actions: u32,
    /// The presses of the shortest plan, in order: "human: take rice".
    pub presses: Vec<String>,
}

impl KitchenSummary {
    pub fn from_kitchen(kitchen: &Arc<Kitchen>) -> KitchenSummary {
        let mut cost = CostToGo::new(kitchen.clone());
        let aspects = kitchen.aspects.iter();
        let aspects = aspects.map(|aspect| AspectValueCount { name: aspect.name.clone(), values: aspect.values.len() });
        let plans = (0..kitchen.dishes.len()).map(|index| plan(kitchen, &mut cost, DishId(index as u8)));
        KitchenSummary {
            name: kitchen.name.clone(),
            states: kitchen.state_count().to_string(),
            aspects: aspects.collect(),
            plans: plans.collect(),
            remarks: remarks(kitchen),
            tags: DisplayTags::place(kitchen).ok().as_ref().map(DisplayTagLayout::from_tags),
        }
    }
}

/// Dishes without a word in a language in which others have one, and dishes that look the same.
fn remarks(kitchen: &Kitchen) -> Vec<String> {
    let mut remarks = Vec::new();
    for (language, words) in kitchen.words.languages().filter(|(language, _)| *language != SCREEN_LANGUAGE) {
        let without: Vec<&str> =
            kitchen.dishes.iter().map(|dish| dish.name.as_str()).filter(|name| !words.contains_key(*name)).collect();
        if !without.is_empty() {
            remarks.push(format!("without words in [words.{language}]: {}", without.join(", ")));
        }
    }
    for (index, dish) in kitchen.dishes.iter().enumerate() {
        let is_alike = |other: &&Dish| other.look.is_some() && other.look == dish.look;
        let alike = kitchen.dishes[..index].iter().find(is_alike);
        remarks.extend(alike.map(|other| format!("the same picture: {}, {}", other.name, dish.name)));
    }
    remarks
}

fn ordered(kitchen: &Kitchen, dish: DishId) -> State {
    let mut state = kitchen.empty_state();
    state.set_order(kitchen.orders[0], OrderContent::Dish(dish));
    state
}

/// Length of the shortest plan for each dish from an empty kitchen, in presses.
pub fn plan_lengths(kitchen: &Kitchen, cost: &mut CostToGo) -> Vec<u32> {
    let recipes = kitchen.true_recipes();
    let length = |index| cost.all_orders(ordered(kitchen, DishId(index as u8)), &recipes);
    (0..kitchen.dishes.len()).map(length).collect()
}

/// A shortest plan from an empty kitchen, which changes the pressing agent only where it has to.
fn plan(kitchen: &Kitchen, cost: &mut CostToGo, dish: DishId) -> ShortestPlanSummary {
    let recipes = kitchen.true_recipes();
    let mut state = ordered(kitchen, dish);
    let actions = cost.all_orders(state, &recipes);
    let mut presses = Vec::new();
    let mut last = Agent::Human;
    for left in (0..actions).rev() {
        let buttons = [last, last.other()].into_iter().flat_map(|agent| {
            (0..kitchen.buttons[agent.index()].len()).map(move |index| (agent, ButtonId(index as u8)))
        });
        let mut nearer = buttons.filter_map(|(agent, button)| {
            let next = kitchen.press(state, &recipes, agent, button)?;
            (cost.all_orders(next, &recipes) <= left).then_some((agent, button, next))
        });
        let Some((agent, button, next)) = nearer.next() else { break };
        presses.push(format!("{}: {}", agent.name(), kitchen.button(agent, button).name));
        (state, last) = (next, agent);
    }
    ShortestPlanSummary { recipe: kitchen.dish(dish).name.clone(), actions, presses }
}

pub fn describe(kitchen: &Kitchen, figures: &KitchenSummary) -> String {
    let mut text = format!("{} ({})\n\nLOCATIONS\n", kitchen.title, kitchen.name);
    for (index, location) in kitchen.locations.iter().enumerate() {
        let id = LocationId(index as u8);
        let role = match id {
            id if id == kitchen.board => " (items are stacked here)",
            id if id == kitchen.plate => " (orders are served from here)",
            _ => "",
        };
        let key = location.signal_key.unwrap_or(' ');
        text += &format!("  {key}  {:<16} {}{role}\n", location.name, accepted(kitchen, id));
    }
    for agent in Agent::BOTH {
        text += &format!("\nBUTTONS OF THE {}\n", agent.name().to_uppercase());
        for button in &kitchen.buttons[agent.index()] {
            let ([x, y], key) = (button.at_m, button.key.unwrap_or(' '));
            text += &format!("  {key}  {:<16} at {x:>5.2} m, {y:>5.2} m\n", button.name);
        }
    }
    text += "\nRECIPES\n";
    for (dish, plan) in kitchen.dishes.iter().zip(&figures.plans) {
        let items = |stack: ContentId| {
            let items = &kitchen.content(stack).items;
            items.iter().map(|item| kitchen.content(*item).name.as_str()).collect::<Vec<_>>().join(" + ")
        };
        text += &format!("  {}: {}\n", dish.name, items(dish.stack()));
        for variant in &dish.variants[1..] {
            text += &format!("      may be taken for {}\n", items(*variant));
        }
        text += &format!("      {} presses: {}\n", plan.actions, plan.presses.join(", "));
    }
    for remark in &figures.remarks {
        text += &format!("  {remark}\n");
    }
    text += "\nSTATE SPACE\n";
    for aspect in &figures.aspects {
        text += &format!("  {:<28} {:>4}\n", aspect.name, aspect.values);
    }
    text += &format!("  {:<28} {:>4}\n\nTAGS OF THE WALL DISPLAY\n", "product", figures.states);
    let tags = match DisplayTags::place(kitchen) {
        Ok(tags) => tags,
        Err(error) => return text + &format!("  none: found {error}; right would be {}\n", error.remedy),
    };
    let [top_left, top_right, bottom_right, bottom_left] = tags.corners.map(|tag| tag.id);
    text + &format!(
        "  tag36h11 {top_left} top left, {top_right} top right, {bottom_right} bottom right, {bottom_left} bottom left\n  \
         black edges of {:.3} m\n",
        tags.edge_m
    )
}

fn accepted(kitchen: &Kitchen, location: LocationId) -> String {
    if kitchen.location(location).kind == LocationKind::Order {
        return "an order".to_string();
    }
    let ids = (1..kitchen.contents.len()).map(|content| ContentId(content as u8));
    let taken: Vec<&str> = ids
        .filter(|&content| kitchen.accepts(location, content))
        .map(|content| kitchen.content(content).name.as_str())
        .collect();
    if taken.len() == kitchen.contents.len() - 1 { "anything".to_string() } else { taken.join(", ") }
}
