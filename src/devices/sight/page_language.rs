//! Texts of the participant's display: the built-in languages, and texts from files.

use std::collections::BTreeMap;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::parts::SCREEN_LANGUAGE;
use tomcom_session::wall_display::DisplaySpec;

const ENGLISH: &str = include_str!("languages/en.toml");
/// The other built-in languages, by their codes: those of [`DisplaySpec::LANGUAGES`].
const OTHERS: [(&str, &str); 5] = [
    ("de", include_str!("languages/de.toml")),
    ("es", include_str!("languages/es.toml")),
    ("fr", include_str!("languages/fr.toml")),
    ("it", include_str!("languages/it.toml")),
    ("ja", include_str!("languages/ja.toml")),
];
/// Prefix of the names of the page's own texts; all other texts have names from the kitchen.
const PAGE: &str = "page ";

/// Texts of the display in the participant's language, by their English names.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayWords {
    /// Language code for the browser, such as "en".
    pub language: String,
    words: BTreeMap<String, String>,
}

impl DisplayWords {
    /// Creates the display's texts: English texts, which the texts of the chosen language replace, and these are
    /// replaced by the texts of the session file.
    pub fn for_display(spec: &DisplaySpec) -> DisplayWords {
        let read = |text: &str| toml::from_str::<BTreeMap<String, String>>(text).unwrap_or_default();
        let mut words = read(ENGLISH);
        for (_, others) in OTHERS.iter().filter(|(code, _)| *code == spec.language) {
            words.extend(read(others));
        }
        words.extend(spec.words.clone());
        let language = words.get("language").cloned().unwrap_or_default();
        DisplayWords { language, words }
    }

    /// The display's texts with the kitchen's own words for its contents: in the display's language, or else in the
    /// language of the screens. Texts of the session file take precedence.
    pub fn for_kitchen(kitchen: &Kitchen, spec: &DisplaySpec) -> DisplayWords {
        let DisplayWords { language, words: others } = DisplayWords::for_display(spec);
        let mut words = kitchen.words.in_language(SCREEN_LANGUAGE).clone();
        words.extend(others);
        words.extend(kitchen.words.in_language(&language).clone());
        words.extend(spec.words.clone());
        DisplayWords { language, words }
    }

    /// A name of the kitchen in the display's language; the name is unchanged where the language has no word for it.
    pub fn of_name(&self, name: &str) -> String {
        let plain = name.replace('_', " ");
        if let Some(word) = self.words.get(&plain) {
            return word.clone();
        }
        // Names such as "take rice" and "order 1" are translated word by word if the language has each word.
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

    /// A name of the kitchen within a sentence: with its article, where the language's file has one.
    pub fn in_sentence(&self, name: &str) -> String {
        self.known(&format!("the {}", name.replace('_', " "))).unwrap_or_else(|| self.of_name(name))
    }

    /// The text for exactly this name; `None` if the language has no such text.
    pub(super) fn known(&self, name: &str) -> Option<String> {
        self.words.get(name).cloned()
    }

    /// The text with this name, in which `what` replaces the "#".
    pub(super) fn filled(&self, name: &str, what: &str) -> String {
        self.of_name(name).replace('#', what)
    }

    /// The page's own texts, by their names.
    pub fn of_page(&self) -> BTreeMap<String, String> {
        let own = self.words.iter().filter_map(|(key, word)| Some((key.strip_prefix(PAGE)?.to_string(), word.clone())));
        own.collect()
    }
}
