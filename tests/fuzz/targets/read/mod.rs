//! Everything that reads what people or other programs wrote: session, layout, recipe, key, language and parameter files,
//! questionnaires, logs and the files beside them; and everything that eye trackers, the participant's page and the terminal send.
//! Whatever it is, the answer is a value or an error that can be shown; never a panic, a hang or memory without bound.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tomcom::console::ConsoleMessage;
use tomcom::run::key_file::key_map;
use tomcom::run::terminal_bytes::TerminalParser;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::raters::CodableErrors;
use tomcom_core::mind::model::HumanModel;
use tomcom_devices::button_box::{ButtonBoxMessage, PressLines};
use tomcom_devices::display::message as page_message;
use tomcom_devices::pupil::message as pupil_message;
use tomcom_devices::pupil::zmtp::ZmtpFrameAssembler;
use tomcom_devices::{gaze_file, gaze_line, stream_head};
use tomcom_session::SessionSpec;
use tomcom_session::apply::apply;
use tomcom_session::files::LanguageFile;
use tomcom_session::files::compile_kitchen;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::files::parse::parse;
use tomcom_session::header::RecordedFile;
use tomcom_session::log::{EXCLUSION_NAME, LogReader, consensus_file, rater_codes, ruling, video_file};
use tomcom_session::plan::{Questionnaire, Study};
use tomcom_session::tracker::TrackerSpec;
use tomcom_study::analysis::annotations::codes as annotations;
use tomcom_study::files::{export, training};

const LAYOUT: &str = include_str!("../../../../layouts/sushi.toml");
const RECIPES: &str = include_str!("../../../../recipes/sushi.toml");
const RECORDING: &str = include_str!("../../../golden/format-3-hand.jsonl");

/// What reads bytes.
pub type Reader = fn(&[u8]);

/// The readers with the names that `tests/fuzz/run` takes.
pub const READERS: [(&str, Reader); 26] = [
    ("layout", layout),
    ("recipes", recipes),
    ("session", session),
    ("questionnaire", questionnaire),
    ("parameters", parameters),
    ("keys", keys),
    ("language", language),
    ("log", log),
    ("events", events),
    ("exclusion", exclusion),
    ("rater_codes", codes),
    ("consensus", consensus),
    ("video", video),
    ("pupil_timestamps", pupil_timestamps),
    ("elan", elan),
    ("boris", boris),
    ("training", trained),
    ("table", table),
    ("gaze_export", gaze_export),
    ("rerun_head", rerun_head),
    ("gaze_line", gaze_line),
    ("pupil_message", pupil),
    ("pupil_frames", frames),
    ("page_message", page),
    ("terminal", terminal),
    ("button_box", button_box),
];

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn layout(bytes: &[u8]) {
    let kitchen = compile_kitchen((Path::new("layout"), text(bytes)), (Path::new("recipes"), RECIPES.to_string()));
    shown(kitchen.map(|files| {
        // A kitchen that is accepted can be worked in.
        CostToGo::new(files.kitchen.into());
    }));
}

fn recipes(bytes: &[u8]) {
    let kitchen = compile_kitchen((Path::new("layout"), LAYOUT.to_string()), (Path::new("recipes"), text(bytes)));
    shown(kitchen.map(drop));
}

fn session(bytes: &[u8]) {
    shown(parse::<SessionSpec>(Path::new("session"), &text(bytes)).map(|spec| {
        // A plan that is accepted has a series for its participants.
        let study = spec.check().ok().and_then(|()| Study::new(&spec, Vec::new(), None, ["", ""]));
        study.is_none_or(|study| !study.slots(0).is_empty())
    }));
}

fn questionnaire(bytes: &[u8]) {
    shown(parse::<Questionnaire>(Path::new("questionnaire"), &text(bytes)).map(|asked| asked.check().is_ok()));
}

fn parameters(bytes: &[u8]) {
    shown(parse::<HumanModel>(Path::new("parameters"), &text(bytes)).map(|model| model.fault().is_none()));
}

fn keys(bytes: &[u8]) {
    shown(key_map(Some(&RecordedFile { path: "keys".to_string(), text: text(bytes) })).map(drop));
}

fn language(bytes: &[u8]) {
    shown(parse::<LanguageFile>(Path::new("language"), &text(bytes)).map(drop));
}

/// Reads a log, which has to be a file, and applies its events.
fn log(bytes: &[u8]) {
    let path = file("events.jsonl", bytes);
    shown(LogReader::open(&path).and_then(|mut log| {
        let mut session = log.session();
        while let Some(line) = log.next_line()? {
            if apply(&mut session, &line.stamped).is_err() {
                break;
            }
        }
        Ok(())
    }));
}

/// Broken events after a header that is right.
fn events(bytes: &[u8]) {
    let header = RECORDING.split_inclusive('\n').next().unwrap_or_default();
    log(&[header.as_bytes(), bytes].concat());
}

fn exclusion(bytes: &[u8]) {
    file(EXCLUSION_NAME, bytes);
    shown(ruling(&folder()).map(drop));
}

/// Codes of one rater beside a log, and of several in an export.
fn codes(bytes: &[u8]) {
    let path = file("codes-R1.csv", bytes);
    shown(rater_codes::read_all(&folder(), &codable()).map(drop));
    shown(rater_codes::read_export(&path).map(drop));
}

