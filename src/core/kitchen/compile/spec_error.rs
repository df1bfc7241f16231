//! Errors in a layout or recipe file, with the position of the error and a remedy.

use std::ops::Range;

use toml::Spanned;

use crate::kitchen::look::Appearance;

/// The file of a kitchen that contains an error: layout or recipes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KitchenFileKind {
    /// The layout file of a kitchen.
    Layout,
    /// The recipe file of a kitchen.
    Recipes,
}

/// Error: a layout or recipe file contains something invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{found}")]
pub struct KitchenFileError {
    /// The file that contains the error.
    pub file: KitchenFileKind,
    /// Position of the error in the file's text, in bytes; `None` for the file as a whole.
    pub span: Option<Range<usize>>,
    /// What the file contains at the position of the error.
    pub found: String,
    /// What the file would have to contain there instead.
    pub remedy: String,
}

/// Result of a step that compiles a kitchen from its files.
pub(super) type Result<T> = std::result::Result<T, KitchenFileError>;

/// An error at a position in a layout or recipe file.
pub(super) fn wrong(
    file: KitchenFileKind,
    span: Range<usize>,
    found: impl Into<String>,
    remedy: impl Into<String>,
) -> KitchenFileError {
    KitchenFileError { file, span: Some(span), found: found.into(), remedy: remedy.into() }
}

/// An error that concerns a layout or recipe file as a whole.
pub(super) fn wrong_file(
    file: KitchenFileKind,
    found: impl Into<String>,
    remedy: impl Into<String>,
) -> KitchenFileError {
    KitchenFileError { file, span: None, found: found.into(), remedy: remedy.into() }
}

/// Reads the appearance of an item, a dish or a place: a shape and its colours.
pub(super) fn look(file: KitchenFileKind, text: &Spanned<String>) -> Result<Appearance> {
    Appearance::read(text.get_ref())
        .map_err(|remedy| wrong(file, text.span(), format!("look = \"{}\"", text.get_ref()), remedy))
}
