//! The scene: what stays the same on the participant's display during a recording, namely areas, pictures, names and
//! buttons.

use std::collections::BTreeMap;

use serde::Serialize;

use super::displayed_item::{SceneElement, spot};
use super::page_language::DisplayWords;
use tomcom_core::gaze::tags::DisplayTags;
use tomcom_core::kitchen::{Agent, Appearance, ButtonAction, ButtonColour, Kitchen, LocationKind};
use tomcom_session::settings::GazeSource;
use tomcom_session::wall_display::DisplayedNames;
use tomcom_session::{Session, SessionSpec};

/// Area on the display: left, top, width and height in fractions of the display's size, with the origin at the top
/// left.
type Rect = [f64; 4];

/// The constant part of the participant's display, which the page builds once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayScene {
    pub title: String,
    /// Language code for the browser, such as "en".
    pub language: String,
    /// Width and height of the display in metres.
    pub display_m: [f64; 2],
    /// Locations on the display, in the order of [`super::DisplayContent::contents`].
    pub locations: Vec<DisplayLocation>,
    pub storages: Vec<DisplayStorage>,
    /// Index of the location whose content is served.
    pub plate: usize,
    pub buttons: Vec<DisplayButton>,
    /// AprilTags in the corners of the display; empty if the session wants no tags or there is no room for them.
    pub tags: Vec<TagPicture>,
    pub items: BTreeMap<String, LabelledAppearance>,
    /// Appearance of dishes, by their names; their recipes are not included.
    pub dishes: BTreeMap<String, LabelledAppearance>,
    pub words: BTreeMap<String, String>,
    pub names: DisplayedNames,
    pub keys: bool,
    /// How the display shows the robot: "none", "hand" or "arm".
    pub arm: &'static str,
    pub flash: bool,
    /// Whether the page has room for the time that the trial still has.
    pub clock: bool,
    pub served: bool,
    /// Whether the page makes a sound at a press without effect and at a signal.
    pub sound: bool,
    /// Whether the page speaks signals.
    pub voice: bool,
    /// Whether the plan's tutorial is in another language than the page, since there is none in the page's.
    pub foreign_tutorial: bool,
    pub pointer: bool,
}

/// Picture and area of an AprilTag.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TagPicture {
    pub area: Rect,
    /// Rows of the tag's cells from the top, "#" for black cells.
    pub rows: Vec<String>,
}

/// A location on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayLocation {
    pub name: String,
    pub label: String,
    /// The name within a sentence, with its article where the language has one.
    pub said: String,
    /// Kind of the location: "order", "human_hand", "robot_hand" or "place".
    pub kind: &'static str,
    pub area: Rect,
    /// Appearance of the location, if the layout file sets one.
    pub look: Option<Appearance>,
}

/// A storage on the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayStorage {
    /// Agent who can take the item from the storage.
    pub agent: Agent,
    /// Item that the storage holds, by its name in [`DisplayScene::items`].
    pub item: String,
    pub label: String,
    pub area: Rect,
}

/// A button of the human, as the participant's display shows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayButton {
    pub name: String,
    pub label: String,
    pub key: Option<char>,
    pub gamepad: Option<u8>,
    pub colour: Option<ButtonColour>,
    pub area: Option<String>,
    /// What a press of the button does, in a word: "take", "use", "process", "trash" or "serve".
    pub does: &'static str,
    /// Index of the location at which the button acts; for a storage, index in [`DisplayScene::storages`].
    pub at: usize,
}

/// Appearance and name of an item or a dish.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelledAppearance {
    /// Name of the item or dish in the display's language.
    pub label: String,
    /// Appearance of the item or dish, if a file of the kitchen sets one.
    pub look: Option<Appearance>,
}

