//! A live session in a build without the feature `rerun`: no stream is written. Where the session asks for one the wizard
//! is told, as where a stream cannot be opened.

use super::Live;
use crate::base::features::{Feature, NotBuilt};
use crate::console::notice::NoticeLevel;
use crate::edge::log::LogWriter;
use crate::session::Stamped;

/// No stream: this type has no value.
pub(super) enum StreamedSession {}

impl StreamedSession {
    /// There is nothing to end.
    pub(super) fn close(self, _: &LogWriter) {
        match self {}
    }
}

impl Live {
    /// Tells the wizard that no stream is opened, where the session asks for one.
    pub(super) fn begin_viewing(&mut self, _: bool, _: u64) {
        if self.engine.session().spec.rerun.is_on() {
            self.model
                .say(NoticeLevel::Alarm, format!("the session goes on without Rerun: {}", NotBuilt(Feature::Rerun)));
        }
    }

    /// Nothing is streamed.
    pub(super) fn view(&mut self, _: &[Stamped]) {}

    /// Nothing is streamed.
    pub(super) fn view_motion(&mut self) {}

    /// There is nothing to tell.
    pub(super) fn tell_viewing(&mut self) {}
}
