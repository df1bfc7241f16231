//! Click targets of the console: while the view draws, it notes screen cells together with the action of a click on
//! them. A click takes the same way through the program as the key with the same action.

use ratatui::layout::Rect;

use super::chord::KeyChord;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::AspectId;

/// Action of a mouse click on the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClickAction {
    /// Do what this key of the keyboard does.
    Key(KeyChord),
    /// Move the cursor to this row of the open list (counted among the rows that match the filter); choose the row if
    /// the cursor is already there.
    Row(usize),
    /// Open the list of all actions (the palette) with this filter text; for hints that several keys share.
    Palette(&'static str),
    /// Show the estimated belief about this state aspect over time.
    Belief(AspectId),
    /// While a rater codes errors: go to the error with this index in the list.
    Error(usize),
    /// Move a replay to this session time.
    Seek(SessionTime),
}

/// Screen cells that can be clicked, with the action of a click.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClickTarget {
    /// Screen cells that can be clicked.
    pub cells: Rect,
    /// Action of a mouse click on these screen cells.
    pub action: ClickAction,
}

/// The question whether to send a clicked signal; the signal is sent once the wizard confirms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SendConfirmation {
    /// Key of the keyboard with the same action as the click.
    pub chord: KeyChord,
    /// Signal that is sent to the participant once the wizard confirms.
    pub signal: Signal,
    /// Sequence number of the clicked offer; `None` if a signal was clicked that is not on offer.
    pub offer: Option<u64>,
    /// Time of the click, on the console's own clock ([`super::console_model::ConsoleModel::clock`]).
    pub asked: SessionTime,
    /// Session time of the click; in a training the session does not run on the console's clock.
    pub asked_at: SessionTime,
}
