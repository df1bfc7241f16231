//! Reads the settings of a session from the text of a session file.

use super::settings::{SessionSpec, SettingError};

impl SessionSpec {
    /// Parses the text of a session file. Missing settings get their defaults; other files to which the session file
    /// refers are not read.
    ///
    /// # Errors
    /// The text is not TOML, or a setting is unknown or invalid.
    pub fn from_toml(text: &str) -> Result<SessionSpec, SettingError> {
        let wrong = |error: toml::de::Error| SettingError::new("", error.to_string(), "settings of a session");
        let spec: SessionSpec = toml::from_str(text).map_err(wrong)?;
        spec.check().map(|()| spec)
    }
}
