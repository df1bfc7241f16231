//! What Rerun's viewers get of a stream, and that nobody else gets anything, or brings in anything. The viewers here speak gRPC-Web,
//! as Rerun's viewer in a browser does.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use tomcom_devices::rerun::{ShownRecording, StreamIdentity};
use tomcom_devices::scene::{EntityData, EntityUpdate, SceneUpdate};
use tomcom_devices::stream::RerunStream;

use crate::support::*;

pub const SERVICE: &str = "/rerun.sdk_comms.v1alpha1.MessageProxyService";
/// What is waited for comes within this time, however busy the machine is.
const PATIENCE: Duration = Duration::from_secs(300);

/// A moment with a value of each of these entities.
fn moment(step: u64, entities: &[&str]) -> SceneUpdate {
    let row = |entity: &&str| EntityUpdate::new(*entity, EntityData::Value(step as f64));
    let time = SessionTime(step * 1_000_000);
    SceneUpdate { time, trial: time, step, rows: entities.iter().map(row).collect() }
}

/// A stream for viewers, without a file, at a port that was free.
pub fn stream(name: &str) -> RerunStream {
    let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).and_then(|one| one.local_addr()).expect("a port");
    let identity = StreamIdentity { id: format!("viewers-{name}"), name: name.to_string(), facts: Vec::new() };
    let fixed = vec![EntityUpdate::new("fixed/for/ever", EntityData::Value(1.0))];
    RerunStream::open(&identity, None, Some(free), (fixed, moment(0, &["opening/entity"])), ShownRecording::default())
        .expect("a stream")
}

/// Asks for a method of the service; `body` is one message of Protocol Buffers.
pub fn ask(server: SocketAddr, method: &str, headers: &[&str], body: &[u8]) -> TcpStream {
    let mut viewer = TcpStream::connect(server).expect("the server listens");
    viewer.set_read_timeout(Some(Duration::from_millis(200))).expect("a time-out");
    let mut head = format!("POST {SERVICE}/{method} HTTP/1.1\r\ncontent-type: application/grpc-web+proto\r\n");
    if !headers.iter().any(|header| header.starts_with("host:")) {
        head += &format!("host: {server}\r\n");
    }
    headers.iter().for_each(|header| head += &format!("{header}\r\n"));
    head += &format!("content-length: {}\r\n\r\n", body.len() + 5);
    let framed = [head.as_bytes(), &[0], &(body.len() as u32).to_be_bytes(), body].concat();
    viewer.write_all(&framed).expect("the server takes the request");
    viewer
}

/// Reads until all of these words have come, or fails.
pub fn read_until(viewer: &mut TcpStream, words: &[&str]) -> Vec<u8> {
    let (began, mut read, mut piece) = (Instant::now(), Vec::new(), vec![0; 1 << 16]);
    let has = |read: &[u8], word: &str| read.windows(word.len()).any(|window| window == word.as_bytes());
    while !words.iter().all(|word| has(&read, word)) {
        assert!(began.elapsed() < PATIENCE, "{words:?} did not come, but {}", String::from_utf8_lossy(&read));
        // Nothing yet is no error.
        let length = viewer.read(&mut piece).unwrap_or(0);
        read.extend_from_slice(&piece[..length]);
    }
    read
}

/// Whether a new viewer is answered. It may be closed instead, to make room for another one.
pub fn is_answered(server: SocketAddr) -> bool {
    let (mut viewer, mut piece) = (ask(server, "ReadMessages", &[], &[]), vec![0; 1 << 16]);
    viewer.set_read_timeout(Some(PATIENCE)).expect("a time-out");
    viewer.read(&mut piece).is_ok_and(|length| piece[..length].starts_with(b"HTTP/1.1 200"))
}

pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < PATIENCE, "{what}");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_viewer_gets_what_was_and_what_comes() {
    let stream = stream("reads");
    let server = stream.server.expect("a server");
    stream.tell(vec![moment(1, &["before/it/came"])]);
    let mut viewer = ask(server, "ReadMessages", &[], &[]);
    let head = read_until(&mut viewer, &["fixed/for/ever", "opening/entity", "before/it/came"]);
    assert!(head.starts_with(b"HTTP/1.1 200 OK"), "{}", String::from_utf8_lossy(&head));
    stream.tell(vec![moment(2, &["after/it/came"])]);
    read_until(&mut viewer, &["after/it/came"]);
    assert_eq!(stream.fares().dropped, 0);
    stream.close();
    // The end of the stream is that of the answer: a trailer, and the last piece of the body.
    read_until(&mut viewer, &["grpc-status:0", "\r\n0\r\n\r\n"]);
}

