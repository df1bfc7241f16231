//! The kitchen as on the wall display, for Rerun: locations with their contents, the present signal, and the gaze.

use super::colours::{self, SceneColour};
use super::entity_content::{EntityData, EntityUpdate, SceneArea, SceneDisc, slug};
use tomcom_core::communication::Signal;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::kitchen::{
    self, Agent, AspectId, ContentId, IngredientStorage, Kitchen, Location, LocationId, LocationKind, OrderContent,
    State,
};
use tomcom_session::history::wording;
use tomcom_session::{Session, proposals};

/// Half widths of the outlines in the kitchen, in millimetres.
const THIN: f64 = 2.0;
const THICK: f64 = 6.0;
/// Distance of a label's anchor above the edge of its location, in millimetres; Rerun draws text below its anchor.
const ABOVE_MM: f64 = 52.0;

const MM: f64 = 1000.0;

fn area(kitchen: &Kitchen, on: kitchen::DisplayArea, colour: SceneColour) -> SceneArea {
    let [width_mm, height_mm] = kitchen.display_m.map(|length| length * MM);
    SceneArea {
        left: on.x * width_mm,
        top: on.y * height_mm,
        width: on.w * width_mm,
        height: on.h * height_mm,
        colour,
        line: THIN,
    }
}

fn words_at(at: [f64; 2], words: &str, colour: SceneColour) -> SceneDisc {
    SceneDisc { at, radius: 0.0, words: words.to_string(), colour }
}

/// Entity updates with the display's edge, the names of the locations, and the storages.
pub fn fixed(kitchen: &Kitchen) -> Vec<EntityUpdate> {
    let whole = kitchen::DisplayArea { x: 0.0, y: 0.0, w: 1.0, h: 1.0 };
    let name = |(index, location): (usize, &Location)| {
        // The name has the colour of the location's curves, since the plots have no legend.
        let colour = colours::of_aspect(AspectId::of_location(LocationId(index as u8)));
        let SceneArea { left, top, width, .. } = area(kitchen, location.display, colour);
        words_at([left + width / 2.0, top - ABOVE_MM], &location.label(), colour)
    };
    let mut rows = vec![
        EntityUpdate::new("kitchen/display", EntityData::Areas(vec![area(kitchen, whole, colours::FRAME)])),
        EntityUpdate::new("kitchen/names", EntityData::Discs(kitchen.locations.iter().enumerate().map(name).collect())),
    ];
    for agent in Agent::BOTH {
        let own = || kitchen.storages.iter().filter(|storage| storage.agent == agent);
        let entity = format!("kitchen/storage/{}", agent.name());
        let areas = own().map(|storage| area(kitchen, storage.display, dimmed(colours::agent_colour(agent))));
        rows.push(EntityUpdate::new(&entity, EntityData::Areas(areas.collect())));
        rows.push(EntityUpdate::new(
            format!("{entity}/items"),
            EntityData::Discs(own().flat_map(|storage| stored(kitchen, storage)).collect()),
        ));
    }
    rows
}

fn dimmed([red, green, blue, opacity]: SceneColour) -> SceneColour {
    [red / 2, green / 2, blue / 2, opacity]
}

/// Entity updates with the contents of the locations that differ from the state `before`, or of all locations without
/// `before`.
pub fn contents(kitchen: &Kitchen, before: Option<State>, state: State) -> impl Iterator<Item = EntityUpdate> {
    let locations = (0..kitchen.locations.len()).map(|index| LocationId(index as u8));
    let changed = locations.filter(move |&id| before.is_none_or(|before| before.code(id) != state.code(id)));
    changed.flat_map(move |id| {
        let location = kitchen.location(id);
        let items = items(kitchen, state, id);
        let is_order = location.kind == LocationKind::Order;
        let words = if items.is_empty() && !is_order { "" } else { kitchen.content_label(state, id) };
        let colour = match (items.is_empty(), location.kind) {
            (true, _) => colours::EMPTY,
            (false, LocationKind::Hand(agent)) => colours::agent_colour(agent),
            (false, _) => colours::FULL,
        };
        let entity = format!("kitchen/{}", slug(&location.name));
        let discs = content(kitchen, location.display, &items, words, colour);
        [
            EntityUpdate::new(&entity, EntityData::Areas(vec![area(kitchen, location.display, colour)])),
            EntityUpdate::new(format!("{entity}/items"), EntityData::Discs(discs)),
        ]
    })
}

