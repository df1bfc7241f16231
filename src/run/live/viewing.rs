//! Live stream to Rerun viewers: events update the 3D scene, and the scene's updates go to a stream that never makes
//! the session wait.

use std::net::SocketAddr;

use crate::console::console_model::RerunStreamStatus;
use tomcom_devices::rerun::{ShownRecording, StreamIdentity, uri};
use tomcom_devices::rrd::{self, RRD_NAME};
use tomcom_devices::scene::{SceneInputs, SessionScene, facts, title};
use tomcom_devices::stream::RerunStream;
use tomcom_session::engine::SessionEngine;
use tomcom_session::log::{LOG_NAME, LogWriter};
use tomcom_session::{LogHeader, Session, TimestampedEvent};

/// Streams a live session to Rerun viewers.
pub(super) struct StreamedSession {
    scene: SessionScene,
    stream: RerunStream,
    /// Whether the stream shows the session from the session's beginning.
    is_whole: bool,
}

impl StreamedSession {
    /// Opens the stream of a recording, whose next event has the sequence number `next`; `None` if the session has no
    /// stream. `is_whole`: whether the recording is the first part of its session.
    ///
    /// # Errors
    /// The stream to Rerun cannot be opened, for this reason; the session can continue without it.
    pub fn open(
        session: &Session,
        header: &LogHeader,
        log: &mut LogWriter,
        next: u64,
        is_whole: bool,
    ) -> Result<Option<StreamedSession>, String> {
        let spec = &session.spec.rerun;
        if !spec.is_on() {
            return Ok(None);
        }
        let mut scene = SessionScene::new(session, next);
        let (fixed, opening) = (scene.fixed(), scene.opening());
        let folder = log.folder();
        let file = spec.record.then(|| folder.join(RRD_NAME));
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let began = header.started.as_deref().unwrap_or_default();
        let whole = if is_whole { rrd::mark() } else { "part".to_string() };
        let mut facts = facts(session);
        facts.push(("began", began.to_string()));
        let facts = vec![("session".to_string(), facts)];
        let identity = StreamIdentity { id: format!("{name} {began} {whole}"), name: title(session, &name), facts };
        let address = spec.live.then(|| spec.address.parse::<SocketAddr>()).transpose();
        let server = address.map_err(|error| format!("{}: {error}", spec.address))?;
        let lane = ShownRecording::of(session, identity.name.clone());
        let stream = RerunStream::open(&identity, file.as_deref(), server, (fixed, opening), lane);
        let stream = stream.map_err(|error| error.to_string())?;
        if let Some(server) = stream.server {
            log.announce(&uri(server));
        }
        Ok(Some(StreamedSession { scene, stream, is_whole }))
    }

    /// Streams events that have just been recorded to the viewers.
    pub fn view(&mut self, events: &[TimestampedEvent], engine: &SessionEngine) {
        let follower = engine.follower();
        for (index, stamped) in events.iter().enumerate() {
            let belief = (index + 1 == events.len()).then(|| engine.belief());
            self.stream.tell(self.scene.see(stamped, SceneInputs { follower, belief }));
        }
    }

    /// Gives up the stream's file, to make room on a full disk; returns false if there is none.
    pub fn give_up_file(&mut self) -> bool {
        self.stream.give_up_file()
    }

    pub fn status(&self) -> RerunStreamStatus {
        let fares = self.stream.fares();
        let address = self.stream.server.map(|address| address.to_string());
        RerunStreamStatus { address, written: fares.written, dropped: fares.dropped }
    }

    /// Ends the stream to Rerun. If the stream's file shows the whole log, which is complete now, the file is sealed as
    /// up to date.
    pub fn close(self, log: &LogWriter) {
        if let Some(file) = self.stream.close().filter(|_| self.is_whole) {
            // If sealing fails, the stream file is rebuilt from the log when it is needed.
            let _ = rrd::seal(&file, &[log.folder().join(LOG_NAME)]);
        }
    }
}
