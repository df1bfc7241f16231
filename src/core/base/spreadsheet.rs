//! Makes text from outside safe for tables that people open with a spreadsheet program.

/// Separators of cells in tables that other programs write.
pub const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

use std::borrow::Cow;

/// What a table's description says about [`without_formula`].
pub const GUARDED: &str =
    "a ' stands before words that begin with = + - @ or a tab, so that no spreadsheet computes them";

/// The text of a table's cell, which no spreadsheet program takes for a formula: text that begins like one gets a `'` in
/// front (as OWASP advises against CSV injection). Numbers stay as they are.
pub fn without_formula(text: &str) -> Cow<'_, str> {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    if is_formula { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}
