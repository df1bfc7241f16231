//! Who may send gaze: trackers, as many as come and go, and nobody who is none.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::{Duration, Instant};

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpStream, UdpSocket};
use tokio::time::timeout;
use tomcom::console::console_model::ConsoleModel;
use tomcom::console::console_model::NoticeLevel;
use tomcom::console::preflight::checks;
use tomcom_devices::gaze_input::{GazeSenderRejection, TrackerMessage};
use tomcom_devices::gaze_json::{ExclusiveDatagramSender, RELEASE};
use tomcom_devices::gaze_json::{GazeListener, listen};
use tomcom_session::preflight_checks::RejectedGaze;
use tomcom_session::settings::GazeSenders;

use crate::support::*;

const SAMPLE: &[u8] = b"{\"x\": 0.25, \"y\": 0.5, \"confidence\": 0.9}\n";
/// Nothing that is waited for takes longer; that it does not come is the failure.
const PATIENCE: Duration = Duration::from_secs(300);

/// This computer's programs are rejected for this reason, `senders` of them for the first time.
fn rejected(why: GazeSenderRejection, senders: u64) -> TrackerMessage {
    TrackerMessage::Rejected { from: IpAddr::V4(Ipv4Addr::LOCALHOST), why, senders }
}

async fn open(senders: GazeSenders) -> GazeListener {
    listen((Ipv4Addr::LOCALHOST, 0).into(), senders, &[]).await.expect("a free port")
}

/// What comes next.
async fn next(listener: &mut GazeListener) -> TrackerMessage {
    timeout(PATIENCE, listener.news.recv()).await.expect("news").expect("a listener")
}

fn sample() -> TrackerMessage {
    TrackerMessage::Sample(GazeSample::new(0.25, 0.5, 0.9), None)
}

