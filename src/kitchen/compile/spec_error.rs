//! What can be wrong with a layout or recipe file, and how it is said.

use std::ops::Range;

use toml::Spanned;

use crate::kitchen::look::Appearance;

/// Which of the two files an error is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpecFile {
    /// The layout file.
    Layout,
    /// The recipe file.
    Recipes,
}

/// Something in a layout or recipe file that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{found}")]
pub struct SpecError {
    /// The file that the error is in.
    pub file: SpecFile,
    /// Where in the file's text, in bytes.
    pub span: Option<Range<usize>>,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: String,
}

/// What a step of the compilation gives.
pub(super) type Result<T> = std::result::Result<T, SpecError>;

/// An error at a place in a file.
pub(super) fn wrong(
    file: SpecFile,
    span: Range<usize>,
    found: impl Into<String>,
    remedy: impl Into<String>,
) -> SpecError {
    SpecError { file, span: Some(span), found: found.into(), remedy: remedy.into() }
}

/// An error of a file as a whole.
pub(super) fn wrong_file(file: SpecFile, found: impl Into<String>, remedy: impl Into<String>) -> SpecError {
    SpecError { file, span: None, found: found.into(), remedy: remedy.into() }
}

/// Reads how something looks.
pub(super) fn look(file: SpecFile, text: &Spanned<String>) -> Result<Appearance> {
    Appearance::read(text.get_ref())
        .map_err(|remedy| wrong(file, text.span(), format!("look = \"{}\"", text.get_ref()), remedy))
}