/// The films of a recording, beside its log.
fn video(bytes: &[u8]) {
    file(video_file::VIDEO_NAME, bytes);
    shown(video_file::read(&folder()).map(|films| films.films.len()));
}

/// The times of the pictures of a film of Pupil Capture.
fn pupil_timestamps(bytes: &[u8]) {
    let _ = tomcom_study::files::pupil_timestamps::parse(bytes);
}

fn elan(bytes: &[u8]) {
    shown(annotations::from_elan(Path::new("codes.eaf"), &text(bytes)).map(|codes| codes.len()));
}

fn boris(bytes: &[u8]) {
    shown(annotations::from_boris(Path::new("codes.boris"), &text(bytes)).map(|codes| codes.len()));
}

/// What two raters settled, beside a log.
fn consensus(bytes: &[u8]) {
    file(consensus_file::CONSENSUS_NAME, bytes);
    shown(consensus_file::read(&folder(), &codable()).map(drop));
}

fn codable() -> CodableErrors {
    CodableErrors { errors: (1..20).collect(), places: vec!["cooking_pot".to_string(), "plate".to_string()] }
}

fn trained(bytes: &[u8]) {
    file("W1-1.json", bytes);
    shown(training::read(&folder(), "W1").map(drop));
}

fn table(bytes: &[u8]) {
    // An error of reading is shown by whoever asked for the table.
    let _ = export::records(&file("trials.csv", bytes));
}

fn gaze_export(bytes: &[u8]) {
    let map =
        SurfaceHomography::new([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).expect("the corners of a square");
    shown(gaze_file::read(&file("gaze.csv", bytes), &map, &TrackerSpec::default()).map(drop));
}

fn rerun_head(bytes: &[u8]) {
    let identity = stream_head::identity(&file("recording.rrd", bytes));
    assert!(identity.expect("a file that can be read").is_none_or(|identity| identity.len() <= bytes.len()));
}

fn gaze_line(bytes: &[u8]) {
    drop(gaze_line::parse(bytes, Instant::now()));
    drop(gaze_line::code_in(bytes));
}

fn pupil(bytes: &[u8]) {
    let told = pupil_message::read(b"surfaces.wall", bytes, "wall");
    assert!(told.gaze.len() + told.fixations.len() <= 2 * bytes.len());
    assert!(told.gaze.iter().all(|gaze| gaze.norm_pos.iter().all(|value| value.is_finite())));
    drop((pupil_message::read(b"fixations", bytes, "wall"), pupil_message::read(b"blinks", bytes, "wall")));
}

/// What a sender of frames may send, in pieces.
fn frames(bytes: &[u8]) {
    let mut inbox = ZmtpFrameAssembler::default();
    for piece in bytes.chunks(7) {
        inbox.push(piece);
        loop {
            match inbox.next_message() {
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => return,
            }
        }
    }
}

fn page(bytes: &[u8]) {
    drop(page_message::read(&text(bytes)));
}

/// What a terminal may send, in pieces, with silence between some of them. After a second of silence a space is the space bar.
fn terminal(bytes: &[u8]) {
    let (mut parser, mut now) = (TerminalParser::default(), Instant::now());
    let second = Duration::from_secs(1);
    for piece in bytes.chunks(5) {
        now += if piece[0] % 3 == 0 { second / 20 } else { Duration::ZERO };
        drop((parser.expire(now), parser.read(piece, now)));
    }
    parser.expire(now + second);
    let read = parser.read(b" ", now + second);
    assert!(matches!(&read[..], [ConsoleMessage::Key(_)]) && parser.deadline().is_none(), "{read:?}");
}

/// What a button box may send, in pieces, at once: no more presses than hands make.
fn button_box(bytes: &[u8]) {
    let kitchen =
        compile_kitchen((Path::new("layout"), LAYOUT.to_string()), (Path::new("recipes"), RECIPES.to_string()));
    let (mut lines, now) = (PressLines::new(&kitchen.expect("a kitchen of the project").kitchen), Instant::now());
    let told: Vec<ButtonBoxMessage> = bytes.chunks(5).flat_map(|piece| lines.take(piece, now)).collect();
    assert!(told.iter().filter(|message| matches!(message, ButtonBoxMessage::Press(..))).count() <= 20, "{told:?}");
}

/// Errors are told, with their place in the text.
fn shown<T>(result: FileResult<T>) {
    if let Err(error) = result {
        let _ = format!("{:?}", miette::Report::new(error));
    }
}

/// A file with this content, in the folder of this thread.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = folder();
    let path = folder.join(name);
    // Some file systems wait for the disk where a file is overwritten.
    let _ = fs::remove_file(&path);
    fs::create_dir_all(&folder).and_then(|()| fs::write(&path, bytes)).expect("the folder can be written to");
    path
}

/// The folder of this thread, below what is built.
fn folder() -> PathBuf {
    let below = option_env!("CARGO_TARGET_TMPDIR").unwrap_or("target/fuzz");
    let thread = format!("{}-{:?}", std::process::id(), std::thread::current().id());
    Path::new(below).join("read").join(thread)
}