/// Sends this over a connection of its own, and waits until the other end closes it.
async fn send_until_closed(to: SocketAddr, pieces: &[&[u8]]) {
    let mut stream = TcpStream::connect(to).await.expect("connected");
    for piece in pieces {
        // It may be closed before all of it is sent.
        let _ = stream.write_all(piece).await;
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    let mut answer = Vec::new();
    let _ = timeout(PATIENCE, stream.read_to_end(&mut answer)).await.expect("it is closed");
    assert!(answer.is_empty(), "whoever sends hears nothing");
}

#[tokio::test]
async fn a_connection_that_begins_with_no_object_is_closed_and_what_was_found_is_told() {
    let lines = SAMPLE.repeat(50);
    let post = [b"POST / HTTP/1.1\r\nHost: 127.0.0.1:50021\r\nContent-Type: text/plain\r\n\r\n", &lines[..]].concat();
    let text = std::str::from_utf8(&lines).expect("ASCII");
    let utf16 = |order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect::<Vec<u8>>();
    let (little, big) = (utf16(u16::to_le_bytes), utf16(u16::to_be_bytes));
    let marked = ["\u{feff}".as_bytes(), &lines].concat();
    let joined = text.replace('\n', "").repeat(3);
    let long = [&b"{\"x\": "[..], &[b'1'; 5000][..]].concat();
    let no_object = |start: &str| GazeSenderRejection::NoObject(start.to_string());
    let broken: [(&[&[u8]], GazeSenderRejection); 15] = [
        (&[&post], GazeSenderRejection::HttpRequest),
        (&[b"\n\n", &post], GazeSenderRejection::HttpRequest),
        (&[b"{'x': 0.5, 'y': 0.5}\n"], no_object("{'x': 0.5, 'y': 0.5}")),
        (&[b"[0.1, 0.2, 0.9]\n"], no_object("[0.1, 0.2, 0.9]")),
        (&[b"nonsense\n"], no_object("nonsense")),
        (&[b"\x1b[2J0.5;0.5;1;and more than fits\n"], no_object("\\u001b[2J0.5;0.5;1;and more t")),
        (&[&little], GazeSenderRejection::Utf16),
        (&[&big], GazeSenderRejection::Utf16),
        (&[&[&b"\xff\xfe"[..], &little].concat()], GazeSenderRejection::Utf16),
        (&[&[&b"\xfe\xff"[..], &big].concat()], GazeSenderRejection::Utf16),
        (&[&marked], GazeSenderRejection::ByteOrderMark),
        (&[joined.as_bytes()], GazeSenderRejection::NoLineBreak),
        (&[&[b' '; 5000]], GazeSenderRejection::LongLine(4096)),
        (&[&[&b"{"[..], &[b'\t'; 5000][..]].concat()], GazeSenderRejection::LongLine(4096)),
        (&[&long], GazeSenderRejection::LongLine(4096)),
    ];
    for (pieces, why) in broken {
        let mut listener = open(GazeSenders::First).await;
        send_until_closed(listener.address, pieces).await;
        assert_eq!(next(&mut listener).await, rejected(why, 1), "{:?}", String::from_utf8_lossy(pieces[0]));
        assert!(listener.news.try_recv().is_err(), "nothing else is told of it");
    }
}

#[tokio::test]
async fn a_program_that_connects_again_and_again_is_one_sender() {
    let mut listener = open(GazeSenders::First).await;
    for _ in 0..20 {
        send_until_closed(listener.address, &[b"[", SAMPLE]).await;
    }
    let mut senders = 0;
    while let Ok(TrackerMessage::Rejected { senders: new, .. }) = listener.news.try_recv() {
        senders += new;
    }
    assert_eq!(senders, 1);
}

#[tokio::test]
async fn a_tracker_may_begin_in_pieces_or_with_a_sample_that_is_none() {
    let mut listener = open(GazeSenders::First).await;
    let mut tracker = TcpStream::connect(listener.address).await.expect("connected");
    for piece in [&b"\r\n "[..], b"{", b"\n", &b"{\"x\": NaN, \"y\": 0.5, \"confidence\": 0}\nnonsense\n"[..]] {
        tracker.write_all(piece).await.expect("sent");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    for _ in 0..3 {
        assert_eq!(next(&mut listener).await, TrackerMessage::Malformed(1));
    }
    tracker.write_all(SAMPLE).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
}

#[tokio::test]
async fn silent_connections_keep_no_tracker_out_and_one_that_sent_stays() {
    let mut listener = open(GazeSenders::First).await;
    let mut tracker = TcpStream::connect(listener.address).await.expect("connected");
    tracker.write_all(SAMPLE).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
    let mut silent = Vec::new();
    for _ in 0..300 {
        silent.push(TcpStream::connect(listener.address).await.expect("connected"));
    }
    let mut other = TcpStream::connect(listener.address).await.expect("connected");
    other.write_all(SAMPLE).await.expect("sent");
    let mut news = Vec::new();
    while news.last() != Some(&sample()) {
        news.push(next(&mut listener).await);
    }
    // They gave way, or their time was over on a busy machine; they are one program of this computer.
    let rejection = |news: &TrackerMessage| matches!(news, TrackerMessage::Rejected { .. });
    assert!(news.iter().all(|news| *news == sample() || rejection(news)), "{news:?}");
    tracker.write_all(SAMPLE).await.expect("the tracker that sent before is still connected");
    news.push(next(&mut listener).await);
    while news.last() != Some(&sample()) {
        news.push(next(&mut listener).await);
    }
    // What still says nothing is closed by itself.
    for mut stream in silent {
        let _ = timeout(PATIENCE, stream.read_to_end(&mut Vec::new())).await.expect("it is closed");
    }
    let silent = rejected(GazeSenderRejection::Silent(10), 0);
    while !news.contains(&silent) {
        news.push(next(&mut listener).await);
    }
}

async fn socket(last: u8) -> UdpSocket {
    UdpSocket::bind((Ipv4Addr::new(127, 0, 0, last), 0)).await.expect("an address of this machine")
}

#[tokio::test]
async fn datagrams_are_taken_from_the_address_that_sent_first() {
    let mut listener = open(GazeSenders::First).await;
    let (tracker, other) = (socket(1).await, socket(2).await);
    // A datagram that is no sample makes nobody the tracker.
    other.send_to(b"{\"x\": 0.5}", listener.address).await.expect("sent");
    assert_eq!(next(&mut listener).await, TrackerMessage::Malformed(1));
    tracker.send_to(SAMPLE, listener.address).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
    for _ in 0..3 {
        other.send_to(SAMPLE, listener.address).await.expect("sent");
    }
    let [here, there] = [&tracker, &other].map(|socket| socket.local_addr().expect("an address").ip());
    let of_other =
        |senders| TrackerMessage::Rejected { from: there, why: GazeSenderRejection::OtherSender(here), senders };
    assert_eq!(next(&mut listener).await, of_other(1));
    tracker.send_to(&SAMPLE.repeat(2), listener.address).await.expect("sent");
    assert_eq!((next(&mut listener).await, next(&mut listener).await), (sample(), sample()));
    // A browser's own datagrams (STUN, RFC 8489) begin with no object, whoever sends.
    tokio::time::sleep(Duration::from_millis(150)).await;
    tracker.send_to(b"\x00\x01\x00\x08\x21\x12\xa4\x42", listener.address).await.expect("sent");
    let found = next(&mut listener).await;
    let is_no_object = |why: &GazeSenderRejection| matches!(why, GazeSenderRejection::NoObject(_));
    assert!(matches!(&found, TrackerMessage::Rejected { why, senders: 1, .. } if is_no_object(why)), "{found:?}");
}

#[tokio::test]
async fn datagrams_of_all_addresses_are_taken_where_the_session_says_so() {
    let mut listener = open(GazeSenders::Any).await;
    for sender in [socket(1).await, socket(2).await, socket(3).await] {
        sender.send_to(SAMPLE, listener.address).await.expect("sent");
        assert_eq!(next(&mut listener).await, sample());
    }
}

/// An address of this machine by which other computers reach it.
fn outer_address() -> IpAddr {
    let socket = std::net::UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).expect("a socket");
    // Nothing is sent: the system only chooses the address from which it would be.
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).expect("a machine with a network");
    let outer = socket.local_addr().expect("an address").ip();
    assert!(!outer.is_loopback(), "this test needs a network beside the loopback");
    outer
}

