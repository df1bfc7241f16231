//! The server of the participant's display, as anybody can reach it: with raw sockets.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use tomcom_devices::display::{DisplayServer, PageInput};
use tomcom_devices::sight::page_language::DisplayWords;
use tomcom_session::wall_display::DisplaySpec;

use crate::raw_page::{RawPage, connect, page};
use crate::support::*;

pub const LOCAL: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
pub const ALL: IpAddr = IpAddr::V4(Ipv4Addr::UNSPECIFIED);

/// Serves the display; it is there until this is dropped.
pub fn serve(listen: IpAddr) -> (DisplayServer, SocketAddr) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let words = DisplayWords::for_display(&DisplaySpec::default());
    let display = runtime.block_on(DisplayServer::open(listen, 0, &words)).expect("a free port");
    let address = address_of(&display.url());
    (display, address)
}

/// Where this machine reaches the page with this URL.
pub fn address_of(url: &str) -> SocketAddr {
    let port = url.rsplit_once(':').and_then(|(_, port)| port.parse().ok()).expect("a port");
    SocketAddr::new(LOCAL, port)
}

/// Sends a request with these lines of headers; the status of the answer, 0: the connection was closed without one.
pub fn status(address: SocketAddr, path: &str, headers: &[String]) -> u32 {
    let mut stream = connect(address);
    let upgrade = match path {
        "/talk" => {
            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        }
        _ => "",
    };
    let lines: String = headers.iter().map(|line| format!("{line}\r\n")).collect();
    write!(stream, "GET {path} HTTP/1.1\r\n{upgrade}{lines}\r\n").expect("sent");
    let mut line = String::new();
    // A connection that is closed without an answer gives an empty line.
    let _ = BufReader::new(stream).read_line(&mut line);
    line.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or_default()
}

/// As a page of the participant.
impl RawPage {
    pub fn hello(&mut self, page: &str, code: Option<&str>) {
        self.say(&json!({"kind": "hello", "page": page, "width": 800, "height": 600, "code": code}));
    }

    /// What a browser answers by itself to a ping, with a mask of zeros.
    fn pong(&mut self) {
        self.0.write_all(&[0x8a, 0x80, 0, 0, 0, 0]).expect("sent");
    }

    /// Says hello; whether it acts, none: it is not let in.
    pub fn joins(&mut self, page: &str) -> Option<bool> {
        self.hello(page, None);
        self.hear("role")?["acts"].as_bool()
    }
}

#[test]
fn only_requests_to_this_machine_by_its_own_names_are_answered() {
    let (display, address) = serve(LOCAL);
    let port = address.port();
    let evil = format!("127.evil.example:{port}");
    let own = [
        format!("127.0.0.1:{port}"),
        "127.0.0.1".to_string(),
        format!("127.8.8.8:{port}"),
        format!("localhost:{port}"),
        "localhost".to_string(),
        format!("LOCALHOST:{port}"),
        format!("[::1]:{port}"),
        "[::1]".to_string(),
    ];
    for host in &own {
        let headers = [format!("Host: {host}")];
        assert_eq!(status(address, "/", &headers), 200, "{host}");
        assert_eq!(status(address, "/talk", &headers), 101, "{host}");
        let origin = |origin: &str| [headers[0].clone(), format!("Origin: {origin}")];
        assert_eq!(status(address, "/talk", &origin(&format!("http://{host}"))), 101, "{host}");
        for foreign in
            [format!("http://{evil}"), format!("https://{host}"), "null".to_string(), "http://a.b".to_string()]
        {
            assert_eq!(status(address, "/talk", &origin(&foreign)), 403, "{host} from {foreign}");
        }
    }
    // Names that only look like one of this machine; without brackets the last group of ::1 would be a port.
    let look_alikes = "127.evil.example 127.0.0.1.evil.example localhost.evil.example 127.0.0.1x 127.0.0.1. localhost. \
                       127.1 2130706433 0.0.0.0 10.0.0.7 [::2] [127.0.0.1] [localhost] evil.example:80@localhost ::1";
    for host in look_alikes.split_whitespace().flat_map(|host| [host.to_string(), format!("{host}:{port}")]) {
        let headers = [format!("Host: {host}"), format!("Origin: http://{host}")];
        assert_eq!(status(address, "/", &headers), 403, "{host}");
        assert_eq!(status(address, "/talk", &headers), 403, "{host}");
    }
    let hosts = [format!("Host: localhost:{port}"), format!("Host: {evil}")];
    assert_eq!(status(address, "/talk", &hosts), 403, "two hosts");
    assert_eq!(status(address, "/talk", &[hosts[1].clone(), hosts[0].clone()]), 403, "two hosts");
    assert_eq!(status(address, "/talk", &[]), 403, "no host");
    let origins = [hosts[0].clone(), format!("Origin: http://localhost:{port}"), "Origin: http://a.b".to_string()];
    assert_eq!(status(address, "/talk", &origins), 403, "two origins");
    assert_eq!(status(address, &format!("http://{evil}/talk"), &hosts[..1]), 403, "another host in the first line");
    assert!(display.screen().counts().refused > 20);
    assert_eq!(display.screen().counts().page, None);
    // What the network reaches asks for a code, and is called by any name, though by the same in host and origin.
    let (_open, address) = serve(ALL);
    let from = |host: &str| ["Host: 10.0.0.7:50022".to_string(), format!("Origin: http://{host}:50022")];
    assert_eq!([from("10.0.0.7"), from("10.0.0.8")].map(|headers| status(address, "/talk", &headers)), [101, 403]);
}

