//! Lists at the console: filter and cursor of every list; the lists of answers, of all actions (the palette) and of
//! recordings; and the prompt before a recording.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::chord::KeyChord;
use super::console_model::{ConsoleModel, Dialog, ReplayAction};
use super::key_action::{KeyAction, KeyBinding, ManualAction};
use super::possible::is_possible_behind;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonId, ContentId, LocationId, LocationKind};
use tomcom_session::Session;
use tomcom_session::history::wording;
use tomcom_session::replay::ReplayLandmark;

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

/// Whether these letters are beginnings of some of these words, in their order. One letter is enough only for a word of one
/// letter, and for the last.
fn begin_words(letters: &str, words: &[String]) -> bool {
    letters.is_empty()
        || words.iter().enumerate().any(|(index, word)| {
            let begun = letters.char_indices().map(|(at, letter)| at + letter.len_utf8());
            let begun = begun.enumerate().take_while(|(_, end)| word.starts_with(&letters[..*end]));
            let enough = |(at, end): &(usize, usize)| *at > 0 || *end == word.len() || *end == letters.len();
            begun.filter(enough).any(|(_, end)| begin_words(&letters[end..], &words[index + 1..]))
        })
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
            KeyCode::Esc => return ListReply::Left,
            KeyCode::Backspace => drop(self.filter.pop()),
            // Other signs are not part of the filter, so that a question mark does not empty the list.
            KeyCode::Char(letter) if is_typed(letter) => self.filter.push(letter),
            KeyCode::Char(letter @ (' ' | ':' | '.')) if !self.filter.is_empty() => self.filter.push(letter),
            _ => {}
        }
        self.at = if self.filter.len() == before { self.at.min(last) } else { 0 };
        ListReply::Open
    }

    /// Adds the words of a pasted text to the filter.
    pub fn paste(&mut self, text: &str) {
        self.filter.extend(text.chars().filter(|letter| is_typed(*letter) || [' ', ':', '.'].contains(letter)));
        self.at = 0;
    }

    /// Indices of the rows with these texts that match the filter, the best one first. Only the best kind of match is
    /// kept, so that a whole code leaves its own row: each typed word begins a word; or each lies within a word; or what is
    /// typed is made of beginnings of a line's words, since the palette takes no spaces: "stoprobot".
    pub fn found(&self, rows: impl Iterator<Item = String>) -> Vec<usize> {
        let mut found = self.ranked(rows);
        let best = found.first().map(|((kind, _), _)| *kind);
        found.retain(|((kind, _), _)| Some(*kind) == best);
        found.into_iter().map(|(_, index)| index).collect()
    }

    /// Likewise, but only those in which each typed word begins a word.
    fn begun(&self, rows: impl Iterator<Item = String>) -> Vec<usize> {
        self.ranked(rows).into_iter().filter(|((kind, _), _)| *kind == 0).map(|(_, index)| index).collect()
    }

    /// The rows that match: kind of the match, how bad it is, and index; the best one first.
    fn ranked(&self, rows: impl Iterator<Item = String>) -> Vec<((u8, i64), usize)> {
        let typed = self.filter.to_lowercase();
        let joined = |line: &str| line.chars().filter(|letter| letter.is_alphanumeric()).collect::<String>();
        let rank = |text: String| {
            let text = text.to_lowercase();
            // From each beginning of a word to the end of the text: what is typed can go over "/" and "-".
            let is_word = |letter: Option<char>| letter.is_some_and(char::is_alphanumeric);
            let begins = |at: usize| is_word(text[at..].chars().next()) && !is_word(text[..at].chars().next_back());
            let ends = |rest: &str| !is_word(rest.chars().next());
            let word_of = |rest: &str| rest.split(|letter: char| !letter.is_alphanumeric()).take(1).collect::<String>();
            let words = || text.char_indices().filter(|(at, _)| begins(*at)).map(|(at, _)| &text[at..]);
            let has = |is_it: &dyn Fn(&str, &str) -> bool| {
                typed.split_whitespace().filter(|typed| words().any(|word| is_it(word, typed))).count()
            };
            let all = typed.split_whitespace().count();
            let letters = joined(&typed);
            match () {
                () if has(&|word, typed| word.starts_with(typed)) == all => {
                    Some((0, (all - has(&|word, typed| word.strip_prefix(typed).is_some_and(ends))) as i64))
                }
                () if has(&|rest, typed| word_of(rest).contains(typed)) == all => Some((1, 0)),
                () => {
                    let of_line = |line: &str| {
                        line.split(|letter: char| !letter.is_alphanumeric()).map(str::to_string).collect::<Vec<_>>()
                    };
                    text.lines().any(|line| begin_words(&letters, &of_line(line))).then_some((2, 0))
                }
            }
        };
        let mut found: Vec<_> = rows.enumerate().filter_map(|(index, text)| Some((rank(text)?, index))).collect();
        found.sort_unstable();
        found
    }

    /// Takes a digit where nothing is typed to filter the rows: the cursor goes to the row of that number. One without a row
    /// begins no words of another reason.
    fn number(&mut self, rows: usize, code: KeyCode) -> bool {
        let KeyCode::Char(letter) = code else { return false };
        let Some(digit) = letter.to_digit(10).filter(|_| self.filter.is_empty()) else { return false };
        if (1..=rows).contains(&(digit as usize)) {
            self.at = digit as usize - 1;
        }
        true
    }
}