#[tokio::test]
#[ignore = "needs a network beside the loopback"]
async fn from_other_addresses_only_listed_ones_are_read_and_the_others_are_told() {
    let outer = outer_address();
    let anywhere = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let elsewhere = IpAddr::V4(Ipv4Addr::new(192, 0, 2, 7));
    let mut listener = listen(anywhere, GazeSenders::Any, &[elsewhere]).await.expect("a free port");
    let to = SocketAddr::new(outer, listener.address.port());
    send_until_closed(to, &[SAMPLE]).await;
    let unlisted = TrackerMessage::Rejected { from: outer, why: GazeSenderRejection::Unlisted, senders: 1 };
    assert_eq!(next(&mut listener).await, unlisted);
    assert_eq!(listener.code, None, "a list asks for no code");
    tokio::time::sleep(Duration::from_millis(200)).await;
    let sender = UdpSocket::bind((outer, 0)).await.expect("the address of this machine");
    sender.send_to(SAMPLE, to).await.expect("sent");
    assert_eq!(next(&mut listener).await, unlisted);
    // This computer itself needs no entry.
    let here = SocketAddr::from((Ipv4Addr::LOCALHOST, to.port()));
    socket(1).await.send_to(SAMPLE, here).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());

    let mut listener = listen(anywhere, GazeSenders::Any, &[outer]).await.expect("a free port");
    let to = SocketAddr::new(outer, listener.address.port());
    sender.send_to(SAMPLE, to).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
    let mut tracker = TcpStream::connect(to).await.expect("connected");
    tracker.write_all(SAMPLE).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
}