#[test]
fn a_page_joins_while_520_connections_say_nothing_or_only_half_of_it() {
    let (display, address) = serve(LOCAL);
    let silent: Vec<TcpStream> = (0..260).map(|_| connect(address)).collect();
    let halves: Vec<TcpStream> = (0..260)
        .map(|_| {
            let mut stream = connect(address);
            // Some were closed already, in favour of those that came later.
            let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: loc");
            stream
        })
        .collect();
    let mut page = page(address);
    assert_eq!(page.joins("participant"), Some(true));
    assert!(display.screen().counts().page.is_some());
    // And what says nothing is closed by itself: all of it ends.
    for mut stream in silent.into_iter().chain(halves) {
        let ended = stream.read_to_end(&mut Vec::new());
        let is_open = ended.is_err_and(|error| matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut));
        assert!(!is_open, "it is still there");
    }
}

#[test]
fn the_page_that_acts_has_a_place_among_those_that_watch() {
    let (display, address) = serve(LOCAL);
    let mut acting = page(address);
    assert_eq!(acting.joins("participant"), Some(true));
    let mut watching: Vec<RawPage> = (0..40).map(|_| page(address)).collect();
    let joined: Vec<Option<bool>> =
        watching.iter_mut().enumerate().map(|(number, page)| page.joins(&format!("watching {number}"))).collect();
    assert_eq!(joined.iter().filter(|acts| **acts == Some(false)).count(), 32, "{joined:?}");
    assert_eq!(joined.iter().filter(|acts| acts.is_none()).count(), 8, "{joined:?}");
    // It is loaded again: in its own place, although no other page is let in.
    let mut again = page(address);
    assert_eq!(again.joins("participant"), Some(true));
    assert_eq!(page(address).joins("watching 41"), None);
    assert_eq!(display.screen().counts().refused, 9);
    drop((acting, watching));
}

#[test]
fn an_address_tries_one_code_at_a_time_however_many_connections_it_has() {
    let (display, address) = serve(ALL);
    let code = display.code().expect("what the network reaches asks for a code").to_string();
    let mut known = page(address);
    known.hello("participant", Some(&code));
    assert_eq!(known.hear("role").map(|role| role["acts"] == true), Some(true));
    let began = Instant::now();
    let say_hello = |number: usize| {
        let mut guesser = page(address);
        guesser.hello(&format!("guesser {number}"), Some("WRONG2"));
        guesser
    };
    let mut guessers: Vec<RawPage> = (0..50).map(say_hello).collect();
    let answers: Vec<Value> = guessers.iter_mut().filter_map(|guesser| guesser.hear("pairing")).collect();
    // How often its lock was over, at most: the first four last a second each, and the later ones longer.
    let most = 1 + began.elapsed().as_secs() as usize;
    let looked_at = answers.iter().filter(|answer| answer["why"] == "wrong").count();
    assert!(answers.iter().all(|answer| answer["why"] == "wrong" || answer["why"] == "locked"), "{answers:?}");
    assert!((1..=most).contains(&looked_at) && answers.len() == 50, "{looked_at} of {} codes looked at", answers.len());
    assert!(answers.iter().all(|answer| answer["wait_s"].as_u64().is_some_and(|seconds| seconds > 0)), "{answers:?}");
    let (mut guesser, asked) = (page(address), Instant::now());
    guesser.hello("guesser", Some("WRONG2"));
    let wait_s = guesser.hear("pairing").and_then(|answer| answer["wait_s"].as_u64()).expect("a time to wait");
    guesser.hello("guesser", Some(&code));
    let answer = guesser.hear_one_of(&["pairing", "role"]).expect("an answer");
    assert!(answer["why"] == "locked" || asked.elapsed() >= Duration::from_secs(wait_s - 1), "not even the right one");
    // A page that was let in before comes back, and so does one at another address.
    let mut again = page(address);
    again.hello("participant", Some(&code));
    assert!(again.hear("role").is_some(), "a page that was let in before");
    let other = socket_from(Ipv4Addr::new(127, 0, 0, 2), address);
    let mut other = RawPage::open(other, address);
    other.hello("other", Some(&code.to_lowercase()));
    assert!(other.hear("role").is_some(), "a page at another address");
}

