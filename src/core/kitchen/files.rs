//! The files of a kitchen, as they are written.
//!
//! The layout file has positions on the wall display and on the table, accepted contents and keys. The recipe file has
//! ingredients with states and look-alikes, processing steps, the stacking rule, the menu, and possible deviations of a
//! remembered recipe.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::parts::{Agent, ButtonColour, DisplayArea};
use crate::base::number_range::{NumberRange, OutOfRange, range_of};

/// The layout file of a kitchen, as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutSpec {
    pub(crate) name: String,
    pub(crate) title: String,
    /// Path of the recipe file, relative to the layout file.
    pub recipes: Spanned<String>,
    pub(crate) display: WallDisplaySpec,
    pub(crate) table: TabletopSpec,
    pub(crate) order: Vec<OrderSpec>,
    pub(crate) hand: Vec<HandSpec>,
    /// The places where agents can put things down.
    pub(crate) place: Vec<PlaceSpec>,
    /// Buttons for processing steps of the recipe file, beside the buttons of the places.
    #[serde(default)]
    pub(crate) process: Vec<ProcessButtonSpec>,
    pub(crate) storage: Vec<StorageSpec>,
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

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WallDisplaySpec {
    pub(crate) width_m: f64,
    pub(crate) height_m: f64,
}

/// `[table]` of a layout file: the height of the table, and the timing of orders.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TabletopSpec {
    /// Height of the table in the frame of the robot's base, in metres.
    pub(crate) height_m: f64,
    pub(crate) served_shown_s: f64,
    /// Time from serving an order to the next order at its location, in seconds.
    pub(crate) new_order_after_s: f64,
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
    pub(crate) key: Option<Spanned<char>>,
    /// Number of the button on the human's gamepad (W3C Gamepad API), counted from 0.
    #[serde(default)]
    pub(crate) gamepad: Option<Spanned<u8>>,
    /// The colour of the button's cap, which the display shows beside the button's action.
    #[serde(default)]
    pub(crate) colour: Option<ButtonColour>,
    #[serde(default)]
    pub(crate) area: Option<Spanned<String>>,
}

/// `[[order]]` of a layout file: a location that shows which dish is ordered.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrderSpec {
    pub(crate) name: Spanned<String>,
    pub(crate) display: Spanned<DisplayArea>,
    #[serde(default)]
    pub(crate) signal: Option<Spanned<char>>,
    pub(crate) serve: ButtonSpec,
}

/// `[[hand]]` of a layout file: the hand of one agent, which holds at most one content.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HandSpec {
    pub(crate) name: Spanned<String>,
    pub(crate) agent: Spanned<Agent>,
    pub(crate) display: Spanned<DisplayArea>,
    #[serde(default)]
    pub(crate) signal: Option<Spanned<char>>,
    pub(crate) trash: ButtonSpec,
}

/// `[[place]]` of a layout file: a location where contents are put down and picked up.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlaceSpec {
    pub(crate) name: Spanned<String>,
    /// Whether items are stacked at this place: true for exactly one place.
    #[serde(default)]
    pub(crate) stacks: bool,
    /// Whether orders are served from this place: true for exactly one place.
    #[serde(default)]
    pub(crate) serves: bool,
    /// Contents that the place accepts: "anything", "ingredients", "dishes", or a group of the recipe file.
    pub(crate) accepts: Vec<Spanned<String>>,
    pub(crate) display: Spanned<DisplayArea>,
    #[serde(default)]
    pub(crate) signal: Option<Spanned<char>>,
    /// The button that puts the hand's content down at this place, or picks up the content of the place.
    pub(crate) button: ButtonSpec,
    #[serde(default)]
    pub(crate) look: Option<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProcessButtonSpec {
    pub(crate) name: Spanned<String>,
    pub(crate) button: ButtonSpec,
}

/// `[[storage]]` of a layout file: an endless supply of one ingredient.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StorageSpec {
    pub(crate) agent: Agent,
    pub(crate) ingredient: Spanned<String>,
    pub(crate) display: DisplayArea,
    pub(crate) button: ButtonSpec,
}

const SECONDS: &str = "s";
const SHOWN: &str = "less is not seen, more is as long as a trial";
const FRACTION: &str = "fractions of the display, which ends at 1";
const SIDE: &str = "less is not seen, more does not fit on the display";

/// The allowed ranges of the numbers in layout files. Those of session files are in `session::ranges`; recipe files have
/// no numbers.
pub const LAYOUT_RANGES: [NumberRange; 11] = [
    NumberRange::real("display.width_m", [0.1, 20.0], "m", "from a telephone to a wall"),
    NumberRange::real("display.height_m", [0.1, 20.0], "m", "from a telephone to a wall"),
    NumberRange::real("table.height_m", [-2.0, 2.0], "m", "the robot does not reach further up or down"),
    NumberRange::real("table.served_shown_s", [0.1, 3_600.0], SECONDS, SHOWN),
    NumberRange::real("table.new_order_after_s", [0.1, 3_600.0], SECONDS, SHOWN),
    NumberRange::real("*.display.x", [0.0, 1.0], "", FRACTION),
    NumberRange::real("*.display.y", [0.0, 1.0], "", FRACTION),
    NumberRange::real("*.display.w", [0.001, 1.0], "", SIDE),
    NumberRange::real("*.display.h", [0.001, 1.0], "", SIDE),
    NumberRange::real("*.*.at_m", [-5.0, 5.0], "m", "buttons are on one table, around the robot's base"),
    NumberRange::whole("*.*.gamepad", [0.0, 63.0], "", "no gamepad or button box has more buttons"),
];

