//! Web server of a room's page: its files, and the WebSocket.

use std::convert::Infallible;
use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, HeaderName, Request, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{sleep, timeout};

use super::{MAX_BYTES, PageDoor, PageRoom, PageSocket, Place, count};
use crate::host_name::is_local;

/// Content security policy of the page: it loads nothing from other servers and must not be framed.
const POLICY: &str = "default-src 'self'; connect-src 'self' ws:; img-src data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
/// Time limit for receiving the head of an HTTP request.
const HEADER: Duration = Duration::from_secs(5);
/// Time limit for an HTTP request and its response together.
const ANSWER: Duration = Duration::from_secs(30);
/// Longest head of an HTTP request, in bytes.
const MAX_REQUEST: usize = 16 * 1024;
/// Pause after an error while accepting network connections.
const AGAIN: Duration = Duration::from_millis(100);
/// Time limit for telling all pages that the program ends, and how often it is checked whether all are told.
const GOODBYE: Duration = Duration::from_millis(500);
const TOLD: Duration = Duration::from_millis(5);

/// Response to a request for a page under another host name.
const REFUSED: &str = "Refused: open the page at the address that the console shows.";

/// The router of HTTP requests, as a service of the `hyper` crate.
type Answers = TowerToHyperService<Router>;

/// Serves a room until the receiver of its inputs is dropped.
pub(super) async fn serve<R: PageRoom>(listener: std::net::TcpListener, room: R) -> io::Result<()> {
    let listener = TcpListener::from_std(listener)?;
    let room = Arc::new(room);
    let mut router = Router::new().route("/talk", get(connect::<R>));
    for &(path, kind, text) in R::FILES {
        let headers = [
            (header::CONTENT_TYPE, kind),
            (header::CACHE_CONTROL, "no-store"),
            (header::CONTENT_SECURITY_POLICY, POLICY),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        ];
        router = router.route(path, get(move || async move { (headers, text) }));
    }
    let answers = TowerToHyperService::new(router.with_state(room.clone()));
    tokio::select! {
        () = take_connections(listener, room.clone(), answers) => {}
        () = room.inputs().closed() => {}
    }
    // Each connection tells its page that the program ends; further messages of pages are not waited for.
    let all_told = async {
        while room.door().counts.pages.load(Ordering::Relaxed) > 0 {
            sleep(TOLD).await;
        }
    };
    let _ = timeout(GOODBYE, all_told).await;
    Ok(())
}

/// Accepts network connections until the server stops.
async fn take_connections<R: PageRoom>(listener: TcpListener, room: Arc<R>, answers: Answers) {
    loop {
        let Ok((stream, from)) = listener.accept().await else {
            // The process may have run out of file descriptors: the pause prevents a loop that never sleeps.
            sleep(AGAIN).await;
            continue;
        };
        let arrival = room.door().connections.arrive(from.ip(), Instant::now());
        if arrival.as_ref().is_none_or(|arrival| arrival.made_room) {
            count(&room.door().counts.refused);
        }
        let Some(arrival) = arrival else { continue };
        // Small messages such as presses are sent at once (no Nagle delay).
        let _ = stream.set_nodelay(true);
        tokio::spawn(answer(stream, Arc::new(arrival.place), room.clone(), answers.clone()));
        // The new connection's first request is read before further connections can replace the new one.
        tokio::task::yield_now().await;
    }
}

/// Answers one HTTP request. A WebSocket that the request opens continues in a task of its own; connections without a
/// WebSocket are closed afterwards.
async fn answer<R: PageRoom>(stream: TcpStream, place: Place, room: Arc<R>, answers: Answers) {
    let shared = place.clone();
    let service = service_fn(move |mut request: Request<Incoming>| {
        shared.heard(Instant::now());
        let is_own = has_own_host(request.headers(), request.uri(), room.door().has_code());
        request.extensions_mut().insert(shared.clone());
        let (answers, room) = (answers.clone(), room.clone());
        async move { if is_own { answers.call(request).await } else { Ok::<Response, Infallible>(refuse(room.door())) } }
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEADER).keep_alive(false).max_buf_size(MAX_REQUEST);
    let served = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
    tokio::select! {
        // Errors and time-outs close the network connection in the same way as success does.
        _ = timeout(ANSWER, served) => {}
        () = place.closed() => {}
    }
}

/// Opens the WebSocket of a page of this server; pages of other websites in the browser are refused.
async fn connect<R: PageRoom>(
    State(room): State<Arc<R>>,
    Extension(place): Extension<Place>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !has_own_origin(&headers) {
        return refuse(room.door());
    }
    let upgrade = upgrade.max_message_size(MAX_BYTES).max_frame_size(MAX_BYTES);
    upgrade.on_upgrade(move |socket| async move {
        let page = PageSocket::new(socket, room.door().clone(), place);
        room.serve(page).await;
    })
}

fn refuse(door: &PageDoor) -> Response {
    count(&door.counts.refused);
    (StatusCode::FORBIDDEN, REFUSED).into_response()
}

/// Whether an HTTP request is addressed to this server. Without a pairing code, the host must be a loopback address or
/// `localhost`: any other name that resolves to this machine, such as `127.evil.example`, belongs to a foreign website
/// (DNS rebinding). For a server open to the network, the pairing code keeps foreign websites out.
fn has_own_host(headers: &HeaderMap, target: &Uri, has_code: bool) -> bool {
    let Some(host) = single(headers, header::HOST) else { return false };
    // A host in the HTTP request line takes precedence over the `Host` header (RFC 9112, section 3.2.2).
    let is_named_alike = target.authority().is_none_or(|authority| authority.as_str() == host);
    is_named_alike && (has_code || is_local(host))
}

/// Whether an HTTP request has no `Origin` header, or this server's own origin. Browsers always send the `Origin`
/// header when a page opens a WebSocket.
fn has_own_origin(headers: &HeaderMap) -> bool {
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
