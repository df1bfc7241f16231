//! Position of the list of errors on the rater's screen.

use ratatui::layout::Rect;

use super::rater_session::{CodingRaters, RaterSession};
use super::view::regions::{PanelAreas, ScreenSize, below_title};

/// The rater's list of errors on the screen.
#[derive(Clone, Copy, Debug)]
pub struct ErrorListLayout {
    /// Screen area above the rows of errors: the coding progress, and the present error in words.
    pub head: Rect,
    /// Screen area of the rows of the list, one for each error.
    pub rows: Rect,
    /// Index of the error that is shown in the first row.
    pub first: usize,
}

impl ErrorListLayout {
    /// Layout of the list of errors while the replay stands after this number of events.
    pub fn new(regions: &PanelAreas, coding: &RaterSession, events: usize) -> ErrorListLayout {
        let area = regions.errors;
        let is_lines = regions.room == ScreenSize::Small || area.height < 8;
        let (inside, head_rows) = match (&coding.party, is_lines) {
            (CodingRaters::Pair { .. }, true) if area.height > 3 => (area, 2),
            (_, true) => (area, 1),
            // Lines above the list of errors: the progress bar, and the present error or the next step.
            (CodingRaters::Rater(_), false) => (below_title(area), 3),
            (CodingRaters::Pair { .. }, false) => (below_title(area), 4),
        };
        let head_rows = head_rows.min(inside.height);
        let head = Rect { height: head_rows, ..inside };
        let rows = Rect { y: inside.y + head_rows, height: inside.height - head_rows, ..inside };
        let number = coding.errors.len();
        let focus = coding.chosen.or(coding.at(events)).unwrap_or(0);
        let height = usize::from(rows.height);
        let first = focus.saturating_sub(height / 2).min(number.saturating_sub(height));
        ErrorListLayout { head, rows, first }
    }
}
