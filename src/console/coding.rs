//! Coding of a recording by raters: its state, the rater's actions, the codebook, and the place of the list of errors.

use ratatui::layout::Rect;

use super::actions::refuse;
use super::chord::KeyChord;
use super::console_model::{ConsoleCommand, ConsoleModel, ReplayAction};
use super::key_action::{KeyAction, KeyBinding, RaterAction};
use super::keys::KeyBindings;
use super::text_columns::{width, wrap};
use super::view::regions::{PanelAreas, ScreenSize, inside};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::raters::{ErrorCauseCode, ErrorCauseKind, RaterCodes, RaterConsensus};
use tomcom_session::Session;
use tomcom_session::error_list::ListedError;
use tomcom_session::history::wording;

pub fn act(model: &mut ConsoleModel, session: &Session, rate: RaterAction) -> Option<ConsoleCommand> {
    let events = model.playback.as_ref().map_or(0, |playback| playback.event);
    let coding = model.coding.as_mut()?;
    let at = coding.at(events);
    let chosen = coding.chosen.take().filter(|chosen| Some(*chosen) != at);
    let code = match rate {
        RaterAction::Next => return go(model, chosen.or(Some(at.map_or(0, |at| at + 1)))),
        RaterAction::Last => return go(model, at.and_then(|at| at.checked_sub(1))),
        RaterAction::ChooseLater | RaterAction::ChooseEarlier => {
            let last = coding.errors.len().checked_sub(1)?;
            let from = chosen.or(at);
            coding.chosen = Some(match rate {
                RaterAction::ChooseLater => from.map_or(0, |from| (from + 1).min(last)),
                _ => from.map_or(0, |from| from.saturating_sub(1)),
            });
            return None;
        }
        RaterAction::Undo => return undone(model, false),
        RaterAction::Redo => return undone(model, true),
        RaterAction::Belief(location) => Some(ErrorCauseCode::Belief(session.kitchen.location(location).name.clone())),
        RaterAction::Cause(kind) => ErrorCauseCode::new(kind, None),
        RaterAction::Clear => None,
    };
    if let Some(error) = chosen.and_then(|chosen| coding.errors.get(chosen)) {
        let words =
            format!("no code given: error {} is only selected; enter goes to it, esc deselects it", error.error);
        coding.chosen = chosen;
        return refuse(model, words);
    }
    let Some(press) = coding.present(events).map(|error| error.press) else {
        return refuse(model, "there is no error before this point of the recording");
    };
    let was = coding.codes.0.get(&press).cloned();
    coding.give(press, code);
    Some(ConsoleCommand::Code { press, was })
}

/// Moves the replay to the error with this index, if there is one.
fn go(model: &mut ConsoleModel, to: Option<usize>) -> Option<ConsoleCommand> {
    let errors = model.coding.as_ref().map(|coding| &coding.errors)?;
    let Some(error) = to.and_then(|to| errors.get(to)) else {
        return refuse(model, "the recording has no other error");
    };
    Some(ConsoleCommand::Move(ReplayAction::ToEvent(error.press)))
}

/// Undoes the rater's last change of a code, or redoes it.
fn undone(model: &mut ConsoleModel, again: bool) -> Option<ConsoleCommand> {
    let coding = model.coding.as_mut()?;
    let changed = coding.undo(again);
    if changed.is_none() {
        let nothing = if again {
            "no undone change of a code that could be redone"
        } else {
            "no code was changed since the recording was opened"
        };
        return refuse(model, nothing);
    }
    changed.map(|(press, was)| ConsoleCommand::Code { press, was })
}

/// Moves the replay to the error with this index in the list.
pub(super) fn go_to(model: &mut ConsoleModel, index: usize) -> Option<ConsoleCommand> {
    if let Some(coding) = &mut model.coding {
        coding.chosen = None;
    }
    go(model, Some(index))
}

/// Who codes the errors of a recording: one rater, or two raters together.
#[derive(Clone, Debug, PartialEq)]
pub enum CodingRaters {
    Rater(String),
    Pair {
        consensus: RaterConsensus,
        /// Codes that each rater gave alone, in the order of the consensus.
        own: [RaterCodes; 2],
    },
}