/// Creates the constant part of the participant's display in a session.
pub fn scene(session: &Session) -> DisplayScene {
    let (kitchen, spec) = (&session.kitchen, &session.spec);
    let words = DisplayWords::for_kitchen(kitchen, &spec.display);
    let rect = |area: tomcom_core::kitchen::DisplayArea| [area.x, area.y, area.w, area.h];
    let spot = |location: &tomcom_core::kitchen::Location| DisplayLocation {
        name: location.name.clone(),
        label: words.of_name(&location.name),
        said: words.in_sentence(&location.name),
        kind: kind(location.kind),
        area: rect(location.display),
        look: location.look.clone(),
    };
    let shelf = |storage: &tomcom_core::kitchen::IngredientStorage| DisplayStorage {
        agent: storage.agent,
        item: kitchen.content(storage.item).name.clone(),
        label: words.of_name(&storage.label),
        area: rect(storage.display),
    };
    let items = kitchen.contents.iter().filter(|content| content.items.len() == 1);
    let picture = |name: &str, look: &Option<Appearance>| {
        (name.to_string(), LabelledAppearance { label: words.of_name(name), look: look.clone() })
    };
    DisplayScene {
        title: words.of_name(&kitchen.title),
        language: words.language.clone(),
        display_m: kitchen.display_m,
        locations: kitchen.locations.iter().map(spot).collect(),
        storages: kitchen.storages.iter().map(shelf).collect(),
        plate: kitchen.plate.index(),
        buttons: knobs(kitchen, spec, &words),
        tags: if spec.display.tags { marks(kitchen) } else { Vec::new() },
        items: items.map(|item| picture(&item.name, &item.look)).collect(),
        dishes: kitchen.dishes.iter().map(|dish| picture(&dish.name, &dish.look)).collect(),
        words: words.of_page(),
        names: spec.display.names,
        keys: spec.display.keys,
        arm: spec.display.arm.name(),
        flash: spec.display.flash,
        clock: spec.display.clock,
        served: spec.display.served,
        sound: spec.display.sound,
        voice: spec.display.voice,
        foreign_tutorial: session.foreign_tutorial().is_some(),
        pointer: has_pointer(spec),
    }
}

fn has_pointer(spec: &SessionSpec) -> bool {
    spec.participant.gaze == GazeSource::Mouse
}

fn kind(kind: LocationKind) -> &'static str {
    match kind {
        LocationKind::Order => "order",
        LocationKind::Hand(Agent::Human) => "human_hand",
        LocationKind::Hand(Agent::Robot) => "robot_hand",
        LocationKind::Place => "place",
    }
}

fn marks(kitchen: &Kitchen) -> Vec<TagPicture> {
    let Ok(tags) = DisplayTags::place(kitchen) else { return Vec::new() };
    let row = |cells: &[bool]| cells.iter().map(|is_black| if *is_black { '#' } else { ' ' }).collect();
    let mark = |tag: &tomcom_core::gaze::tags::DisplayTag| TagPicture {
        area: [tag.area.x, tag.area.y, tag.area.w, tag.area.h],
        rows: tag.cells().iter().map(|cells| row(cells)).collect(),
    };
    tags.corners.iter().map(mark).collect()
}

fn knobs(kitchen: &Kitchen, spec: &SessionSpec, words: &DisplayWords) -> Vec<DisplayButton> {
    let knob = |button: &tomcom_core::kitchen::Button| {
        let does = match button.action {
            ButtonAction::Take(_) => "take",
            ButtonAction::Use(_) => "use",
            ButtonAction::Process(_) => "process",
            ButtonAction::Trash => "trash",
            ButtonAction::Serve(_) => "serve",
        };
        let place = spot(kitchen, Agent::Human, button.action);
        let (SceneElement::Location(at) | SceneElement::Storage(at)) = place;
        let label = match place {
            SceneElement::Storage(shelf) => words.filled("do take", &words.of_name(&kitchen.storages[shelf].label)),
            SceneElement::Location(_) if does == "serve" => words.of_name("serve"),
            SceneElement::Location(_) => words.of_name(&button.name),
        };
        let (name, area) = (button.name.clone(), button.area.clone());
        let &tomcom_core::kitchen::Button { key, gamepad, colour, .. } = button;
        // Colours are those of caps: whoever presses keys has none before them.
        let colour = colour.filter(|_| !spec.display.keys);
        DisplayButton { name, label, key, gamepad, colour, area, does, at }
    };
    kitchen.buttons[Agent::Human.index()].iter().map(knob).collect()
}
