//! Rerun's viewer as a web page, for browsers on this machine. The page is Rerun's own, with a script that goes to the
//! asked time: neither the page's address nor the viewer's layout can contain one.

use std::future::IntoFuture;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::Router;
use axum::http::{StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use re_web_viewer_server::WebViewerData;
use tokio::net::TcpListener;
use tokio::sync::oneshot;

use super::TRIAL_TIME;
use tomcom_core::base::time::SessionTime;

/// Sets the viewer's time once the stream is there up to this time.
const GO_TO: &str = include_str!("go_to.js");

/// Server of the page, until this value is dropped.
pub struct WebViewer {
    _ends: oneshot::Sender<()>,
}

impl WebViewer {
    /// Serves Rerun's viewer at this address; it opens at this time on the trial's clock.
    ///
    /// # Errors
    /// The network port is in use.
    pub fn serve(address: SocketAddr, at: Option<SessionTime>) -> io::Result<WebViewer> {
        let data = Arc::new(WebViewerData::load(None).map_err(io::Error::other)?);
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (ends, ended) = oneshot::channel();
        let pages = Router::new().fallback(move |uri: Uri| {
            let data = data.clone();
            async move { file(&data, uri.path(), at) }
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
        Ok(WebViewer { _ends: ends })
    }
}

/// A file of Rerun's page.
fn file(data: &WebViewerData, path: &str, at: Option<SessionTime>) -> Response {
    let (kind, bytes) = match path {
        "/" | "/index.html" => ("text/html", [data.index_html(), script(at).as_bytes()].concat()),
        "/favicon.ico" => ("image/x-icon", data.favicon().to_vec()),
        "/apple-touch-icon.png" => ("image/png", data.apple_touch_icon().to_vec()),
        "/re_viewer.js" => ("text/javascript", data.viewer_js().to_vec()),
        "/re_viewer_bg.wasm" => ("application/wasm", data.viewer_wasm().to_vec()),
        _ => return StatusCode::NOT_FOUND.into_response(),
    };
    // The same address serves other times later.
    ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], bytes).into_response()
}

fn script(at: Option<SessionTime>) -> String {
    at.map_or_else(String::new, |at| format!("<script>{GO_TO}goTo(\"{TRIAL_TIME}\", {});</script>", at.0))
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
            assert!(GO_TO.contains(used.trim_start_matches("class ")) && code.contains(used), "{used}");
        }
        assert!(script(Some(SessionTime(94_600_000_000))).contains("goTo(\"trial_time\", 94600000000)"));
        assert_eq!(script(None), "");
    }
}