/// Sends these lines over a connection of its own; the lines that it is answered until it is closed.
async fn answers(to: SocketAddr, lines: &[&[u8]]) -> String {
    let mut stream = TcpStream::connect(to).await.expect("connected");
    let mut answer = vec![0; 256];
    let mut found = String::new();
    for line in lines {
        stream.write_all(line).await.expect("sent");
        let count = timeout(PATIENCE, stream.read(&mut answer)).await.expect("an answer").unwrap_or(0);
        found += &String::from_utf8_lossy(&answer[..count]);
    }
    found
}

#[tokio::test]
#[ignore = "needs a network beside the loopback"]
async fn another_computer_pairs_with_the_code_and_sends_then() {
    assert_eq!(open(GazeSenders::Any).await.code, None, "this computer needs none");
    let outer = outer_address();
    let anywhere = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let mut listener = listen(anywhere, GazeSenders::Any, &[]).await.expect("a free port");
    let code = listener.code.clone().expect("a code, since no address is listed");
    let to = listener.reachable();
    assert_eq!(to, SocketAddr::new(outer, listener.address.port()));
    let refused = |why, senders| TrackerMessage::Rejected { from: outer, why, senders };
    let pairing = format!("{{\"pair\": \"{}\"}}\n", code.to_lowercase());

    // Nothing is read of who does not know it, and a wrong code is told to both ends.
    assert_eq!(answers(to, &[SAMPLE]).await, "{\"paired\": false, \"checked\": false, \"wait_s\": 0}\n");
    assert_eq!(next(&mut listener).await, refused(GazeSenderRejection::Unpaired, 1));
    tokio::time::sleep(Duration::from_millis(150)).await;
    let wrong_at = Instant::now();
    assert_eq!(
        answers(to, &[b"{\"pair\": \"WRONG2\"}\n"]).await,
        "{\"paired\": false, \"checked\": true, \"wait_s\": 1}\n"
    );
    // It is the same sender as before.
    assert_eq!(next(&mut listener).await, refused(GazeSenderRejection::WrongCode, 0));
    let locked = answers(to, &[pairing.as_bytes()]).await == "{\"paired\": false, \"checked\": false, \"wait_s\": 1}\n";
    assert!(locked || wrong_at.elapsed() >= Duration::from_secs(1), "locked for a second");
    tokio::time::sleep(Duration::from_millis(1100)).await;
    // That the code was locked is told only where the last notice was 0.1 s ago.
    while listener.news.try_recv().is_ok() {}

    let mut tracker = TcpStream::connect(to).await.expect("connected");
    tracker.write_all(&[pairing.as_bytes(), SAMPLE].concat()).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
    let mut answer = [0; 17];
    tracker.read_exact(&mut answer).await.expect("an answer");
    assert_eq!(&answer, b"{\"paired\": true}\n");
    // A later pairing line is a line that is no sample.
    tracker.write_all(pairing.as_bytes()).await.expect("sent");
    assert_eq!(next(&mut listener).await, TrackerMessage::Malformed(1));

    // That one connection is paired pairs no datagram.
    let datagrams = UdpSocket::bind((outer, 0)).await.expect("the address of this machine");
    datagrams.send_to(SAMPLE, to).await.expect("sent");
    assert_eq!(next(&mut listener).await, refused(GazeSenderRejection::Unpaired, 1));
    datagrams.send_to(&[pairing.as_bytes(), SAMPLE].concat(), to).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
    datagrams.send_to(SAMPLE, to).await.expect("sent");
    assert_eq!(next(&mut listener).await, sample());
}