#[test]
fn a_new_page_is_let_in_while_wrong_codes_come_from_many_addresses() {
    let (display, address) = serve(ALL);
    let code = display.code().expect("what the network reaches asks for a code").to_string();
    for round in 0..3_u8 {
        // More addresses than wrong codes of a second that slow down nobody.
        let wrong = |host: u8| {
            let from = Ipv4Addr::new(127, 0, 10 + round, host);
            let mut guesser = RawPage::open(socket_from(from, address), address);
            guesser.hello("guesser", Some("WRONG2"));
            guesser
        };
        let guessers: Vec<RawPage> = (1..=30).map(wrong).collect();
        let mut new = RawPage::open(socket_from(Ipv4Addr::new(127, 0, 2, round + 1), address), address);
        new.hello(&format!("new {round}"), Some(&code));
        assert!(new.hear("role").is_some(), "round {round}");
        drop(guessers);
    }
}

/// Connects from this address of this machine.
fn socket_from(from: Ipv4Addr, to: SocketAddr) -> TcpStream {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let stream = runtime.block_on(async {
        let socket = tokio::net::TcpSocket::new_v4().expect("a socket");
        socket.bind(SocketAddr::new(from.into(), 0)).expect("an address of this machine");
        socket.connect(to).await.expect("connected").into_std().expect("a stream")
    });
    stream.set_nonblocking(false).expect("a stream that waits");
    stream
}

#[test]
fn a_page_that_is_asked_for_a_code_may_wait_and_is_answered() {
    let (_display, address) = serve(ALL);
    let mut page = page(address);
    page.hello("participant", None);
    assert_eq!(page.hear("pairing").map(|answer| answer["why"] == "code"), Some(true));
    // More pings than malformed messages would be allowed.
    for t in 0..150 {
        page.say(&json!({"kind": "ping", "t": t, "took": null, "hidden": true}));
        assert_eq!(page.hear("pong").map(|pong| pong["t"] == f64::from(t)), Some(true));
    }
}

#[test]
fn a_visible_page_that_says_nothing_is_lost_though_its_browser_answers() {
    let (mut display, address) = serve(LOCAL);
    let mut page = page(address);
    assert_eq!(page.joins("participant"), Some(true));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let mut next = |page: &mut RawPage| loop {
        page.pong();
        let waited = runtime.block_on(async { tokio::time::timeout(Duration::from_millis(100), display.next()).await });
        if let Ok(input) = waited {
            return input.expect("the display is there");
        }
    };
    assert!(matches!(next(&mut page), PageInput::Connected { .. }));
    assert!(matches!(next(&mut page), PageInput::Lost { .. }));
    // Its connection is kept: it is back as soon as it says something.
    page.say(&json!({"kind": "ping", "t": 1.0, "took": null}));
    assert!(matches!(next(&mut page), PageInput::Connected { .. }));
}

#[test]
fn every_page_is_told_that_the_program_ends() {
    let (display, address) = serve(LOCAL);
    let (mut acting, mut watching) = (page(address), page(address));
    assert_eq!([acting.joins("one"), watching.joins("two")], [Some(true), Some(false)]);
    drop(display);
    assert!(acting.hear("ended").is_some() && watching.hear("ended").is_some());
}
