//! Rerun's viewer as a web page with the file of a stream, for browsers on this machine. The page is Rerun's own, with a
//! script that says that the file is loading, and goes to the asked time: neither the page's address nor the viewer's
//! layout can contain one.

use std::fs::File;
use std::future::IntoFuture;
use std::io::{self, Read};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use futures::stream;
use re_web_viewer_server::WebViewerData;
use tokio::net::TcpListener;
use tokio::sync::oneshot;

use super::{END, TRIAL_TIME};
use crate::host_name::is_local;
use tomcom_core::base::time::SessionTime;

const OPENING: &str = include_str!("opening.js");
/// Path of the stream's file.
const STREAM: &str = "/recording.rrd";
/// Number of bytes of the file that are read at a time.
const PIECE: usize = 1 << 20;

/// Server of the page, until this value is dropped.
pub struct WebViewer {
    /// The page's address, for a browser.
    pub url: String,
    _ends: oneshot::Sender<()>,
}

/// What the page shows.
#[derive(Clone)]
struct ShownFile {
    path: PathBuf,
    at: Option<SessionTime>,
}

impl WebViewer {
    /// Serves Rerun's viewer at this address; it opens this file of a stream, at this time on the trial's clock.
    ///
    /// # Errors
    /// The network port is in use.
    pub fn serve(address: SocketAddr, file: &Path, at: Option<SessionTime>) -> io::Result<WebViewer> {
        let shown = ShownFile { path: file.to_path_buf(), at };
        let data = Arc::new(WebViewerData::load(None).map_err(io::Error::other)?);
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (ends, ended) = oneshot::channel();
        let pages = Router::new().fallback(move |uri: Uri, headers: HeaderMap| {
            let (data, shown) = (data.clone(), shown.clone());
            async move { answer(&data, &shown, uri.path(), &headers) }
        });
        std::thread::Builder::new().name("viewer page".to_string()).spawn(move || {
            runtime.block_on(async {
                let Ok(listener) = TcpListener::from_std(listener) else { return };
                tokio::select! {
                    _ = axum::serve(listener, pages).into_future() => {}
                    _ = ended => {}
                }
            });
        })?;
        let file = format!("http://{address}{STREAM}").replace(':', "%3A").replace('/', "%2F");
        Ok(WebViewer { url: format!("http://{address}/?hide_welcome_screen&url={file}"), _ends: ends })
    }
}

/// A file of Rerun's page, or of the stream. Requests under another name of this machine come from a foreign website (DNS
/// rebinding), and are refused.
fn answer(data: &WebViewerData, shown: &ShownFile, path: &str, headers: &HeaderMap) -> Response {
    let host = headers.get(header::HOST).map(|host| host.to_str().unwrap_or_default());
    if !host.is_none_or(is_local) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let (kind, bytes) = match path {
        STREAM => return stream_file(&shown.path).unwrap_or_else(|_| StatusCode::NOT_FOUND.into_response()),
        "/" | "/index.html" => ("text/html", [data.index_html(), script(shown.at).as_bytes()].concat()),
        "/favicon.ico" => ("image/x-icon", data.favicon().to_vec()),
        "/apple-touch-icon.png" => ("image/png", data.apple_touch_icon().to_vec()),
        "/re_viewer.js" => ("text/javascript", data.viewer_js().to_vec()),
        "/re_viewer_bg.wasm" => ("application/wasm", data.viewer_wasm().to_vec()),
        _ => return StatusCode::NOT_FOUND.into_response(),
    };
    // The same address serves other times later.
    ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], bytes).into_response()
}

/// The file of the stream, piece by piece: it may be large.
fn stream_file(path: &Path) -> io::Result<Response> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let pieces = stream::try_unfold(file, |mut file| async move {
        let mut piece = Vec::new();
        file.by_ref().take(PIECE as u64).read_to_end(&mut piece)?;
        io::Result::Ok((!piece.is_empty()).then_some((piece, file)))
    });
    let head = [
        (header::CONTENT_TYPE, "application/octet-stream".to_string()),
        (header::CONTENT_LENGTH, length.to_string()),
        (header::CACHE_CONTROL, "no-store".to_string()),
    ];
    Ok((head, Body::from_stream(pieces)).into_response())
}

fn script(at: Option<SessionTime>) -> String {
    let at = at.map_or_else(|| "null".to_string(), |at| at.0.to_string());
    format!("<script>{{{OPENING}openRecording(\"{TRIAL_TIME}\", \"{END}\", {at});}}</script>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_this_version_has_what_the_script_uses() {
        let data = WebViewerData::load(None).unwrap();
        let code = String::from_utf8_lossy(data.viewer_js());
        for used in [
            "class WebHandle",
            "start(",
            "get_active_recording_id(",
            "get_timeline_time_range(",
            "set_time_for_timeline(",
        ] {
            assert!(OPENING.contains(used.trim_start_matches("class ")) && code.contains(used), "{used}");
        }
        assert!(
            script(Some(SessionTime(94_600_000_000)))
                .contains("openRecording(\"trial_clock_time\", \"end\", 94600000000)")
        );
        assert!(script(None).contains("openRecording(\"trial_clock_time\", \"end\", null)"));
    }

    #[test]
    fn the_stream_is_for_pages_of_this_machine_only() {
        let data = WebViewerData::load(None).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        let shown = ShownFile { path: file.path().to_path_buf(), at: None };
        let status = |host: &str, path: &str| {
            let headers = HeaderMap::from_iter([(header::HOST, host.parse().unwrap())]);
            answer(&data, &shown, path, &headers).status()
        };
        assert_eq!(status("127.0.0.1:9090", STREAM), StatusCode::OK);
        assert_eq!(status("127.evil.example:9090", STREAM), StatusCode::FORBIDDEN);
        assert_eq!(status("127.0.0.1:9090", "/etc/passwd"), StatusCode::NOT_FOUND);
        let gone = ShownFile { path: file.path().with_extension("gone"), at: None };
        assert_eq!(answer(&data, &gone, STREAM, &HeaderMap::new()).status(), StatusCode::NOT_FOUND);
    }
}
