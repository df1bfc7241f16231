//! The keys of a sheet, by what they mean there.

/// A key of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SheetKey {
    /// Tick the step, go on from the item, or confirm.
    Confirm,
    /// Go on to the next phase, if nothing is missing.
    Leave,
    /// Show the next item.
    Forward,
    /// Show the item before.
    Back,
    /// Take back the last tick, or show the item before.
    Undo,
    /// Leave the item out.
    Skip,
    /// A digit: it answers or chooses.
    Digit(u8),
    /// Another letter, or a minus sign: it begins an answer that is typed.
    Letter(char),
}