/// Ingredient items at a location; for an order location, the items of the order's dish.
fn items(kitchen: &Kitchen, state: State, id: LocationId) -> Vec<ContentId> {
    let content = match kitchen.location(id).kind {
        LocationKind::Order => match state.order(id) {
            OrderContent::Dish(dish) => kitchen.dish(dish).stack(),
            OrderContent::None | OrderContent::Served => ContentId::EMPTY,
        },
        _ => state.content(id),
    };
    if content.is_empty() { Vec::new() } else { kitchen.content(content).items.clone() }
}

/// A disc for each item of a content, side by side in an area, with a label below.
fn content(
    kitchen: &Kitchen,
    on: kitchen::DisplayArea,
    items: &[ContentId],
    words: &str,
    colour: SceneColour,
) -> Vec<SceneDisc> {
    let SceneArea { left, top, width, height, .. } = area(kitchen, on, colour);
    let share = width / (items.len() as f64 + 1.0);
    let radius = (height * 0.34).min(share * 0.6);
    let disc = |(nth, &item): (usize, &ContentId)| SceneDisc {
        at: [left + share * (nth as f64 + 1.0), top + height / 2.0],
        radius,
        words: String::new(),
        colour: colours::of_item(kitchen, item),
    };
    let below = words_at([left + width / 2.0, top + height], words, colour);
    items.iter().enumerate().map(disc).chain((!words.is_empty()).then_some(below)).collect()
}

/// Discs for a storage: its item above its name, both inside its area, since storages are adjacent.
fn stored(kitchen: &Kitchen, storage: &IngredientStorage) -> [SceneDisc; 2] {
    let SceneArea { left, top, width, height, .. } = area(kitchen, storage.display, colours::QUIET);
    let middle = left + width / 2.0;
    let disc = SceneDisc {
        at: [middle, top + height * 0.26],
        radius: (height * 0.2).min(width * 0.3),
        words: String::new(),
        colour: colours::of_item(kitchen, storage.item),
    };
    [disc, words_at([middle, top + height * 0.42], &storage.label, colours::QUIET)]
}

/// Entities for the present signal: a highlighted location, a recipe at its order, or proposed presses in the middle of
/// the display.
pub fn shown_signal(session: &Session) -> Vec<EntityUpdate> {
    let outline = |areas| EntityUpdate::new("kitchen/shown", EntityData::Areas(areas));
    let label = |words| EntityUpdate::new("kitchen/shown/words", EntityData::Discs(words));
    if let Some(left) = proposals::left(session) {
        let middle = session.kitchen.display_m.map(|length| length * MM / 2.0);
        let words = format!("next: {}", wording::proposal(left));
        return vec![outline(Vec::new()), label(vec![words_at(middle, &words, colours::SIGNAL)])];
    }
    let shown = session.shown.as_ref().and_then(|shown| Some((&shown.signal, shown.location?)));
    let Some((signal, location)) = shown else { return vec![outline(Vec::new()), label(Vec::new())] };
    let words = match signal {
        Signal::ShowRecipe(_) => {
            wording::recipe(session, location).map_or_else(String::new, |recipe| format!("recipe: {recipe}"))
        }
        Signal::Highlight(_) | Signal::Propose(_) => "look here".to_string(),
    };
    let inner = area(&session.kitchen, session.kitchen.location(location).display, colours::SIGNAL);
    let (gap, line) = (4.0 * THIN, THICK);
    let outer = SceneArea {
        left: inner.left - gap,
        top: inner.top - gap,
        width: inner.width + 2.0 * gap,
        height: inner.height + 2.0 * gap,
        line,
        ..inner
    };
    let below = [outer.left + outer.width / 2.0, outer.top + outer.height + ABOVE_MM];
    vec![outline(vec![outer]), label(vec![words_at(below, &words, colours::SIGNAL)])]
}

/// Entity update with the gaze point, and with the area around the point that the participant can read.
pub fn gaze(session: &Session, sample: GazeSample) -> EntityUpdate {
    let [width_m, height_m] = session.kitchen.display_m;
    let at = [sample.x * width_m * MM, sample.y * height_m * MM];
    let around = session.spec.human.perception.radius_m() * MM;
    let colour = if sample.confidence >= MIN_CONFIDENCE { colours::SIGNAL } else { colours::LOST };
    EntityUpdate::new("human/gaze", EntityData::Sight { at, around, colour })
}
