//! The recipe file: ingredients with states and look-alikes, processing steps, the stacking rule, the menu, and possible deviations
//! of a remembered recipe.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::agent::Agent;

/// The recipe file as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecipesSpec {
    /// Identifier of the menu.
    pub name: String,
    /// The ingredients with their states.
    pub ingredient: Vec<IngredientSpec>,
    /// The processing steps.
    #[serde(default)]
    pub process: Vec<ProcessSpec>,
    /// What a dish is made of: from each slot at most one item.
    pub slot: Vec<SlotSpec>,
    /// Names for sets of items that places can accept.
    #[serde(default)]
    pub group: Vec<GroupSpec>,
    /// The menu.
    pub dish: Vec<DishSpec>,
    /// What else may be taken for a dish's recipe.
    #[serde(default)]
    pub deviation: Vec<DeviationSpec>,
    /// How items, ingredients and dishes are worded: by language, and in a language by name.
    #[serde(default)]
    pub words: BTreeMap<String, BTreeMap<String, Spanned<String>>>,
}

/// `[[ingredient]]` of a recipe file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IngredientSpec {
    /// The ingredient's name: "salmon".
    pub name: Spanned<String>,
    /// States in order; a storage supplies the first. Empty for an ingredient with a single state.
    #[serde(default)]
    pub states: Vec<Spanned<String>>,
    /// Ingredients that it can be taken for at a glance.
    #[serde(default)]
    pub looks_like: Vec<Spanned<String>>,
    /// Appearance on the display, a shape and colours for each state.
    #[serde(default)]
    pub look: Vec<Spanned<String>>,
}

/// `[[process]]` of a recipe file: a button's press that turns one item into another.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessSpec {
    /// The process's name: "cut".
    pub name: Spanned<String>,
    /// A place of the layout, or "hand".
    pub at: Spanned<String>,
    /// Who can do it.
    pub agents: Vec<Agent>,
    /// Which item becomes which.
    pub steps: Vec<ProcessStepSpec>,
}

/// A step of a process: one item becomes another.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessStepSpec {
    /// The item before, as "ingredient state".
    pub from: Spanned<String>,
    /// The item after, as "ingredient state".
    pub to: Spanned<String>,
}

/// `[[slot]]` of a recipe file: items that take the same part in a dish.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotSpec {
    /// The slot's name: "topping".
    pub name: Spanned<String>,
    /// The items of the slot, as "ingredient state"; each item in at most one slot.
    pub items: Vec<Spanned<String>>,
}

/// `[[group]]` of a recipe file: a name for items that a place accepts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupSpec {
    /// The group's name.
    pub name: Spanned<String>,
    /// The items that belong to it, as "ingredient state"; a stack belongs to it if each of its items does.
    pub made_of: Vec<Spanned<String>>,
}

/// `[[dish]]` of a recipe file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DishSpec {
    /// The dish's name.
    pub name: Spanned<String>,
    /// What the dish is made of, as "ingredient state": the true recipe.
    pub items: Spanned<Vec<Spanned<String>>>,
    /// Appearance of the final product on the display; it must not reveal the recipe.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

/// `[[deviation]]` of a recipe file: how people misremember the recipes of some dishes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSpec {
    /// The rule applies to dishes with at least one of these items.
    pub dishes_with: Vec<Spanned<String>>,
    /// How the deviations of several slots go together.
    pub combine: DeviationCombination,
    /// The slots that can be misremembered.
    pub slots: Vec<DeviationSlotSpec>,
}

/// A slot of a deviation, with what may be remembered instead.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSlotSpec {
    /// The slot, by its name.
    pub slot: Spanned<String>,
    /// The items that may be remembered in this slot.
    pub items: Vec<Spanned<String>>,
}

/// Combination of deviations in several slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum DeviationCombination {
    /// At most one slot deviates from the true recipe.
    #[serde(rename = "one at a time")]
    OneAtATime,
    /// Every combination of the items.
    #[serde(rename = "all")]
    All,
}
