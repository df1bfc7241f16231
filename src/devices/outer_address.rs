//! The network address by which other computers reach this one.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

/// The network address at which other computers reach a server of this program: for a wildcard address, this machine's
/// address in the network.
pub(super) fn reachable(mut listening: SocketAddr) -> SocketAddr {
    if let (true, Some(known)) = (listening.ip().is_unspecified(), address_outside(listening.ip())) {
        listening.set_ip(known);
    }
    listening
}

/// Address of this machine in the network, found without sending anything (the socket's target is a documentation
/// address, RFC 5737 and RFC 3849).
fn address_outside(any: IpAddr) -> Option<IpAddr> {
    let elsewhere: IpAddr = match any {
        IpAddr::V4(_) => Ipv4Addr::new(192, 0, 2, 1).into(),
        IpAddr::V6(_) => Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1).into(),
    };
    let socket = UdpSocket::bind((any, 0)).ok()?;
    socket.connect((elsewhere, 9)).ok()?;
    socket.local_addr().ok().map(|address| address.ip())
}
