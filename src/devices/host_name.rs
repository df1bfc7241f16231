//! Names of this machine, as browsers send them in the `Host` header of an HTTP request.

use std::net::{IpAddr, Ipv6Addr};

/// Whether the value of a `Host` header, with or without a port, is a loopback address or `localhost`. Any other name
/// that resolves to this machine, such as `127.evil.example`, belongs to a foreign website (DNS rebinding).
pub fn is_local(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    match name.strip_prefix('[').and_then(|name| name.strip_suffix(']')) {
        Some(address) => address.parse::<Ipv6Addr>().is_ok_and(|address| address.is_loopback()),
        None if name.contains(':') => false,
        None => {
            name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
        }
    }
}
