//! Text in terminal columns: its width, and how it is cut or broken into lines.

use ratatui::text::Span;

use tomcom_core::base::text::printable;

/// Terminal columns that a text takes.
pub fn width(text: &str) -> u16 {
    Span::raw(printable(text)).width() as u16
}

/// The text cut to `columns`, with an ellipsis if something was cut off.
pub fn fit(text: &str, columns: u16, ellipsis: &str) -> String {
    let text = printable(text);
    if width(&text) <= columns {
        return text.to_string();
    }
    let mut cut = String::new();
    for letter in text.chars() {
        if width(&cut) + width(letter.encode_utf8(&mut [0; 4])) + width(ellipsis) > columns {
            break;
        }
        cut.push(letter);
    }
    cut.truncate(cut.trim_end().len());
    if columns >= width(ellipsis) {
        cut.push_str(ellipsis);
    }
    cut
}

/// The end of a text in `columns`, after an ellipsis if its beginning was cut off.
pub fn fit_end(text: &str, columns: u16, ellipsis: &str) -> String {
    let mut end = text;
    while width(end) + if end.len() < text.len() { width(ellipsis) } else { 0 } > columns {
        let Some((first, _)) = end.char_indices().nth(1) else { break };
        end = &end[first..];
    }
    if end.len() < text.len() { format!("{ellipsis}{end}") } else { text.to_string() }
}

/// Shortens a content to this number of columns: first removes spaces after plus signs, then cuts the end, with an
/// ellipsis.
pub fn squeeze(content: &str, columns: u16, ellipsis: &str) -> String {
    match width(content) <= columns {
        true => content.to_string(),
        false => fit(&content.replace(" + ", " +"), columns, ellipsis),
    }
}

/// Breaks a text between words into lines of at most `columns` characters.
pub fn wrap(text: &str, columns: u16) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line) + 1 + width(word) <= columns => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

/// A text beside `first`, broken between words into lines from column `indent` to `columns`.
pub fn beside(first: &str, text: &str, indent: u16, columns: u16) -> String {
    let lines = wrap(text, columns.saturating_sub(indent).max(indent));
    let starts = std::iter::once(first).chain(std::iter::repeat(""));
    starts.zip(&lines).map(|(start, line)| format!("{start:indent$}{line}\n", indent = usize::from(indent))).collect()
}

/// Breaks a text into at most `rows` lines, with an ellipsis if something was cut off.
pub fn wrap_to(text: &str, columns: u16, rows: u16, ellipsis: &str) -> Vec<String> {
    let mut lines = wrap(text, columns);
    let rows = usize::from(rows);
    if lines.len() > rows && rows > 0 {
        let last = lines.split_off(rows - 1).join(" ");
        lines.push(fit(&last, columns, ellipsis));
    }
    lines
}
