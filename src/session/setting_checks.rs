//! A setting that cannot be, and what several settings are checked by.

use std::borrow::Cow;

use crate::base::number_range::OutOfRange;

/// A setting that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct SettingError {
    /// The setting with the tables around it, from outside; tables in between may be left out: "rerun.address".
    pub path: String,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: Cow<'static, str>,
    /// Which of the settings of that path it is; 0 is the first.
    pub nth: usize,
}

impl SettingError {
    /// An error about the first setting of that path.
    pub fn new(path: impl Into<String>, found: String, remedy: impl Into<Cow<'static, str>>) -> SettingError {
        SettingError { path: path.into(), found, remedy: remedy.into(), nth: 0 }
    }

    /// The setting without the tables around it.
    pub fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }
}

impl From<OutOfRange> for SettingError {
    fn from(error: OutOfRange) -> SettingError {
        SettingError::new(error.path, error.found, error.remedy)
    }
}

/// Whether a text is short and simple enough to name a participant, a plan, an item: in folders, keys and tables.
pub fn is_code(text: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !text.is_empty() && text.len() <= 32 && text.chars().all(is_plain)
}
