//! Severity of a notice, the console's short message to the wizard.

/// Severity of a notice, the console's short message to the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeLevel {
    /// Information: an action was carried out.
    Done,
    /// Warning: an action was refused.
    Refused,
    /// Alarm: a fault that lasts until it is fixed.
    Alarm,
}
