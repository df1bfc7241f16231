//! Summary of a kitchen: its size, its shortest plans, and the tags by which eye trackers find its display.

use std::fmt::Write;
use std::sync::Arc;

use serde::Serialize;

use tomcom_core::gaze::tags::{CELLS, DisplayTag, DisplayTags};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, DishId, Kitchen, LocationKind, OrderContent, State};

/// Summary of a kitchen: size, shortest plans and display tags.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KitchenSummary {
    pub name: String,
    /// Number of possible combinations of all state aspects' values, as a decimal text, since the number is too large
    /// for JSON readers.
    pub states: String,
    pub aspects: Vec<AspectValueCount>,
    pub plans: Vec<ShortestPlanSummary>,
    /// Tags in the corners of the wall display for eye trackers; null if there is no room for tags.
    pub tags: Option<DisplayTagLayout>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayTagLayout {
    pub family: &'static str,
    /// Length of the edges of the tags' black squares, in metres.
    pub edge_m: f64,
    pub tags: Vec<DisplayTagGeometry>,
    /// Corners of the surface that the tags span: top left, top right, bottom right, bottom left, in fractions of the
    /// display.
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

/// A shortest plan for a dish from an empty kitchen.
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
            tags: DisplayTags::place(kitchen).ok().as_ref().map(DisplayTagLayout::from_tags),
        }
    }
}

/// The state of a kitchen that is empty except for one order of this dish.
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

/// A shortest plan for a dish: follows best presses from an empty kitchen until the dish is served, and changes the
/// pressing agent only where it has to.
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
    let mut text = format!("{} ({})\n", kitchen.title, kitchen.name);
    let written = write_locations(&mut text, kitchen)
        .and_then(|()| write_buttons(&mut text, kitchen))
        .and_then(|()| write_recipes(&mut text, kitchen, figures))
        .and_then(|()| write_aspects(&mut text, figures))
        .and_then(|()| write_tags(&mut text, kitchen));
    written.expect("a string takes every text");
    text
}

fn write_locations(text: &mut String, kitchen: &Kitchen) -> std::fmt::Result {
    writeln!(text, "\nLOCATIONS")?;
    for (index, location) in kitchen.locations.iter().enumerate() {
        let id = tomcom_core::kitchen::LocationId(index as u8);
        let accepts = match location.kind {
            LocationKind::Order => "an order".to_string(),
            _ => {
                let taken: Vec<&str> = (1..kitchen.contents.len())
                    .filter(|&content| kitchen.accepts(id, ContentId(content as u8)))
                    .map(|content| kitchen.contents[content].name.as_str())
                    .collect();
                match taken.len() == kitchen.contents.len() - 1 {
                    true => "anything".to_string(),
                    false => taken.join(", "),
                }
            }
        };
        let role = match id {
            id if id == kitchen.board => " (items are stacked here)",
            id if id == kitchen.plate => " (orders are served from here)",
            _ => "",
        };
        let key = location.signal_key.map_or(' ', |key| key);
        writeln!(text, "  {key}  {:<16} {accepts}{role}", location.name)?;
    }
    Ok(())
}

fn write_buttons(text: &mut String, kitchen: &Kitchen) -> std::fmt::Result {
    for agent in Agent::BOTH {
        writeln!(text, "\nBUTTONS OF THE {}", agent.name().to_uppercase())?;
        for button in &kitchen.buttons[agent.index()] {
            let [x, y] = button.at_m;
            let key = button.key.unwrap_or(' ');
            writeln!(text, "  {key}  {:<16} at {x:>5.2} m, {y:>5.2} m", button.name)?;
        }
    }
    Ok(())
}

fn write_recipes(text: &mut String, kitchen: &Kitchen, figures: &KitchenSummary) -> std::fmt::Result {
    writeln!(text, "\nRECIPES")?;
    for (dish, plan) in kitchen.dishes.iter().zip(&figures.plans) {
        let items = |stack: ContentId| {
            let items = &kitchen.content(stack).items;
            items.iter().map(|item| kitchen.content(*item).name.as_str()).collect::<Vec<_>>().join(" + ")
        };
        writeln!(text, "  {}: {}", dish.name, items(dish.stack()))?;
        for variant in &dish.variants[1..] {
            writeln!(text, "      may be taken for {}", items(*variant))?;
        }
        writeln!(text, "      {} presses: {}", plan.actions, plan.presses.join(", "))?;
    }
    Ok(())
}

fn write_aspects(text: &mut String, figures: &KitchenSummary) -> std::fmt::Result {
    writeln!(text, "\nSTATE SPACE")?;
    for aspect in &figures.aspects {
        writeln!(text, "  {:<28} {:>4}", aspect.name, aspect.values)?;
    }
    writeln!(text, "  {:<28} {:>4}", "product", figures.states)
}

fn write_tags(text: &mut String, kitchen: &Kitchen) -> std::fmt::Result {
    writeln!(text, "\nTAGS OF THE WALL DISPLAY")?;
    let tags = match DisplayTags::place(kitchen) {
        Ok(tags) => tags,
        Err(error) => return writeln!(text, "  none: found {error}; right would be {}", error.remedy),
    };
    let [top_left, top_right, bottom_right, bottom_left] = tags.corners.map(|tag| tag.id);
    writeln!(
        text,
        "  tag36h11 {top_left} top left, {top_right} top right, {bottom_right} bottom right, {bottom_left} bottom left"
    )?;
    writeln!(text, "  black edges of {:.3} m", tags.edge_m)
}