/// A change of an error's code, which can be undone; of an undone one, the change back.
#[derive(Clone, Debug, PartialEq)]
struct CodeChange {
    press: u64,
    before: Option<ErrorCauseCode>,
    after: Option<ErrorCauseCode>,
}

/// State of coding the errors of a recording: the codes so far, and the steps to undo.
#[derive(Clone, Debug, PartialEq)]
pub struct RaterSession {
    pub party: CodingRaters,
    /// Errors to be coded, in order of time; for two raters, their disagreements.
    pub errors: Vec<ListedError>,
    /// Codes so far: the causes of errors, by the sequence number of the press.
    pub codes: RaterCodes,
    /// Names of other raters who have coded every error of the recording.
    pub finished: Vec<String>,
    /// Row of the error list that the arrow keys have selected, while the replay does not stand at that error.
    pub chosen: Option<usize>,
    pub is_saved: bool,
    /// Codes of the errors at the time when the recording was opened.
    opened: RaterCodes,
    done: Vec<CodeChange>,
    undone: Vec<CodeChange>,
}

impl RaterSession {
    /// State of coding when a recording is opened.
    pub fn new(party: CodingRaters, errors: Vec<ListedError>, codes: RaterCodes) -> RaterSession {
        let opened = codes.clone();
        let (done, undone) = (Vec::new(), Vec::new());
        RaterSession { party, errors, codes, finished: Vec::new(), chosen: None, is_saved: true, opened, done, undone }
    }

    /// Index of the last error among the first `events` events of the recording, where the replay stands.
    pub fn at(&self, events: usize) -> Option<usize> {
        self.errors.partition_point(|error| error.press < events as u64).checked_sub(1)
    }

    /// The last error among the first `events` events of the recording, where the replay stands.
    pub fn present(&self, events: usize) -> Option<&ListedError> {
        self.errors.get(self.at(events)?)
    }

    /// Index of the first error that has no code yet.
    pub fn first_open(&self) -> Option<usize> {
        self.errors.iter().position(|error| self.code(error).is_none())
    }

    /// The rater's code of an error, if there is one.
    pub fn code(&self, error: &ListedError) -> Option<&ErrorCauseCode> {
        self.codes.0.get(&error.press)
    }

    /// Number of errors that have a rater's code.
    pub fn coded(&self) -> usize {
        self.errors.iter().filter(|error| self.code(error).is_some()).count()
    }

    /// Number of errors whose code was given or changed since the recording was opened.
    pub fn coded_now(&self) -> usize {
        let is_new = |error: &&ListedError| {
            let code = self.code(error);
            code.is_some() && code != self.opened.0.get(&error.press)
        };
        self.errors.iter().filter(is_new).count()
    }

    pub fn give(&mut self, press: u64, code: Option<ErrorCauseCode>) {
        let before = self.codes.0.get(&press).cloned();
        if before != code {
            self.done.push(CodeChange { press, before, after: code.clone() });
            self.undone.clear();
            self.set(press, code);
        }
    }

    /// Undoes the last change of a code, or redoes the one that was undone last (`again`); returns the sequence number of
    /// the press whose code changed, and what it was.
    pub fn undo(&mut self, again: bool) -> Option<(u64, Option<ErrorCauseCode>)> {
        let (from, to) = if again { (&mut self.undone, &mut self.done) } else { (&mut self.done, &mut self.undone) };
        let CodeChange { press, before, after } = from.pop()?;
        to.push(CodeChange { press, before: after.clone(), after: before.clone() });
        self.set(press, before);
        Some((press, after))
    }

    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    fn set(&mut self, press: u64, code: Option<ErrorCauseCode>) {
        match code {
            Some(code) => self.codes.0.insert(press, code),
            None => self.codes.0.remove(&press),
        };
    }

    /// Names of the raters: "R1", "R1 and R2".
    pub fn name(&self) -> String {
        match &self.party {
            CodingRaters::Rater(rater) => rater.clone(),
            CodingRaters::Pair { consensus, .. } => consensus.raters.join(" and "),
        }
    }

