//! Severity of a notice, the console's short message to the wizard.

/// Severity of a notice, the console's short message to the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeLevel {
    /// Information: the console carried out an action.
    Done,
    /// Warning: the console refused an action.
    Refused,
    /// Alarm: a fault that lasts until it is fixed.
    Alarm,
}
