//! Everything that reads text which people or other programs wrote: session, layout, recipe, key and parameter files,
//! questionnaires, logs; and everything that eye trackers send. Whatever it is, the answer is a value or an error that can be shown; never a panic, a hang or
//! memory without bound.

use std::path::{Path, PathBuf};

use tomcom::edge::file_error::FileResult;
use tomcom::edge::files::compile_kitchen;
use tomcom::edge::gaze_json;
use tomcom::edge::key_file::key_map;
use tomcom::edge::log::LogReader;
use tomcom::edge::parse::parse;
use tomcom::edge::pupil::message;
use tomcom::edge::pupil::zmtp::FrameAssembler;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::mind::model::HumanModel;
use tomcom::session::SessionSpec;
use tomcom::session::apply::apply;
use tomcom::session::header::FileText;
use tomcom::session::plan::{Questionnaire, Study};

const LAYOUT: &str = include_str!("../../../../layouts/sushi.toml");
const RECIPES: &str = include_str!("../../../../recipes/sushi.toml");
const RECORDING: &str = include_str!("../../../golden/format-1-hand.jsonl");

/// Reads data as what its first byte says.
pub fn read(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    let text = || String::from_utf8_lossy(rest).into_owned();
    match kind % 12 {
        0 => shown(compile_kitchen((Path::new("layout"), text()), (Path::new("recipes"), RECIPES.to_string())).map(
            |files| {
                // A kitchen that is accepted can be worked in.
                CostToGo::new(files.kitchen.into());
            },
        )),
        1 => {
            shown(compile_kitchen((Path::new("layout"), LAYOUT.to_string()), (Path::new("recipes"), text())).map(drop))
        }
        2 => shown(parse::<SessionSpec>(Path::new("session"), &text()).map(|spec| {
            // A plan that is accepted has a series for its participants.
            let study = spec.check().ok().and_then(|()| Study::new(&spec, Vec::new()));
            study.is_none_or(|study| !study.slots(0).is_empty())
        })),
        3 => replay(rest),
        4 => shown(parse::<Questionnaire>(Path::new("questionnaire"), &text()).map(|asked| asked.check().is_ok())),
        5 => shown(parse::<HumanModel>(Path::new("parameters"), &text()).map(|model| model.fault().is_none())),
        6 => shown(key_map(Some(&FileText { path: "keys".to_string(), text: text() })).map(drop)),
        8 => {
            let told = message::read(b"surfaces.wall", rest, "wall");
            assert!(told.gaze.len() + told.fixations.len() <= 2 * rest.len());
            assert!(told.gaze.iter().all(|gaze| gaze.norm_pos.iter().all(|value| value.is_finite())));
        }
        9 => drop((message::read(b"fixations", rest, "wall"), message::read(b"blinks", rest, "wall"))),
        10 => frames(rest),
        11 => drop(gaze_json::parse(rest)),
        // Broken events after a header that is right.
        _ => {
            let header = RECORDING.split_inclusive('\n').next().unwrap_or_default();
            replay(&[header.as_bytes(), rest].concat());
        }
    }
}

/// What a sender of frames may send, in pieces.
fn frames(bytes: &[u8]) {
    let mut inbox = FrameAssembler::default();
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

/// Errors are told, with their place in the text.
fn shown<T>(result: FileResult<T>) {
    if let Err(error) = result {
        let _ = format!("{:?}", miette::Report::new(error));
    }
}

/// Reads a log, which has to be a file, and applies its events.
fn replay(log: &[u8]) {
    let path = path();
    std::fs::write(&path, log).expect("the temporary folder can be written");
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

/// A file of this process.
fn path() -> PathBuf {
    std::env::temp_dir().join(format!("tomcom-fuzz-{}.jsonl", std::process::id()))
}
