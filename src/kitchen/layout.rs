//! The layout file: where things are on the wall display and on the table, what they accept, and which keys they have.

use serde::Deserialize;
use toml::Spanned;

use super::action::Agent;
use super::content::ContentId;
use super::look::Appearance;

/// An index into [`super::Kitchen::locations`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LocationId(pub u8);

impl LocationId {
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// An area of the wall display, as fractions of its width and height; the origin is at the top left, y points down.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisplayArea {
    pub x: f64,
    pub y: f64,
    pub w: f64,
    pub h: f64,
}

impl DisplayArea {
    /// The centre, in the same fractions.
    pub fn centre(self) -> [f64; 2] {
        [self.x + self.w / 2.0, self.y + self.h / 2.0]
    }

    /// The distance in metres from a display point (fractions) to this area, 0 inside, on a display of `display_m`.
    pub fn distance_m(self, point: [f64; 2], display_m: [f64; 2]) -> f64 {
        let outside = |low: f64, length: f64, value: f64| (low - value).max(value - low - length).max(0.0);
        let dx = outside(self.x, self.w, point[0]) * display_m[0];
        let dy = outside(self.y, self.h, point[1]) * display_m[1];
        dx.hypot(dy)
    }

    /// The least distance in metres between two areas, 0 if they touch.
    pub fn gap_m(self, other: DisplayArea, display_m: [f64; 2]) -> f64 {
        let gap = |a: f64, a_len: f64, b: f64, b_len: f64| (b - a - a_len).max(a - b - b_len).max(0.0);
        let dx = gap(self.x, self.w, other.x, other.w) * display_m[0];
        let dy = gap(self.y, self.h, other.y, other.h) * display_m[1];
        dx.hypot(dy)
    }
}

/// What kind of place a location is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocationKind {
    /// Shows the wanted dish.
    Order,
    /// The hand of an agent.
    Hand(Agent),
    /// Holds one item; items are stacked there if it is the board.
    Place,
}

/// A location whose content a person can be wrong about.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    pub name: String,
    pub kind: LocationKind,
    /// Its area on the wall display.
    pub display: DisplayArea,
    /// The wizard's key for the signal about it.
    pub signal_key: Option<char>,
    /// How the display draws it, if its file says so.
    pub look: Option<Appearance>,
}

impl Location {
    /// The name as it is written on screens: "assembly board".
    pub fn label(&self) -> String {
        self.name.replace('_', " ")
    }
}

/// An endless array of one ingredient, within reach of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Storage {
    pub agent: Agent,
    pub item: ContentId,
    /// The ingredient's name.
    pub label: String,
    pub display: DisplayArea,
}

/// The layout file as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutSpec {
    pub name: String,
    pub title: String,
    /// The recipe file, relative to the layout file.
    pub recipes: Spanned<String>,
    pub display: WallDisplaySpec,
    pub table: TableSpec,
    pub order: Vec<OrderSpec>,
    pub hand: Vec<HandSpec>,
    pub place: Vec<PlaceSpec>,
    #[serde(default)]
    pub process: Vec<ProcessButtonSpec>,
    pub storage: Vec<StorageSpec>,
}

impl LayoutSpec {
    /// The locations with a signal, and the wizard's key for it.
    pub fn signal_keys(&self) -> impl Iterator<Item = (&str, &Spanned<char>)> {
        let orders = self.order.iter().map(|order| (&order.name, &order.signal));
        let hands = self.hand.iter().map(|hand| (&hand.name, &hand.signal));
        let places = self.place.iter().map(|place| (&place.name, &place.signal));
        let all = orders.chain(hands).chain(places);
        all.filter_map(|(name, key)| Some((name.get_ref().as_str(), key.as_ref()?)))
    }

    /// The buttons of both agents.
    pub fn buttons(&self) -> impl Iterator<Item = &ButtonSpec> {
        let orders = self.order.iter().map(|order| &order.serve);
        let hands = self.hand.iter().map(|hand| &hand.trash);
        let places = self.place.iter().map(|place| &place.button);
        let processes = self.process.iter().map(|process| &process.button);
        let storages = self.storage.iter().map(|storage| &storage.button);
        orders.chain(hands).chain(places).chain(processes).chain(storages)
    }

    /// The human's keys for buttons.
    pub fn button_keys(&self) -> impl Iterator<Item = &Spanned<char>> {
        self.buttons().filter_map(|button| button.key.as_ref())
    }
}

/// Whether two characters are on the same key: capitals are on that of their small letters.
pub fn is_same_key(a: char, b: char) -> bool {
    a.to_lowercase().eq(b.to_lowercase())
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallDisplaySpec {
    pub width_m: Spanned<f64>,
    pub height_m: Spanned<f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    pub height_m: f64,
    pub served_shown_s: Spanned<f64>,
    pub new_order_after_s: Spanned<f64>,
}

/// A physical button: its place on the table in the frame of the robot's base, and the human's key for it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ButtonSpec {
    pub at_m: Spanned<[f64; 2]>,
    #[serde(default)]
    pub key: Option<Spanned<char>>,
    /// The number of the gamepad's button (W3C Gamepad), 0 the first.
    #[serde(default)]
    pub gamepad: Option<Spanned<u8>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrderSpec {
    pub name: Spanned<String>,
    pub display: Spanned<DisplayArea>,
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    pub serve: ButtonSpec,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandSpec {
    pub name: Spanned<String>,
    pub agent: Spanned<Agent>,
    pub display: Spanned<DisplayArea>,
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    pub trash: ButtonSpec,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceSpec {
    pub name: Spanned<String>,
    #[serde(default)]
    pub stacks: bool,
    #[serde(default)]
    pub serves: bool,
    /// "anything", "ingredients", "dishes", or a group of the recipe file.
    pub accepts: Vec<Spanned<String>>,
    pub display: Spanned<DisplayArea>,
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    pub button: ButtonSpec,
    /// How the display draws it, a shape and colours.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessButtonSpec {
    pub name: Spanned<String>,
    pub button: ButtonSpec,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StorageSpec {
    pub agent: Agent,
    pub ingredient: Spanned<String>,
    pub display: Spanned<DisplayArea>,
    pub button: ButtonSpec,
}
