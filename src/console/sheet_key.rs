//! Meanings of keys on a sheet (a form at full size).

/// Meaning of a key on a sheet (a form at full size).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SheetKey {
    /// Tick the present step, go on from the present item, or confirm the sheet.
    Confirm,
    /// Go on to the session's next phase, if the sheet is complete.
    Leave,
    /// Show the next item of the sheet.
    Forward,
    /// Show the previous item of the sheet.
    Back,
    /// Take back the last tick, or show the previous item.
    Undo,
    /// Leave the sheet's present item unanswered.
    Skip,
    /// A digit, which answers an item or selects a choice.
    Digit(u8),
    /// A letter or a minus sign, which begins a typed answer.
    Letter(char),
}
