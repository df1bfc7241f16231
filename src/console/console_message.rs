//! Messages that the console receives, and commands that it returns.

use crossterm::event::KeyEvent;

use super::playback::ReplayAction;
use tomcom_session::Event;

/// Input of the console: a key, a mouse event, pasted text or a change of the terminal.
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
    /// Text was pasted into the terminal; `None` if the paste had no end, so that it was given up.
    Paste(Option<String>),
}

/// A command of the console to the program that runs it.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleCommand {
    /// Apply this event to the session.
    Input(Event),
    /// Record the results of the preflight checks and start the trial.
    Start(Event),
    /// Move a replay to another position or change its speed.
    Move(ReplayAction),
    /// Save the rater's codes, and move the replay to the error whose code changed.
    Code {
        /// Sequence number of the press whose code changed.
        press: u64,
    },
    /// Close this recording and repeat its trial in a new recording.
    Redo,
    /// Close this finished recording and continue with the participant's next recording.
    Next,
    /// Close the console; in a live run the session ends.
    Quit,
}
