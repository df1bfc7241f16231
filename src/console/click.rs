//! What can be clicked: while the view draws, it notes cells together with what a click on them does. A click goes the way of the
//! key that does the same.

use ratatui::layout::Rect;

use super::chord::KeyChord;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::kitchen::AspectId;

/// What a click does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClickAction {
    /// What this key does.
    Key(KeyChord),
    /// Go to this row of the open list, of those that are left; on the row under the cursor: take it.
    Row(usize),
    /// Open the palette with this filter, for keys that share a hint.
    Palette(&'static str),
    /// Show the belief about this aspect over time.
    Belief(AspectId),
    /// Go to this error of the list, while errors are coded.
    Error(usize),
    /// Move a replay to this session time.
    Seek(SessionTime),
}

/// Cells that can be clicked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClickTarget {
    /// The cells on the screen.
    pub cells: Rect,
    /// What a click on them does.
    pub action: ClickAction,
}

/// A clicked signal that is sent once it is confirmed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SendQuestion {
    /// The key of what was clicked.
    pub chord: KeyChord,
    /// The signal.
    pub signal: Signal,
    /// Sequence number of the offer that was clicked, if it was the offer.
    pub offer: Option<u64>,
    /// Time of the click, on the clock of keys.
    pub asked: SessionTime,
}
