//! Text from outside (names of files, notes, devices, excerpts) made fit to be shown: whatever could command a terminal is
//! written out.

use std::borrow::Cow;
use std::fmt::Write;

/// The text on one line. Control characters stand as JSON writes them (`\u001b`, `\n`), and so do the characters that reverse
/// the direction of writing or break a line.
pub fn printable(text: &str) -> Cow<'_, str> {
    written_out(text, |_, _| false)
}

/// The same for text of several lines: ends of lines and tabs stay. In JSON it changes no value.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    written_out(text, |letter, next| matches!(letter, '\n' | '\t') || (letter == '\r' && next == Some('\n')))
}

fn written_out(text: &str, stays: impl Fn(char, Option<char>) -> bool) -> Cow<'_, str> {
    if !text.chars().any(commands) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            letter if !commands(letter) || stays(letter, letters.peek().copied()) => out.push(letter),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            // None of them is beyond U+FFFF; writing to a string cannot fail.
            letter => drop(write!(out, "\\u{:04x}", u32::from(letter))),
        }
    }
    Cow::Owned(out)
}

/// Whether a terminal does something else with a character than show it: controls (C0, DEL, C1), and Unicode's directional
/// formatting characters and line separators.
fn commands(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
