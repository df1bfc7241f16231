//! Builds processing steps, dishes, and for each dish the variants of its recipe that people may remember.

use super::contents::IngredientItems;
use super::places::stored;
use super::spec_error::{KitchenFileKind, Result, look, wrong, wrong_file};
use crate::kitchen::agent::Agent;
use crate::kitchen::content::{Content, ContentId};
use crate::kitchen::dish::Dish;
use crate::kitchen::layout::LayoutSpec;
use crate::kitchen::location::{Location, LocationId, LocationKind};
use crate::kitchen::process::ProcessingStep;
use crate::kitchen::recipe::{DeviationCombinationRule, DeviationSpec, ProcessingStepSpec, RecipesSpec};
use crate::kitchen::state::MAX_DISHES;

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
                    return Err(wrong(
                        KitchenFileKind::Recipes,
                        process.at.span(),
                        found,
                        "\"hand\" or a [[place]] of the layout",
                    ));
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
            return Err(wrong(KitchenFileKind::Recipes, dish.items.span(), found, "one item of each [[slot]]"));
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
            return Err(wrong(KitchenFileKind::Recipes, dish.name.span(), found, "each name and each recipe once"));
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
            return Err(wrong(KitchenFileKind::Recipes, vary.slot.span(), found, "the name of a [[slot]]"));
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
                    return Err(wrong(KitchenFileKind::Recipes, name.span(), found, remedy));
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
                return Err(wrong(KitchenFileKind::Recipes, name.span(), found, remedy));
            }
        }
    }
    Ok(())
}
