//! The layout file of a kitchen: positions on the wall display and on the table, accepted contents, and keys.

use serde::Deserialize;
use toml::Spanned;

use super::action::ButtonColour;
use super::agent::Agent;
use super::location::DisplayArea;

/// The layout file of a kitchen, as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutSpec {
    /// Identifier of the kitchen's layout.
    pub name: String,
    /// The kitchen's title on screens.
    pub title: String,
    /// Path of the recipe file, relative to the layout file.
    pub recipes: Spanned<String>,
    /// The size of the wall display.
    pub display: WallDisplaySpec,
    /// The height of the table, and the timing of orders.
    pub table: TabletopSpec,
    /// The order locations of the kitchen, at least one.
    pub order: Vec<OrderSpec>,
    /// The hands: one for each agent.
    pub hand: Vec<HandSpec>,
    /// The places where agents can put things down.
    pub place: Vec<PlaceSpec>,
    /// Buttons for processing steps of the recipe file, beside the buttons of the places.
    #[serde(default)]
    pub process: Vec<ProcessButtonSpec>,
    /// The storages, one for each agent and ingredient.
    pub storage: Vec<StorageSpec>,
}

impl LayoutSpec {
    /// The locations about which a signal can be sent, each with the wizard's key for that signal.
    pub fn signal_keys(&self) -> impl Iterator<Item = (&str, &Spanned<char>)> {
        let orders = self.order.iter().map(|order| (&order.name, &order.signal));
        let hands = self.hand.iter().map(|hand| (&hand.name, &hand.signal));
        let places = self.place.iter().map(|place| (&place.name, &place.signal));
        let all = orders.chain(hands).chain(places);
        all.filter_map(|(name, key)| Some((name.get_ref().as_str(), key.as_ref()?)))
    }

    /// The buttons of both agents, as the layout file has them.
    pub fn buttons(&self) -> impl Iterator<Item = &ButtonSpec> {
        let orders = self.order.iter().map(|order| &order.serve);
        let hands = self.hand.iter().map(|hand| &hand.trash);
        let places = self.place.iter().map(|place| &place.button);
        let processes = self.process.iter().map(|process| &process.button);
        let storages = self.storage.iter().map(|storage| &storage.button);
        orders.chain(hands).chain(places).chain(processes).chain(storages)
    }

    /// The keys on the human's keyboard that press buttons.
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
    /// Width of the wall display in metres.
    pub width_m: Spanned<f64>,
    /// Height of the wall display in metres.
    pub height_m: Spanned<f64>,
}

/// `[table]` of a layout file: the height of the table, and the timing of orders.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TabletopSpec {
    /// Height of the table in the frame of the robot's base, in metres.
    pub height_m: f64,
    /// Time for which an order is shown as served, in seconds.
    pub served_shown_s: Spanned<f64>,
    /// Time from serving an order to the next order at its location, in seconds.
    pub new_order_after_s: Spanned<f64>,
}

/// A physical button: its position on the table in the frame of the robot's base, and the human's key for the button.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ButtonSpec {
    /// Position of the button on the table in metres, in the frame of the robot's base: x towards the human, y to the
    /// robot's left.
    pub at_m: Spanned<[f64; 2]>,
    /// The key on the human's keyboard that presses this button; `None`: the human cannot press it by keyboard.
    #[serde(default)]
    pub key: Option<Spanned<char>>,
    /// Number of the button on the human's gamepad (W3C Gamepad API), counted from 0.
    #[serde(default)]
    pub gamepad: Option<Spanned<u8>>,
    /// The colour of the button's cap, which the display shows beside the button's action.
    #[serde(default)]
    pub colour: Option<ButtonColour>,
    /// The name of the button's area on the table.
    #[serde(default)]
    pub area: Option<Spanned<String>>,
}

/// `[[order]]` of a layout file: a location that shows which dish is ordered.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrderSpec {
    /// Identifier of the order location.
    pub name: Spanned<String>,
    /// The order's area on the wall display.
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
    /// Identifier of the hand's location.
    pub name: Spanned<String>,
    /// The agent to whom the hand belongs.
    pub agent: Spanned<Agent>,
    /// The hand's area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The wizard's key for the signal about this hand.
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    /// The button that throws away what the hand holds.
    pub trash: ButtonSpec,
}

/// `[[place]]` of a layout file: a location where contents are put down and picked up.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceSpec {
    /// Identifier of the place.
    pub name: Spanned<String>,
    /// Whether items are stacked at this place: true for exactly one place.
    #[serde(default)]
    pub stacks: bool,
    /// Whether orders are served from this place: true for exactly one place.
    #[serde(default)]
    pub serves: bool,
    /// Contents that the place accepts: "anything", "ingredients", "dishes", or a group of the recipe file.
    pub accepts: Vec<Spanned<String>>,
    /// The place's area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The wizard's key for the signal about this place.
    #[serde(default)]
    pub signal: Option<Spanned<char>>,
    /// The button that puts the hand's content down at this place, or picks up the content of the place.
    pub button: ButtonSpec,
    /// Appearance of the place on the display: a shape and colours.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

/// `[[process]]` of a layout file: the button of a processing step.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessButtonSpec {
    /// The processing step, as the recipe file names it.
    pub name: Spanned<String>,
    /// The button of the processing step.
    pub button: ButtonSpec,
}

/// `[[storage]]` of a layout file: an endless supply of one ingredient.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StorageSpec {
    /// The agent who can take from the storage.
    pub agent: Agent,
    /// The ingredient, as the recipe file names it.
    pub ingredient: Spanned<String>,
    /// The storage's area on the wall display.
    pub display: Spanned<DisplayArea>,
    /// The button that takes one piece from the storage into the hand.
    pub button: ButtonSpec,
}