#[test]
fn nobody_adds_to_the_stream() {
    let stream = stream("writes");
    let server = stream.server.expect("a server");
    for method in ["WriteMessages", "WriteTable"] {
        let mut writer = ask(server, method, &[], &[]);
        let answer = read_until(&mut writer, &["grpc-status: 7"]);
        assert!(String::from_utf8_lossy(&answer).contains("reading"), "{method}: the refusal says why");
    }
    // Rerun's service that steers viewers is none of this server's.
    let mut other = TcpStream::connect(server).expect("the server listens");
    let path = "/rerun.sdk_comms.v1alpha1.ViewerControlService/SetTimeCursor";
    let head = format!(
        "POST {path} HTTP/1.1\r\nhost: {server}\r\ncontent-type: application/grpc-web+proto\r\ncontent-length: 5\r\n\r\n"
    );
    other.write_all(&[head.as_bytes(), &[0; 5]].concat()).expect("the server takes the request");
    read_until(&mut other, &["grpc-status: 12"]);
}

#[test]
fn pages_of_other_websites_get_nothing() {
    let stream = stream("pages");
    let server = stream.server.expect("a server");
    // A name that leads to this machine (DNS rebinding).
    let evil = format!("host: 127.evil.example:{}", server.port());
    let mut page = ask(server, "ReadMessages", &[&evil, "origin: http://127.evil.example"], &[]);
    let answer = read_until(&mut page, &["grpc-status: 7"]);
    assert!(!String::from_utf8_lossy(&answer).contains("opening"), "the stream was shown");
    // The browser keeps an answer without this header from a page of another origin.
    let mut page = ask(server, "ReadMessages", &["origin: https://evil.example"], &[]);
    let answer = read_until(&mut page, &["\r\n\r\n"]);
    assert!(!String::from_utf8_lossy(&answer).contains("access-control-allow-origin: https://evil"), "it is allowed");
    let mut page = ask(server, "ReadMessages", &["origin: http://127.0.0.1:9090"], &[]);
    read_until(&mut page, &["access-control-allow-origin: http://127.0.0.1:9090", "opening/entity"]);
}

/// Takes what comes at a connection, and counts its bytes.
fn take_all(viewer: &TcpStream) -> Arc<AtomicUsize> {
    let came = Arc::new(AtomicUsize::new(0));
    let (counted, mut viewer) = (came.clone(), viewer.try_clone().expect("a socket"));
    thread::spawn(move || {
        let mut piece = vec![0; 1 << 16];
        loop {
            match viewer.read(&mut piece) {
                Ok(0) => return,
                Ok(length) => counted.fetch_add(length, Ordering::Relaxed),
                Err(_) => 0,
            };
        }
    });
    came
}

#[test]
fn a_viewer_that_stopped_and_many_silent_connections_hold_up_nobody() {
    let stream = stream("stopped");
    let server = stream.server.expect("a server");
    let stopped = ask(server, "ReadMessages", &[], &[]);
    let mut reading = ask(server, "ReadMessages", &[], &[]);
    read_until(&mut reading, &["opening/entity"]);
    let came = take_all(&reading);
    // More than sockets hold: the first viewer takes none of it.
    let entities: Vec<String> = (0..200).map(|one| format!("many/entity_{one}")).collect();
    let entities: Vec<&str> = entities.iter().map(String::as_str).collect();
    let (mut told, mut rows) = (1, stream.fares().written);
    wait_until("the reading viewer got too little", || {
        // More is told when all that was told before is written, so that nothing is dropped for want of a processor.
        if stream.fares().written >= rows {
            stream.tell((told..told + 20).map(|step| moment(step, &entities)).collect());
            (told, rows) = (told + 20, rows + 20 * 200);
        }
        came.load(Ordering::Relaxed) > 12 << 20
    });
    assert_eq!(stream.fares().dropped, 0, "the stream waited for the stopped viewer");
    // Silent connections are closed, and there is room again.
    let silent: Vec<TcpStream> = (0..64).filter_map(|_| TcpStream::connect(server).ok()).collect();
    wait_until("no room beside silent connections", || is_answered(server));
    drop((silent, stopped));
}
