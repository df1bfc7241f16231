//! Stand-in for the live stream to Rerun in a build without the feature `rerun`; the wizard is told if the session asks
//! for a stream.

use crate::console::console_model::RerunStreamStatus;
use tomcom_session::engine::SessionEngine;
use tomcom_session::features::{Feature, MissingFeature};
use tomcom_session::log::LogWriter;
use tomcom_session::{LogHeader, Session, TimestampedEvent};

/// The stream to Rerun, which this build lacks; so the type has no values.
pub(super) enum StreamedSession {}

impl StreamedSession {
    /// Opens no stream, since this build lacks Rerun.
    ///
    /// # Errors
    /// The session's settings ask for a stream to Rerun.
    pub fn open(
        session: &Session,
        _: &LogHeader,
        _: &mut LogWriter,
        _: u64,
        _: bool,
    ) -> Result<Option<StreamedSession>, String> {
        if session.spec.rerun.is_on() { Err(MissingFeature(Feature::Rerun).to_string()) } else { Ok(None) }
    }

    pub fn view(&mut self, _: &[TimestampedEvent], _: &SessionEngine) {
        match *self {}
    }

    pub fn give_up_file(&mut self) -> bool {
        match *self {}
    }

    pub fn status(&self) -> RerunStreamStatus {
        match *self {}
    }

    pub fn close(self, _: &LogWriter) {
        match self {}
    }
}
