//! Words of screens for contents, by language.

use std::collections::BTreeMap;

use super::content::Content;

/// The language of the console, of Rerun and of reports.
pub const SCREEN_LANGUAGE: &str = "en";

/// Words for items, ingredients and dishes, by language, then by name in logs. The table has a word for every item in
/// the screens' language, in other languages only the words that the recipe file gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KitchenWords(BTreeMap<String, BTreeMap<String, String>>);

impl KitchenWords {
    /// Creates the table of words from words by language and name.
    pub(super) fn new(languages: BTreeMap<String, BTreeMap<String, String>>) -> KitchenWords {
        KitchenWords(languages)
    }

    /// The words for names in this language; empty if the recipe file has no words in the language.
    pub fn in_language(&self, language: &str) -> &BTreeMap<String, String> {
        static NONE: BTreeMap<String, String> = BTreeMap::new();
        self.0.get(language).unwrap_or(&NONE)
    }

    /// The wording of a content in this language: "cooked rice", "nori + cooked rice". A name without a word in the
    /// language is returned as it is. `contents` are all contents of the kitchen.
    pub fn content(&self, language: &str, content: &Content, contents: &[Content]) -> String {
        let words = self.in_language(language);
        let word = |name: &str| words.get(name).map_or(name, String::as_str).to_string();
        match content.is_stack() && !content.is_dish {
            true => {
                let items = content.items.iter().map(|item| word(&contents[item.index()].name));
                items.collect::<Vec<_>>().join(" + ")
            }
            false => word(&content.name),
        }
    }
}
