//! Messages to the console, and commands from it.

use crossterm::event::KeyEvent;

use super::playback::ReplayKey;
use crate::session::Event;

/// An input to the console.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleMessage {
    /// A key was pressed, repeated or released.
    Key(KeyEvent),
    /// The mouse pointer moved to this cell (column, row).
    Pointer(u16, u16),
    /// The mouse was clicked on this cell.
    Click(u16, u16),
    /// The mouse wheel turned over this cell, by this number of steps upwards.
    Wheel(u16, u16, i8),
    /// The terminal was resized to these columns and rows.
    Resized(u16, u16),
    /// The terminal gained or lost keyboard focus.
    Focus(bool),
}

/// A command of the console to the shell that runs it.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleCommand {
    /// An input of the session.
    Input(Event),
    /// Record the preflight results and start the trial.
    Start(Event),
    /// Seek in a recording.
    Move(ReplayKey),
    /// Save the rater's codes, and show the error of which one changed.
    Code {
        /// Sequence number of the press that was the error.
        press: u64,
    },
    /// Close this recording and repeat its trial in another one.
    Redo,
    /// Close this finished recording and continue with the next one of the series.
    Next,
    /// Close the console; in a live run the session ends.
    Quit,
}
