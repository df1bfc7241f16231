//! Check of the `Host` and `Origin` headers of HTTP requests. A browser lets every website connect to this machine, but
//! no website can change these two headers.

use axum::http::{HeaderMap, HeaderName, Uri, header};

use crate::host_name::is_local;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_its_own_pages_may_connect() {
        let is_own = |host: &str, origin: Option<&str>, has_code| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().expect("a header"));
            origin.map(|origin| headers.insert(header::ORIGIN, origin.parse().expect("a header")));
            has_own_host(&headers, &Uri::from_static("/talk"), has_code) && has_own_origin(&headers)
        };
        assert!(is_own("127.0.0.1:50022", Some("http://127.0.0.1:50022"), false));
        assert!(is_own("localhost:50022", Some("http://localhost:50022"), false));
        assert!(is_own("localhost:50022", None, false));
        assert!(!is_own("localhost:50022", Some("http://somewhere.example"), false));
        assert!(!is_own("localhost:50022", Some("https://localhost:50022"), false));
        assert!(!is_own("localhost:50022", Some("null"), false));
        assert!(!is_own("somewhere.example:50022", Some("http://somewhere.example:50022"), false));
        // Test: host names that only look like an address of this machine are refused.
        for foreign in [
            "127.evil.example",
            "127.0.0.1.evil.example",
            "localhost.evil.example",
            "127.0.0.1x",
            "127.0.0.1.",
            "localhost.",
            "127.1",
            "2130706433",
            "0.0.0.0",
            "10.0.0.7",
            "[::2]",
            "[127.0.0.1]",
            "[localhost]",
            "evil.example:80@localhost",
            "",
        ] {
            let named = format!("{foreign}:50022");
            assert!(!is_own(&named, Some(&format!("http://{named}")), false), "{foreign}");
            assert!(!is_own(foreign, None, false), "{foreign}");
        }
        assert!(!is_own("::1", None, false), "without brackets the last group would be a port");
        for own in ["127.0.0.1", "127.8.8.8:50022", "LOCALHOST:50022", "localhost", "[::1]:50022", "[::1]"] {
            assert!(is_own(own, None, false), "{own}");
        }
        assert!(is_own("10.0.0.7:50022", Some("http://10.0.0.7:50022"), true));
        assert!(!is_own("10.0.0.7:50022", Some("http://10.0.0.8:50022"), true));
    }

    #[test]
    fn a_request_names_one_host_and_one_origin() {
        let headers = |pairs: &[(HeaderName, &'static str)]| {
            let mut headers = HeaderMap::new();
            for (name, value) in pairs {
                headers.append(name, value.parse().expect("a header"));
            }
            headers
        };
        let talk = Uri::from_static("/talk");
        let twice = headers(&[(header::HOST, "localhost"), (header::HOST, "evil.example")]);
        assert!(!has_own_host(&twice, &talk, false) && !has_own_host(&twice, &talk, true));
        assert!(!has_own_host(&headers(&[]), &talk, true));
        let once = headers(&[(header::HOST, "localhost")]);
        assert!(has_own_host(&once, &talk, false));
        assert!(!has_own_host(&once, &Uri::from_static("http://evil.example/talk"), false));
        let origins =
            [(header::HOST, "localhost"), (header::ORIGIN, "http://localhost"), (header::ORIGIN, "http://a.b")];
        assert!(!has_own_origin(&headers(&origins)) && has_own_origin(&headers(&origins[..2])));
    }
}
