//! The server: the page's files, and the place where pages connect.

use std::collections::BTreeMap;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;
use tokio::sync::mpsc::Sender;
use tokio::sync::watch;

use super::PageInput;
use super::connection::talk;
use super::listener::LimitedListener;
use super::message::MAX_BYTES;
use super::status::{DisplayStatus, count};

/// The page may load nothing from elsewhere, and nobody may frame it.
const POLICY: &str = "default-src 'self'; connect-src 'self' ws:; img-src data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// The page's files: path, kind, text.
const FILES: [(&str, &str, &str); 6] = [
    ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
    ("/display.css", "text/css; charset=utf-8", include_str!("page/display.css")),
    ("/display.js", "text/javascript; charset=utf-8", include_str!("page/display.js")),
    ("/stage.js", "text/javascript; charset=utf-8", include_str!("page/stage.js")),
    ("/hands.js", "text/javascript; charset=utf-8", include_str!("page/hands.js")),
    ("/art.js", "text/javascript; charset=utf-8", include_str!("page/art.js")),
];

/// What all connections share.
pub(super) struct ServerState {
    /// What a page is asked for, if the network reaches it.
    pub code: Option<String>,
    /// The words of the page, by what they stand for.
    pub words: BTreeMap<String, String>,
    pub inputs: Sender<PageInput>,
    pub scene: watch::Receiver<Arc<str>>,
    pub sight: watch::Receiver<Arc<str>>,
    pub status: Arc<DisplayStatus>,
    /// The connection that acts, and the page that it is of.
    pub acting: watch::Sender<Option<(u64, String)>>,
    connections: AtomicU64,
    began: Instant,
}

impl ServerState {
    pub fn new(
        code: Option<String>,
        words: BTreeMap<String, String>,
        inputs: Sender<PageInput>,
        scene: watch::Receiver<Arc<str>>,
        sight: watch::Receiver<Arc<str>>,
        status: Arc<DisplayStatus>,
    ) -> ServerState {
        let (acting, connections, began) = (watch::Sender::new(None), AtomicU64::new(0), Instant::now());
        ServerState { code, words, inputs, scene, sight, status, acting, connections, began }
    }

    /// The server's clock, in milliseconds.
    pub fn now_ms(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * 1000.0
    }

    /// The moment of a time on it. What comes from a page was no later than now, and not long ago.
    pub fn moment(&self, at_ms: f64) -> Instant {
        /// No press waits longer than so many milliseconds on its way.
        const OLDEST_MS: f64 = 2000.0;
        let now = Instant::now();
        let age_ms = (self.now_ms() - at_ms).clamp(0.0, OLDEST_MS);
        now.checked_sub(Duration::from_secs_f64(age_ms / 1000.0)).unwrap_or(now)
    }
}

/// Serves until nobody wants inputs any more.
pub(super) async fn serve(listener: std::net::TcpListener, hub: ServerState) -> io::Result<()> {
    let listener = TcpListener::from_std(listener)?;
    let hub = Arc::new(hub);
    let mut router = Router::new().route("/talk", get(connect));
    for (path, kind, text) in FILES {
        let headers = [
            (header::CONTENT_TYPE, kind),
            (header::CACHE_CONTROL, "no-store"),
            (header::CONTENT_SECURITY_POLICY, POLICY),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        ];
        router = router.route(path, get(move || async move { (headers, text) }));
    }
    let inputs = hub.inputs.clone();
    let server = axum::serve(LimitedListener::new(listener), router.with_state(hub));
    // The session is over: its connections end with it, without waiting for what they may still say.
    tokio::select! {
        done = server => done,
        () = inputs.closed() => Ok(()),
    }
}

/// Lets a page connect: of this server, and of no other that a browser may have open.
async fn connect(State(hub): State<Arc<ServerState>>, headers: HeaderMap, upgrade: WebSocketUpgrade) -> Response {
    if !is_own(&headers, hub.code.is_some()) {
        count(&hub.status.refused);
        return StatusCode::FORBIDDEN.into_response();
    }
    let number = hub.connections.fetch_add(1, Ordering::Relaxed);
    let upgrade = upgrade.max_message_size(MAX_BYTES).max_frame_size(MAX_BYTES);
    upgrade.on_upgrade(move |socket| talk(socket, hub, number))
}

/// Whether a request comes from a page of this server. Without a pairing code the host must be a loopback address or
/// `localhost`: any other name that resolves to this machine, `127.evil.example` too, belongs to a foreign page (DNS
/// rebinding). In the network the pairing code keeps foreign pages out.
fn is_own(headers: &HeaderMap, has_code: bool) -> bool {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let Some(host) = text(header::HOST) else { return false };
    let is_same = text(header::ORIGIN).is_none_or(|origin| origin.strip_prefix("http://") == Some(host));
    is_same && (has_code || is_local(host))
}

/// Whether the value of a `Host` header, with or without a port, is a loopback address or `localhost`.
fn is_local(host: &str) -> bool {
    if let Ok(address) = host.parse::<SocketAddr>() {
        return address.ip().is_loopback();
    }
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        _ => host,
    };
    let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    name.eq_ignore_ascii_case("localhost") || address.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_its_own_pages_may_connect() {
        let is_own = |host: &'static str, origin: Option<&'static str>, has_code| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().expect("a header"));
            origin.map(|origin| headers.insert(header::ORIGIN, origin.parse().expect("a header")));
            super::is_own(&headers, has_code)
        };
        assert!(is_own("127.0.0.1:50022", Some("http://127.0.0.1:50022"), false));
        assert!(is_own("localhost:50022", Some("http://localhost:50022"), false));
        assert!(is_own("localhost:50022", None, false));
        assert!(!is_own("localhost:50022", Some("http://somewhere.example"), false));
        assert!(!is_own("somewhere.example:50022", Some("http://somewhere.example:50022"), false));
        // Names that only look like an address of this machine.
        for foreign in [
            "127.evil.example",
            "127.0.0.1.evil.example",
            "localhost.evil.example",
            "127.0.0.1x",
            "127.1",
            "10.0.0.7",
            "[::2]",
        ] {
            let named: &'static str = format!("{foreign}:50022").leak();
            let origin: &'static str = format!("http://{foreign}:50022").leak();
            assert!(!is_own(named, Some(origin), false), "{foreign}");
            assert!(!is_own(foreign, None, false), "{foreign}");
        }
        for own in ["127.0.0.1", "127.8.8.8:50022", "LOCALHOST:50022", "localhost", "[::1]:50022", "[::1]"] {
            assert!(is_own(own, None, false), "{own}");
        }
        assert!(is_own("10.0.0.7:50022", Some("http://10.0.0.7:50022"), true));
        assert!(!is_own("10.0.0.7:50022", Some("http://10.0.0.8:50022"), true));
    }
}
