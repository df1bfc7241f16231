//! Enumerates the contents of a kitchen: the items (ingredients in their states), and the stacks that can be made of
//! items.

use toml::Spanned;

use super::spec_error::{KitchenFileKind, Result, look, wrong, wrong_file};
use crate::kitchen::content::{Content, ContentId};
use crate::kitchen::look::Appearance;
use crate::kitchen::recipe::{DishSpec, RecipesSpec};

/// Largest number of contents: a content is one byte, and one value of the byte means "none".
const MAX_CONTENTS: usize = 255;
const TOO_MANY: &str = "at most 255 items and stacks: fewer ingredients, states or slots";

/// The items (ingredients in a state, such as "rice cooked") of the recipe file, with their names and ids.
pub(super) struct IngredientItems {
    pub(super) names: Vec<String>,
    /// For each item, its ingredient, as an index into the recipe file's list.
    pub(super) ingredient: Vec<usize>,
    /// For each item, its state, as an index into the list of states of its ingredient.
    pub(super) state: Vec<usize>,
}

impl IngredientItems {
    pub(super) fn read(spec: &RecipesSpec) -> Result<IngredientItems> {
        let mut items = IngredientItems { names: Vec::new(), ingredient: Vec::new(), state: Vec::new() };
        for (index, ingredient) in spec.ingredient.iter().enumerate() {
            let states: Vec<String> = match ingredient.states.is_empty() {
                true => vec![String::new()],
                false => ingredient.states.iter().map(|state| format!(" {}", state.get_ref())).collect(),
            };
            for (state, suffix) in states.iter().enumerate() {
                let name = format!("{}{suffix}", ingredient.name.get_ref());
                if items.names.contains(&name) {
                    let found = format!("the item \"{name}\" a second time");
                    return Err(wrong(KitchenFileKind::Recipes, ingredient.name.span(), found, "each item once"));
                }
                if items.names.len() == MAX_CONTENTS - 1 {
                    let found = format!("\"{name}\" as item number {MAX_CONTENTS}");
                    return Err(wrong(KitchenFileKind::Recipes, ingredient.name.span(), found, TOO_MANY));
                }
                items.names.push(name);
                items.ingredient.push(index);
                items.state.push(state);
            }
        }
        Ok(items)
    }

    pub(super) fn find(&self, name: &Spanned<String>) -> Result<ContentId> {
        match self.names.iter().position(|item| item == name.get_ref()) {
            Some(index) => Ok(ContentId(index as u8 + 1)),
            None => Err(wrong(
                KitchenFileKind::Recipes,
                name.span(),
                format!("\"{}\"", name.get_ref()),
                format!("one of the items {}", self.names.join(", ")),
            )),
        }
    }

    pub(super) fn find_all(&self, names: &[Spanned<String>]) -> Result<Vec<ContentId>> {
        names.iter().map(|name| self.find(name)).collect()
    }
}

/// All contents of the kitchen: empty, all items, then all stacks, pairs first.
pub(super) fn contents(spec: &RecipesSpec, items: &IngredientItems) -> Result<Vec<Content>> {
    let item_sets = (0..items.names.len()).map(|index| vec![ContentId(index as u8 + 1)]);
    let mut sets: Vec<Vec<ContentId>> = std::iter::once(Vec::new()).chain(item_sets).collect();
    sets.extend(stacks(spec, items)?);
    if sets.len() > MAX_CONTENTS {
        let found = format!("{} different contents (items and stacks)", sets.len());
        return Err(wrong_file(KitchenFileKind::Recipes, found, TOO_MANY));
    }
    let dish_names = dish_names(spec, items)?;
    let mut contents: Vec<Content> = sets.iter().map(|set| content(set, items, &dish_names)).collect();
    let look_alikes: Vec<Vec<ContentId>> =
        sets.iter().map(|set| look_alikes(spec, items, &sets, set)).collect::<Result<_>>()?;
    for (content, alike) in contents.iter_mut().zip(look_alikes) {
        content.look_alikes = alike;
    }
    for (item, content) in contents.iter_mut().skip(1).take(items.names.len()).enumerate() {
        content.look = item_look(spec, items, item)?;
    }
    Ok(contents)
}

