//! Actions of keys, and the entries of the console's key table.

use std::fmt;
use std::ops::Range;

use super::chord::KeyChord;
use super::compared::ComparisonAction;
use super::playback::ReplayAction;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{ButtonId, LocationId};
use tomcom_core::measures::raters::ErrorCauseKind;

/// Whose keys are active: the wizard's, or the buttons of a person who plays the participant at this keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyLayer {
    /// The wizard's keys: letters send signals.
    Wizard,
    /// The participant's keys: letters press the human's buttons in the kitchen.
    Participant,
}

/// Action of a key at the console.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyAction {
    /// Send this signal about this location to the participant.
    Signal(LocationId, Signal),
    /// Press this button of the human in the kitchen.
    Press(ButtonId),
    /// Accept the open offer: send the recommended signal.
    Accept,
    /// End the signal that the participant sees.
    TakeBack,
    /// Record the preset note with this index as a marker of the trial.
    Note(usize),
    /// Start, pause or resume the trial.
    Advance,
    /// Ask whether to end the trial.
    EndTrial,
    /// Stop the robot at once.
    StopRobot,
    /// Release the robot after a stop.
    ResumeRobot,
    /// Change between the wizard's keys and the participant's buttons.
    SwitchLayer,
    /// Manual intervention: correct the kitchen, steer the robot, or abort the trial.
    Hand(ManualAction),
    /// Move a replay to another position or change its speed.
    Move(ReplayAction),
    /// Change which panels or which time the screen shows.
    Look(ViewAction),
    /// Show the estimated belief about one state aspect over time; pressed again, the next aspect.
    Belief,
    /// Select or open a difference in the comparison of wizard and assistant.
    Differ(ComparisonAction),
    /// Action of a rater who codes errors.
    Rate(RaterAction),
    /// Open or close the help of the console.
    Help,
    /// Open the list of all actions (the palette).
    Palette,
    /// Ask whether to end the session and leave.
    Quit,
}

/// A manual intervention of the experimenter during or around a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManualAction {
    /// Correct the recorded content of a location.
    Correct,
    /// Keep the robot from starting its next press, or release it.
    HoldRobot,
    /// Skip the robot's ongoing press.
    SkipPress,
    /// Choose the robot's next press.
    DriveRobot,
    /// Abort the trial, for a reason.
    Abort,
    /// Repeat a trial that was aborted or excluded.
    Redo,
    /// Show the preflight checks.
    Preflight,
    /// Start a gaze accuracy check.
    Calibrate,
    /// Write a note in free text.
    NoteInWords,
    /// Exclude the trial from the analysis for a reason, or include it again.
    Exclude,
    /// Request a freeze probe of the participant.
    AskProbe,
    /// Skip the remaining questions of a freeze probe, for a reason.
    SkipProbe,
}

/// Action of a key that changes which panels or which time the screen shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewAction {
    /// Show the next panel at full size; after the last one, all panels.
    Next,
    /// Show the previous panel at full size.
    Last,
    /// Show all panels of the console.
    All,
    /// Scroll the shown panel back in time.
    Back,
    /// Scroll the shown panel forward in time.
    Forward,
    /// Scroll the timeline to an earlier time.
    Earlier,
    /// Scroll the timeline to a later time.
    Later,
}

/// Action of a rater who codes the causes of errors in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaterAction {
    /// Go to the next error in the recording.
    Next,
    /// Go to the previous error in the recording.
    Last,
    /// Code the error as a false belief about this location; for an order, about the recipe of its dish, too.
    Belief(LocationId),
    /// Code the error with another cause, such as a slip.
    Cause(ErrorCauseKind),
    /// Remove the code of the present error.
    Clear,
    /// Undo the last change of an error's code.
    Undo,
    /// Redo the change of a code that was undone last.
    Redo,
    /// Move the selection to the next error of the list.
    ChooseLater,
    /// Move the selection to the previous error of the list.
    ChooseEarlier,
}

/// A table of a key file, the TOML file that assigns keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyFileTable {
    /// Keys of the console in a live session.
    Console,
    /// Keys of the console in a replay.
    Replay,
    /// Keys that send signals, by location.
    Signals,
    /// Keys of the participant's buttons in the kitchen, by button name.
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
    /// Table of the key file that contains the action.
    pub section: KeyFileTable,
    /// Name of the action in that table of the key file.
    pub name: String,
    /// Keys of the action; the first one is shown on the screen.
    pub chords: Vec<KeyChord>,
    /// Action that the keys of the key table's entry carry out.
    pub action: KeyAction,
    /// Heading under which the help lists the action.
    pub group: &'static str,
    /// Description of the action in the console's help.
    pub help: String,
    /// Label of the action in the console's lowest line, if it is shown there.
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
    /// The invalid key stands in the key file, at this byte range.
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
    /// What is wrong with the key assignment.
    pub found: String,
    /// What a valid key assignment would be.
    pub remedy: String,
}
