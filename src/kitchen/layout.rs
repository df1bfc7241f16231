//! The layout file: positions on the wall display and on the table, accepted contents, and keys.

use serde::Deserialize;
use toml::Spanned;

use super::agent::Agent;
use super::location::DisplayArea;

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

/// Whether two characters are on the same key, ignoring case.
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
    /// Appearance on the display, a shape and colours.
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
