//! Actions of keys, and the entries of the key table.

use std::fmt;
use std::ops::Range;

use super::chord::KeyChord;
use super::compared::ComparisonKey;
use super::playback::ReplayKey;
use crate::communication::Signal;
use crate::kitchen::{ButtonId, LocationId};
use crate::measures::cause_codes::CauseKind;

/// Key layer: the wizard's keys, or the buttons of a person who plays the participant at this keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyLayer {
    /// Keys send signals.
    Wizard,
    /// Keys press the human's buttons.
    Participant,
}

/// Action of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyAction {
    /// Send this signal about this location.
    Signal(LocationId, Signal),
    /// Press this button of the human.
    Press(ButtonId),
    /// Send the recommended signal.
    Accept,
    /// Take the shown signal back.
    TakeBack,
    /// Set a marker with this preset note.
    Note(usize),
    /// Start, pause or resume the trial.
    Advance,
    /// Ask whether to end the trial.
    EndTrial,
    /// Stop the robot at once.
    StopRobot,
    /// Let a stopped robot go on.
    ResumeRobot,
    /// Change between the wizard's keys and the participant's buttons.
    SwitchLayer,
    /// Correct the kitchen, steer the robot, or abort the trial.
    Hand(ManualAction),
    /// Move a replay.
    Move(ReplayKey),
    /// Change what the screen shows.
    Look(PanelKey),
    /// Show the belief about one aspect over time; again for the next aspect.
    Belief,
    /// A key of the comparison of wizard and assistant.
    Differ(ComparisonKey),
    /// A key of the rater, to code an error.
    Rate(RaterKey),
    /// Open or close the help.
    Help,
    /// Open the list of all actions.
    Palette,
    /// Ask whether to end the session and leave.
    Quit,
}

/// A manual intervention of the experimenter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManualAction {
    /// Correct the content of a location.
    Correct,
    /// Hold the robot before its next press, or release it.
    HoldRobot,
    /// Skip the robot's ongoing press.
    SkipPress,
    /// Choose the robot's next press.
    DriveRobot,
    /// Abort the trial, for a reason.
    Abort,
    /// Do a trial again that was aborted or excluded.
    Redo,
    /// Show the preflight checks.
    Preflight,
    /// Start a gaze accuracy check.
    Calibrate,
    /// Write a free text note.
    NoteInWords,
    /// Exclude the trial from the analysis for a reason, or take that back.
    Exclude,
    /// Ask for a freeze probe.
    AskProbe,
    /// Skip the rest of a freeze probe, for a reason.
    SkipProbe,
}

/// A navigation key of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKey {
    /// Show the next panel at full size; after the last one, all panels.
    Next,
    /// Show the panel before it alone.
    Last,
    /// Show all panels.
    All,
    /// Scroll back in time.
    Back,
    /// Scroll forward in time.
    Forward,
    /// Show an earlier part of the timeline.
    Earlier,
    /// Show a later part of the timeline.
    Later,
}

/// A key of the rater.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaterKey {
    /// Go to the next error.
    Next,
    /// Go to the error before.
    Last,
    /// Code a false belief about this location, or about the order and the recipe of its dish.
    Belief(LocationId),
    /// Code another cause.
    Cause(CauseKind),
    /// Remove the code of the error.
    Clear,
    /// Take the last code back.
    Undo,
    /// Do what was undone again.
    Redo,
    /// Choose the error below in the list.
    ChooseLater,
    /// Choose the error above in the list.
    ChooseEarlier,
}

/// A table of a key file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeySection {
    /// Keys of the live console.
    Console,
    /// Keys of the replay console.
    Replay,
    /// Keys of signals, by location.
    Signals,
    /// Keys of the participant's buttons, by name.
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

/// An entry of the key table.
#[derive(Clone, Debug)]
pub struct KeyBinding {
    /// Table of the key file that contains the entry.
    pub section: KeySection,
    /// Its name in that section.
    pub name: String,
    /// Its keys; the first one is shown on the screen.
    pub chords: Vec<KeyChord>,
    /// What the keys do.
    pub action: KeyAction,
    /// Heading in the help.
    pub group: &'static str,
    /// What the help says about it.
    pub help: String,
    /// Label in the footer, if it is shown there.
    pub footer: Option<&'static str>,
    /// Key layer of the entry; `None` for all layers.
    pub layer: Option<KeyLayer>,
}

impl KeyBinding {
    /// Whether two entries can be active at the same time and so need different keys.
    pub(super) fn meets(&self, other: &KeyBinding) -> bool {
        self.layer.is_none() || other.layer.is_none() || self.layer == other.layer
    }

    /// Its first key, if that is a letter.
    pub(super) fn letter(&self) -> Option<char> {
        match self.chords.first()?.code {
            crossterm::event::KeyCode::Char(letter) => Some(letter),
            _ => None,
        }
    }
}

/// Source of an invalid key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyPlace {
    /// The key file, at this byte range.
    File(Range<usize>),
    /// The layout, as the key of a signal (wizard) or of a button (participant).
    Layout(KeyLayer, char),
}

/// An invalid key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct KeyError {
    /// Where the key is bound: in the key file or in the layout.
    pub place: KeyPlace,
    /// What is wrong.
    pub found: String,
    /// What would be right.
    pub remedy: String,
}
