//! Entities of the kitchen: its places with what lies there, the present signal, and the gaze.

use super::entity_content::{self, EntityData, EntityUpdate, SceneArea, SceneColour, SceneLabel, ScenePicture, slug};
use super::pictures;
use tomcom_core::communication::Signal;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::kitchen::{
    self, Agent, ContentId, IngredientStorage, Kitchen, Location, LocationId, LocationKind, OrderContent, State,
};
use tomcom_session::history::wording;
use tomcom_session::{Session, proposals};

/// Width of the display in the kitchen's lengths.
pub const WIDE: f64 = 1500.0;
/// Half widths of the outlines in the kitchen.
const THIN: f64 = 2.0;
const THICK: f64 = 6.0;
/// Distance of a label's anchor above the edge of its location; Rerun draws text below its anchor.
const ABOVE: f64 = 46.0;
/// Distance of a label's middle from the edge of the storage beside it.
const BESIDE: f64 = 60.0;
/// Storages nearer to the display's edge than this share of its width have their names outside, so far from the edge.
const AT_EDGE: f64 = 0.15;
const OUTSIDE: f64 = 85.0;
/// A label within this distance of the display's upper edge would be struck through by it.
const EDGE: f64 = 24.0;
/// Longest line of a label of contents, in characters.
const LINE: usize = 20;
/// Largest number of items of a recipe that is shown.
const MOST_ITEMS: usize = 6;

/// Lengths of the kitchen in a metre.
fn per_metre(kitchen: &Kitchen) -> f64 {
    WIDE / kitchen.display_m[0]
}

fn area(kitchen: &Kitchen, on: kitchen::DisplayArea, colour: SceneColour) -> SceneArea {
    let [width, height] = kitchen.display_m.map(|length| length * per_metre(kitchen));
    SceneArea { left: on.x * width, top: on.y * height, width: on.w * width, height: on.h * height, colour, line: THIN }
}

fn words_at(at: [f64; 2], words: &str, colour: SceneColour) -> SceneLabel {
    SceneLabel { at, words: words.to_string(), colour }
}

/// Entity updates with the display's edge, the names and furniture of the locations, and the storages.
pub fn fixed_places(session: &Session) -> Vec<EntityUpdate> {
    let kitchen = &session.kitchen;
    let whole = kitchen::DisplayArea { x: 0.0, y: 0.0, w: 1.0, h: 1.0 };
    let named = |on, words: &str, colour| {
        let SceneArea { left, top, width, .. } = area(kitchen, on, colour);
        words_at([left + width / 2.0, above(top)], words, colour)
    };
    let name = |location: &Location| named(location.display, &location.label(), entity_content::FRAME);
    let mut rows = vec![
        EntityUpdate::new("kitchen/display", EntityData::Areas(vec![area(kitchen, whole, entity_content::FRAME)])),
        EntityUpdate::new("kitchen/names", EntityData::Labels(kitchen.locations.iter().map(name).collect())),
        EntityUpdate::new(
            "human/gaze",
            EntityData::SightRadius(session.spec.human.perception.radius_m() * per_metre(kitchen)),
        ),
    ];
    for location in &kitchen.locations {
        let look = match location.kind {
            LocationKind::Order => pictures::named("card"),
            LocationKind::Hand(Agent::Human) => pictures::named("human_hand"),
            LocationKind::Hand(Agent::Robot) => pictures::named("robot_hand"),
            _ => location.look.as_ref().and_then(pictures::of_look).or_else(|| pictures::named("counter")),
        };
        let at = area(kitchen, location.display, entity_content::FRAME);
        rows.extend(picture(format!("kitchen/furniture/{}", slug(&location.name)), look, &at, 0));
    }
    for agent in Agent::BOTH {
        let own = || kitchen.storages.iter().filter(|storage| storage.agent == agent);
        let entity = format!("kitchen/storage/{}", agent.name());
        let names = own().map(|storage| beside(kitchen, storage));
        rows.push(EntityUpdate::new(&entity, EntityData::Labels(names.collect())));
        for (nth, storage) in own().enumerate() {
            let at = area(kitchen, storage.display, entity_content::FRAME);
            let item = kitchen.content(storage.item).look.as_ref().and_then(pictures::of_look);
            // Not one below the other: the place of a picture would be that of what is below it, too.
            rows.extend(picture(format!("{entity}/shelves/{nth}"), pictures::named("shelf"), &at, 0));
            rows.extend(picture(format!("{entity}/items/{nth}"), item, &square(&at, 1.0, 50.0), 1));
        }
    }
    rows
}

/// Where a label above a place begins whose top is there: not on the display's edge.
fn above(top: f64) -> f64 {
    if top - ABOVE < EDGE { -ABOVE - EDGE } else { top - ABOVE }
}