/// Whether a typed sign is part of a filter.
fn is_typed(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '/' | '-' | '^')
}

/// Last entry of every list of reasons: its words are typed.
pub const OTHER_REASON: &str = "other reason";

/// What the wizard gives a reason for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReasonFor {
    Abort,
    Exclude,
    SkipProbe(u32),
    /// Going on in a plan although the practice criterion is not met. Its reasons stand on a sheet, not in a list.
    Waive,
}

/// Question that a list of answers asks the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PickerKind {
    /// Which location has another content than the program assumes?
    Place,
    Content(LocationId),
    Button,
    Reason(ReasonFor),
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
    /// What was typed is no entry, so it begins the words of another reason.
    Words(String),
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
            PickerKind::Reason(ReasonFor::Abort) => "Abort the trial: why?".to_string(),
            PickerKind::Reason(ReasonFor::Exclude) => "Exclude the trial from the analysis: why?".to_string(),
            PickerKind::Reason(ReasonFor::SkipProbe(probe)) => format!("Skip the rest of probe {probe}: why?"),
            PickerKind::Reason(ReasonFor::Waive) => "Waive the practice criterion: why?".to_string(),
        }
    }

    /// Whether words can be typed to the chosen reason: not while the trial runs, for there the space bar stops the robot.
    pub fn takes_words(&self, session: &Session) -> bool {
        matches!(self.kind, PickerKind::Reason(_)) && !session.is_running()
    }

    /// Entries of the list that match the filter.
    pub fn choices(&self, session: &Session) -> Vec<PickerEntry> {
        let all = self.all(session);
        let labels = all.iter().map(|choice| choice.label.clone());
        let found = match self.takes_words(session) {
            // Words of another reason must not match an entry by a part of a word.
            true => self.cursor.begun(labels),
            false => self.cursor.found(labels),
        };
        found.into_iter().map(|index| all[index].clone()).collect()
    }

    fn all(&self, session: &Session) -> Vec<PickerEntry> {
        match self.kind {
            PickerKind::Place => places(session),
            PickerKind::Content(place) => contents(session, place),
            PickerKind::Button => buttons(session),
            PickerKind::Reason(_) => reasons(session, self.takes_words(session)),
        }
    }

    pub fn key(&mut self, session: &Session, code: KeyCode) -> PickerOutcome {
        let mut choices = self.choices(session);
        if self.cursor.number(choices.len(), code) {
            return PickerOutcome::Nothing;
        }
        match self.cursor.key(choices.len(), code) {
            ListReply::Open => self.other_words(session).map_or(PickerOutcome::Nothing, PickerOutcome::Words),
            ListReply::Left => PickerOutcome::Left,
            ListReply::Taken => PickerOutcome::This(choices.swap_remove(self.cursor.at).answer),
        }
    }

    /// The typed words, if they are the beginning of another reason than those of the list.
    pub fn other_words(&self, session: &Session) -> Option<String> {
        (self.takes_words(session) && self.choices(session).is_empty()).then(|| self.cursor.filter.clone())
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

/// The preset reasons and, where words can be typed, another one.
fn reasons(session: &Session, takes_words: bool) -> Vec<PickerEntry> {
    let choice = |reason: &str| PickerEntry {
        answer: PickerAnswer::Reason(reason.to_string()),
        label: reason.to_string(),
        remark: String::new(),
    };
    let preset = session.spec.console.reasons.iter().map(String::as_str).filter(|reason| *reason != OTHER_REASON);
    preset.chain(takes_words.then_some(OTHER_REASON)).map(choice).collect()
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
    let bindings = model.keys.bindings.iter().map(|line| &line.action);
    let idle = bindings.filter(|action| !is_possible_behind(session, model, action)).cloned().collect();
    model.palette_idle = idle;
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

/// The actions that match the filter, the best match first, else in the order of the help; first the one whose key the
/// filter names, last those without an effect when the palette was opened. Without a filter, the one that the palette
/// was opened with is first, and what stops the robot or ends the trial or the session is last.
pub fn actions<'a>(model: &'a ConsoleModel, cursor: &ListCursor) -> Vec<&'a KeyBinding> {
    let is_active =
        |line: &&KeyBinding| line.layer.is_none_or(|only| only == model.layer) && line.action != KeyAction::Palette;
    let mut active: Vec<&KeyBinding> = model.keys.bindings.iter().filter(is_active).collect();
    if cursor.filter.is_empty() {
        active.sort_by_key(|line| (model.palette_first.as_ref() != Some(&line.action), ends(&line.action)));
    }
    let keys = |line: &KeyBinding| line.chords.iter().map(KeyChord::to_string).collect::<Vec<_>>();
    let words = active
        .iter()
        .map(|line| format!("{}\n{}\n{}\n{}", line.help, line.group, synonyms(&line.action), keys(line).join(" ")));
    let mut found: Vec<&KeyBinding> = cursor.found(words).into_iter().map(|index| active[index]).collect();
    // A single letter begins a word.
    let is_letter = cursor.filter.len() == 1 && cursor.filter.chars().all(char::is_alphanumeric);
    let is_keyed = |line: &KeyBinding| !is_letter && keys(line).contains(&cursor.filter);
    if !cursor.filter.is_empty() {
        found.sort_by_key(|line| (!is_keyed(line), model.palette_idle.contains(&line.action)));
    }
    found
}

