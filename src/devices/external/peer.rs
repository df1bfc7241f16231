//! An external mind that listens on a port of this computer.

use std::net::{Shutdown, SocketAddr, TcpStream};
use std::time::Duration;

use tomcom_session::external::MindConnection;

use super::lines::{LineReceiver, LineSender};

/// Longest time to connect.
const CONNECTS_WITHIN: Duration = Duration::from_secs(2);

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
    let from = LineReceiver::start(copy()?, || "it closed the connection".to_string());
    let to = LineSender::start(copy()?, move || drop(socket.shutdown(Shutdown::Read)));
    Ok(MindConnection { to: Box::new(to), from: Box::new(from) })
}
