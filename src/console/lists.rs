//! Lists at the console: filter and cursor of every list; the lists of answers, of all actions (the palette) and of
//! recordings; and the prompt before a recording.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::console_model::{ConsoleModel, Dialog};
use super::key_action::{KeyAction, KeyBinding, ManualAction};
use super::possible::is_possible_behind;
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, LocationId, LocationKind};
use tomcom_session::Session;
use tomcom_session::history::wording;

/// Number of rows that the page up and page down keys move the cursor.
const PAGE: usize = 10;

/// Filter and cursor of an open list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ListCursor {
    /// Typed text by which the rows are filtered.
    pub filter: String,
    /// Index of the row under the cursor, among the rows that match the filter.
    pub at: usize,
}

/// Result of a key in an open list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListReply {
    Open,
    Left,
    Taken,
}

impl ListCursor {
    /// Handles a key, where `rows` rows match the filter.
    pub fn key(&mut self, rows: usize, code: KeyCode) -> ListReply {
        let last = rows.saturating_sub(1);
        let before = self.filter.len();
        match code {
            KeyCode::Up => self.at = self.at.saturating_sub(1),
            KeyCode::Down => self.at += 1,
            KeyCode::PageUp => self.at = self.at.saturating_sub(PAGE),
            KeyCode::PageDown => self.at += PAGE,
            KeyCode::Home => self.at = 0,
            KeyCode::End => self.at = last,
            KeyCode::Enter if self.at < rows => return ListReply::Taken,
            KeyCode::Esc if self.filter.is_empty() => return ListReply::Left,
            KeyCode::Esc => self.filter.clear(),
            KeyCode::Backspace => drop(self.filter.pop()),
            // Punctuation is not part of the filter, so that a question mark does not empty the list.
            KeyCode::Char(letter) if letter.is_alphanumeric() => self.filter.push(letter),
            _ => {}
        }
        self.at = if self.filter.len() == before { self.at.min(last) } else { 0 };
        ListReply::Open
    }

    /// Adds the letters and digits of a pasted text to the filter.
    pub fn paste(&mut self, text: &str) {
        self.filter.extend(text.chars().filter(|letter| letter.is_alphanumeric()));
        self.at = 0;
    }

    /// Whether a row with this text matches the filter: the row's letters and digits contain the filter, or the filter
    /// consists of beginnings of the row's words in their order ("traw" for "tuna raw").
    pub fn keeps(&self, text: &str) -> bool {
        let wanted: Vec<char> = self.filter.to_lowercase().chars().collect();
        let text = text.to_lowercase();
        let words: Vec<Vec<char>> = text
            .split(|letter: char| !letter.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(|word| word.chars().collect())
            .collect();
        let joined: Vec<char> = words.concat();
        wanted.is_empty() || joined.windows(wanted.len()).any(|part| part == wanted) || begins(&words, &wanted)
    }
}

/// Whether `wanted` consists of beginnings of some of these words, in their order.
fn begins(words: &[Vec<char>], wanted: &[char]) -> bool {
    let Some((word, rest)) = words.split_first() else { return wanted.is_empty() };
    let common = word.iter().zip(wanted).take_while(|(letter, typed)| letter == typed).count();
    wanted.is_empty() || (0..=common).any(|taken| begins(rest, &wanted[taken..]))
}

/// Question that a list of answers asks the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PickerKind {
    /// Which location has another content than the program assumes?
    Place,
    Content(LocationId),
    Button,
    Abort,
    Exclude,
    SkipProbe(u32),
}

/// Answer that the wizard chose from a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PickerAnswer {
    Place(LocationId),
    Content(ContentId),
    Button(ButtonId),
    Reason(String),
}

/// An entry of a list from which the wizard chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PickerEntry {
    pub answer: PickerAnswer,
    pub label: String,
    pub remark: String,
}

/// An open list from which the wizard chooses the answer to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picker {
    pub kind: PickerKind,
    pub cursor: ListCursor,
}

/// Result of a key in a list of answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PickerOutcome {
    Nothing,
    Left,
    This(PickerAnswer),
}

impl Picker {
    /// An open list without a filter, with the cursor on the first entry.
    pub fn new(kind: PickerKind) -> Picker {
        Picker { kind, cursor: ListCursor::default() }
    }

    pub fn title(&self, session: &Session) -> String {
        match self.kind {
            PickerKind::Place => "Correct the kitchen: which place?".to_string(),
            PickerKind::Content(place) => format!("What is really at {}?", session.kitchen.location(place).label()),
            PickerKind::Button => "The robot's next press".to_string(),
            PickerKind::Abort => "Abort the trial: why?".to_string(),
            PickerKind::Exclude => "Exclude the trial from the analysis: why?".to_string(),
            PickerKind::SkipProbe(probe) => format!("Skip the rest of probe {probe}: why?"),
        }
    }

