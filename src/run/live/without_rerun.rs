//! Stand-in for the live stream to Rerun in a build without the feature `rerun`; the wizard is told if the session asks
//! for a stream.

use crate::base::features::{Feature, NotBuilt};
use crate::base::time::SessionTime;
use crate::console::console_model::ViewerStreamStatus;
use crate::edge::log::LogWriter;
use crate::run::engine::Engine;
use crate::session::{Header, Session, Stamped};

/// The stream to Rerun, which this build lacks: the type has no value.
pub(super) enum StreamedSession {}

impl StreamedSession {
    /// Opens no stream, since this build lacks Rerun.
    ///
    /// # Errors
    /// The session asks for a stream.
    pub fn open(
        session: &Session,
        _: &Header,
        _: &mut LogWriter,
        _: u64,
        _: bool,
    ) -> Result<Option<StreamedSession>, String> {
        if session.spec.rerun.is_on() { Err(NotBuilt(Feature::Rerun).to_string()) } else { Ok(None) }
    }

    /// Does nothing: this build has no stream.
    pub fn view(&mut self, _: &[Stamped], _: &Engine) {
        match *self {}
    }

    /// Does nothing: this build has no stream.
    pub fn view_motion(&mut self, _: SessionTime) {
        match *self {}
    }

    /// Never called, since this build has no stream.
    pub fn status(&self) -> ViewerStreamStatus {
        match *self {}
    }

    /// Never called, since this build has no stream.
    pub fn close(self, _: &LogWriter) {
        match self {}
    }
}
