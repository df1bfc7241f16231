//! The Rerun viewer: finds the installed program `rerun`, and opens it if there is a screen.

use std::env;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use super::child_process::find_program;
use super::rerun::{TRIAL_TIME, VERSION};
use super::stream::free_port;
use super::stream_head::varint;

/// First network port at which an opened viewer may listen; if the port is in use, one of the next ports is taken.
const PORT: u16 = 9900;
/// Time limit for the Rerun viewer to become ready, and period of asking whether it is.
const READY: Duration = Duration::from_secs(30);
const RETRY: Duration = Duration::from_millis(500);
/// Time limit and size limit of an answer of the viewer program, about its version or to a request.
const ANSWER: Duration = Duration::from_secs(5);
const ANSWER_BYTES: u64 = 1 << 16;

/// Viewer program that was found on this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ViewerAvailability {
    /// A viewer whose version can read this program's streams is installed; the path of its program.
    Ready(PathBuf),
    Other(String),
    NoScreen,
    None,
}

/// How to install the Rerun viewer.
pub const REMEDY: &str = "pip install rerun-sdk==0.36.3, or cargo install rerun-cli --locked --version 0.36.3";

impl ViewerAvailability {
    /// Looks for the viewer program in the folders of `PATH`.
    pub fn find() -> ViewerAvailability {
        let Some(path) = find_program("rerun") else { return ViewerAvailability::None };
        match version_of(&path, ANSWER) {
            Some(version) if version != VERSION => ViewerAvailability::Other(version),
            None => ViewerAvailability::None,
            Some(_) if !has_screen() => ViewerAvailability::NoScreen,
            Some(_) => ViewerAvailability::Ready(path),
        }
    }
}

/// The version that the viewer program at this path reports within the time limit: "rerun-cli 0.36.3 …".
fn version_of(path: &Path, within: Duration) -> Option<String> {
    let mut command = Command::new(path);
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut viewer = command.spawn().ok()?;
    let said = viewer.stdout.take().and_then(|out| read_within(out, within));
    // Another program of this name may not end by itself.
    let _ = viewer.kill().and_then(|()| viewer.wait());
    let said = said?;
    let text = String::from_utf8_lossy(&said);
    let line = text.lines().find_map(|line| line.strip_prefix("rerun-cli "))?;
    line.split_whitespace().next().map(str::to_string)
}

/// What a program writes until it closes its output, up to the size limit; `None` after the time limit.
fn read_within(out: impl Read + Send + 'static, within: Duration) -> Option<Vec<u8>> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut said = Vec::new();
        // After the time limit nobody receives what was read.
        let _ = out.take(ANSWER_BYTES).read_to_end(&mut said).map(|_| sender.send(said));
    });
    receiver.recv_timeout(within).ok()
}

/// Whether there is a screen on which windows can be opened.
pub fn has_screen() -> bool {
    let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

/// Opens the viewer on a file; the viewer stays open when this program ends, and writes nothing into the terminal. With
/// a time in nanoseconds on the trial's clock, the viewer goes to that time as soon as it is ready.
///
/// # Errors
/// The viewer cannot be started, or cannot be told the time.
pub fn open(viewer: &Path, file: &Path, at_ns: Option<u64>) -> io::Result<()> {
    let port = free_port(SocketAddr::from((Ipv4Addr::LOCALHOST, PORT)))?.port();
    let mut command = Command::new(viewer);
    // By default the viewer would listen at all addresses of this computer.
    command.arg(file).args(["--bind", "127.0.0.1", "--port", &port.to_string()]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let Some(at_ns) = at_ns else { return Ok(()) };
    let began = Instant::now();
    loop {
        match go_to(port, at_ns) {
            Err(error) if began.elapsed() > READY => return Err(error),
            Err(_) => std::thread::sleep(RETRY),
            Ok(()) => return Ok(()),
        }
    }
}

/// Asks the viewer at this port to go to a time, through its gRPC-Web service `ViewerControlService`.
fn go_to(port: u16, at_ns: u64) -> io::Result<()> {
    let mut viewer = TcpStream::connect((Ipv4Addr::LOCALHOST, port))?;
    viewer.set_read_timeout(Some(ANSWER))?;
    // Layout of the Protocol Buffers message: SetTimeCursorRequest { timeline (2): Timeline { name (1) }, time (3):
    // TimelineTime { time (1) } }
    let mut request = field(2, &field(1, TRIAL_TIME.as_bytes()));
    request.extend(field(3, &[&[0x08], &varint(at_ns)[..]].concat()));
    let length = (request.len() as u32).to_be_bytes();
    let head = format!(
        "POST /rerun.sdk_comms.v1alpha1.ViewerControlService/SetTimeCursor HTTP/1.1\r\nhost: 127.0.0.1\r\n\
         content-type: application/grpc-web+proto\r\nx-grpc-web: 1\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
        request.len() + 5
    );
    viewer.write_all(&[head.as_bytes(), &[0], &length, &request].concat())?;
    let mut answer = Vec::new();
    viewer.take(ANSWER_BYTES).read_to_end(&mut answer)?;
    let answer = String::from_utf8_lossy(&answer);
    if answer.contains("grpc-status:0") {
        Ok(())
    } else {
        Err(io::Error::other("the Rerun viewer does not go to this time"))
    }
}

/// A field of a Protocol Buffers message whose content has a length.
fn field(number: u8, body: &[u8]) -> Vec<u8> {
    [&[number << 3 | 2], &varint(body.len() as u64)[..], body].concat()
}

/// Opens a web page in the user's browser, if there is a screen and a command that opens pages.
pub fn browse(url: &str) {
    let opener = match env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    if has_screen() {
        // If there is no command that opens pages, the user can open the printed address.
        let _ = Command::new(opener).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn a_viewer_that_does_not_end_or_says_too_much_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rerun");
        let version = |script: &str, within| {
            fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
            version_of(&path, within)
        };
        let long = Duration::from_secs(3000);
        assert_eq!(version("echo rerun-cli 0.36.3 now", long).as_deref(), Some("0.36.3"));
        let began = Instant::now();
        assert_eq!(version("exec sleep 6000", Duration::from_millis(100)), None);
        assert_eq!(version("echo rerun-cli 0.36.3; exec yes", long).as_deref(), Some("0.36.3"));
        assert!(began.elapsed() < Duration::from_secs(6000), "the first one was waited for");
    }
}
