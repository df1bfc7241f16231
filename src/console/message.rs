//! What reaches the console, and what it asks for.

use crossterm::event::KeyEvent;

use super::playback::ReplayKey;
use crate::session::Event;

/// Something that the console has to know.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleMessage {
    Key(KeyEvent),
    /// The mouse pointer is over this cell, column and row.
    Pointer(u16, u16),
    /// The mouse was clicked on this cell.
    Click(u16, u16),
    /// The wheel was turned over this cell, by so many steps away from the hand.
    Wheel(u16, u16, i8),
    /// The terminal has this size now, columns and rows.
    Resized(u16, u16),
    /// The terminal window gained or lost the keyboard.
    Focus(bool),
}

/// What the console asks of whoever runs it.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleCommand {
    /// An input of the session.
    Input(Event),
    /// Record what was found before the trial, and start it.
    Start(Event),
    /// Another place in a recording.
    Move(ReplayKey),
    /// What the rater says has changed: it is to be kept.
    Code,
    /// Close this recording and do its trial again in another one.
    Redo,
    /// This recording is done: close it and go on to the next one of the series.
    Next,
    /// Close the console; in a live run the session ends.
    Quit,
}
