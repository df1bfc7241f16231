//! What stays the same during a recording: where things are, how they look, what the buttons are called.

use std::collections::BTreeMap;

use serde::Serialize;

use super::page_language::DisplayWords;
use crate::gaze::tags::DisplayTags;
use crate::kitchen::{Agent, Appearance, ButtonAction, ButtonColour, Kitchen, LocationKind};
use crate::session::settings::GazeSource;
use crate::session::wall_display::{DisplayedArm, Names};
use crate::session::{Session, SessionSpec};

/// Where something is on the display: fractions of its width and height, the origin at the top left.
type Rect = [f64; 4];

/// The display as it is built once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayScene {
    /// What the page calls the kitchen.
    pub title: String,
    /// "en": for the browser.
    pub language: String,
    /// Width and height in metres.
    pub display_m: [f64; 2],
    /// In the order of [`super::DisplayUpdate::contents`].
    pub locations: Vec<DisplayLocation>,
    /// The storages with their areas and pictures.
    pub storages: Vec<DisplayStorage>,
    /// The human's.
    pub buttons: Vec<DisplayButton>,
    /// AprilTags: none, if the session wants none or there is no room for them.
    pub tags: Vec<TagPicture>,
    /// How items look, by their names.
    pub items: BTreeMap<String, LabelledAppearance>,
    /// How dishes look, by their names. No dish says here what it is made of.
    pub dishes: BTreeMap<String, LabelledAppearance>,
    /// The page's own words.
    pub words: BTreeMap<String, String>,
    /// Names in the display's language.
    pub names: Names,
    /// The page shows the keys of the buttons.
    pub keys: bool,
    /// How the robot is shown: "none", "hand", "arm".
    pub arm: &'static str,
    /// New events are marked by a flash, for recordings with a camera.
    pub flash: bool,
    /// The page has room for the time that the trial still has.
    pub clock: bool,
    /// The page has room for the number of served orders.
    pub served: bool,
    /// A press without effect and a signal are heard.
    pub sound: bool,
    /// The mouse pointer stands for the gaze.
    pub pointer: bool,
}

/// An AprilTag.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TagPicture {
    /// Its area with its white border.
    pub area: Rect,
    /// Rows of cells from the top, "#" for black cells.
    pub rows: Vec<String>,
}

/// A location.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayLocation {
    /// The location's name in the layout file.
    pub name: String,
    /// Its name in the display's language.
    pub label: String,
    /// "order", "human_hand", "robot_hand", "place".
    pub kind: &'static str,
    /// Its area.
    pub area: Rect,
    /// How it is drawn, if its file says so.
    pub look: Option<Appearance>,
}

/// A storage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayStorage {
    /// The agent who can take from it.
    pub agent: Agent,
    /// The item that it gives, by its name in [`DisplayScene::items`].
    pub item: String,
    /// Its name in the display's language.
    pub label: String,
    /// Its area.
    pub area: Rect,
}

/// A button of the human.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayButton {
    /// The button's name in logs.
    pub name: String,
    /// Its name in the display's language.
    pub label: String,
    /// Its key on the keyboard.
    pub key: Option<char>,
    /// The number of its gamepad button.
    pub gamepad: Option<u8>,
    /// The colour of its cap on the table.
    pub colour: Option<ButtonColour>,
    /// The name of its area on the table.
    pub area: Option<String>,
    /// What it does: "take", "use", "process", "trash", "serve".
    pub does: &'static str,
    /// The location that it is at; of a storage, its place in [`DisplayScene::storages`].
    pub at: usize,
}

/// How something looks, and what it is called.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelledAppearance {
    /// The name in the display's language.
    pub label: String,
    /// How it is drawn, if its file says so.
    pub look: Option<Appearance>,
}

/// The scene of a session.
pub fn scene(session: &Session) -> DisplayScene {
    let (kitchen, spec) = (&session.kitchen, &session.spec);
    let words = DisplayWords::for_kitchen(kitchen, &spec.display);
    let rect = |area: crate::kitchen::DisplayArea| [area.x, area.y, area.w, area.h];
    let spot = |location: &crate::kitchen::Location| DisplayLocation {
        name: location.name.clone(),
        label: words.of_name(&location.name),
        kind: kind(location.kind),
        area: rect(location.display),
        look: location.look.clone(),
    };
    let shelf = |storage: &crate::kitchen::Storage| DisplayStorage {
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
        buttons: knobs(kitchen, &words),
        tags: if spec.display.tags { marks(kitchen) } else { Vec::new() },
        items: items.map(|item| picture(&item.name, &item.look)).collect(),
        dishes: kitchen.dishes.iter().map(|dish| picture(&dish.name, &dish.look)).collect(),
        words: words.of_page(),
        names: spec.display.names,
        keys: spec.display.keys,
        arm: spec.display.arm.unwrap_or(DisplayedArm::None).name(),
        flash: spec.display.flash,
        clock: spec.display.clock,
        served: spec.display.shows_served(),
        sound: spec.display.sound,
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
    let mark = |tag: &crate::gaze::tags::DisplayTag| TagPicture {
        area: [tag.area.x, tag.area.y, tag.area.w, tag.area.h],
        rows: tag.cells().iter().map(|cells| row(cells)).collect(),
    };
    tags.corners.iter().map(mark).collect()
}

fn knobs(kitchen: &Kitchen, words: &DisplayWords) -> Vec<DisplayButton> {
    let hand = kitchen.hands[Agent::Human.index()].index();
    let shelf = |item| {
        let is_it = |storage: &crate::kitchen::Storage| storage.agent == Agent::Human && storage.item == item;
        kitchen.storages.iter().position(is_it).unwrap_or_default()
    };
    let knob = |button: &crate::kitchen::Button| {
        let (does, at) = match button.action {
            ButtonAction::Take(item) => ("take", shelf(item)),
            ButtonAction::Use(location) => ("use", location.index()),
            ButtonAction::Process(process) => {
                ("process", kitchen.processes[usize::from(process)].place.map_or(hand, |place| place.index()))
            }
            ButtonAction::Trash => ("trash", hand),
            ButtonAction::Serve(order) => ("serve", order.index()),
        };
        let label = match does {
            "serve" => words.of_name("serve"),
            _ => words.of_name(&button.name),
        };
        let (name, area) = (button.name.clone(), button.area.clone());
        let &crate::kitchen::Button { key, gamepad, colour, .. } = button;
        DisplayButton { name, label, key, gamepad, colour, area, does, at }
    };
    kitchen.buttons[Agent::Human.index()].iter().map(knob).collect()
}