    /// Entries of the list that match the filter.
    pub fn choices(&self, session: &Session) -> Vec<PickerEntry> {
        let mut choices = self.all(session);
        choices.retain(|choice| self.cursor.keeps(&choice.label));
        choices
    }

    fn all(&self, session: &Session) -> Vec<PickerEntry> {
        match self.kind {
            PickerKind::Place => places(session),
            PickerKind::Content(place) => contents(session, place),
            PickerKind::Button => buttons(session),
            PickerKind::Abort | PickerKind::Exclude | PickerKind::SkipProbe(_) => reasons(session),
        }
    }

    pub fn key(&mut self, session: &Session, code: KeyCode) -> PickerOutcome {
        let mut choices = self.choices(session);
        match self.cursor.key(choices.len(), code) {
            ListReply::Open => PickerOutcome::Nothing,
            ListReply::Left => PickerOutcome::Left,
            ListReply::Taken => PickerOutcome::This(choices.swap_remove(self.cursor.at).answer),
        }
    }
}

fn places(session: &Session) -> Vec<PickerEntry> {
    let kitchen = &session.kitchen;
    let places = kitchen.locations.iter().enumerate().filter(|(_, location)| location.kind != LocationKind::Order);
    let choice = |(index, location): (usize, &tomcom_core::kitchen::Location)| {
        let id = LocationId(index as u8);
        let remark = kitchen.content_label(session.state, id).to_string();
        PickerEntry { answer: PickerAnswer::Place(id), label: location.label().to_string(), remark }
    };
    places.map(choice).collect()
}

fn contents(session: &Session, place: LocationId) -> Vec<PickerEntry> {
    let kitchen = &session.kitchen;
    let can_be = |id: ContentId| id.is_empty() || kitchen.accepts(place, id);
    let ids = (0..kitchen.contents.len()).map(|index| ContentId(index as u8));
    let left = ids.filter(|&id| can_be(id) && id != session.state.content(place));
    let choice = |id: ContentId| {
        let label = kitchen.content(id).wording.clone();
        PickerEntry { answer: PickerAnswer::Content(id), label, remark: String::new() }
    };
    left.map(choice).collect()
}

fn buttons(session: &Session) -> Vec<PickerEntry> {
    let (kitchen, recipes) = (&session.kitchen, session.kitchen.true_recipes());
    let ids = (0..kitchen.buttons[Agent::Robot.index()].len()).map(|index| ButtonId(index as u8));
    let choice = |id: ButtonId| {
        let does = kitchen.press(session.state, &recipes, Agent::Robot, id).is_some();
        let remark = if does { "" } else { "press has no effect now" }.to_string();
        PickerEntry { answer: PickerAnswer::Button(id), label: wording::button(kitchen, Agent::Robot, id), remark }
    };
    let mut choices: Vec<PickerEntry> = ids.map(choice).collect();
    // Buttons that have an effect now come first.
    choices.sort_by_key(|choice| !choice.remark.is_empty());
    choices
}

fn reasons(session: &Session) -> Vec<PickerEntry> {
    let choice = |reason: &String| PickerEntry {
        answer: PickerAnswer::Reason(reason.clone()),
        label: reason.clone(),
        remark: String::new(),
    };
    session.spec.console.reasons.iter().map(choice).collect()
}

/// Further words by which the palette finds an action: what people type who think of it by another name.
fn synonyms(action: &KeyAction) -> &'static str {
    match action {
        KeyAction::Advance => "begin go continue run",
        KeyAction::EndTrial => "finish stop the trial over",
        KeyAction::Manual(ManualAction::Abort) => "cancel the trial",
        KeyAction::Manual(ManualAction::Redo) => "redo again",
        KeyAction::Manual(ManualAction::NoteInWords) => "comment remark write",
        KeyAction::Note(_) => "marker",
        KeyAction::Manual(ManualAction::Correct) => "fix change mend",
        KeyAction::Manual(ManualAction::Calibrate) => "calibrate calibration eye tracker",
        KeyAction::StopRobot => "halt emergency",
        KeyAction::TakeBack => "undo withdraw hide",
        KeyAction::Quit => "exit close leave end the session",
        KeyAction::Help => "keys manual signs",
        _ => "",
    }
}

/// Actions that may stand first in the open palette, the most likely one first. None of them changes the trial.
const FIRST: [KeyAction; 3] = [KeyAction::Accept, KeyAction::Manual(ManualAction::Preflight), KeyAction::Help];

/// Opens the palette with this filter. Its first action is the one that was chosen last in it, or else a likely one
/// that changes nothing. It is decided here once, so that no row moves under the cursor while the palette is open.
pub(super) fn open(model: &mut ConsoleModel, session: &Session, filter: &str) {
    let likely = model.palette_chosen.iter().chain(&FIRST);
    let does =
        |action: &&KeyAction| model.keys.chord_for(action).is_some() && is_possible_behind(session, model, action);
    model.palette_first = likely.into_iter().find(does).cloned();
    model.dialog = Some(Dialog::Palette(ListCursor { filter: filter.to_string(), at: 0 }));
}