#[test]
fn an_address_that_is_silent_for_five_seconds_is_the_trackers_no_more() {
    let [one, other] = [1, 2].map(|last| IpAddr::V4(Ipv4Addr::new(127, 0, 0, last)));
    let start = Instant::now();
    let after = |seconds: f64| start + Duration::from_secs_f64(seconds);
    assert_eq!(RELEASE, Duration::from_secs(5));
    let mut holder = ExclusiveDatagramSender::new(GazeSenders::First);
    assert_eq!([one, other].map(|from| holder.excludes(from, start)), [None, None]);
    holder.heard(one, start);
    holder.heard(one, after(3.0));
    assert_eq!([one, other].map(|from| holder.excludes(from, after(7.9))), [None, Some(one)]);
    assert_eq!(holder.excludes(other, after(8.0)), None);
    holder.heard(other, after(8.0));
    assert_eq!([one, other].map(|from| holder.excludes(from, after(9.0))), [Some(other), None]);
    let mut any = ExclusiveDatagramSender::new(GazeSenders::Any);
    any.heard(one, start);
    assert_eq!(any.excludes(other, start), None);
}

#[test]
fn the_wizard_is_told_of_rejected_senders_and_keeps_an_alarm() {
    let files = session_file("default");
    let mut model = console_model(&files.kitchen.kitchen, &files.spec, (120, 40));
    let from = |address: &str, why: &GazeSenderRejection| RejectedGaze {
        told: format!("gaze from {address} is rejected: {}", why.words()),
        remedy: why.remedy().to_string(),
    };
    let notice = |model: &ConsoleModel| model.notice.as_ref().map(|notice| (notice.level, notice.text.clone()));
    let unlisted = GazeSenderRejection::Unlisted;
    for address in ["192.168.1.7", "192.168.1.7", "192.168.1.8"] {
        model.reject_sender(from(address, &unlisted), 1);
    }
    assert_eq!(model.rejected_senders, 3);
    let told = "gaze from 192.168.1.8 is rejected: gaze_from does not list this address".to_string();
    assert_eq!(notice(&model), Some((NoticeLevel::Refused, told)));
    model.notice = None;
    model.reject_sender(from("192.168.1.7", &unlisted), 8);
    assert_eq!(notice(&model), None, "each is told once");
    model.reject_sender(from("192.168.1.7", &GazeSenderRejection::WrongCode), 0);
    let told = "gaze from 192.168.1.7 is rejected: the pairing code is wrong".to_string();
    assert_eq!(notice(&model), Some((NoticeLevel::Refused, told)), "for each reason");
    assert_eq!(model.rejected_senders, 11, "whom another reason rejects is no further sender");
    model.say(NoticeLevel::Alarm, "the recording cannot be written");
    model.reject_sender(from("192.168.1.9", &unlisted), 1);
    assert_eq!(notice(&model).map(|(level, _)| level), Some(NoticeLevel::Alarm));
}

#[test]
fn the_checks_say_what_was_found_in_rejected_gaze() {
    let files = session_file("default");
    let kitchen = kitchen("sushi");
    let mut spec = files.spec;
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
    let mut model = console_model(&kitchen, &spec, (120, 40));
    let mut engine = SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen));
    let gaze = |engine: &SessionEngine, model: &ConsoleModel| {
        let found =
            checks(engine.session(), model).into_iter().find(|check| check.name == "gaze").expect("a check of gaze");
        (found.found, found.remedy.unwrap_or_default())
    };
    model.now = at(1.0);
    assert_eq!(gaze(&engine, &model).1, "start the program that sends gaze to port 50021");
    let why = GazeSenderRejection::Utf16;
    let told = format!("gaze from 127.0.0.1 is rejected: {}", why.words());
    model.reject_sender(RejectedGaze { told: told.clone(), remedy: why.remedy().to_string() }, 1);
    assert_eq!(gaze(&engine, &model), (told, "let the sender write UTF-8".to_string()));
    // A sample arrives: whoever was rejected before is not what is missing later.
    assert_eq!(engine.input(at(2.0), Event::Gaze(GazeSample::new(0.5, 0.5, 1.0))).refused, None);
    model.now = at(60.0);
    assert_eq!(gaze(&engine, &model).0, "no gaze sample arrives");
}
