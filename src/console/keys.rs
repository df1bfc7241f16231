//! The one table of keys: it makes the bindings, the footer, the help and the badges at the things in the kitchen.
//!
//! Letters belong to the kitchen (its layout says which), everything else to the console. So no layout takes a key away
//! from the console, and the space bar is the robot stop in every view and layer.

use std::fmt;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::hands::Hand;
use super::playback::Move;
use crate::communication::{self, Signal};
use crate::kitchen::{Agent, ButtonId, Kitchen, LocationId};
use crate::session::settings::{ParticipantKind, SessionSpec};

/// The notes of the markers 1 to 5: short, so that no text has to be typed while the trial runs.
pub const NOTES: [&str; 5] =
    ["wrong recipe", "overlooked a change", "slip", "waits for the robot", "look at this later"];

/// Which hand plays: the wizard's keys, or the buttons of a person who plays the participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Wizard,
    Participant,
}

/// A key, with or without control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    pub code: KeyCode,
    pub ctrl: bool,
}

impl Chord {
    const fn plain(code: KeyCode) -> Chord {
        Chord { code, ctrl: false }
    }

    const fn ctrl(key: char) -> Chord {
        Chord { code: KeyCode::Char(key), ctrl: true }
    }

    /// The chord of a key event. Capitals count as their small letters, so that caps lock does no harm.
    pub fn of(key: &KeyEvent) -> Chord {
        let code = match key.code {
            KeyCode::Char(letter) => KeyCode::Char(letter.to_lowercase().next().unwrap_or(letter)),
            other => other,
        };
        Chord { code, ctrl: key.modifiers.contains(KeyModifiers::CONTROL) }
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ctrl {
            f.write_str("^")?;
        }
        match self.code {
            KeyCode::Char(' ') => f.write_str("space"),
            KeyCode::Char(key) => write!(f, "{key}"),
            KeyCode::Tab => f.write_str("tab"),
            KeyCode::Backspace => f.write_str("bksp"),
            KeyCode::Esc => f.write_str("esc"),
            KeyCode::Left => f.write_str("left"),
            KeyCode::Right => f.write_str("right"),
            KeyCode::PageUp => f.write_str("pgup"),
            KeyCode::PageDown => f.write_str("pgdn"),
            KeyCode::Home => f.write_str("home"),
            KeyCode::End => f.write_str("end"),
            other => write!(f, "{other}"),
        }
    }
}

/// What a key does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    Signal(LocationId, Signal),
    Press(ButtonId),
    TakeBack,
    /// A marker with this note of [`NOTES`].
    Note(usize),
    /// Start, pause or resume the trial.
    Advance,
    EndTrial,
    StopRobot,
    ResumeRobot,
    SwitchLayer,
    Hand(Hand),
    Move(Move),
    Help,
    Quit,
}

/// One line of the table.
#[derive(Clone, Debug)]
pub struct Binding {
    pub chord: Chord,
    pub action: Action,
    /// The heading that it stands under in the help.
    pub group: &'static str,
    pub help: String,
    /// What the footer says, if it is in the footer.
    pub footer: Option<&'static str>,
    /// The layer that it works in; `None`: in every layer.
    pub layer: Option<Layer>,
}

/// A key that would have two meanings.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the key \"{key}\" for \"{what}\", which the console has for \"{by}\"")]
pub struct Clash {
    pub key: char,
    pub what: String,
    pub layer: Layer,
    /// What the key means already.
    pub by: String,
}

/// The table.
#[derive(Clone, Debug)]
pub struct Keys {
    pub bindings: Vec<Binding>,
}

const SIGNALS: &str = "Signals to the participant";
const TRIAL: &str = "Trial";
const MARKERS: &str = "Markers";
const REPLAY: &str = "Recording";
const ROBOT: &str = "Robot";
const BUTTONS: &str = "The participant's buttons";
const CONSOLE: &str = "Console";

