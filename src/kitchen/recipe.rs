//! The recipe file: ingredients with states and look-alikes, processing steps, the stacking rule, the menu, and possible deviations
//! of a remembered recipe.

use serde::Deserialize;
use toml::Spanned;

use super::agent::Agent;

/// The recipe file as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecipesSpec {
    pub name: String,
    pub ingredient: Vec<IngredientSpec>,
    #[serde(default)]
    pub process: Vec<ProcessSpec>,
    pub slot: Vec<SlotSpec>,
    #[serde(default)]
    pub group: Vec<GroupSpec>,
    pub dish: Vec<DishSpec>,
    #[serde(default)]
    pub deviation: Vec<DeviationSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IngredientSpec {
    pub name: Spanned<String>,
    /// States in order; a storage supplies the first. Empty for an ingredient with a single state.
    #[serde(default)]
    pub states: Vec<Spanned<String>>,
    #[serde(default)]
    pub looks_like: Vec<Spanned<String>>,
    /// Appearance on the display, a shape and colours for each state.
    #[serde(default)]
    pub look: Vec<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessSpec {
    pub name: Spanned<String>,
    /// A place of the layout, or "hand".
    pub at: Spanned<String>,
    pub agents: Vec<Agent>,
    pub steps: Vec<ProcessStepSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcessStepSpec {
    pub from: Spanned<String>,
    pub to: Spanned<String>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotSpec {
    pub name: Spanned<String>,
    pub items: Vec<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupSpec {
    pub name: Spanned<String>,
    pub made_of: Vec<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DishSpec {
    pub name: Spanned<String>,
    pub items: Spanned<Vec<Spanned<String>>>,
    /// Appearance of the final product on the display; it must not reveal the recipe.
    #[serde(default)]
    pub look: Option<Spanned<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSpec {
    /// The rule applies to dishes with at least one of these items.
    pub dishes_with: Vec<Spanned<String>>,
    pub combine: DeviationCombination,
    pub slots: Vec<DeviationSlotSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationSlotSpec {
    pub slot: Spanned<String>,
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
