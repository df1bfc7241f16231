//! Check of the `Host` and `Origin` headers of HTTP requests. A browser lets every website connect to this machine, but
//! no website can change these two headers.

use axum::http::{HeaderMap, HeaderName, Uri, header};

use crate::edge::host_name::is_local;

/// Whether an HTTP request is addressed to this server. Without a pairing code, the host must be a loopback address or
/// `localhost`: any other name that resolves to this machine, such as `127.evil.example`, belongs to a foreign website
/// (DNS rebinding). For a server open to the network, the pairing code keeps foreign websites out.
pub(super) fn has_own_host(headers: &HeaderMap, target: &Uri, has_code: bool) -> bool {
    let Some(host) = single(headers, header::HOST) else { return false };
    // A host in the HTTP request line takes precedence over the `Host` header (RFC 9112, section 3.2.2).
    let is_named_alike = target.authority().is_none_or(|authority| authority.as_str() == host);
    is_named_alike && (has_code || is_local(host))
}

/// Whether an HTTP request has no `Origin` header, or this server's own origin. Browsers always send the `Origin`
/// header when a page opens a WebSocket.
pub(super) fn has_own_origin(headers: &HeaderMap) -> bool {
    if !headers.contains_key(header::ORIGIN) {
        return true;
    }
    let origin = single(headers, header::ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
    origin.is_some() && origin == single(headers, header::HOST)
}

/// Value of an HTTP header that occurs exactly once; two values would be ambiguous.
fn single(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (Some(value), None) => value.to_str().ok(),
        _ => None,
    }
}
