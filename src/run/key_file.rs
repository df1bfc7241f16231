//! Reads key files, which change the keys of the console.

use std::path::Path;

use toml::Spanned;

use crate::console::KeyFileBindings;
use crate::console::key_action::{KeyError, KeyErrorSource, KeyLayer};
use crate::console::keys;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::files::{LayoutSpec, is_same_key};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::parse::{FileKind, ParsedFile, parse};
use tomcom_session::header::RecordedFile;

impl ParsedFile for KeyFileBindings {
    const KIND: FileKind = FileKind::Keys;
}

/// Checks the keys in a kitchen's layout file together with a key file.
///
/// # Errors
/// A key is used twice, or the key file is invalid.
pub(super) fn check_keys(
    (path, text): (&Path, &str),
    layout: &LayoutSpec,
    kitchen: &Kitchen,
    keys: Option<&RecordedFile>,
) -> FileResult<()> {
    let map = key_map(keys)?;
    let Err(KeyError { place, found, remedy }) = keys::lines(kitchen, &map) else { return Ok(()) };
    match (place, keys) {
        (KeyErrorSource::File(span), Some(keys)) => {
            Err(FileError::at(Path::new(&keys.path), &keys.text, Some(span), found, remedy))
        }
        (KeyErrorSource::Layout(layer, letter), _) => {
            let is_it = |key: &&Spanned<char>| is_same_key(*key.get_ref(), letter);
            let key = match layer {
                KeyLayer::Wizard => layout.signal_keys().map(|(_, key)| key).find(is_it),
                KeyLayer::Participant => layout.button_keys().find(is_it),
            };
            Err(FileError::at(path, text, key.map(Spanned::span), found, remedy))
        }
        (KeyErrorSource::File(_), None) => Ok(()),
    }
}

/// Parses a key file into key bindings; without a file there are no bindings.
///
/// # Errors
/// The text is not a key file.
pub fn key_map(keys: Option<&RecordedFile>) -> FileResult<KeyFileBindings> {
    keys.map_or(Ok(KeyFileBindings::default()), |keys| parse(Path::new(&keys.path), &keys.text))
}
