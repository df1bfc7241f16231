//! The session in Rerun while it runs: every event goes to the scene, and what that shows to a stream that never waits.

use std::net::SocketAddr;

use super::Live;
use crate::base::time::SessionTime;
use crate::console::model::ViewerStreamStatus;
use crate::console::notice::NoticeLevel;
use crate::edge::log::{LOG_NAME, LogWriter};
use crate::edge::rerun::{StreamIdentity, uri};
use crate::edge::rrd::{self, RRD_NAME};
use crate::edge::stream::RerunStream;
use crate::scene::{DerivedData, SessionScene};
use crate::session::Stamped;

/// What moves between events is shown so late, so that no event of before is still to come.
const BEHIND: SessionTime = SessionTime(100_000_000);

/// A session that is streamed.
pub(super) struct StreamedSession {
    scene: SessionScene,
    stream: RerunStream,
    /// It shows the session from its beginning.
    is_whole: bool,
}

impl StreamedSession {
    /// Ends the stream. The log is complete by now: a file that shows all of it is sealed.
    pub(super) fn close(self, log: &LogWriter) {
        if let Some(file) = self.stream.close().filter(|_| self.is_whole) {
            // Without its seal it is made anew when somebody asks for it.
            let _ = rrd::seal(&file, &[log.folder().join(LOG_NAME)]);
        }
    }
}

impl Live {
    /// Opens the stream, where the session asks for one; the recording begins here, unless it goes on from an earlier part.
    /// Its next event has the number `next`. A stream that cannot be opened is told, and the session goes on without it.
    pub(super) fn begin_viewing(&mut self, is_new: bool, next: u64) {
        let session = self.engine.session();
        let spec = session.spec.rerun.clone();
        if !spec.is_on() {
            return;
        }
        let mut scene = SessionScene::new(session, next);
        let (fixed, opening) = (scene.fixed(), scene.opening());
        let folder = self.log.folder();
        let file = spec.record.then(|| folder.join(RRD_NAME));
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let began = self.header.started.as_deref().unwrap_or_default();
        let whole = if is_new { rrd::mark() } else { "part".to_string() };
        let identity = StreamIdentity { id: format!("{name} {began} {whole}"), name };
        let address = spec.live.then(|| spec.address.parse::<SocketAddr>()).transpose();
        let opened = address.map_err(|error| format!("{}: {error}", spec.address)).and_then(|server| {
            RerunStream::open(&identity, file.as_deref(), server, fixed, opening).map_err(|error| error.to_string())
        });
        match opened {
            Ok(stream) => {
                if let Some(server) = stream.server {
                    self.log.announce(&uri(server));
                }
                self.viewing = Some(StreamedSession { scene, stream, is_whole: is_new });
            }
            Err(reason) => self.model.say(NoticeLevel::Alarm, format!("the session goes on without Rerun: {reason}")),
        }
        self.tell_viewing();
    }

    /// Shows what has just been recorded.
    pub(super) fn view(&mut self, events: &[Stamped]) {
        let Some(StreamedSession { scene, stream, .. }) = &mut self.viewing else { return };
        let judged = self.engine.judged();
        for (index, stamped) in events.iter().enumerate() {
            let belief = (index + 1 == events.len()).then(|| self.engine.belief());
            stream.tell(scene.see(stamped, DerivedData { judged, belief }));
        }
    }

    /// Shows what moved since the last event.
    pub(super) fn view_motion(&mut self) {
        let until = self.clock.now() - BEHIND;
        if let Some(StreamedSession { scene, stream, .. }) = &mut self.viewing {
            stream.tell(scene.until(until));
        }
    }

    /// Tells the console how the stream fares.
    pub(super) fn tell_viewing(&mut self) {
        self.model.viewers = self.viewing.as_ref().map(|StreamedSession { stream, .. }| {
            let fares = stream.fares();
            let address = stream.server.map(|address| address.to_string());
            ViewerStreamStatus { address, written: fares.written, dropped: fares.dropped }
        });
    }
}
