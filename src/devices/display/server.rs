//! Web server of the participant's display: the files of the page, and the WebSocket.

use std::convert::Infallible;
use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, Request, StatusCode, header};
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

use super::connection::talk;
use super::host_check::{has_own_host, has_own_origin};
use super::message::MAX_BYTES;
use super::server_state::ServerState;
use super::status::count;
use crate::connection_table::ConnectionHandle;

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

/// Response to a request for the participant's page under another host name.
const REFUSED: &str = "Refused: open the participant's page at the address that the console shows.";

/// Files of the participant's page: path, content type, and content of each file.
const FILES: [(&str, &str, &str); 15] = [
    ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
    ("/display.css", "text/css; charset=utf-8", include_str!("page/display.css")),
    ("/display.js", "text/javascript; charset=utf-8", include_str!("page/display.js")),
    ("/sound.js", "text/javascript; charset=utf-8", include_str!("page/sound.js")),
    ("/reason.js", "text/javascript; charset=utf-8", include_str!("page/reason.js")),
    ("/status.js", "text/javascript; charset=utf-8", include_str!("page/status.js")),
    ("/robot.js", "text/javascript; charset=utf-8", include_str!("page/robot.js")),
    ("/room.js", "text/javascript; charset=utf-8", include_str!("page/room.js")),
    ("/upright.js", "text/javascript; charset=utf-8", include_str!("page/upright.js")),
    ("/stage.js", "text/javascript; charset=utf-8", include_str!("page/stage.js")),
    ("/tutorial.js", "text/javascript; charset=utf-8", include_str!("page/tutorial.js")),
    ("/probe.js", "text/javascript; charset=utf-8", include_str!("page/probe.js")),
    ("/questions.js", "text/javascript; charset=utf-8", include_str!("page/questions.js")),
    ("/hands.js", "text/javascript; charset=utf-8", include_str!("page/hands.js")),
    ("/art.js", "text/javascript; charset=utf-8", include_str!("page/art.js")),
];

/// The router of HTTP requests, as a service of the `hyper` crate.
type Answers = TowerToHyperService<Router>;

/// Serves the participant's display until the receiver of page inputs is dropped.
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
    let answers = TowerToHyperService::new(router.with_state(hub.clone()));
    let (inputs, status) = (hub.inputs.clone(), hub.status.clone());
    tokio::select! {
        () = take_connections(listener, hub, answers) => {}
        () = inputs.closed() => {}
    }
    // Each connection tells its page that the program ends; further messages of pages are not waited for.
    let all_told = async {
        while status.pages.load(Ordering::Relaxed) > 0 {
            sleep(TOLD).await;
        }
    };
    let _ = timeout(GOODBYE, all_told).await;
    Ok(())
}

/// Accepts network connections until the server stops.
async fn take_connections(listener: TcpListener, hub: Arc<ServerState>, answers: Answers) {
    loop {
        let Ok((stream, from)) = listener.accept().await else {
            // The process may have run out of file descriptors: the pause prevents a loop that never sleeps.
            sleep(AGAIN).await;
            continue;
        };
        let arrival = hub.connections.arrive(from.ip(), Instant::now());
        if arrival.as_ref().is_none_or(|arrival| arrival.made_room) {
            count(&hub.status.refused);
        }
        let Some(arrival) = arrival else { continue };
        // Small messages such as presses are sent at once (no Nagle delay).
        let _ = stream.set_nodelay(true);
        tokio::spawn(answer(stream, Arc::new(arrival.place), hub.clone(), answers.clone()));
        // The new connection's first request is read before further connections can replace the new one.
        tokio::task::yield_now().await;
    }
}

/// Answers one HTTP request. A WebSocket that the request opens continues in a task of its own; connections without a
/// WebSocket are closed afterwards.
async fn answer(stream: TcpStream, place: Arc<ConnectionHandle>, hub: Arc<ServerState>, answers: Answers) {
    let shared = place.clone();
    let service = service_fn(move |mut request: Request<Incoming>| {
        shared.heard(Instant::now());
        let is_own = has_own_host(request.headers(), request.uri(), hub.has_code());
        request.extensions_mut().insert(shared.clone());
        let (answers, hub) = (answers.clone(), hub.clone());
        async move { if is_own { answers.call(request).await } else { Ok::<Response, Infallible>(refuse(&hub)) } }
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
async fn connect(
    State(hub): State<Arc<ServerState>>,
    Extension(place): Extension<Arc<ConnectionHandle>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !has_own_origin(&headers) {
        return refuse(&hub);
    }
    let upgrade = upgrade.max_message_size(MAX_BYTES).max_frame_size(MAX_BYTES);
    upgrade.on_upgrade(move |socket| talk(socket, hub, place))
}

fn refuse(hub: &ServerState) -> Response {
    count(&hub.status.refused);
    (StatusCode::FORBIDDEN, REFUSED).into_response()
}