/// The events of a replay whose words match what is typed to its palette, with the action that goes there; their times only
/// match a time.
pub fn events<'a>(model: &'a ConsoleModel, cursor: &ListCursor) -> Vec<&'a (ReplayAction, String)> {
    let Some(playback) = model.playback.as_ref().filter(|_| cursor.filter.len() > 1) else { return Vec::new() };
    let timeless = |words: &str| words.trim_start().split_once(' ').map_or(words, |(_, rest)| rest).to_string();
    let is_time = cursor.filter.contains(':');
    let found =
        cursor.found(playback.told.iter().map(|(_, words)| if is_time { words.clone() } else { timeless(words) }));
    found.into_iter().map(|index| &playback.told[index]).collect()
}

/// Where the text that is typed to a replay's palette leads, with it in words: to a time of the trial's clock (`2:13`), or to
/// a landmark with a number (`error 7`), if a key goes to landmarks of its kind. Raters have none to what would tell them more.
pub fn place(model: &ConsoleModel, cursor: &ListCursor) -> Option<(ReplayAction, String)> {
    let goes = |to: ReplayAction| model.keys.chord_for(&KeyAction::Move(to)).is_some();
    let typed = cursor.filter.trim().to_lowercase();
    if let Some(time) = SessionTime::from_clock(&typed).filter(|_| goes(ReplayAction::SeekForward)) {
        return Some((ReplayAction::ToClock(time), format!("go to {time} on the trial's clock")));
    }
    let (name, number) = typed.split_at(typed.find(|letter: char| letter.is_ascii_digit())?);
    let (name, number) = (name.trim(), number.parse().ok()?);
    use ReplayLandmark::{Error, FalseBelief, Marker, Signal};
    let is_it = |what: &ReplayLandmark| !name.is_empty() && what.name().contains(name) && goes(ReplayAction::On(*what));
    let what = [Error, Signal, Marker, FalseBelief].into_iter().find(is_it)?;
    Some((ReplayAction::ToNth(what, number), format!("go to {} {number}", what.name())))
}

