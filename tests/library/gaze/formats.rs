//! Messages of Pupil, frames of ZeroMQ, and files of gaze: read in full, or counted as broken.

use std::path::Path;

use rand::RngExt;
use rmpv::Value;
use tomcom::base::rng::stream;
use tomcom::edge::gaze_file;
use tomcom::edge::pupil::message::{self, PupilMessage};
use tomcom::edge::pupil::zmtp::FrameAssembler;
use tomcom::gaze::surface::SurfaceMap;

const DATUM: &[u8] = include_bytes!("../../pupil/surfaces_wall.msgpack");

#[test]
fn a_real_datum_of_pupil_is_read_in_full() {
    let told = message::read(b"surfaces.wall", DATUM, "wall");
    assert!(told.sees_surface && told.malformed == 0 && told.fixations.is_empty() && told.blink.is_none());
    assert_eq!(told.gaze.len(), 8);
    let first = told.gaze[0];
    assert_eq!(first.norm_pos, [0.515_122_294_425_964_4, 0.587_292_253_971_099_9]);
    assert_eq!((first.confidence, first.timestamp), (0.97, 5.113_798_565_000_025));
    assert!(told.gaze.windows(2).all(|pair| pair[0].timestamp <= pair[1].timestamp));
    // Other surfaces and topics are not ours, also where their names begin alike.
    for topic in [b"surfaces.wall2".as_slice(), b"surfaces.wal", b"gaze.3d.01.", b"", b"notify.x"] {
        assert_eq!(message::read(topic, DATUM, "wall"), PupilMessage::default());
    }
}

#[test]
fn broken_messages_of_pupil_are_counted_and_nothing_more() {
    let read = |bytes: &[u8]| message::read(b"surfaces.wall", bytes, "wall");
    for length in 0..DATUM.len() {
        assert_eq!(read(&DATUM[..length]).malformed, 1, "cut after {length} bytes");
    }
    let mut random = stream(1, "broken messages", 0);
    let mut bytes = DATUM.to_vec();
    for _ in 0..20_000 {
        let at = random.random_range(0..bytes.len());
        let before = std::mem::replace(&mut bytes[at], random.random());
        let told = read(&bytes);
        assert!(told.gaze.len() <= 8);
        let is_number = |gaze: &message::SurfaceGaze| {
            gaze.norm_pos.iter().all(|v| v.is_finite())
                && (0.0..=1.0).contains(&gaze.confidence)
                && gaze.timestamp >= 0.0
        };
        assert!(told.gaze.iter().all(is_number), "{told:?}");
        if random.random::<bool>() {
            bytes[at] = before;
        }
        if random.random_range(0..50) == 0 {
            bytes = DATUM.to_vec();
        }
    }
    // What claims to be longer than it is: a list, a map, a text of four thousand million.
    for head in [[0xdd, 0xff, 0xff, 0xff, 0xff], [0xdf, 0xff, 0xff, 0xff, 0xff], [0xdb, 0xff, 0xff, 0xff, 0xff]] {
        assert_eq!(read(&head).malformed, 1);
    }
    assert_eq!(read(&[0x91; 100_000]).malformed, 1, "lists in lists in lists");
    // One item that is none does not cost the others.
    let item = |x: f64| {
        let text = Value::from;
        let place = Value::Array(vec![Value::from(x), Value::from(0.5)]);
        let time = (text("timestamp"), Value::from(7));
        Value::Map(vec![(text("norm_pos"), place), (text("confidence"), Value::from(1.0)), time])
    };
    let items = vec![item(0.1), item(f64::NAN), Value::Nil, item(f64::INFINITY), item(0.2)];
    let mut bytes = Vec::new();
    let datum = Value::Map(vec![(Value::from("gaze_on_surfaces"), Value::Array(items))]);
    rmpv::encode::write_value(&mut bytes, &datum).expect("written");
    let told = read(&bytes);
    assert_eq!((told.gaze.len(), told.malformed), (2, 3));
    assert_eq!(told.gaze[0].timestamp, 7.0);
}

#[test]
fn frames_are_put_together_from_any_pieces_and_claims_are_not_believed() {
    let long = vec![7u8; 300];
    let mut bytes = vec![1, 8];
    bytes.extend(b"surfaces");
    bytes.push(2);
    bytes.extend(300u64.to_be_bytes());
    bytes.extend(&long);
    // A command in between, then a message of one empty frame.
    bytes.extend([4, 2, b'o', b'k', 0, 0]);
    for piece in [1, 2, 3, 7, 64, 1000] {
        let mut inbox = FrameAssembler::default();
        let mut found = Vec::new();
        for part in bytes.chunks(piece) {
            inbox.push(part);
            while let Some(message) = inbox.next_message().expect("messages") {
                found.push(message);
            }
        }
        assert_eq!(found, [vec![b"surfaces".to_vec(), long.clone()], vec![Vec::new()]], "pieces of {piece}");
    }
    let refused = |bytes: &[u8]| {
        let mut inbox = FrameAssembler::default();
        inbox.push(bytes);
        inbox.next_message().is_err()
    };
    assert!(refused(&[2, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]), "a frame of 8 EB");
    assert!(refused(&[0x10, 1, 1]), "flags that there are not");
    assert!(refused(&[1, 0].repeat(17)), "a message of very many frames");
}

#[test]
fn exports_of_pupil_player_and_own_recordings_are_replayed() {
    let hull = [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]];
    let map = SurfaceMap::new(hull).expect("a surface");
    let found = gaze_file::read(Path::new("tests/pupil/gaze_positions_on_surface_wall.csv"), &map).expect("an export");
    assert_eq!((found.samples.len(), found.malformed), (3, 2));
    let (at_s, sample) = found.samples[1];
    assert!((at_s - 0.004_124_045).abs() < 1e-9, "{at_s}");
    assert!((sample.x - 0.3).abs() < 1e-9 && (sample.y - 0.1).abs() < 1e-9, "{sample:?}");
    assert_eq!((sample.device_ns, sample.confidence), (Some(5_117_922_610), 0.91));
    let error = gaze_file::read(Path::new("layouts/sushi.toml"), &map).expect_err("no export");
    assert!(error.to_string().contains("no column gaze_timestamp"), "{error}");
    let recording = std::fs::read_dir("tests/golden").expect("recordings").map(|entry| entry.expect("an entry").path());
    let recording = recording.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    let counts: Vec<usize> = recording.map(|path| gaze_file::read(&path, &map).expect("gaze").samples.len()).collect();
    assert!(counts.iter().any(|count| *count > 1000), "{counts:?}");
}