    /// Coding progress in words: "12/31 coded, 3 since opening".
    pub fn progress(&self) -> String {
        let (what, all, coded) = (self.verb(), self.errors.len(), self.coded());
        match self.coded_now() {
            0 => format!("{coded}/{all} errors {what}"),
            now => format!("{coded}/{all} {what}, {now} since opening"),
        }
    }

    /// The rater's code of an error in words; "-" if there is none.
    pub fn words(code: Option<&ErrorCauseCode>) -> String {
        code.map_or("-".to_string(), wording::code)
    }

    /// The code that each of two raters gave an error alone: "R1: slip"; empty for a single rater.
    pub fn own(&self, error: &ListedError) -> Vec<String> {
        let CodingRaters::Pair { consensus, own } = &self.party else { return Vec::new() };
        let of = |(rater, codes): (&String, &RaterCodes)| {
            format!("{rater}: {}", RaterSession::words(codes.0.get(&error.press)))
        };
        consensus.raters.iter().zip(own).map(of).collect()
    }

    pub fn next_step(&self) -> Option<String> {
        if self.first_open().is_some() {
            return None;
        }
        let number = self.errors.len();
        Some(match &self.party {
            CodingRaters::Pair { .. } if number == 0 => {
                "nothing to settle: the raters agree on what both coded".to_string()
            }
            CodingRaters::Pair { .. } => "all is settled; tomcom codes tells what lacks a code".to_string(),
            CodingRaters::Rater(_) if number == 0 => "no error in this recording: nothing to code".to_string(),
            CodingRaters::Rater(rater) => {
                let next = match self.finished.first() {
                    None => "a second rater codes independently, with --rater".to_string(),
                    Some(other) => format!("tomcom codes compares, --settle {other} {rater} settles"),
                };
                format!("every error is coded; next: {next}")
            }
        })
    }

    /// Verb for the progress: errors are "coded" by one rater, "settled" by two.
    fn verb(&self) -> &'static str {
        match self.party {
            CodingRaters::Rater(_) => "coded",
            CodingRaters::Pair { .. } => "settled",
        }
    }
}

/// Columns between two codebook entries in a line.
const GAP: u16 = 2;

/// An entry of the rater's codebook: a key and the error cause that it codes, or a heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodebookEntry {
    /// Key that codes this cause; `None` for a heading and for continued lines of a definition.
    pub key: Option<KeyChord>,
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

/// Height of a list of errors, with its frame, from which it has room for more than the errors.
pub const ROOMY_LIST: u16 = 14;

/// The rater's list of errors on the screen.
#[derive(Clone, Copy, Debug)]
pub struct ErrorListLayout {
    /// Screen area above the rows of errors: the coding progress, and the present error in words.
    pub head: Rect,
    /// Screen area of the rows of the list, one for each error.
    pub rows: Rect,
    /// Index of the error that is shown in the first row.
    pub first: usize,
}

impl ErrorListLayout {
    /// Layout of the list of errors while the replay stands after this number of events.
    pub fn new(regions: &PanelAreas, coding: &RaterSession, events: usize) -> ErrorListLayout {
        let area = regions.errors;
        let is_lines = regions.screen_size == ScreenSize::Small || area.height < 8;
        let (inside, head_rows) = match (&coding.party, is_lines) {
            (CodingRaters::Pair { .. }, true) if area.height > 3 => (area, 2),
            (_, true) => (area, 1),
            // Lines above the list of errors: the present error or the next step; where there is room, also the progress
            // bar and what was on the display.
            (CodingRaters::Rater(_), false) => (inside(area), if area.height < ROOMY_LIST { 3 } else { 5 }),
            (CodingRaters::Pair { .. }, false) => (inside(area), if area.height < ROOMY_LIST { 4 } else { 6 }),
        };
        let head_rows = head_rows.min(inside.height);
        let head = Rect { height: head_rows, ..inside };
        let rows = Rect { y: inside.y + head_rows, height: inside.height - head_rows, ..inside };
        let number = coding.errors.len();
        let focus = coding.chosen.or(coding.at(events)).unwrap_or(0);
        let height = usize::from(rows.height);
        let first = focus.saturating_sub(height / 2).min(number.saturating_sub(height));
        ErrorListLayout { head, rows, first }
    }
}