/// An open list from which the user chooses a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingPicker {
    pub title: String,
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// Number of recordings that are being read, until they are rows.
    pub reading: Option<usize>,
    /// What is done with the chosen recording: "replay", "exclude".
    pub does: &'static str,
    pub cursor: ListCursor,
}

/// What the user of a list of recordings, or of a question before a recording, decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListChoice {
    /// The row or the answer with this index.
    Chosen(usize),
    Leave,
}

impl RecordingPicker {
    /// A list of recordings without a filter, with the cursor on its first row.
    pub fn new(title: String, headings: Vec<String>, rows: Vec<Vec<String>>, does: &'static str) -> RecordingPicker {
        RecordingPicker { title, headings, rows, reading: None, does, cursor: ListCursor::default() }
    }

    /// Indices of the rows that match the filter, the best match first.
    pub fn left(&self) -> Vec<usize> {
        self.cursor.found(self.rows.iter().map(|row| row.join(" ")))
    }

    pub fn key(&mut self, key: &KeyEvent) -> Option<ListChoice> {
        let has_control = key.modifiers.contains(KeyModifiers::CONTROL);
        match (key.kind, key.code) {
            (KeyEventKind::Release, _) => None,
            (_, KeyCode::Char('c')) if has_control => Some(ListChoice::Leave),
            // A held enter key does not open a recording.
            (KeyEventKind::Repeat, KeyCode::Enter) => None,
            (_, KeyCode::Char(_)) if has_control => None,
            (_, code) => self.take(code),
        }
    }

    /// Moves the cursor to a row of the list, counted among the rows that match the filter; chooses the row if the
    /// cursor was already there.
    pub fn click(&mut self, row: usize) -> Option<ListChoice> {
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
    pub fn take(&mut self, code: KeyCode) -> Option<ListChoice> {
        let left = self.left();
        match self.cursor.key(left.len(), code) {
            ListReply::Open => None,
            ListReply::Left => Some(ListChoice::Leave),
            ListReply::Taken => left.get(self.cursor.at).map(|&row| ListChoice::Chosen(row)),
        }
    }
}

/// A question to the user with numbered answers, shown before a recording begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartPrompt {
    pub title: String,
    pub text: Vec<String>,
    /// Texts of the answers; key 1 chooses the first.
    pub answers: Vec<String>,
    /// Index of the chosen answer, until enter gives it.
    pub chosen: Option<usize>,
    /// What is to be opened while the participant's page is wanted and none is connected.
    pub missing_page: Option<String>,
}

impl StartPrompt {
    /// A question of which no answer is chosen.
    pub fn new(title: String, text: Vec<String>, answers: Vec<String>) -> StartPrompt {
        StartPrompt { title, text, answers, chosen: None, missing_page: None }
    }

    /// The reply that a key gives; `None` for keys that choose an answer, for other keys, and for key repeat.
    pub fn reply(&mut self, key: &KeyEvent) -> Option<ListChoice> {
        if key.kind != KeyEventKind::Press {
            return None;
        }
        match key.code {
            KeyCode::Esc => Some(ListChoice::Leave),
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(ListChoice::Leave),
            KeyCode::Enter => self.chosen.map(ListChoice::Chosen),
            KeyCode::Char(digit @ '1'..='9') => {
                let index = usize::from(digit as u8 - b'1');
                self.chosen = Some(index).filter(|index| *index < self.answers.len()).or(self.chosen);
                None
            }
            KeyCode::Backspace => {
                self.chosen = None;
                None
            }
            _ => None,
        }
    }
}
