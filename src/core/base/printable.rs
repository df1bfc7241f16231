//! Makes text from outside (file names, notes, device names, excerpts of files) safe to show: characters that control a
//! terminal are escaped.

use std::borrow::Cow;
use std::fmt::Write;

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
