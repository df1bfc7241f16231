//! Text: numbers in words, text from outside that is safe to show, cells of tables, paths.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt;
use std::fmt::Write;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize, Serializer};

/// A number with its noun in singular or plural: "1 press", "2 presses".
pub fn count(number: impl Into<u64>, one: &str, many: &str) -> String {
    let number = number.into();
    format!("{number} {}", if number == 1 { one } else { many })
}

/// A number with this many decimal places; "-" if it is not known.
pub fn decimal(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_string(), |value| format!("{value:.digits$}"))
}

/// A number with this many decimal places, or as a power of ten where these would show nothing of it, or too much:
/// "0.0300", "1e-6", "1e18".
pub fn short(value: f64, digits: usize) -> String {
    let size = value.abs();
    let is_shown = size == 0.0 || (0.1_f64.powi(digits as i32 - 1)..1e6).contains(&size);
    if is_shown || !value.is_finite() {
        return format!("{value:.digits$}");
    }
    let power = format!("{value:.2e}");
    let (digits, exponent) = power.split_once('e').unwrap_or((&power, "0"));
    format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// A share of 1 in percent, with one decimal place: "12.5 %"; "-" if it is not known.
pub fn percent(share: Option<f64>) -> String {
    share.map_or("-".to_string(), |share| format!("{:.1} %", 100.0 * share))
}

/// Largest number of wrong letters in a mistyped name for which another is suggested.
const MOST_EDITS: usize = 2;

/// The name that is nearest to a mistyped one, whose capital letters do not matter; at least half of the letters must be
/// right. `None` if no name is near.
pub fn nearest<Name: AsRef<str>>(mistyped: &str, names: impl IntoIterator<Item = Name>) -> Option<Name> {
    let most = MOST_EDITS.min(mistyped.chars().count() / 2);
    let mistyped = mistyped.to_lowercase();
    let edits = |name: Name| (strsim::osa_distance(&mistyped, &name.as_ref().to_lowercase()), name);
    let near = names.into_iter().map(edits).filter(|(edits, _)| *edits <= most);
    near.min_by(|a, b| (a.0, a.1.as_ref()).cmp(&(b.0, b.1.as_ref()))).map(|(_, name)| name)
}

/// "; did you mean rice?"; empty if no name is near.
pub fn did_you_mean<Name: AsRef<str>>(mistyped: &str, names: impl IntoIterator<Item = Name>) -> String {
    nearest(mistyped, names).map_or(String::new(), |name| format!("; did you mean {}?", name.as_ref()))
}

/// The text in one line. Control characters, directional formatting characters and line separators are escaped as in
/// JSON (`\u001b`, `\n`).
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |_, _| false)
}

/// A text of several lines made printable: control characters are escaped, but ends of lines and tabs stay. A JSON text
/// keeps its values.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |letter, next| matches!(letter, '\n' | '\t') || (letter == '\r' && next == Some('\n')))
}

fn escaped(text: &str, stays: impl Fn(char, Option<char>) -> bool) -> Cow<'_, str> {
    if !text.chars().any(is_control) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            letter if !is_control(letter) || stays(letter, letters.peek().copied()) => out.push(letter),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            // No control character lies beyond U+FFFF; writing to a string cannot fail.
            letter => drop(write!(out, "\\u{:04x}", u32::from(letter))),
        }
    }
    Cow::Owned(out)
}

/// Whether a character controls a terminal or the order of the text: control characters (C0, DEL, C1), and Unicode's
/// directional formatting characters and line separators.
fn is_control(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Separators of cells in tables that other programs write.
pub const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// What a table's description says about [`without_formula`].
pub const GUARDED: &str =
    "a ' stands before words that begin with = + - @ or a tab, so that no spreadsheet computes them";

/// The text of a table's cell, which no spreadsheet program takes for a formula: text that begins like one gets a `'` in
/// front (as OWASP advises against CSV injection). Numbers stay as they are.
pub fn without_formula(text: &str) -> Cow<'_, str> {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    if is_formula { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}

/// A path that is written as text. On many systems a path is any bytes, and serde refuses to write a path that is not
/// UTF-8; here, bytes that are no text become replacement characters.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct PathText(pub PathBuf);

impl Deref for PathText {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for PathText {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl AsRef<OsStr> for PathText {
    fn as_ref(&self) -> &OsStr {
        self.as_os_str()
    }
}

impl From<PathBuf> for PathText {
    fn from(path: PathBuf) -> PathText {
        PathText(path)
    }
}

impl fmt::Display for PathText {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.display().fmt(out)
    }
}

impl Serialize for PathText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
