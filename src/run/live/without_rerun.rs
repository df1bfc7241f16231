//! A live session in a build without the feature `rerun`: no stream is written, and the wizard is told if the session asks for one.

use crate::base::features::{Feature, NotBuilt};
use crate::base::time::SessionTime;
use crate::console::console_model::ViewerStreamStatus;
use crate::edge::log::LogWriter;
use crate::run::engine::Engine;
use crate::session::{Header, Session, Stamped};

/// No stream: this type has no value.
pub(super) enum StreamedSession {}

impl StreamedSession {
    /// Opens no stream.
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

    /// Nothing is streamed.
    pub fn view(&mut self, _: &[Stamped], _: &Engine) {
        match *self {}
    }

    /// Nothing is streamed.
    pub fn view_motion(&mut self, _: SessionTime) {
        match *self {}
    }

    /// There is no state.
    pub fn status(&self) -> ViewerStreamStatus {
        match *self {}
    }

    /// There is nothing to end.
    pub fn close(self, _: &LogWriter) {
        match self {}
    }
}
