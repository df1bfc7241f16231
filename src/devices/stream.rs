//! Live Rerun stream of scene updates to viewers and a file, written by a separate thread. The session never waits: if
//! the thread is too slow, updates are dropped and counted. On a full disk the session gives up the stream's file, which
//! can be made from the log.

use std::fs::{self, File};
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::time::Duration;

use super::rerun::{RerunWriter, ShownRecording, StreamIdentity, StreamOutlets};
use crate::scene::{EntityUpdate, SceneUpdate};

/// Number of packets of scene updates that may wait to be written: the packets of 20 seconds at 200 gaze samples per
/// second.
const WAITING: usize = 4096;
/// Longest time for which the end of a session waits for the stream's file to be completed.
const END: Duration = Duration::from_secs(5);
/// Longest time for which a session on a full disk waits until the stream's file is closed.
const CLOSED: Duration = Duration::from_secs(1);
/// Number of further network ports that are tried if the wanted port is in use.
pub const PORTS: u16 = 20;

/// Numbers of written and dropped rows of a Rerun stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts {
    pub written: u64,
    pub dropped: u64,
}

/// State that session and writing thread share.
#[derive(Debug, Default)]
struct Counters {
    written: AtomicU64,
    dropped: AtomicU64,
    without_file: AtomicBool,
}

/// A live Rerun stream that is open.
#[derive(Debug)]
pub struct RerunStream {
    pub server: Option<SocketAddr>,
    file: Option<PathBuf>,
    news: SyncSender<Vec<SceneUpdate>>,
    counters: Arc<Counters>,
    closed: Receiver<()>,
}

impl RerunStream {
    /// Opens a Rerun stream that begins with these rows. If the port is in use, the server takes one of the next ports.
    ///
    /// # Errors
    /// The file cannot be created, or the program cannot listen at the address.
    pub fn open(
        identity: &StreamIdentity,
        file: Option<&Path>,
        server: Option<SocketAddr>,
        (fixed, opening): (Vec<EntityUpdate>, SceneUpdate),
        lane: ShownRecording,
    ) -> io::Result<RerunStream> {
        let server = server.map(free_port).transpose()?;
        let outlets = StreamOutlets { file: file.map(Path::to_path_buf), server };
        let mut writer = RerunWriter::open(identity, &outlets, std::slice::from_ref(&lane))?;
        let (news, told) = sync_channel::<Vec<SceneUpdate>>(WAITING);
        let (close, closed) = channel();
        let counters = Arc::new(Counters::default());
        let counted = counters.clone();
        std::thread::Builder::new().name("rerun".to_string()).spawn(move || {
            writer.fixed(&lane, &fixed);
            counted.written.fetch_add(writer.moment(&lane, &opening), Relaxed);
            for moments in told {
                if counted.without_file.load(Relaxed) && writer.close_file() {
                    let _ = close.send(());
                }
                for moment in moments {
                    counted.written.fetch_add(writer.moment(&lane, &moment), Relaxed);
                }
            }
            // The stream's file is completed first, since a viewer that does not read may delay the rest.
            writer.finish();
            let _ = close.send(());
        })?;
        Ok(RerunStream { server, file: outlets.file, news, counters, closed })
    }

    /// Passes scene updates to the writing thread, or drops the updates if the thread is too slow.
    pub fn tell(&self, moments: Vec<SceneUpdate>) {
        if moments.is_empty() {
            return;
        }
        if let Err(TrySendError::Full(moments) | TrySendError::Disconnected(moments)) = self.news.try_send(moments) {
            let rows: usize = moments.iter().map(|moment| moment.rows.len()).sum();
            self.counters.dropped.fetch_add(rows as u64, Relaxed);
        }
    }

    /// Deletes the stream's file, to make room on a full disk, while viewers still get the stream. Returns false if there
    /// is no file.
    pub fn give_up_file(&mut self) -> bool {
        let Some(path) = self.file.take() else { return false };
        // The file's space is free only when the writing thread has closed the file, or when its content is removed.
        let file = File::options().write(true).open(&path);
        let _ = fs::remove_file(&path);
        self.counters.without_file.store(true, Relaxed);
        // If too much waits to be written, the thread is awake anyway.
        let _ = self.news.try_send(Vec::new());
        let _ = self.closed.recv_timeout(CLOSED);
        if let Ok(file) = file {
            let _ = file.set_len(0);
        }
        true
    }

