//! The words of the display: two languages that the program carries, and whatever a file says.

use std::collections::BTreeMap;

use crate::kitchen::Kitchen;
use crate::kitchen::content_wording::SCREEN_LANGUAGE;
use crate::session::wall_display::DisplaySpec;

const ENGLISH: &str = include_str!("languages/en.toml");
const GERMAN: &str = include_str!("languages/de.toml");
/// Words of the page itself begin so; all others are names of the kitchen.
const PAGE: &str = "page ";

/// Words by their English names.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayWords {
    /// "en": for the browser.
    pub language: String,
    words: BTreeMap<String, String>,
}

impl DisplayWords {
    /// English, with the words of the chosen language over it, and those of the session file over these.
    pub fn for_display(spec: &DisplaySpec) -> DisplayWords {
        let read = |text: &str| toml::from_str::<BTreeMap<String, String>>(text).unwrap_or_default();
        let mut words = read(ENGLISH);
        if spec.language == "de" {
            words.extend(read(GERMAN));
        }
        words.extend(spec.words.clone());
        let language = words.get("language").cloned().unwrap_or_default();
        DisplayWords { language, words }
    }

    /// The same with the kitchen's words for its contents: in this language, or else in that of the screens. The words of the
    /// session file stand over them.
    pub fn for_kitchen(kitchen: &Kitchen, spec: &DisplaySpec) -> DisplayWords {
        let DisplayWords { language, words: others } = DisplayWords::for_display(spec);
        let mut words = kitchen.words.in_language(SCREEN_LANGUAGE).clone();
        words.extend(others);
        words.extend(kitchen.words.in_language(&language).clone());
        words.extend(spec.words.clone());
        DisplayWords { language, words }
    }

    /// A name of the kitchen in this language; in its own words where the language has none for it.
    pub fn of_name(&self, name: &str) -> String {
        let plain = name.replace('_', " ");
        if let Some(word) = self.words.get(&plain) {
            return word.clone();
        }
        // "take rice" and "order 1" are made of words that are there.
        let parts: Vec<&str> = plain.split(' ').collect();
        let known = parts.iter().all(|part| self.words.contains_key(*part) || part.parse::<u32>().is_ok());
        match known {
            true => parts
                .iter()
                .map(|part| self.words.get(*part).map_or(*part, String::as_str))
                .collect::<Vec<_>>()
                .join(" "),
            false => plain,
        }
    }

    /// The words that stand for exactly this; none where the language has none.
    pub(super) fn known(&self, name: &str) -> Option<String> {
        self.words.get(name).cloned()
    }

    /// The sentence of this name with `what` in place of its "#".
    pub(super) fn filled(&self, name: &str, what: &str) -> String {
        self.of_name(name).replace('#', what)
    }

    /// The page's own words, by what they stand for.
    pub fn of_page(&self) -> BTreeMap<String, String> {
        let own = self.words.iter().filter_map(|(key, word)| Some((key.strip_prefix(PAGE)?.to_string(), word.clone())));
        own.collect()
    }
}
