//! Contents and their words, processing steps, dishes and the variants of their recipes, from the recipe file.

use std::collections::BTreeMap;

use toml::Spanned;

use super::places::stored;
use super::{KitchenFileKind, Result, in_recipes, look, wrong_file};
use crate::kitchen::files::{
    DeviationCombinationRule, DeviationSpec, DishSpec, LayoutSpec, ProcessingStepSpec, RecipesSpec,
};
use crate::kitchen::parts::{
    Agent, Appearance, Content, ContentId, Dish, KitchenWords, Location, LocationId, LocationKind, ProcessingStep,
    SCREEN_LANGUAGE,
};
use crate::kitchen::state::MAX_DISHES;

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
                    return Err(in_recipes(ingredient.name.span(), found, "each item once"));
                }
                if items.names.len() == MAX_CONTENTS - 1 {
                    let found = format!("\"{name}\" as item number {MAX_CONTENTS}");
                    return Err(in_recipes(ingredient.name.span(), found, TOO_MANY));
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
            None => Err(in_recipes(
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
        return Err(in_recipes(looks[0].span(), found, remedy));
    }
    looks.get(items.state[item]).map(|text| look(KitchenFileKind::Recipes, text)).transpose()
}

fn stacks(spec: &RecipesSpec, items: &IngredientItems) -> Result<Vec<Vec<ContentId>>> {
    let mut stacks: Vec<Vec<ContentId>> = vec![Vec::new()];
    let mut of_slots: Vec<ContentId> = Vec::new();
    for slot in &spec.slot {
        let below = stacks.clone();
        for (item, name) in items.find_all(&slot.items)?.into_iter().zip(&slot.items) {
            if of_slots.contains(&item) {
                let found = format!("\"{}\" in a second slot, or twice in one", name.get_ref());
                return Err(in_recipes(name.span(), found, "each item in at most one [[slot]]"));
            }
            of_slots.push(item);
            stacks.extend(below.iter().map(|stack| [stack.as_slice(), &[item]].concat()));
            if stacks.len() > 2 * MAX_CONTENTS {
                return Err(in_recipes(slot.name.span(), "too many different stacks", TOO_MANY));
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
                return Err(in_recipes(name.span(), found, "the name of another ingredient"));
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

/// Largest length of the wording of a content, in characters: a longer wording would not fit under a place on the
/// screen.
const MAX_WORDING: usize = 40;

/// The wordings of contents in all languages: those of the recipe file and, in the screens' language, a default for
/// every other item.
pub(super) fn content_words(spec: &RecipesSpec, items: &IngredientItems) -> Result<KitchenWords> {
    let mut languages: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    let defaults = (0..items.names.len()).map(|item| (items.names[item].clone(), default_wording(spec, items, item)));
    languages.insert(SCREEN_LANGUAGE.to_string(), defaults.collect());
    for (language, entries) in &spec.words {
        let words = languages.entry(language.clone()).or_default();
        for (name, wording) in entries {
            let dish = spec.dish.iter().any(|dish| dish.name.get_ref() == name);
            let ingredient = spec.ingredient.iter().any(|ingredient| ingredient.name.get_ref() == name);
            if !dish && !ingredient && !items.names.contains(name) {
                let found = format!("words for \"{name}\" in the table [words.{language}]");
                let remedy = format!("a dish, an ingredient, or one of the items {}", items.names.join(", "));
                return Err(in_recipes(wording.span(), found, remedy));
            }
            let text = wording.get_ref();
            let is_wording = (1..=MAX_WORDING).contains(&text.chars().count()) && text.trim() == text;
            if !is_wording || text.chars().any(char::is_control) || text.contains(" + ") {
                let remedy = format!("1 to {MAX_WORDING} characters in one line, such as \"cooked rice\"");
                return Err(in_recipes(wording.span(), format!("{text:?} as words for \"{name}\""), remedy));
            }
            words.insert(name.clone(), text.clone());
        }
        check_distinct(spec, items, language, words)?;
    }
    Ok(KitchenWords(languages))
}

/// The default wording of an item: "cooked rice" for "rice" in the state "cooked".
fn default_wording(spec: &RecipesSpec, items: &IngredientItems, item: usize) -> String {
    let ingredient = &spec.ingredient[items.ingredient[item]];
    let name = ingredient.name.get_ref();
    ingredient.states.get(items.state[item]).map_or(name.clone(), |state| format!("{} {name}", state.get_ref()))
}

/// Checks that no two items, and no two dishes, have the same wording: they could not be told apart on a screen.
fn check_distinct(
    spec: &RecipesSpec,
    items: &IngredientItems,
    language: &str,
    words: &BTreeMap<String, String>,
) -> Result<()> {
    let dishes = spec.dish.iter().map(|dish| dish.name.get_ref());
    let mut seen: BTreeMap<&str, &str> = BTreeMap::new();
    for name in items.names.iter().chain(dishes) {
        let Some(wording) = words.get(name) else { continue };
        let Some(other) = seen.insert(wording, name) else { continue };
        let entries = &spec.words[language];
        let span = [name.as_str(), other].iter().find_map(|name| entries.get(*name)).map_or(0..0, |word| word.span());
        let found = format!("\"{wording}\" as words for both \"{other}\" and \"{name}\"");
        return Err(in_recipes(span, found, "words of its own for each item and each dish"));
    }
    Ok(())
}

pub(super) fn word(contents: &mut [Content], words: &KitchenWords) {
    let wordings: Vec<String> =
        contents.iter().map(|content| words.content(SCREEN_LANGUAGE, content, contents)).collect();
    for (content, wording) in contents.iter_mut().zip(wordings) {
        content.wording = wording;
    }
}

pub(super) fn processes(
    spec: &RecipesSpec,
    items: &IngredientItems,
    locations: &[Location],
) -> Result<Vec<ProcessingStep>> {
    let one = |process: &ProcessingStepSpec| {
        let place = match process.at.get_ref().as_str() {
            "hand" => None,
            name => match locations.iter().position(|l| l.name == name && l.kind == LocationKind::Place) {
                Some(index) => Some(LocationId(index as u8)),
                None => {
                    let found = format!("at = \"{name}\"");
                    return Err(in_recipes(process.at.span(), found, "\"hand\" or a [[place]] of the layout"));
                }
            },
        };
        let steps = process.steps.iter().map(|step| Ok((items.find(&step.from)?, items.find(&step.to)?)));
        let agents = Agent::BOTH.map(|agent| process.agents.contains(&agent));
        Ok(ProcessingStep { name: process.name.get_ref().clone(), place, agents, steps: steps.collect::<Result<_>>()? })
    };
    spec.process.iter().map(one).collect()
}

pub(super) fn dishes(spec: &RecipesSpec, items: &IngredientItems, contents: &[Content]) -> Result<Vec<Dish>> {
    if spec.dish.is_empty() || spec.dish.len() > MAX_DISHES {
        let found = format!("{} dishes", spec.dish.len());
        return Err(wrong_file(KitchenFileKind::Recipes, found, format!("1 to {MAX_DISHES} tables [[dish]]")));
    }
    let slots: Vec<Vec<ContentId>> = spec.slot.iter().map(|slot| items.find_all(&slot.items)).collect::<Result<_>>()?;
    let mut dishes: Vec<Dish> = Vec::new();
    for dish in &spec.dish {
        let parts = items.find_all(dish.items.get_ref())?;
        let by_slot: Option<Vec<ContentId>> =
            slots.iter().map(|slot| slot.iter().copied().find(|item| parts.contains(item))).collect();
        let Some(by_slot) = by_slot.filter(|by_slot| by_slot.len() == parts.len()) else {
            let found = format!("\"{}\" of {} items", dish.name.get_ref(), parts.len());
            return Err(in_recipes(dish.items.span(), found, "one item of each [[slot]]"));
        };
        let deviation = spec.deviation.iter().find_map(|deviation| match items.find_all(&deviation.dishes_with) {
            Ok(with) => with.iter().any(|item| parts.contains(item)).then_some(Ok(deviation)),
            Err(error) => Some(Err(error)),
        });
        let sets = match deviation.transpose()? {
            Some(deviation) => variants(deviation, spec, items, &by_slot)?,
            None => vec![by_slot],
        };
        let find = |mut set: Vec<ContentId>| {
            set.sort_unstable();
            contents.iter().position(|content| content.items == set).map(|index| ContentId(index as u8))
        };
        // Each set has one item of every slot, so it is a stack.
        let variants: Vec<ContentId> = sets.into_iter().filter_map(find).collect();
        if dishes.iter().any(|other| other.name == *dish.name.get_ref() || other.variants[0] == variants[0]) {
            let found = format!("the dish \"{}\" a second time", dish.name.get_ref());
            return Err(in_recipes(dish.name.span(), found, "each name and each recipe once"));
        }
        let look = dish.look.as_ref().map(|text| look(KitchenFileKind::Recipes, text)).transpose()?;
        dishes.push(Dish { name: dish.name.get_ref().clone(), variants, look });
    }
    Ok(dishes)
}

/// The variants of a recipe that people may remember instead of `truth` (one item per slot), the true recipe first.
fn variants(
    deviation: &DeviationSpec,
    spec: &RecipesSpec,
    items: &IngredientItems,
    truth: &[ContentId],
) -> Result<Vec<Vec<ContentId>>> {
    let mut sets = vec![truth.to_vec()];
    for vary in &deviation.slots {
        let Some(slot) = spec.slot.iter().position(|slot| slot.name.get_ref() == vary.slot.get_ref()) else {
            let found = format!("slot = \"{}\"", vary.slot.get_ref());
            return Err(in_recipes(vary.slot.span(), found, "the name of a [[slot]]"));
        };
        let starts = match deviation.combine {
            DeviationCombinationRule::OneAtATime => vec![truth.to_vec()],
            DeviationCombinationRule::All => sets.clone(),
        };
        for start in starts {
            for (item, name) in items.find_all(&vary.items)?.into_iter().zip(&vary.items) {
                let stackable = &spec.slot[slot].items;
                if !stackable.iter().any(|other| other.get_ref() == name.get_ref()) {
                    let found = format!("\"{}\" in the slot \"{}\"", name.get_ref(), vary.slot.get_ref());
                    let of_slot: Vec<&str> = stackable.iter().map(|item| item.get_ref().as_str()).collect();
                    let remedy = format!("an item of that [[slot]]: {}", of_slot.join(", "));
                    return Err(in_recipes(name.span(), found, remedy));
                }
                let mut set = start.clone();
                set[slot] = item;
                if !sets.contains(&set) {
                    sets.push(set);
                }
            }
        }
    }
    Ok(sets)
}

/// Checks that every dish can be made: each item comes from a storage, and every processing step has an agent who can
/// do the step.
pub(super) fn check_obtainable(
    spec: &RecipesSpec,
    layout: &LayoutSpec,
    items: &IngredientItems,
    processes: &[ProcessingStep],
) -> Result<()> {
    let mut obtainable: Vec<ContentId> =
        layout.storage.iter().map(|storage| stored(&storage.ingredient, spec, items)).collect::<Result<_>>()?;
    let steps = processes.iter().filter(|process| process.agents.contains(&true)).flat_map(|process| &process.steps);
    let steps: Vec<(ContentId, ContentId)> = steps.copied().collect();
    while let Some((_, to)) = steps.iter().find(|(from, to)| obtainable.contains(from) && !obtainable.contains(to)) {
        obtainable.push(*to);
    }
    for dish in &spec.dish {
        for name in dish.items.get_ref() {
            if !obtainable.contains(&items.find(name)?) {
                let found = format!("\"{}\", which nobody can get", name.get_ref());
                let remedy = "a [[storage]] of the layout that gives it, or steps of a [[process]] that lead to it";
                return Err(in_recipes(name.span(), found, remedy));
            }
        }
    }
    Ok(())
}
