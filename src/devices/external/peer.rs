//! An external mind that listens on a port of this computer.

use std::net::{Shutdown, SocketAddr, TcpStream};
use std::time::Duration;

use tomcom_session::external::{MindConnection, MindWriter};

use super::lines::{LineReceiver, LineSender};

/// Longest time to connect.
const CONNECTS_WITHIN: Duration = Duration::from_secs(2);

/// The way to a peer; its socket is closed with it.
#[derive(Debug)]
struct PeerWriter {
    lines: LineSender,
    socket: TcpStream,
}

impl MindWriter for PeerWriter {
    fn send(&mut self, line: String) -> Result<(), String> {
        self.lines.send(line)
    }
}

impl Drop for PeerWriter {
    fn drop(&mut self) {
        self.lines.close();
        let _ = self.socket.shutdown(Shutdown::Read);
    }
}

pub(super) fn connect(address: &str) -> Result<MindConnection, String> {
    let wanted: SocketAddr = address
        .parse()
        .map_err(|_| format!("tcp://{address}; right would be an address such as tcp://127.0.0.1:5555"))?;
    if !wanted.ip().is_loopback() {
        return Err(format!("tcp://{address}, another computer; right would be one on this computer, 127.0.0.1"));
    }
    let socket = TcpStream::connect_timeout(&wanted, CONNECTS_WITHIN).map_err(|error| error.to_string())?;
    let copy = || socket.try_clone().map_err(|error| error.to_string());
    let _ = socket.set_nodelay(true);
    let (to, from) = (LineSender::start(copy()?), copy()?);
    let from = LineReceiver::start(from, || "it closed the connection".to_string());
    Ok(MindConnection { to: Box::new(PeerWriter { lines: to, socket }), from: Box::new(from) })
}
