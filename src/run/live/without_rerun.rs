//! Stand-in for the live stream to Rerun in a build without the feature `rerun`; the wizard is told if the session asks
//! for a stream.

use crate::console::console_model::RerunStreamStatus;
use crate::edge::log::LogWriter;
use crate::run::engine::SessionEngine;
use crate::session::features::{Feature, MissingFeature};
use crate::session::{LogHeader, Session, TimestampedEvent};
use tomcom_core::base::time::SessionTime;

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

    /// Does nothing: this build has no stream to Rerun.
    pub fn view(&mut self, _: &[TimestampedEvent], _: &SessionEngine) {
        match *self {}
    }

    /// Does nothing: this build has no stream to Rerun.
    pub fn view_motion(&mut self, _: SessionTime) {
        match *self {}
    }

    /// Never called, since this build has no stream to Rerun.
    pub fn give_up_file(&mut self) -> bool {
        match *self {}
    }

    /// Never called, since this build has no stream to Rerun.
    pub fn status(&self) -> RerunStreamStatus {
        match *self {}
    }

    /// Never called, since this build has no stream to Rerun.
    pub fn close(self, _: &LogWriter) {
        match self {}
    }
}
