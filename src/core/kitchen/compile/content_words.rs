//! Reads the words of screens for contents, from the tables `[words]` of the recipe file.

use std::collections::BTreeMap;

use super::contents::IngredientItems;
use super::spec_error::{KitchenFileKind, Result, wrong};
use crate::kitchen::content::Content;
use crate::kitchen::content_wording::{KitchenWords, SCREEN_LANGUAGE};
use crate::kitchen::recipe::RecipesSpec;

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
                return Err(wrong(KitchenFileKind::Recipes, wording.span(), found, remedy));
            }
            let text = wording.get_ref();
            let is_wording = (1..=MAX_WORDING).contains(&text.chars().count()) && text.trim() == text;
            if !is_wording || text.chars().any(char::is_control) || text.contains(" + ") {
                let remedy = format!("1 to {MAX_WORDING} characters in one line, such as \"cooked rice\"");
                return Err(wrong(
                    KitchenFileKind::Recipes,
                    wording.span(),
                    format!("{text:?} as words for \"{name}\""),
                    remedy,
                ));
            }
            words.insert(name.clone(), text.clone());
        }
        check_distinct(spec, items, language, words)?;
    }
    Ok(KitchenWords::new(languages))
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
        return Err(wrong(KitchenFileKind::Recipes, span, found, "words of its own for each item and each dish"));
    }
    Ok(())
}

/// Sets the wording of each content for screens of the program.
pub(super) fn word(contents: &mut [Content], words: &KitchenWords) {
    let wordings: Vec<String> =
        contents.iter().map(|content| words.content(SCREEN_LANGUAGE, content, contents)).collect();
    for (content, wording) in contents.iter_mut().zip(wordings) {
        content.wording = wording;
    }
}
