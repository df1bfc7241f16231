//! The desk in a build without the feature `display`: no display, and nothing comes from one.

use crate::run::error::LiveError;
use crate::session::{Session, SessionSpec};

/// Input of a display: this type has no value.
pub(in crate::run) enum PageInput {}

/// No display.
#[derive(Default)]
pub(in crate::run) struct WallDisplay {}

impl WallDisplay {
    /// Opens no display: sessions with a participant at a display have been refused before.
    ///
    /// # Errors
    /// None.
    pub async fn open(_: &SessionSpec) -> Result<WallDisplay, LiveError> {
        Ok(WallDisplay {})
    }

    /// Asks nobody: there is no page.
    pub fn ask_consent(&self, _: &Session, _: &str) -> bool {
        false
    }

    /// Never.
    pub async fn next(&mut self) -> Option<PageInput> {
        std::future::pending().await
    }
}

/// Never: there is no page.
pub(in crate::run) fn is_consent(_: &PageInput) -> bool {
    false
}