fn binding(chord: Chord, action: Action, group: &'static str, help: &str, footer: Option<&'static str>) -> Binding {
    Binding { chord, action, group, help: help.to_string(), footer, layer: None }
}

/// A key of the experimenter's hands; the footer shows it when it matters.
fn hand(key: char, hand: Hand, group: &'static str, help: &str) -> Binding {
    binding(Chord::ctrl(key), Action::Hand(hand), group, help, None)
}

impl Keys {
    /// The table of a live session.
    ///
    /// # Errors
    /// A letter of the layout that means two things.
    pub fn live(kitchen: &Kitchen, spec: &SessionSpec) -> Result<Keys, Clash> {
        Keys::table(kitchen, spec.signals.own_hand, spec.participant.kind == ParticipantKind::Keyboard)
    }

    /// Whether the console can take every key of a kitchen, whatever the session's settings are.
    ///
    /// # Errors
    /// A letter of the layout that means two things.
    pub fn check(kitchen: &Kitchen) -> Result<(), Clash> {
        Keys::table(kitchen, true, true).map(drop)
    }

    fn table(kitchen: &Kitchen, own_hand: bool, at_keyboard: bool) -> Result<Keys, Clash> {
        use KeyCode::{Backspace, Char, Tab};
        let mut keys = Keys { bindings: Vec::new() };
        keys.bindings.extend([
            binding(Chord::plain(Char(' ')), Action::StopRobot, ROBOT, "stop the robot, at once", Some("STOP ROBOT")),
            binding(Chord::ctrl('r'), Action::ResumeRobot, ROBOT, "resume it after a stop", Some("resume robot")),
            hand('p', Hand::HoldRobot, ROBOT, "hold it before its next press, release it"),
            hand('s', Hand::SkipPress, ROBOT, "skip its press: it decides anew"),
            hand('d', Hand::DriveRobot, ROBOT, "drive it: choose its next press"),
            binding(Chord::plain(Char('.')), Action::Advance, TRIAL, "start, pause, resume", Some("start/pause")),
            binding(Chord::ctrl('e'), Action::EndTrial, TRIAL, "end the trial (asks first)", Some("end")),
            hand('k', Hand::Correct, TRIAL, "correct the kitchen: what is where"),
        ]);
        if at_keyboard {
            let help = "switch between wizard and participant";
            keys.bindings.push(binding(Chord::plain(Tab), Action::SwitchLayer, CONSOLE, help, Some("switch")));
        }
        keys.signals(kitchen, own_hand)?;
        let take_back = "take the shown signal back";
        keys.wizards(binding(Chord::plain(Backspace), Action::TakeBack, SIGNALS, take_back, Some("take back")));
        for (index, note) in NOTES.iter().enumerate() {
            let key = Chord::plain(Char(char::from(b'1' + index as u8)));
            keys.wizards(binding(key, Action::Note(index), MARKERS, note, (index == 0).then_some("note")));
        }
        if at_keyboard {
            keys.buttons(kitchen)?;
        }
        keys.console();
        Ok(keys)
    }

    /// The table of a replay.
    pub fn replay() -> Keys {
        use KeyCode::{Char, End, Home, Left, PageDown, PageUp, Right};
        let moves = [
            (Right, Move::StepForward, "to the next event", Some("step")),
            (Left, Move::StepBack, "to the last event", None),
            (PageDown, Move::SeekForward, "ten seconds on", Some("10 s")),
            (PageUp, Move::SeekBack, "ten seconds back", None),
            (Char('+'), Move::Faster, "faster", Some("speed")),
            (Char('-'), Move::Slower, "slower", None),
            (Home, Move::ToStart, "to the beginning", None),
            (End, Move::ToEnd, "to the end; stays there if the recording grows", Some("ends")),
        ];
        let line = |(code, to, help, footer)| binding(Chord::plain(code), Action::Move(to), REPLAY, help, footer);
        let mut keys = Keys { bindings: vec![line((Char('.'), Move::PlayPause, "play, pause", Some("play/pause")))] };
        keys.bindings.extend([
            binding(Chord::plain(Char('q')), Action::Quit, CONSOLE, "quit", Some("quit")),
            binding(Chord::plain(Char('?')), Action::Help, CONSOLE, "this help", Some("help")),
            binding(Chord::ctrl('c'), Action::Quit, CONSOLE, "quit", None),
        ]);
        keys.bindings.extend(moves.into_iter().map(line));
        keys
    }

