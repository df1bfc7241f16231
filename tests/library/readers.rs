//! Whatever files hold, reading them gives a value or an error that can be shown.

use std::fs;

use rand::RngExt;
use tomcom::base::rng::{Stream, stream};

#[path = "../fuzz/targets/read/mod.rs"]
mod read;

/// What fuzzing does with the readers, with what it begins with, and with every file cut and changed at many places.
#[test]
fn the_readers_survive_cut_and_changed_files() {
    let seeds = [
        (0, "layouts/sushi.toml"),
        (0, "layouts/burger.toml"),
        (1, "recipes/sushi.toml"),
        (2, "sessions/default.toml"),
        (2, "sessions/study.toml"),
        (4, "sessions/questionnaires/acceptance.toml"),
    ];
    for (kind, path) in seeds {
        let text = fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        for at in (0..text.len()).step_by(text.len().div_ceil(10)) {
            let mut changed = [&[kind], &text[..]].concat();
            read::read(&changed[..=at]);
            changed[at + 1] = changed[at + 1].wrapping_add(1) | 1;
            read::read(&changed);
        }
    }
    let log = fs::read("tests/golden/format-1-hand.jsonl").expect("a log");
    let events = log.splitn(2, |byte| *byte == b'\n').nth(1).expect("events after the header");
    for (kind, text) in [(3, &log[..]), (7, events)] {
        let text = &text[..text.len().min(60_000)];
        for at in (0..text.len()).step_by(text.len() / 10) {
            read::read(&[&[kind], &text[..at], b"\xff\x00}", &text[at..]].concat());
        }
    }
}

/// Seed of the mutations, printed by a failure through the case's number.
const SEED: u64 = 24;
/// Mutated cases per reader.
const CASES: u64 = 300;
/// Longest input of a case, in bytes: longer files are cut.
const LONGEST: usize = 30_000;
/// Pieces that parsers treat in a special way.
const PIECES: [&[u8]; 14] = [
    b"inf",
    b"nan",
    b"-1",
    b"1e308",
    b"18446744073709551616",
    b"\"\"",
    b"[]",
    b"{}",
    b"null",
    b"\n",
    b"\xff\xfe",
    b"\0",
    b"\x1b[2J",
    b"\xdf\xff\xff\xff\xff",
];

/// An input for one reader: the number of the reader (see `read::read`) and the bytes.
fn inputs() -> Vec<(u8, Vec<u8>)> {
    let file = |kind: u8, path: &str| {
        let bytes = fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        (kind, bytes[..bytes.len().min(LONGEST)].to_vec())
    };
    let log = fs::read("tests/golden/format-1-hand.jsonl").expect("a log");
    let events = log.splitn(2, |byte| *byte == b'\n').nth(1).expect("events after the header");
    let datum = fs::read("tests/pupil/surfaces_wall.msgpack").expect("a datum of Pupil Capture");
    let human = toml::to_string(&tomcom::mind::model::HumanModel::default()).expect("TOML");
    let keys = "[console]\nhelp = [\"?\", \"f1\"]\n[signals]\nplate = \"l\"\n";
    vec![
        file(0, "layouts/sushi.toml"),
        file(1, "recipes/sushi.toml"),
        file(2, "sessions/study.toml"),
        (3, log[..log.len().min(LONGEST)].to_vec()),
        file(4, "sessions/questionnaires/acceptance.toml"),
        (5, human.into_bytes()),
        (6, keys.as_bytes().to_vec()),
        (7, events[..events.len().min(LONGEST)].to_vec()),
        (8, datum.clone()),
        (9, datum),
        (10, b"\x01\x02ab\x02\x00\x00\x00\x00\x00\x00\x00\x03abc".to_vec()),
        (11, br#"{"t": 1.5, "x": 0.5, "y": 0.25, "confidence": 0.9}"#.to_vec()),
    ]
}

/// One to eight random changes: a byte set, a range removed, a range repeated, or a special piece put in.
fn mutate(bytes: &mut Vec<u8>, random: &mut Stream) {
    for _ in 0..random.random_range(1..=8) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..64)).min(bytes.len());
        match random.random_range(0..4) {
            0 if at < bytes.len() => bytes[at] = random.random(),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let range = bytes[at..end].to_vec();
                bytes.splice(at..at, range);
            }
            _ => {
                let piece = PIECES[random.random_range(0..PIECES.len())];
                bytes.splice(at..at, piece.iter().copied());
            }
        }
    }
}

/// Every reader gets inputs that are changed at random from a valid one.
#[test]
fn the_readers_survive_seeded_mutations() {
    for (kind, input) in inputs() {
        for case in 0..CASES {
            let mut bytes = input.clone();
            mutate(&mut bytes, &mut stream(SEED + u64::from(kind), "mutations", case));
            let outcome = std::panic::catch_unwind(|| read::read(&[&[kind], &bytes[..]].concat()));
            assert!(outcome.is_ok(), "reader {kind}, case {case} of seed {SEED}");
        }
    }
}
