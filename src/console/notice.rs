//! How much a line to the wizard matters.

/// How much a notice matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeLevel {
    /// Something was done.
    Done,
    /// Something was not done.
    Refused,
    /// Something is wrong until it is mended.
    Alarm,
}