/// Where a label below a place begins whose bottom is there: not on the display's edge, nor over the place's picture.
fn below(kitchen: &Kitchen, bottom: f64) -> f64 {
    let edge = kitchen.display_m[1] * per_metre(kitchen);
    if bottom + ABOVE > edge { edge + EDGE } else { bottom }
}

/// The name of a storage beside the display; beside the storage, if it is far from the display's edges: storages lie one
/// above the other, and contents of hands beside them.
fn beside(kitchen: &Kitchen, storage: &IngredientStorage) -> SceneLabel {
    let colour = entity_content::agent_colour(storage.agent);
    let SceneArea { left, top, width, height, .. } = area(kitchen, storage.display, colour);
    let is_left = left + width / 2.0 < WIDE / 2.0;
    let x = match is_left {
        true if left < WIDE * AT_EDGE => -OUTSIDE,
        true => left + width + BESIDE,
        false if left + width > WIDE * (1.0 - AT_EDGE) => WIDE + OUTSIDE,
        false => left - BESIDE,
    };
    words_at([x, top + height / 2.0 - ABOVE / 2.0], &storage.label, colour)
}

fn picture(entity: String, png: Option<&'static [u8]>, at: &SceneArea, layer: u8) -> Option<EntityUpdate> {
    let &SceneArea { left, top, width, height, .. } = at;
    Some(EntityUpdate::new(entity, EntityData::Picture(ScenePicture { png: png?, left, top, width, height, layer })))
}

/// A square in an area, so high as a share of the area's height; its centre at this percentage of the height.
fn square(on: &SceneArea, share: f64, centre: f64) -> SceneArea {
    let side = share * on.height;
    let (left, top) = (on.left + (on.width - side) / 2.0, on.top + on.height * centre / 100.0 - side / 2.0);
    SceneArea { left, top, width: side, height: side, ..*on }
}

/// Entity updates with the contents of the locations that differ from the state `before`, or of all locations without
/// `before`.
pub fn contents(kitchen: &Kitchen, before: Option<State>, state: State) -> Vec<EntityUpdate> {
    let locations = (0..kitchen.locations.len()).map(|index| LocationId(index as u8));
    let changed = locations.filter(|&id| before.is_none_or(|before| before.code(id) != state.code(id)));
    changed.flat_map(|id| content(kitchen, before, state, id)).collect()
}

fn content(kitchen: &Kitchen, before: Option<State>, state: State, id: LocationId) -> Vec<EntityUpdate> {
    let location = kitchen.location(id);
    let shown = shown(kitchen, state, id);
    let is_order = location.kind == LocationKind::Order;
    let words = if !is_order && state.content(id).is_empty() { "" } else { kitchen.content_label(state, id) };
    let colour = match location.kind {
        _ if shown.is_empty() => entity_content::FRAME,
        LocationKind::Hand(agent) => entity_content::agent_colour(agent),
        _ => entity_content::CONTENT,
    };
    let entity = format!("kitchen/{}", slug(&location.name));
    let on = area(kitchen, location.display, colour);
    let below = words_at([on.left + on.width / 2.0, below(kitchen, on.top + on.height)], &in_lines(words), colour);
    let label = EntityData::Labels(if words.is_empty() { Vec::new() } else { vec![below] });
    let mut rows = vec![
        EntityUpdate::new(&entity, EntityData::Areas(vec![on.clone()])),
        EntityUpdate::new(format!("{entity}/words"), label),
    ];
    // Stacked as on the participant's page, the last one on top.
    let (share, step) = match shown.len() {
        1 => (1.0, 0.0),
        2 => (0.7, 26.0),
        _ => (0.6, 21.0),
    };
    let first = 50.0 + step * (shown.len() as f64 - 1.0) / 2.0;
    let places: Vec<SceneArea> = (0..shown.len()).map(|nth| square(&on, share, first - step * nth as f64)).collect();
    let were = before.map_or(0, |before| self::shown(kitchen, before, id).len());
    rows.extend(pictured(&format!("{entity}/items"), &shown, &places, were));
    rows
}

/// A stack's words in lines, "cooked rice + nori" above "+ cut shrimp": beside hands lie other things.
fn in_lines(words: &str) -> String {
    let (mut lines, mut length) = (String::new(), 0);
    for (nth, item) in words.split(" + ").enumerate() {
        let letters = item.chars().count() + 3;
        if length > 0 && length + letters > LINE {
            lines += "\n";
            length = 0;
        } else if nth > 0 {
            lines += " ";
        }
        lines += if nth > 0 { "+ " } else { "" };
        lines += item;
        length += letters;
    }
    lines
}

