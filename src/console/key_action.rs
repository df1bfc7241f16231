//! Actions of keys, and the entries of the console's key table.

use std::fmt;
use std::ops::Range;

use super::chord::KeyChord;
use super::console_model::{ComparisonAction, ReplayAction};
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{ButtonId, LocationId};
use tomcom_core::measures::raters::ErrorCauseKind;

/// Whose keys are active: the wizard's, or the buttons of a person who plays the participant at this keyboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeyLayer {
    #[default]
    Wizard,
    Participant,
}

/// Action of a key at the console.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyAction {
    Signal(LocationId, Signal),
    Press(ButtonId),
    Accept,
    TakeBack,
    /// Record the preset note with this index as a marker of the trial.
    Note(usize),
    Advance,
    EndTrial,
    StopRobot,
    ResumeRobot,
    SwitchLayer,
    Manual(ManualAction),
    Move(ReplayAction),
    Look(ViewAction),
    Belief,
    Differ(ComparisonAction),
    Rate(RaterAction),
    Help,
    Palette,
    Quit,
}

/// A manual intervention of the experimenter during or around a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManualAction {
    Correct,
    HoldRobot,
    SkipPress,
    DriveRobot,
    ConfirmArm,
    Abort,
    Redo,
    Preflight,
    Calibrate,
    NoteInWords,
    Exclude,
    AskProbe,
    SkipProbe,
}

/// Action of a key that changes which panels or which time the screen shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewAction {
    /// Give the focus to the next panel, at full size if one is shown so.
    Next,
    Last,
    /// Show the panel with the focus at full size, or all panels again.
    Open,
    All,
    Back,
    Forward,
    Earlier,
    Later,
}

/// Action of a rater who codes the causes of errors in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaterAction {
    Next,
    Last,
    /// Code the error as a false belief about this location; for an order, about the recipe of its dish, too.
    Belief(LocationId),
    Cause(ErrorCauseKind),
    Clear,
    Undo,
    Redo,
    ChooseLater,
    ChooseEarlier,
}

/// A table of a key file, the TOML file that assigns keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyFileTable {
    Console,
    Replay,
    Signals,
    Buttons,
}

/// Writes the name of the table as it stands in key files.
impl fmt::Display for KeyFileTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            KeyFileTable::Console => "console",
            KeyFileTable::Replay => "replay",
            KeyFileTable::Signals => "signals",
            KeyFileTable::Buttons => "buttons",
        })
    }
}

/// An entry of the key table: an action with its keys and texts.
#[derive(Clone, Debug)]
pub struct KeyBinding {
    pub section: KeyFileTable,
    pub name: String,
    /// Keys of the action; the first one is shown on the screen.
    pub chords: Vec<KeyChord>,
    pub action: KeyAction,
    pub group: &'static str,
    pub help: String,
    pub footer: Option<&'static str>,
    /// Layer in which the keys are active (wizard's or participant's); `None` for both.
    pub layer: Option<KeyLayer>,
}

impl KeyBinding {
    /// Whether two key bindings can be active at the same time and therefore need different keys.
    pub(super) fn meets(&self, other: &KeyBinding) -> bool {
        self.layer.is_none() || other.layer.is_none() || self.layer == other.layer
    }

    /// First key of the binding, if that is a letter without ctrl.
    pub(super) fn letter(&self) -> Option<char> {
        match self.chords.first()?.code {
            crossterm::event::KeyCode::Char(letter) => Some(letter),
            _ => None,
        }
    }
}

/// Where an invalid key assignment stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyErrorSource {
    File(Range<usize>),
    /// The invalid key stands in the kitchen's layout file, as the key of a signal (wizard) or of a button
    /// (participant).
    Layout(KeyLayer, char),
}

/// An invalid key assignment, with its source and a remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct KeyError {
    /// Where the assignment stands: in the key file or in the layout file.
    pub place: KeyErrorSource,
    pub found: String,
    pub remedy: String,
}
