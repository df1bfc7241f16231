//! The recipe file of a kitchen: ingredients with states and look-alikes, processing steps, the stacking rule, the
//! menu, and possible deviations of a remembered recipe.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::agent::Agent;

/// The recipe file of a kitchen, as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecipesSpec {
    /// Identifier of the recipe file's menu.
    pub name: String,
    /// The ingredients of the kitchen with their possible states.
    pub ingredient: Vec<IngredientSpec>,
    /// The processing steps, such as cutting.
    #[serde(default)]
    pub process: Vec<ProcessingStepSpec>,
    /// The slots of a dish: a dish has at most one item from each slot.
    pub slot: Vec<SlotSpec>,
    /// Names for sets of items that places can accept.
    #[serde(default)]
    pub group: Vec<GroupSpec>,
    /// The dishes of the menu.
    pub dish: Vec<DishSpec>,
    /// How people may misremember the recipes of dishes.
    #[serde(default)]
    pub deviation: Vec<DeviationSpec>,
    /// Words of screens for items, ingredients and dishes: by language, then by name.
    #[serde(default)]
    pub words: BTreeMap<String, BTreeMap<String, Spanned<String>>>,
}

/// `[[ingredient]]` of a recipe file: an ingredient with its states.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IngredientSpec {
    /// The ingredient's name: "salmon".
    pub name: Spanned<String>,
    /// The states of the ingredient in order; a storage supplies the ingredient in the first state. Empty for an
    /// ingredient with a single state.
    #[serde(default)]
    pub states: Vec<Spanned<String>>,
    /// Ingredients for which this ingredient can be mistaken at a glance.
    #[serde(default)]
    pub looks_like: Vec<Spanned<String>>,
    /// Appearance of the ingredient on the display: a shape and colours for each state.
    #[serde(default)]
    pub look: Vec<Spanned<String>>,
}

/// `[[process]]` of a recipe file: a processing step, in which a press turns one item into another.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessingStepSpec {
    /// The name of the processing step: "cut".
    pub name: Spanned<String>,
    /// Location of the processing step: a place of the layout, or "hand".
    pub at: Spanned<String>,
    /// The agents who can do the processing step.
    pub agents: Vec<Agent>,
    /// The conversions of the processing step: which item becomes which other item.
    pub steps: Vec<ItemConversionSpec>,
}

/// One conversion of a processing step: an item becomes another item.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ItemConversionSpec {
    /// The item before the conversion, as "ingredient state".
    pub from: Spanned<String>,
    /// The item after the conversion, as "ingredient state".
    pub to: Spanned<String>,
}

/// `[[slot]]` of a recipe file: items that have the same role in a dish, such as toppings.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotSpec {
    /// The slot's name: "topping".
    pub name: Spanned<String>,
    /// The items of the slot, as "ingredient state"; each item is in at most one slot.
    pub items: Vec<Spanned<String>>,
}

/// `[[group]]` of a recipe file: a name for items that a place accepts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupSpec {
    /// The name of the group of items.
    pub name: Spanned<String>,
    /// The items that belong to the group, as "ingredient state"; a stack belongs to the group if each of its items
    /// does.
    pub made_of: Vec<Spanned<String>>,
}

/// `[[dish]]` of a recipe file: a dish of the menu.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DishSpec {
    /// The dish's name.
    pub name: Spanned<String>,
    /// The items of the dish, as "ingredient state": the true recipe.
    pub items: Spanned<Vec<Spanned<String>>>,
    /// Appearance of the finished dish on the display, which must not reveal the recipe.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

/// `[[deviation]]` of a recipe file: how people misremember the recipes of some dishes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSpec {
    /// The deviation applies to dishes with at least one of these items.
    pub dishes_with: Vec<Spanned<String>>,
    /// How deviations in several slots may be combined.
    pub combine: DeviationCombinationRule,
    /// The slots of a dish that people can misremember.
    pub slots: Vec<DeviationSlotSpec>,
}

/// A slot of a deviation, with the items that people may remember instead.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSlotSpec {
    /// The name of the slot that can be misremembered.
    pub slot: Spanned<String>,
    /// The items that may be remembered in this slot.
    pub items: Vec<Spanned<String>>,
}

/// How deviations of a remembered recipe in several slots may be combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum DeviationCombinationRule {
    /// At most one slot deviates from the true recipe.
    #[serde(rename = "one at a time")]
    OneAtATime,
    /// Every combination of the slots' items can be remembered.
    #[serde(rename = "all")]
    All,
}
