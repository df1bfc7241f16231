//! Requests that are changed at random, at the ports of the participant's display and of the live stream: no connection's task
//! panics, and who comes after them is answered.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::panic;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::display_server::{LOCAL, serve, status};
use crate::raw_page::page;
use crate::readers::mutate;
use crate::support::*;
use crate::viewers;

const SEED: u64 = 25;
/// Changed requests of each kind.
const CASES: u64 = 500;

/// A panic in a task of a server only ends a connection, and would not be seen: counts those of a thread of this name from now on.
fn panics_of(thread: &'static str) -> &'static AtomicUsize {
    let count: &AtomicUsize = Box::leak(Box::default());
    let before = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if std::thread::current().name() == Some(thread) {
            count.fetch_add(1, Ordering::Relaxed);
        }
        before(info);
    }));
    count
}

/// Sends these bytes, and waits for a while for what is answered.
fn send(server: SocketAddr, bytes: &[u8]) {
    let mut connection = TcpStream::connect(server).expect("the server listens");
    connection.set_read_timeout(Some(Duration::from_millis(20))).expect("a time-out");
    // The server may close a connection before it has taken everything.
    let _ = connection.write_all(bytes).and_then(|()| connection.shutdown(Shutdown::Write));
    let mut answer = vec![0; 1 << 16];
    while connection.read(&mut answer).is_ok_and(|length| length == answer.len()) {}
}

/// Sends requests of which the part from `fixed` on is changed.
fn send_changed(server: SocketAddr, kind: &str, fixed: &[u8], rest: &[u8]) {
    for case in 0..CASES {
        let mut changed = rest.to_vec();
        mutate(&mut changed, &mut stream(SEED, kind, case));
        send(server, &[fixed, &changed].concat());
    }
}

/// A frame of HTTP/2 (RFC 9113, section 4.1).
fn frame(kind: u8, flags: u8, stream: u32, payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() as u32).to_be_bytes();
    [&length[1..], &[kind, flags], &stream.to_be_bytes(), payload].concat()
}

#[test]
fn the_live_stream_survives_malformed_requests() {
    let panics = panics_of("viewers");
    let viewed = viewers::stream("malformed");
    let server = viewed.server.expect("a server");
    let path = format!("{}/ReadMessages", viewers::SERVICE);
    let web = format!(
        "POST {path} HTTP/1.1\r\nhost: {server}\r\ncontent-type: application/grpc-web+proto\r\ncontent-length: 5\r\n\r\n"
    );
    send_changed(server, "grpc-web", b"", &[web.as_bytes(), &[0; 5]].concat());
    // Fields from the static table of HPACK (RFC 7541, appendix A): method 3, scheme 6, path 4, authority 1, content type 31.
    let field = |index: &[u8], value: &str| [index, &[value.len() as u8], value.as_bytes()].concat();
    let authority = server.to_string();
    let fields =
        [vec![0x83, 0x86], field(&[0x04], &path), field(&[0x01], &authority), field(&[0x0f, 0x10], "application/grpc")];
    let frames = [frame(4, 0, 0, &[]), frame(1, 4, 1, &fields.concat()), frame(0, 1, 1, &[0; 5])].concat();
    send_changed(server, "grpc", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", &frames);
    // Directly after all these connections the next one may be closed; viewers connect again.
    viewers::wait_until("no viewer is answered any more", || viewers::is_answered(server));
    assert_eq!(panics.load(Ordering::Relaxed), 0);
}

#[test]
fn the_display_survives_malformed_requests() {
    let panics = panics_of("display");
    let (_display, address) = serve(LOCAL);
    let request = format!(
        "GET /talk HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    send_changed(address, "request", b"", request.as_bytes());
    // Frames of a page that says who it is and presses, with a mask of zeros.
    let messages = [
        r#"{"kind":"hello","page":"a","width":800,"height":600,"code":null}"#,
        r#"{"kind":"ping","t":1.5,"took":0.2,"hidden":false}"#,
        r#"{"kind":"press","number":1,"button":"cut","at":12.5}"#,
        r#"{"kind":"pointer","x":0.5,"y":0.25}"#,
        r#"{"kind":"answer","item":"helpful","rated":4}"#,
    ];
    let text = |message: &str| [&[0x81, 0x80 | message.len() as u8, 0, 0, 0, 0], message.as_bytes()].concat();
    let frames: Vec<u8> = messages.iter().flat_map(|message| text(message)).collect();
    send_changed(address, "frames", request.as_bytes(), &frames);
    // Directly after all these connections the next one may be closed; browsers connect again.
    let host = [format!("Host: {address}")];
    viewers::wait_until("no request is answered any more", || status(address, "/", &host) == 200);
    assert_eq!(page(address).joins("after"), Some(true), "the next page acts");
    assert_eq!(panics.load(Ordering::Relaxed), 0);
}