/// Checks that all numbers in the text of a layout file lie within their allowed ranges. Other errors of the text are
/// ignored.
///
/// # Errors
/// The first number outside of its allowed range, with its position.
pub fn check_layout(text: &str) -> Result<(), OutOfRange> {
    let Ok(document) = DeTable::parse(text) else { return Ok(()) };
    in_table(document.get_ref(), "")
}

fn in_table(table: &DeTable, path: &str) -> Result<(), OutOfRange> {
    table.iter().try_for_each(|(name, value)| {
        let inner = if path.is_empty() { name.get_ref().to_string() } else { format!("{path}.{}", name.get_ref()) };
        in_value(value, &inner)
    })
}

fn in_value(value: &Spanned<DeValue>, path: &str) -> Result<(), OutOfRange> {
    let number = match value.get_ref() {
        DeValue::Table(table) => return in_table(table, path),
        DeValue::Array(values) => return values.iter().try_for_each(|value| in_value(value, path)),
        DeValue::Float(number) => number.as_str().parse().unwrap_or(f64::NAN),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).map_or(f64::NAN, |n| n as f64),
        _ => return Ok(()),
    };
    let Some(range) = range_of(&LAYOUT_RANGES, path).filter(|range| !range.holds(number)) else { return Ok(()) };
    Err(OutOfRange { place: Some(value.span()), ..range.violation(path, number) })
}

/// The recipe file of a kitchen, as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecipesSpec {
    /// Identifier of the recipe file's menu.
    pub name: String,
    pub(crate) ingredient: Vec<IngredientSpec>,
    #[serde(default)]
    pub(crate) process: Vec<ProcessingStepSpec>,
    /// The slots of a dish: a dish has at most one item from each slot.
    pub(crate) slot: Vec<SlotSpec>,
    /// Names for sets of items that places can accept.
    #[serde(default)]
    pub(crate) group: Vec<GroupSpec>,
    pub(crate) dish: Vec<DishSpec>,
    #[serde(default)]
    pub(crate) deviation: Vec<DeviationSpec>,
    /// Words of screens for items, ingredients and dishes: by language, then by name.
    #[serde(default)]
    pub(crate) words: BTreeMap<String, BTreeMap<String, Spanned<String>>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct IngredientSpec {
    pub(crate) name: Spanned<String>,
    /// The states of the ingredient in order; a storage supplies the ingredient in the first state. Empty for an
    /// ingredient with a single state.
    #[serde(default)]
    pub(crate) states: Vec<Spanned<String>>,
    #[serde(default)]
    pub(crate) looks_like: Vec<Spanned<String>>,
    #[serde(default)]
    pub(crate) look: Vec<Spanned<String>>,
}

/// `[[process]]` of a recipe file: a processing step, in which a press turns one item into another.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProcessingStepSpec {
    pub(crate) name: Spanned<String>,
    pub(crate) at: Spanned<String>,
    pub(crate) agents: Vec<Agent>,
    pub(crate) steps: Vec<ItemConversionSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ItemConversionSpec {
    pub(crate) from: Spanned<String>,
    pub(crate) to: Spanned<String>,
}

/// `[[slot]]` of a recipe file: items that have the same role in a dish, such as toppings.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SlotSpec {
    pub(crate) name: Spanned<String>,
    /// The items of the slot, as "ingredient state"; each item is in at most one slot.
    pub(crate) items: Vec<Spanned<String>>,
}

/// `[[group]]` of a recipe file: a name for items that a place accepts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GroupSpec {
    pub(crate) name: Spanned<String>,
    /// The items that belong to the group, as "ingredient state"; a stack belongs to the group if each of its items
    /// does.
    pub(crate) made_of: Vec<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DishSpec {
    pub(crate) name: Spanned<String>,
    /// The items of the dish, as "ingredient state": the true recipe.
    pub(crate) items: Spanned<Vec<Spanned<String>>>,
    /// Appearance of the finished dish on the display, which must not reveal the recipe.
    #[serde(default)]
    pub(crate) look: Option<Spanned<String>>,
}

/// `[[deviation]]` of a recipe file: how people misremember the recipes of some dishes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeviationSpec {
    /// The deviation applies to dishes with at least one of these items.
    pub(crate) dishes_with: Vec<Spanned<String>>,
    pub(crate) combine: DeviationCombinationRule,
    pub(crate) slots: Vec<DeviationSlotSpec>,
}

/// A slot of a deviation, with the items that people may remember instead.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeviationSlotSpec {
    pub(crate) slot: Spanned<String>,
    pub(crate) items: Vec<Spanned<String>>,
}

/// How deviations of a remembered recipe in several slots may be combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum DeviationCombinationRule {
    /// At most one slot deviates from the true recipe.
    #[serde(rename = "one at a time")]
    OneAtATime,
    /// Every combination of the slots' items can be remembered.
    #[serde(rename = "all")]
    All,
}
