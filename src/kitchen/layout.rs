//! The layout file: positions on the wall display and on the table, accepted contents, and keys.

use serde::Deserialize;
use toml::Spanned;

use super::action::ButtonColour;
use super::agent::Agent;
use super::location::DisplayArea;

/// The layout file as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutSpec {
    /// Identifier of the kitchen.
    pub name: String,
    /// What screens call the kitchen.
    pub title: String,
    /// The recipe file, relative to the layout file.
    pub recipes: Spanned<String>,
    /// The size of the wall display.
    pub display: WallDisplaySpec,
    /// The table, and the timing of orders.
    pub table: TableSpec,
    /// The orders: at least one.
    pub order: Vec<OrderSpec>,
    /// The hands: one for each agent.
    pub hand: Vec<HandSpec>,
    /// The places where things can be put down.
    pub place: Vec<PlaceSpec>,
    /// Buttons of the recipe file's processes, beside those of the places.
    #[serde(default)]
    pub process: Vec<ProcessButtonSpec>,
    /// The storages, one for each agent and ingredient.
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

/// `[display]` of a layout file: the size of the wall display.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallDisplaySpec {
    /// Width in metres.
    pub width_m: Spanned<f64>,
    /// Height in metres.
    pub height_m: Spanned<f64>,
}

/// `[table]` of a layout file: the height of the table, and the timing of orders.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Height of the table in the frame of the robot's base, in metres.
    pub height_m: f64,
    /// How long an order shows that it was served, in seconds.
    pub served_shown_s: Spanned<f64>,
    /// Time from serving an order to the next order at its location, in seconds.
    pub new_order_after_s: Spanned<f64>,
}

/// A physical button: its place on the table in the frame of the robot's base, and the human's key for it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ButtonSpec {
    /// Its place on the table in metres, in the frame of the robot's base: x towards the human, y to the robot's left.
    pub at_m: Spanned<[f64; 2]>,
    /// The human's key for it; none: the human cannot press it by keyboard.
    #[serde(default)]
    pub key: Option<Spanned<char>>,
    /// The number of the gamepad's button (W3C Gamepad), 0 the first.
    #[serde(default)]
    pub gamepad: Option<Spanned<u8>>,
    /// The colour of its cap, which the display shows beside what the button does.
    #[serde(default)]
    pub colour: Option<ButtonColour>,
    /// The name of its area on the table.
    #[serde(default)]
    pub area: Option<Spanned<String>>,
}

/// `[[order]]` of a layout file: a location that shows which dish is wanted.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrderSpec {
    /// Identifier of the location.
    pub name: Spanned<String>,
    /// Its area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The wizard's key for the signal that shows the recipe of this order.
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    /// The button that serves this order from the plate.
    pub serve: ButtonSpec,
}

/// `[[hand]]` of a layout file: the hand of one agent, which holds at most one content.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandSpec {
    /// Identifier of the location.
    pub name: Spanned<String>,
    /// Whose hand it is.
    pub agent: Spanned<Agent>,
    /// Its area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The wizard's key for the signal about this hand.
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    /// The button that throws away what the hand holds.
    pub trash: ButtonSpec,
}

/// `[[place]]` of a layout file: a location where contents are put down and taken up.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceSpec {
    /// Identifier of the location.
    pub name: Spanned<String>,
    /// Items are stacked here: true for exactly one place.
    #[serde(default)]
    pub stacks: bool,
    /// Orders are served from here: true for exactly one place.
    #[serde(default)]
    pub serves: bool,
    /// "anything", "ingredients", "dishes", or a group of the recipe file.
    pub accepts: Vec<Spanned<String>>,
    /// Its area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The wizard's key for the signal about this place.
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    /// The button that puts the hand's content down here, or takes up what is here.
    pub button: ButtonSpec,
    /// Appearance on the display, a shape and colours.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

/// `[[process]]` of a layout file: the button of a processing step.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessButtonSpec {
    /// The process, as the recipe file names it.
    pub name: Spanned<String>,
    /// Its button.
    pub button: ButtonSpec,
}

/// `[[storage]]` of a layout file: an endless supply of one ingredient.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StorageSpec {
    /// The agent who can take from it.
    pub agent: Agent,
    /// The ingredient, as the recipe file names it.
    pub ingredient: Spanned<String>,
    /// Its area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The button that takes one piece into the hand.
    pub button: ButtonSpec,
}