/// The appearance of an item on the display; an ingredient without an appearance is shown by its name.
fn item_look(spec: &RecipesSpec, items: &IngredientItems, item: usize) -> Result<Option<Appearance>> {
    let ingredient = &spec.ingredient[items.ingredient[item]];
    let (looks, states) = (&ingredient.look, ingredient.states.len().max(1));
    if !looks.is_empty() && looks.len() != states {
        let found = format!("{} looks of \"{}\"", looks.len(), ingredient.name.get_ref());
        let remedy = format!("one for each of its states: {states}");
        return Err(wrong(KitchenFileKind::Recipes, looks[0].span(), found, remedy));
    }
    looks.get(items.state[item]).map(|text| look(KitchenFileKind::Recipes, text)).transpose()
}

/// All stacks of two or more items, smaller stacks first.
fn stacks(spec: &RecipesSpec, items: &IngredientItems) -> Result<Vec<Vec<ContentId>>> {
    let mut stacks: Vec<Vec<ContentId>> = vec![Vec::new()];
    let mut of_slots: Vec<ContentId> = Vec::new();
    for slot in &spec.slot {
        let below = stacks.clone();
        for (item, name) in items.find_all(&slot.items)?.into_iter().zip(&slot.items) {
            if of_slots.contains(&item) {
                let found = format!("\"{}\" in a second slot, or twice in one", name.get_ref());
                return Err(wrong(KitchenFileKind::Recipes, name.span(), found, "each item in at most one [[slot]]"));
            }
            of_slots.push(item);
            stacks.extend(below.iter().map(|stack| [stack.as_slice(), &[item]].concat()));
            if stacks.len() > 2 * MAX_CONTENTS {
                return Err(wrong(KitchenFileKind::Recipes, slot.name.span(), "too many different stacks", TOO_MANY));
            }
        }
    }
    for stack in &mut stacks {
        stack.sort_unstable();
    }
    stacks.retain(|stack| stack.len() > 1);
    stacks.sort_by_key(|stack| (stack.len(), stack.clone()));
    Ok(stacks)
}

fn content(set: &[ContentId], items: &IngredientItems, dish_names: &[(Vec<ContentId>, String)]) -> Content {
    let names: Vec<&str> = set.iter().map(|item| items.names[item.index() - 1].as_str()).collect();
    let dish = dish_names.iter().find(|(stack, _)| stack == set);
    let name = match dish {
        Some((_, dish)) => dish.clone(),
        None if set.is_empty() => "empty".to_string(),
        None => names.join(" + "),
    };
    let ingredient = (set.len() == 1).then(|| items.ingredient[set[0].index() - 1]);
    let wording = name.clone();
    Content {
        name,
        wording,
        items: set.to_vec(),
        is_dish: dish.is_some(),
        ingredient,
        look_alikes: Vec::new(),
        look: None,
    }
}

pub(super) fn dish_names(spec: &RecipesSpec, items: &IngredientItems) -> Result<Vec<(Vec<ContentId>, String)>> {
    let one = |dish: &DishSpec| {
        let mut stack = items.find_all(dish.items.get_ref())?;
        stack.sort_unstable();
        Ok((stack, dish.name.get_ref().clone()))
    };
    spec.dish.iter().map(one).collect()
}

/// The contents that look like this content: the same content with one ingredient replaced by one that looks like the
/// ingredient.
fn look_alikes(
    spec: &RecipesSpec,
    items: &IngredientItems,
    sets: &[Vec<ContentId>],
    set: &[ContentId],
) -> Result<Vec<ContentId>> {
    let mut alike = Vec::new();
    for (position, item) in set.iter().enumerate() {
        let state = items.state[item.index() - 1];
        for name in &spec.ingredient[items.ingredient[item.index() - 1]].looks_like {
            let other = spec.ingredient.iter().position(|ingredient| ingredient.name.get_ref() == name.get_ref());
            let Some(other) = other else {
                let found = format!("looks_like \"{}\"", name.get_ref());
                return Err(wrong(KitchenFileKind::Recipes, name.span(), found, "the name of another ingredient"));
            };
            let twin =
                (0..items.names.len()).find(|&twin| items.ingredient[twin] == other && items.state[twin] == state);
            let Some(twin) = twin else { continue };
            let mut exchanged = set.to_vec();
            exchanged[position] = ContentId(twin as u8 + 1);
            exchanged.sort_unstable();
            alike.extend(sets.iter().position(|set| *set == exchanged).map(|index| ContentId(index as u8)));
        }
    }
    Ok(alike)
}
