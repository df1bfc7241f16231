//! What Rerun's viewers get of a stream, and that nobody else gets anything, or brings in anything. The viewers here speak gRPC-Web,
//! as Rerun's viewer in a browser does.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use tomcom::edge::rerun::StreamIdentity;
use tomcom::edge::rrd;
use tomcom::edge::stream::RerunStream;
use tomcom::scene::{EntityData, EntityUpdate, SceneInputs, SceneUpdate, SessionScene};

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
    let identity = StreamIdentity { id: format!("viewers-{name}"), name: name.to_string() };
    let fixed = vec![EntityUpdate::new("fixed/for/ever", EntityData::Value(1.0))];
    RerunStream::open(&identity, None, Some(free), fixed, moment(0, &["opening/entity"])).expect("a stream")
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

/// Memory of this process, in MB, as Linux tells it.
fn resident_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("the status of a Linux process");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")?.trim().strip_suffix(" kB"));
    line.and_then(|kilobytes| kilobytes.trim().parse::<f64>().ok()).expect("resident memory in kB") / 1000.0
}

/// Two hours of the default session (arm in the physics, gaze at 120 Hz) at ten times real time, with its file, a viewer that reads and
/// one that takes nothing. Takes 12 minutes: `cargo test --test library -- --ignored --nocapture two_hours`.
#[test]
#[ignore = "takes 12 minutes, on Linux"]
fn two_hours_of_a_session_stay_below_200_mb() {
    const TIMES_REAL: f64 = 10.0;
    const MOST_MB: f64 = 200.0;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("two-hours");
    std::fs::create_dir_all(&folder).expect("a folder");
    let files = session_file("default");
    let kitchen = Arc::new(files.kitchen.kitchen);
    let mut spec = files.spec;
    (spec.trial.seconds, spec.trial.presses) = (7200.0, u32::MAX);
    (spec.trial.condition, spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    let mut engine = SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen)).without_causes();
    let mut scene = SessionScene::new(engine.session(), 0);
    let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).and_then(|one| one.local_addr()).expect("a port");
    let identity = StreamIdentity { id: rrd::mark(), name: "two hours".to_string() };
    let file = folder.join(rrd::RRD_NAME);
    let (fixed, opening) = (scene.fixed(), scene.opening());
    let stream = RerunStream::open(&identity, Some(&file), Some(free), fixed, opening).expect("a stream");
    let server = stream.server.expect("a server");
    let reading = ask(server, "ReadMessages", &[], &[]);
    let came = take_all(&reading);
    let _stopped = ask(server, "ReadMessages", &[], &[]);
    let (began, mut told_at, mut most) = (Instant::now(), 0.0, 0.0_f64);
    let mut events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    while engine.session().is_running() || !events.is_empty() {
        let count = events.len();
        for (index, stamped) in std::mem::take(&mut events).iter().enumerate() {
            let belief = (index + 1 == count).then(|| engine.belief());
            stream.tell(scene.see(stamped, SceneInputs { judged: engine.judged(), belief }));
        }
        let now_s = engine.session().time.as_secs_f64();
        thread::sleep(Duration::from_secs_f64((now_s / TIMES_REAL - began.elapsed().as_secs_f64()).max(0.0)));
        if now_s - told_at >= 300.0 {
            let resident = resident_mb();
            (told_at, most) = (now_s, most.max(resident));
            let (read, written) =
                (came.load(Ordering::Relaxed) >> 20, file.metadata().map_or(0, |file| file.len() >> 20));
            println!(
                "{:3.0} min: {resident:.1} MB resident; {read} MB read by a viewer, {written} MB in the file",
                now_s / 60.0
            );
            assert!(resident < MOST_MB, "{resident} MB");
        }
        if engine.session().is_running() {
            events = engine.fire();
        }
    }
    let fares = stream.fares();
    println!("{} rows, {} dropped; {most:.1} MB at most", fares.written, fares.dropped);
    assert_eq!(fares.dropped, 0);
    assert!(stream.close().is_some(), "the file is whole");
    println!("{:.1} MB after the end of the file", resident_mb());
    std::fs::remove_dir_all(folder).expect("the folder can be removed");
}