/// Remembers the action that the wizard chose in the palette, unless it stops or ends something.
pub(super) fn remember(model: &mut ConsoleModel, action: &KeyAction) {
    if !ends(action) {
        model.palette_chosen = Some(action.clone());
    }
}

/// Whether an action stops the robot, or ends the trial or the session.
fn ends(action: &KeyAction) -> bool {
    matches!(
        action,
        KeyAction::StopRobot | KeyAction::EndTrial | KeyAction::Quit | KeyAction::Manual(ManualAction::Abort)
    )
}

/// The actions that match the filter, in the order of the help. Without a filter, the one that the palette was opened
/// with is first, and what stops the robot or ends the trial or the session is last.
pub fn actions<'a>(model: &'a ConsoleModel, cursor: &ListCursor) -> Vec<&'a KeyBinding> {
    let is_active = |line: &&KeyBinding| line.layer.is_none_or(|only| only == model.layer);
    let is_left = |line: &&KeyBinding| {
        let words = format!("{} {} {}", line.help, line.group, synonyms(&line.action));
        line.action != KeyAction::Palette && cursor.keeps(&words)
    };
    let mut left: Vec<&KeyBinding> = model.keys.bindings.iter().filter(is_active).filter(is_left).collect();
    if cursor.filter.is_empty() {
        left.sort_by_key(|line| (model.palette_first.as_ref() != Some(&line.action), ends(&line.action)));
    }
    left
}

/// An open list from which the user chooses a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingPicker {
    pub title: String,
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
    pub cursor: ListCursor,
}

/// Result of a key in the list of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingReply {
    /// The recording with this index in [`RecordingPicker::rows`] was chosen.
    Chosen(usize),
    Leave,
}

impl RecordingPicker {
    /// A list of recordings without a filter, with the cursor on its first row.
    pub fn new(title: String, headings: Vec<String>, rows: Vec<Vec<String>>) -> RecordingPicker {
        RecordingPicker { title, headings, rows, cursor: ListCursor::default() }
    }

    /// Indices of the rows that match the filter, within one cell or across neighbouring cells.
    pub fn left(&self) -> Vec<usize> {
        (0..self.rows.len()).filter(|&row| self.cursor.keeps(&self.rows[row].join(" "))).collect()
    }

    pub fn key(&mut self, key: &KeyEvent) -> Option<RecordingReply> {
        let has_control = key.modifiers.contains(KeyModifiers::CONTROL);
        match (key.kind, key.code) {
            (KeyEventKind::Release, _) => None,
            (_, KeyCode::Char('c')) if has_control => Some(RecordingReply::Leave),
            // A held enter key does not open a recording.
            (KeyEventKind::Repeat, KeyCode::Enter) => None,
            (_, KeyCode::Char(_)) if has_control => None,
            (_, code) => self.take(code),
        }
    }

    /// Moves the cursor to a row of the list, counted among the rows that match the filter; chooses the row if the
    /// cursor was already there.
    pub fn click(&mut self, row: usize) -> Option<RecordingReply> {
        if self.cursor.at == row {
            return self.take(KeyCode::Enter);
        }
        self.cursor.at = row;
        None
    }

    pub fn scroll(&mut self, steps: i8) {
        self.take(if steps > 0 { KeyCode::Up } else { KeyCode::Down });
    }

    /// Handles a key in the list of recordings that is pressed without ctrl.
    pub fn take(&mut self, code: KeyCode) -> Option<RecordingReply> {
        let left = self.left();
        match self.cursor.key(left.len(), code) {
            ListReply::Open => None,
            ListReply::Left => Some(RecordingReply::Leave),
            ListReply::Taken => left.get(self.cursor.at).map(|&row| RecordingReply::Chosen(row)),
        }
    }
}

/// A question to the user with numbered answers, shown before a recording begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartPrompt {
    pub title: String,
    pub text: Vec<String>,
    /// Texts of the answers; key 1 selects the first.
    pub answers: Vec<String>,
}

/// Reply of the user to a question before a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartReply {
    Answer(usize),
    Leave,
}

impl StartPrompt {
    /// The reply that a key gives; `None` for other keys and for key repeat.
    pub fn reply(&self, key: &KeyEvent) -> Option<StartReply> {
        if key.kind != KeyEventKind::Press {
            return None;
        }
        match key.code {
            KeyCode::Esc => Some(StartReply::Leave),
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(StartReply::Leave),
            KeyCode::Char(digit @ '1'..='9') => {
                let index = usize::from(digit as u8 - b'1');
                (index < self.answers.len()).then_some(StartReply::Answer(index))
            }
            _ => None,
        }
    }
}
