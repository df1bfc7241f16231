//! Parses files that people write (TOML). Every error names the file, the line, what was found and what would be valid.

use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::file_error::{FileError, FileResult};
use super::known_settings::places_of;
use crate::SessionSpec;
use crate::plan::{Questionnaire, Tutorial};
use tomcom_core::kitchen::files::LayoutSpec;
use tomcom_core::kitchen::files::RecipesSpec;
use tomcom_core::mind::model::HumanModel;

/// Kind of a file that people write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A session file: the settings of a session.
    Session,
    /// A layout file of a kitchen: places, buttons and the display.
    Layout,
    /// A recipe file of a kitchen: dishes and their ingredients.
    Recipes,
    /// A parameter file of the human model (beliefs and choices of simulated people).
    HumanModel,
    /// A key file, which changes keys of the console.
    Keys,
    /// A file with a questionnaire for participants.
    Questionnaire,
    /// A file with a tutorial for participants.
    Tutorial,
    /// A file with the texts of the participant's display in a language.
    Language,
    /// A file with a battery of cohorts of simulated participants.
    Battery,
}

impl FileKind {
    /// The kind of file to which a text belongs, judged by the tables in it; `None` if unknown.
    fn from_text(text: &str) -> Option<FileKind> {
        let table: toml::Table = text.parse().ok()?;
        let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
        match () {
            () if has(&["cohort"]) => Some(FileKind::Battery),
            () if has(&["recipes", "storage", "place"]) => Some(FileKind::Layout),
            () if has(&["ingredient", "slot", "dish"]) => Some(FileKind::Recipes),
            () if has(&["scale", "item"]) => Some(FileKind::Questionnaire),
            () if has(&["layout"]) => Some(FileKind::Session),
            () if has(&["step"]) => Some(FileKind::Tutorial),
            () if has(&["language"]) => Some(FileKind::Language),
            () if has(&["model", "prior", "perception", "transition", "decision"]) => Some(FileKind::HumanModel),
            () if has(&["console", "replay", "signals", "buttons"]) => Some(FileKind::Keys),
            () => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            FileKind::Session => "a session file",
            FileKind::Layout => "a layout file",
            FileKind::Recipes => "a recipe file",
            FileKind::HumanModel => "a file with parameters of the human model",
            FileKind::Keys => "a key file",
            FileKind::Questionnaire => "a questionnaire",
            FileKind::Tutorial => "a tutorial",
            FileKind::Language => "words of the participant's display",
            FileKind::Battery => "a battery of cohorts",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            FileKind::Session => "a session file, like sessions/default.toml",
            FileKind::Layout => "a layout file, like layouts/sushi.toml",
            FileKind::Recipes => "a recipe file, like recipes/sushi.toml",
            FileKind::Questionnaire => "a questionnaire, like sessions/questionnaires/acceptance.toml",
            FileKind::Tutorial => "a tutorial, like sessions/tutorials/sushi.toml",
            FileKind::Language => "words of the participant's display, lines like \"rice\" = \"riz\"",
            FileKind::HumanModel => "parameters of the human model, like those that tomcom fit writes",
            FileKind::Keys => "a key file, as tomcom keys prints it",
            FileKind::Battery => "a battery of cohorts, like sessions/people/robustness.toml",
        }
    }
}

/// A type into which files of one kind are parsed.
pub trait ParsedFile: DeserializeOwned {
    /// The kind of file from which this type is parsed.
    const KIND: FileKind;
}

impl ParsedFile for SessionSpec {
    const KIND: FileKind = FileKind::Session;
}

impl ParsedFile for LayoutSpec {
    const KIND: FileKind = FileKind::Layout;
}

impl ParsedFile for RecipesSpec {
    const KIND: FileKind = FileKind::Recipes;
}

impl ParsedFile for Questionnaire {
    const KIND: FileKind = FileKind::Questionnaire;
}

impl ParsedFile for Tutorial {
    const KIND: FileKind = FileKind::Tutorial;
}

impl ParsedFile for HumanModel {
    const KIND: FileKind = FileKind::HumanModel;
}

/// Parses TOML into `T`; if the text is a file of another kind, the error says so.
pub fn parse<T: ParsedFile>(path: &Path, text: &str) -> FileResult<T> {
    toml::from_str(text).map_err(|error| match FileKind::from_text(text).filter(|kind| *kind != T::KIND) {
        Some(other) => FileError::at(path, text, None, other.name().to_string(), T::KIND.remedy().to_string()),
        None => {
            let (found, right) = told::<T>(text, &error);
            let kind = T::KIND.remedy();
            let remedy = right.map_or(kind.to_string(), |right| format!("{right}; in {kind}"));
            FileError::at(path, text, error.span(), found, remedy)
        }
    })
}

/// What the parser found, and what it expected instead, if it says so.
fn told<T: DeserializeOwned>(text: &str, error: &toml::de::Error) -> (String, Option<String>) {
    let message = error.message();
    if let Some((found, expected)) = message.split_once(", expected ") {
        let unknown = found.strip_prefix("unknown field `").and_then(|found| found.strip_suffix('`'));
        if let Some(place) = unknown.and_then(|name| Some(format!("{name} {}", places_of::<T>(name)?))) {
            return (found.to_string(), Some(place));
        }
        let found = error.span().filter(|_| unknown.is_none()).and_then(|span| Some((setting_at(text, span)?, found)));
        return match found {
            Some((setting, found)) if found.starts_with("unknown variant ") => {
                (format!("{setting}, which is not known"), Some(type_name(expected)))
            }
            Some((setting, _)) => (setting, Some(type_name(expected))),
            None => (message.split(", expected ").next().unwrap_or(message).to_string(), Some(type_name(expected))),
        };
    }
    let (span, value) = match error.span().and_then(|span| Some((span.clone(), text.get(span)?))) {
        Some((span, value)) if !value.is_empty() && !value.contains('\n') => (span, value),
        _ => return (message.to_string(), None),
    };
    // Which words are right the parser says only of a text.
    if message == "wanted string or table"
        && let Err(error) = toml::from_str::<T>(&[&text[..span.start], "\"\"", &text[span.end..]].concat())
        && let Some((_, words)) = error.message().split_once(", expected ")
    {
        return (value.to_string(), Some(type_name(words)));
    }
    (format!("{value}: {message}"), None)
}

/// The setting whose value, or part of whose value, stands at this place of a text: `tau = "high"`, or `"both" in
/// conditions`. `None` if that is not on one line.
fn setting_at(text: &str, span: Range<usize>) -> Option<String> {
    let (before, value) = (text.get(..span.start)?, text.get(span)?);
    let line = before.rsplit('\n').next().unwrap_or(before);
    let (key, between) = line.rsplit_once('=')?;
    let key = key.rsplit(['{', ',', '\n']).next().unwrap_or(key).trim();
    if key.is_empty() || value.is_empty() || value.contains('\n') {
        return None;
    }
    Some(if between.trim().is_empty() { format!("{key} = {value}") } else { format!("{value} in {key}") })
}

/// What was expected, with types of Rust by names that people know who write settings, and words in quotes.
fn type_name(expected: &str) -> String {
    let name = match expected {
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        // Most settings have narrower bounds, which are checked and reported by other code.
        "u32" | "u64" | "usize" => "a whole number, not below 0",
        "i64" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "a sequence" => "a list, in [ ]",
        "a map" => "a table of settings",
        _ if expected.starts_with("struct ") => "a table of settings",
        _ if expected.contains('"') => expected,
        _ => return expected.replace('`', "\""),
    };
    name.to_string()
}
