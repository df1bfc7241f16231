//! Whatever files hold, reading them gives a value or an error that can be shown.

#[path = "../fuzz/targets/read/mod.rs"]
mod read;

use tomcom_core::base::rng::Stream;

use crate::support::*;

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

/// A valid input for this reader.
fn input(reader: &str) -> Vec<u8> {
    let file = |path: &str| fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let log = || file("tests/golden/format-3-hand.jsonl");
    let mut bytes = match reader {
        "layout" => file("layouts/sushi.toml"),
        "recipes" => file("recipes/sushi.toml"),
        "session" => file("sessions/study.toml"),
        "questionnaire" => file("sessions/questionnaires/acceptance.toml"),
        "parameters" => toml::to_string(&tomcom_core::mind::model::HumanModel::default()).expect("TOML").into_bytes(),
        "keys" => b"[console]\nhelp = [\"?\", \"f1\"]\n[signals]\nplate = \"l\"\n".to_vec(),
        "language" => b"\"Press start\" = \"Appuyez\"\n".to_vec(),
        "log" => log(),
        "events" => log().splitn(2, |byte| *byte == b'\n').nth(1).expect("events after the header").to_vec(),
        "exclusion" => b"[[ruling]]\nexcluded = true\nreason = \"fire alarm\"\nat = \"2026-03-14T10:00:00Z\"\n".to_vec(),
        "rater_codes" => b"press,cause,aspect\n3,belief,cooking_pot\n7,slip,\n".to_vec(),
        "consensus" => b"rater_1,cause_1,aspect_1,rater_2,cause_2,aspect_2,press,cause,aspect\n\
            R1,slip,,R2,belief,plate,3,slip,\nR1,race,,R2,race,,7,race,\n"
            .to_vec(),
        "video" => br#"{"films":[{"file":"room.mp4","sha256":"00","by":"flashes","offset_s":-3.5,"drift_ppm":20.0,"residual_ms":9.5,"flashes":5,"frame_ms":33.3,"length_s":60.0}]}"#.to_vec(),
        "pupil_timestamps" => b"\x93NUMPY\x01\x00\x3a\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }\n12345678".to_vec(),
        "elan" => b"<ANNOTATION_DOCUMENT><HEADER><PROPERTY NAME=\"tomcom recording\">P07-1</PROPERTY></HEADER>\n\
            <TIME_SLOT TIME_SLOT_ID=\"a\" TIME_VALUE=\"1000\"/><TIME_SLOT TIME_SLOT_ID=\"b\" TIME_VALUE=\"1500\"/>\n\
            <TIER TIER_ID=\"errors\"><ALIGNABLE_ANNOTATION TIME_SLOT_REF1=\"a\" TIME_SLOT_REF2=\"b\">\
            <ANNOTATION_VALUE>error 1: cut &amp; press</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></TIER>\n\
            <TIER TIER_ID=\"codes R1\"><ALIGNABLE_ANNOTATION TIME_SLOT_REF1=\"a\" TIME_SLOT_REF2=\"b\">\
            <ANNOTATION_VALUE>belief: plate</ANNOTATION_VALUE></ALIGNABLE_ANNOTATION></TIER></ANNOTATION_DOCUMENT>"
            .to_vec(),
        "boris" => br#"{"observations":{"P07-1":{"events":[[1.0,"","errors","error 1: cut","",""],[1.2,"R1","code","slip","",""]]}}}"#.to_vec(),
        "training" => br#"{"wizard":"W1","at":"2026-03-14T10:00:00Z","minutes":2.5,"criterion":{"hits":0.5,"wrong":0.2},"met":false,"recordings":[]}"#.to_vec(),
        "table" => b"participant,press,kind\nP07,1,\"slip, seen\"\n".to_vec(),
        "gaze_export" => file("tests/pupil/gaze_positions_on_surface_wall.csv"),
        "rerun_head" => b"RRF2\x00\x24\x03\x00\x12\x17P07-1 tomcom-scene-3-whole\x1a\x08".to_vec(),
        "gaze_line" => br#"{"t": 1.5, "x": 0.5, "y": 0.25, "confidence": 0.9}"#.to_vec(),
        "pupil_message" => file("tests/pupil/surfaces_wall.msgpack"),
        "pupil_frames" => b"\x01\x02ab\x02\x00\x00\x00\x00\x00\x00\x00\x03abc".to_vec(),
        "page_message" => br#"{"kind":"press","number":1,"button":"cut","at":12.5}"#.to_vec(),
        "button_box" => "take rice\r\n12\ncutting_board\n".into(),
        "terminal" => "a\x1b[A\x1b[<35;12;3M\x1b[200~please call\x1b[201~\x1b[97:65;2:1u\x1b]11;?\x1b\\ß ".into(),
        other => panic!("no input for the reader {other}"),
    };
    bytes.truncate(LONGEST);
    bytes
}

/// One to eight random changes: a byte set, a range removed, a range repeated, the end cut off, or a special piece put in.
pub fn mutate(bytes: &mut Vec<u8>, random: &mut Stream) {
    for _ in 0..random.random_range(1..=8) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..64)).min(bytes.len());
        match random.random_range(0..5) {
            0 if at < bytes.len() => bytes[at] = random.random(),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let range = bytes[at..end].to_vec();
                bytes.splice(at..at, range);
            }
            3 if random.random_bool(0.2) => bytes.truncate(at),
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
    for (number, (name, read)) in read::READERS.into_iter().enumerate() {
        let input = input(name);
        for case in 0..CASES {
            let mut bytes = input.clone();
            mutate(&mut bytes, &mut stream(SEED + number as u64, "mutations", case));
            let outcome = std::panic::catch_unwind(|| read(&bytes));
            assert!(outcome.is_ok(), "the reader \"{name}\", case {case} of seed {SEED}");
        }
    }
}