/// Pictures of contents at these places, in entities with numbers; of entities that showed one before, `were` in all, the
/// others become empty.
fn pictured(entity: &str, looks: &[Option<&'static [u8]>], places: &[SceneArea], were: usize) -> Vec<EntityUpdate> {
    let nowhere = SceneArea { left: 0.0, top: 0.0, width: 1.0, height: 1.0, colour: entity_content::FRAME, line: THIN };
    let blank = pictures::named("blank");
    let one = |nth: usize| {
        let png = looks.get(nth).copied().flatten().or(blank);
        picture(format!("{entity}/{nth}"), png, places.get(nth).unwrap_or(&nowhere), 1 + nth as u8)
    };
    (0..looks.len().max(were)).filter_map(one).collect()
}

/// Pictures of what the page shows at a location: of an order's dish, or of the items; `None` for what has no picture.
fn shown(kitchen: &Kitchen, state: State, id: LocationId) -> Vec<Option<&'static [u8]>> {
    if kitchen.location(id).kind == LocationKind::Order {
        return match state.order(id) {
            OrderContent::Dish(dish) => vec![kitchen.dish(dish).look.as_ref().and_then(pictures::of_look)],
            OrderContent::None | OrderContent::Served => Vec::new(),
        };
    }
    match state.content(id) {
        content if content.is_empty() => Vec::new(),
        content => of_items(kitchen, content),
    }
}

fn of_items(kitchen: &Kitchen, content: ContentId) -> Vec<Option<&'static [u8]>> {
    let items = kitchen.content(content).items.iter();
    items.map(|&item| kitchen.content(item).look.as_ref().and_then(pictures::of_look)).collect()
}

/// Entities for the present signal: a highlighted location, a recipe at its order, or proposed presses in the middle of
/// the display.
pub fn shown_signal(session: &Session) -> Vec<EntityUpdate> {
    let kitchen = &session.kitchen;
    let rows = |outlines, words, items: &[Option<&'static [u8]>], places: &[SceneArea]| {
        let mut rows = vec![
            EntityUpdate::new("kitchen/shown", EntityData::Areas(outlines)),
            EntityUpdate::new("kitchen/shown/words", EntityData::Labels(words)),
        ];
        rows.extend(pictured("kitchen/shown/items", items, places, MOST_ITEMS));
        rows
    };
    if let Some(left) = proposals::left(session) {
        let middle = kitchen.display_m.map(|length| length * per_metre(kitchen) / 2.0);
        let words = format!("next: {}", wording::proposal(left));
        return rows(Vec::new(), vec![words_at(middle, &words, entity_content::SIGNAL)], &[], &[]);
    }
    let shown = session.shown.as_ref().and_then(|shown| Some((&shown.signal, shown.location?)));
    let Some((signal, location)) = shown else { return rows(Vec::new(), Vec::new(), &[], &[]) };
    let inner = area(kitchen, kitchen.location(location).display, entity_content::SIGNAL);
    let (gap, line) = (4.0 * THIN, THICK);
    let outer = SceneArea {
        left: inner.left - gap,
        top: inner.top - gap,
        width: inner.width + 2.0 * gap,
        height: inner.height + 2.0 * gap,
        line,
        ..inner
    };
    // Above the location's name.
    let words_for = |words: &str| {
        vec![words_at([inner.left + inner.width / 2.0, above(inner.top) - ABOVE], words, entity_content::SIGNAL)]
    };
    let (Signal::ShowRecipe(_), OrderContent::Dish(dish)) = (signal, session.state.order(location)) else {
        return rows(vec![outer], words_for("look here"), &[], &[]);
    };
    let (items, side) = (of_items(kitchen, kitchen.dish(dish).stack()), inner.height);
    let below = |nth: usize| SceneArea {
        left: inner.left + inner.width / 2.0 + side * (nth as f64 - items.len() as f64 / 2.0),
        top: inner.top + inner.height + ABOVE,
        width: side,
        height: side,
        ..inner
    };
    let places: Vec<SceneArea> = (0..items.len()).map(below).collect();
    let recipe = wording::recipe(session, location).unwrap_or_default();
    rows(vec![outer], words_for(&format!("recipe: {recipe}")), &items, &places)
}

/// Entity update with the gaze point; the area around it is what the participant can read.
pub fn gaze(session: &Session, sample: GazeSample) -> EntityUpdate {
    let [width, height] = session.kitchen.display_m.map(|length| length * per_metre(&session.kitchen));
    let at = [sample.x * width, sample.y * height];
    let colour = if sample.confidence >= MIN_CONFIDENCE { entity_content::GAZE } else { entity_content::QUIET };
    EntityUpdate::new("human/gaze", EntityData::Sight { at, colour })
}