    /// Numbers of rows that were written to the Rerun stream and dropped so far.
    pub fn fares(&self) -> StreamCounts {
        StreamCounts { written: self.counters.written.load(Relaxed), dropped: self.counters.dropped.load(Relaxed) }
    }

    /// Ends the stream, and waits for a limited time for its file, whose path is returned. An incomplete file is
    /// deleted, since it can be made from the log.
    pub fn close(self) -> Option<PathBuf> {
        let RerunStream { file, news, counters, closed, .. } = self;
        drop(news);
        let is_whole = closed.recv_timeout(END).is_ok() && counters.dropped.load(Relaxed) == 0;
        if let Some(file) = file.as_ref().filter(|_| !is_whole) {
            let _ = fs::remove_file(file);
        }
        file.filter(|_| is_whole)
    }
}

/// Checks that the program can listen at this address now.
///
/// # Errors
/// The program cannot listen at the address.
pub fn is_free(address: SocketAddr) -> io::Result<()> {
    TcpListener::bind(address).map(drop)
}

/// This network address, or the same address with the next free port.
///
/// # Errors
/// None of the ports is free.
pub fn free_port(wanted: SocketAddr) -> io::Result<SocketAddr> {
    let ports = wanted.port()..=wanted.port().saturating_add(PORTS);
    let mut tried = ports.map(|port| {
        let address = SocketAddr::new(wanted.ip(), port);
        is_free(address).map(|()| address)
    });
    let first = tried.next().unwrap_or_else(|| Err(io::ErrorKind::AddrInUse.into()));
    first.or_else(|error| tried.find_map(Result::ok).ok_or(error))
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;
    use crate::rrd::{self, RRD_NAME, RerunFileState};
    use crate::scene::EntityData;
    use tomcom_core::base::time::SessionTime;

    fn open(file: &Path, server: Option<SocketAddr>) -> RerunStream {
        let identity = StreamIdentity { id: rrd::mark(), name: "test".to_string(), facts: Vec::new() };
        let rows = (Vec::new(), moment(0));
        RerunStream::open(&identity, Some(file), server, rows, ShownRecording::default()).unwrap()
    }

    fn moment(step: u64) -> SceneUpdate {
        let rows = vec![EntityUpdate::new("a", EntityData::Value(step as f64))];
        let time = SessionTime(step * 1_000_000);
        SceneUpdate { time, trial: time, step, rows }
    }

    #[test]
    fn what_is_told_is_in_the_file_when_the_stream_is_closed_and_a_taken_port_is_no_trouble() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RRD_NAME);
        let other = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let taken = other.local_addr().unwrap();
        let stream = open(&path, Some(taken));
        let server = stream.server.unwrap();
        assert!(server.port() != taken.port() && server.ip() == taken.ip());
        (1..1000).for_each(|step| stream.tell(vec![moment(step)]));
        assert_eq!(rrd::state(&path, &[]).unwrap(), RerunFileState::Cut, "it is not written to its end yet");
        assert_eq!(stream.fares().dropped, 0);
        assert_eq!(stream.close().as_ref(), Some(&path));
        assert_eq!(rrd::state(&path, &[]).unwrap(), RerunFileState::Unsealed, "it is whole, and waits for its seal");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_file_that_is_given_up_is_gone_while_the_stream_goes_on() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path();
        let path = folder.join(RRD_NAME);
        let mut stream = open(&path, None);
        (1..100).for_each(|step| stream.tell(vec![moment(step)]));
        assert!(path.exists() && stream.give_up_file() && !path.exists());
        assert!(!stream.give_up_file(), "there is none any more");
        (100..200).for_each(|step| stream.tell(vec![moment(step)]));
        assert_eq!(stream.close(), None);
        assert_eq!(fs::read_dir(folder).unwrap().count(), 0, "nothing is written to it any more");
    }
}
