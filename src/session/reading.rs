//! Reads the settings of a session from the text of a session file.

use super::settings::{SessionSpec, SettingError};

impl SessionSpec {
    /// Reads a session file's text; settings that it does not name have their defaults. The files that it names are not
    /// read.
    ///
    /// # Errors
    /// The text is not TOML, a setting is unknown, or a setting cannot be.
    pub fn from_toml(text: &str) -> Result<SessionSpec, SettingError> {
        let wrong = |error: toml::de::Error| SettingError::new("", error.to_string(), "settings of a session");
        let spec: SessionSpec = toml::from_str(text).map_err(wrong)?;
        spec.check().map(|()| spec)
    }
}
