//! What keys do, and the lines of the table of keys.

use std::fmt;
use std::ops::Range;

use super::chord::KeyChord;
use super::compared::ComparisonKey;
use super::playback::ReplayKey;
use crate::communication::Signal;
use crate::kitchen::{ButtonId, LocationId};
use crate::measures::coding::CauseKind;

/// Which hand plays: the wizard's keys, or the buttons of a person who plays the participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyLayer {
    Wizard,
    Participant,
}

/// What a key does.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyAction {
    Signal(LocationId, Signal),
    Press(ButtonId),
    /// Send the signal that is recommended most.
    Accept,
    TakeBack,
    /// A marker with this note of the session's.
    Note(usize),
    /// Start, pause or resume the trial.
    Advance,
    EndTrial,
    StopRobot,
    ResumeRobot,
    SwitchLayer,
    Hand(ManualAction),
    Move(ReplayKey),
    Look(PanelKey),
    /// One aspect of the belief over time, then the next one.
    Belief,
    /// Where wizard and assistant differ.
    Differ(ComparisonKey),
    /// Code an error.
    Rate(RaterKey),
    Help,
    Quit,
}

/// What a key of the hands does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManualAction {
    /// Say what really lies at a location.
    Correct,
    /// Hold the robot before its next press, or release it.
    HoldRobot,
    /// The robot gives up its press and decides anew.
    SkipPress,
    /// Choose the robot's next press.
    DriveRobot,
    /// Abort the trial, for a reason.
    Abort,
    /// Do a trial again that was aborted or excluded.
    Redo,
    /// Show what is ready for the trial, and what is not.
    Preflight,
    /// Check the calibration of the eye tracker.
    Calibrate,
    /// Write a note in words.
    NoteInWords,
    /// Leave the trial out of the analysis, for a reason; or take that back.
    Exclude,
}

/// What a key asks of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKey {
    /// The next panel alone; after the last all of them.
    Next,
    Last,
    All,
    /// Further back in time, and forward again.
    Back,
    Forward,
}

/// What a key asks of a rater's console.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaterKey {
    /// To the next error, or the one before.
    Next,
    Last,
    /// The participant believed something wrong about this place, or the order there and the recipe of its dish.
    Belief(LocationId),
    /// Another cause.
    Cause(CauseKind),
    /// Nothing is said about the error after all.
    Clear,
}

/// The tables of a key file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeySection {
    /// What the console of a live session does.
    Console,
    /// What the console over a recording does.
    Replay,
    /// The signals, by location.
    Signals,
    /// The participant's buttons, by name.
    Buttons,
}

/// The name of the table.
impl fmt::Display for KeySection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            KeySection::Console => "console",
            KeySection::Replay => "replay",
            KeySection::Signals => "signals",
            KeySection::Buttons => "buttons",
        })
    }
}

/// One line of the table.
#[derive(Clone, Debug)]
pub struct KeyBinding {
    /// Where it stands in a key file, and its name there.
    pub section: KeySection,
    pub name: String,
    /// Its keys; the first is the one that is shown.
    pub chords: Vec<KeyChord>,
    pub action: KeyAction,
    /// The heading that it stands under in the help.
    pub group: &'static str,
    pub help: String,
    /// What the footer says, if it is in the footer.
    pub footer: Option<&'static str>,
    /// The layer that it works in; `None`: in every layer.
    pub layer: Option<KeyLayer>,
}

impl KeyBinding {
    /// Whether two lines can act at the same time, so that they need different keys.
    pub(super) fn meets(&self, other: &KeyBinding) -> bool {
        self.layer.is_none() || other.layer.is_none() || self.layer == other.layer
    }

    /// Its first key, where that is a letter.
    pub(super) fn letter(&self) -> Option<char> {
        match self.chords.first()?.code {
            crossterm::event::KeyCode::Char(letter) => Some(letter),
            _ => None,
        }
    }
}

/// Where a wrong key stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyPlace {
    /// In the key file, at these bytes.
    File(Range<usize>),
    /// In the layout, as the key of a signal (the wizard's) or of a button (the participant's).
    Layout(KeyLayer, char),
}

/// A key that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct KeyError {
    pub place: KeyPlace,
    pub found: String,
    pub remedy: String,
}
