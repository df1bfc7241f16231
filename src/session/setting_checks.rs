//! Errors of invalid settings, and checks that several settings share.

use std::borrow::Cow;

use tomcom_core::base::number_range::OutOfRange;

/// Error: an invalid setting in a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct SettingError {
    /// Dotted path of the setting, outermost table first; inner tables may be left out: "rerun.address".
    pub path: String,
    /// The invalid value that was found.
    pub found: String,
    /// Description of a valid value of the setting.
    pub remedy: Cow<'static, str>,
    /// Index of the invalid setting among several settings with the same path, from 0.
    pub nth: usize,
}

impl SettingError {
    /// An error in the first setting with this path.
    pub fn new(path: impl Into<String>, found: String, remedy: impl Into<Cow<'static, str>>) -> SettingError {
        SettingError { path: path.into(), found, remedy: remedy.into(), nth: 0 }
    }

    /// Name of the invalid setting without the tables in front.
    pub fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }
}

impl From<OutOfRange> for SettingError {
    fn from(error: OutOfRange) -> SettingError {
        SettingError::new(error.path, error.found, error.remedy)
    }
}

/// Whether a text is a valid code: 1 to 32 ASCII letters, digits, `-` and `_`. Such codes are safe in names of folders,
/// keys and tables.
pub fn is_code(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !text.is_empty() && text.len() <= 32 && text.chars().all(is_plain)
}
