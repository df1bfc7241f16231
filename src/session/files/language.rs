//! Files with the texts of the participant's display, for languages that are not built in.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::file_error::{FileResult, missing, read_text};
use super::parse::{FileKind, ParsedFile, parse};
use crate::SessionSpec;
use crate::wall_display::DisplaySpec;

/// Translations of the display's texts, by the English originals.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct LanguageFile(pub BTreeMap<String, String>);

impl ParsedFile for LanguageFile {
    const KIND: FileKind = FileKind::Language;
}

/// Reads the texts of a session's display from a language file; texts in the session file take precedence.
///
/// # Errors
/// The file does not exist, or contains no texts.
pub(super) fn read_words(session: &Path, text: &str, spec: &mut SessionSpec) -> FileResult<()> {
    let language = &spec.display.language;
    if DisplaySpec::LANGUAGES.contains(&language.as_str()) {
        return Ok(());
    }
    let path = session.parent().unwrap_or(Path::new(".")).join(language);
    if let Err(reason) = std::fs::metadata(&path) {
        let remedy = "\"en\", \"de\", or the path of a file with words, relative to the session file";
        return Err(missing(session, text, ("display.language", 0, language), reason, remedy));
    }
    let LanguageFile(mut words) = parse(&path, &read_text(&path)?)?;
    words.append(&mut spec.display.words);
    spec.display.words = words;
    Ok(())
}
