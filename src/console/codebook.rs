//! The rater's codebook on the console: the error causes that a rater can code, with their keys and definitions.

use super::chord::KeyChord;
use super::key_action::{KeyAction, KeyBinding, RaterAction};
use super::keys::KeyBindings;
use super::text_columns::{width, wrap};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::raters::ErrorCauseKind;

/// Columns between two codebook entries in a line.
const GAP: u16 = 2;

/// An entry of the rater's codebook: a key and the error cause that it codes, or a heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodebookEntry {
    /// Key that codes this cause; `None` for a heading and for continued lines of a definition.
    pub key: Option<KeyChord>,
    /// Text of the entry: the error's cause with its definition, or a heading.
    pub words: String,
}

impl CodebookEntry {
    fn heading(words: String) -> CodebookEntry {
        CodebookEntry { key: None, words }
    }

    /// Columns that the codebook entry takes, with a space after its key.
    fn columns(&self) -> u16 {
        key_columns(self.key) + width(&self.words)
    }
}

/// A line of the codebook: entries, each with the number of columns before it.
pub type CodebookLine = Vec<(u16, CodebookEntry)>;

/// The codebook for a panel with this number of columns: first the causes with their definitions, one a line, then the
/// places about which a belief can be false.
pub fn full(keys: &KeyBindings, kitchen: &Kitchen, columns: u16) -> Vec<CodebookLine> {
    let mut lines: Vec<CodebookLine> = Vec::new();
    for CodebookEntry { key, words } in of_kinds(keys, |kind| Some(kind.definition())) {
        let indent = key_columns(key);
        for (row, words) in wrap(&words, columns.saturating_sub(indent)).into_iter().enumerate() {
            let (before, key) = if row == 0 { (0, key) } else { (indent, None) };
            lines.push(vec![(before, CodebookEntry { key, words })]);
        }
    }
    let belief = format!("{} ({}):", ErrorCauseKind::Belief.title(), ErrorCauseKind::Belief.definition());
    lines.extend(wrap(&belief, columns).into_iter().map(|words| vec![(0, CodebookEntry::heading(words))]));
    let places = places(keys, kitchen);
    let widest = places.iter().map(CodebookEntry::columns).max().unwrap_or(0) + GAP;
    let across = usize::from(((columns + GAP) / widest).max(1));
    let down = places.len().div_ceil(across).max(1);
    for row in 0..down {
        let of_row = places.iter().skip(row).step_by(down).enumerate();
        lines.push(of_row.map(|(column, entry)| (column as u16 * widest, entry.clone())).collect());
    }
    lines
}

/// The codebook without definitions, in as few lines of at most `columns` as possible.
pub fn compact(keys: &KeyBindings, kitchen: &Kitchen, columns: u16) -> Vec<CodebookLine> {
    let mut beliefs = vec![CodebookEntry::heading(ErrorCauseKind::Belief.title().to_string())];
    beliefs.extend(places(keys, kitchen));
    let mut lines = flow(of_kinds(keys, ErrorCauseKind::short_definition), columns);
    lines.extend(flow(beliefs, columns));
    lines
}

/// Codebook entries of the places about which a belief can be false: "q order 1".
fn places(keys: &KeyBindings, kitchen: &Kitchen) -> Vec<CodebookEntry> {
    let entry = |line: &KeyBinding| match line.action {
        KeyAction::Rate(RaterAction::Belief(location)) => {
            Some(CodebookEntry { key: Some(*line.chords.first()?), words: kitchen.location(location).label() })
        }
        _ => None,
    };
    keys.bindings.iter().filter_map(entry).collect()
}

/// Codebook entries of the error causes that need no place: "1 slip: nothing was believed wrong".
fn of_kinds(keys: &KeyBindings, definition: impl Fn(ErrorCauseKind) -> Option<&'static str>) -> Vec<CodebookEntry> {
    let entry = |kind: ErrorCauseKind| {
        let key = Some(keys.chord_for(&KeyAction::Rate(RaterAction::Cause(kind)))?);
        let definition = definition(kind).map_or(String::new(), |definition| format!(": {definition}"));
        Some(CodebookEntry { key, words: format!("{}{definition}", kind.title()) })
    };
    ErrorCauseKind::ALL.into_iter().filter_map(entry).collect()
}

fn flow(entries: Vec<CodebookEntry>, columns: u16) -> Vec<CodebookLine> {
    let mut lines: Vec<CodebookLine> = Vec::new();
    let mut used = 0;
    for entry in entries {
        let needed = entry.columns();
        if lines.is_empty() || used + needed > columns {
            (used, lines) = (0, [lines, vec![Vec::new()]].concat());
        }
        if let Some(line) = lines.last_mut() {
            line.push((used, entry));
        }
        used += needed + GAP;
    }
    lines
}

/// Columns of a key and the space after it.
fn key_columns(key: Option<KeyChord>) -> u16 {
    key.map_or(0, |key| width(&key.to_string()) + 1)
}
