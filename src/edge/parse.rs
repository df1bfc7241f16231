//! Parses the files that people write. Every error names the file, the line, what was found and what would be right.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::file_error::{FileError, FileResult};
use super::type_error::{in_words, message};
use crate::kitchen::layout::LayoutSpec;
use crate::kitchen::recipe::RecipesSpec;
use crate::mind::model::HumanModel;
use crate::session::SessionSpec;
use crate::session::plan::Questionnaire;

/// The kinds of files that people write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Session,
    Layout,
    Recipes,
    HumanModel,
    Keys,
    Questionnaire,
    Language,
}

impl Kind {
    /// What a text is by the tables in it, if it is any of them.
    fn of(text: &str) -> Option<Kind> {
        let table: toml::Table = text.parse().ok()?;
        let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
        match () {
            () if has(&["recipes", "storage", "place"]) => Some(Kind::Layout),
            () if has(&["ingredient", "slot", "dish"]) => Some(Kind::Recipes),
            () if has(&["scale", "item"]) => Some(Kind::Questionnaire),
            () if has(&["layout"]) => Some(Kind::Session),
            () if has(&["language"]) => Some(Kind::Language),
            () if has(&["prior", "perception", "transition", "decision"]) => Some(Kind::HumanModel),
            () if has(&["console", "replay", "signals", "buttons"]) => Some(Kind::Keys),
            () => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Kind::Session => "a session file",
            Kind::Layout => "a layout file",
            Kind::Recipes => "a recipe file",
            Kind::HumanModel => "a file with parameters of the human model",
            Kind::Keys => "a key file",
            Kind::Questionnaire => "a questionnaire",
            Kind::Language => "words of the participant's display",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Kind::Session => "a session file, like sessions/default.toml",
            Kind::Layout => "a layout file, like layouts/sushi.toml",
            Kind::Recipes => "a recipe file, like recipes/sushi.toml",
            Kind::Questionnaire => "a questionnaire, like sessions/questionnaires/acceptance.toml",
            Kind::Language => "words of the participant's display, lines like \"rice\" = \"riz\"",
            Kind::HumanModel => "parameters of the human model, like those that tomcom fit writes",
            Kind::Keys => "a key file, as tomcom keys prints it",
        }
    }
}

/// What a file of one kind is parsed into.
pub trait OfKind: DeserializeOwned {
    /// The kind.
    const KIND: Kind;
}

impl OfKind for SessionSpec {
    const KIND: Kind = Kind::Session;
}

impl OfKind for LayoutSpec {
    const KIND: Kind = Kind::Layout;
}

impl OfKind for RecipesSpec {
    const KIND: Kind = Kind::Recipes;
}

impl OfKind for Questionnaire {
    const KIND: Kind = Kind::Questionnaire;
}

impl OfKind for HumanModel {
    const KIND: Kind = Kind::HumanModel;
}

/// Parses TOML into `T`.
pub fn parse<T: OfKind>(path: &Path, text: &str) -> FileResult<T> {
    toml::from_str(text).map_err(|error| match Kind::of(text).filter(|kind| *kind != T::KIND) {
        Some(other) => FileError::at(path, text, None, other.name().to_string(), T::KIND.remedy().to_string()),
        None => {
            let (found, right) = in_words(&message::<T>(text, &error));
            let kind = T::KIND.remedy();
            let remedy = right.map_or(kind.to_string(), |right| format!("{right}; in {kind}"));
            FileError::at(path, text, error.span(), found, remedy)
        }
    })
}