    fn console(&mut self) {
        self.bindings.extend([
            binding(Chord::plain(KeyCode::Char('?')), Action::Help, CONSOLE, "this help", Some("help")),
            binding(Chord::ctrl('c'), Action::Quit, CONSOLE, "quit (asks first)", Some("quit")),
        ]);
    }

    fn wizards(&mut self, binding: Binding) {
        self.bindings.push(Binding { layer: Some(Layer::Wizard), ..binding });
    }

    fn signals(&mut self, kitchen: &Kitchen, own_hand: bool) -> Result<(), Clash> {
        for (id, signal) in communication::signals(kitchen, own_hand) {
            let location = kitchen.location(id);
            let Some(key) = location.signal_key else { continue };
            let help = match signal {
                Signal::ShowRecipe(_) => format!("show the recipe of {}", location.label()),
                Signal::Highlight(_) => format!("highlight {}", location.label()),
            };
            let chord = self.letter(key, &location.name, Layer::Wizard)?;
            self.wizards(binding(chord, Action::Signal(id, signal), SIGNALS, &help, None));
        }
        Ok(())
    }

    fn buttons(&mut self, kitchen: &Kitchen) -> Result<(), Clash> {
        for (index, button) in kitchen.buttons[Agent::Human.index()].iter().enumerate() {
            let Some(key) = button.key else { continue };
            let chord = self.letter(key, &button.name, Layer::Participant)?;
            let help = button.name.replace('_', " ");
            let line = binding(chord, Action::Press(ButtonId(index as u8)), BUTTONS, &help, None);
            self.bindings.push(Binding { layer: Some(Layer::Participant), ..line });
        }
        Ok(())
    }

    /// The chord of a key from a layout, if it is free in its layer.
    fn letter(&self, key: char, what: &str, layer: Layer) -> Result<Chord, Clash> {
        let chord = Chord::plain(KeyCode::Char(key.to_lowercase().next().unwrap_or(key)));
        let taken = match key {
            '1'..='5' if layer == Layer::Wizard => Some(NOTES[usize::from(key as u8 - b'1')]),
            '?' => Some("this help"),
            _ => self.find(layer, chord).map(|line| line.help.as_str()),
        };
        match taken {
            Some(by) => Err(Clash { key, what: what.to_string(), layer, by: by.to_string() }),
            None => Ok(chord),
        }
    }

    /// What a key means in a layer.
    pub fn find(&self, layer: Layer, chord: Chord) -> Option<&Binding> {
        self.bindings.iter().find(|line| line.chord == chord && line.layer.is_none_or(|only| only == layer))
    }

    /// The key of the signal about a location.
    pub fn of_signal(&self, location: LocationId) -> Option<Chord> {
        let is_it = |line: &&Binding| matches!(line.action, Action::Signal(about, _) if about == location);
        self.bindings.iter().find(is_it).map(|line| line.chord)
    }

    /// The participant's key of a button.
    pub fn of_button(&self, button: ButtonId) -> Option<Chord> {
        self.bindings.iter().find(|line| line.action == Action::Press(button)).map(|line| line.chord)
    }

    /// The key of an action of the console.
    pub fn of(&self, action: &Action) -> Option<Chord> {
        self.bindings.iter().find(|line| line.action == *action).map(|line| line.chord)
    }
}
