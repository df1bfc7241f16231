//! Headers of old recordings, and numbers that no log can hold.

use std::fs;
use std::path::{Path, PathBuf};

use tomcom::base::time::SessionTime;
use tomcom::edge::log::{LOG_NAME, LogReader, SimulatedLogState};
use tomcom::mind::choice::ChoiceModel;
use tomcom::mind::choice_parameters::ChoiceParameters;
use tomcom::robot::moment::ArmSample;
use tomcom::session::{Event, TimestampedEvent};

use super::folder;

/// A log of an earlier version with another text in its header.
fn with_header(folder: &Path, wanted: &str, text: &str) -> PathBuf {
    let log = fs::read_to_string("tests/golden/format-1-hand.jsonl").expect("a golden log");
    assert!(log.contains(wanted), "the header has {wanted}");
    let path = folder.join(LOG_NAME);
    fs::write(&path, log.replacen(wanted, text, 1)).expect("a file can be written");
    path
}

/// The header says nothing of assistant and human model: they stand before the signals.
const BEFORE: &str = "\"signals\":{";

/// What the reader says of a header: warned of, or refused.
fn told(folder: &Path, wanted: &str, text: &str) -> Result<Option<String>, String> {
    let log = LogReader::open(&with_header(folder, wanted, text));
    log.map(|log| log.unusual().map(|unusual| unusual.found)).map_err(|error| format!("{error:?}"))
}

#[test]
fn of_old_headers_only_what_no_version_took_is_refused() {
    let folder = folder("headers");
    assert_eq!(told(&folder, "\"seconds\":", "\"seconds\":").expect("as it was"), None);
    // What earlier versions took is warned of: it replays as it was recorded.
    for (wanted, text, found) in [
        (BEFORE, "\"assistant\":{\"cost_of_communication\":1e308},\"signals\":{", "cost_of_communication = "),
        (BEFORE, "\"human\":{\"decision\":{\"tau\":0.00001}},\"signals\":{", "tau = 0.00001"),
        ("\"shown_s\":4.0", "\"shown_s\":5000.0", "shown_s = 5000"),
    ] {
        let unusual = told(&folder, wanted, text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(unusual.as_ref().is_some_and(|told| told.starts_with(found)), "{text}: {unusual:?}");
    }
    let unusual = told(&folder, "served_shown_s = 2.0", "served_shown_s = 9e9").expect("a layout of an old recording");
    assert_eq!(unusual.as_deref(), Some("served_shown_s = 9000000000"));
    for (wanted, text) in [
        ("\"shown_s\":4.0", "\"shown_s\":-4.0"),
        (BEFORE, "\"human\":{\"decision\":{\"tau\":0.0}},\"signals\":{"),
        (BEFORE, "\"human\":{\"inference\":{\"beliefs\":0}},\"signals\":{"),
        (BEFORE, "\"human\":{\"inference\":{\"states\":9007199254740993}},\"signals\":{"),
        (BEFORE, "\"assistant\":{\"cost_of_communication\":1e999},\"signals\":{"),
        ("served_shown_s = 2.0", "served_shown_s = -2.0"),
        ("x = 0.", "x = inf #"),
    ] {
        assert!(told(&folder, wanted, text).is_err(), "{text} was taken");
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

/// A recording may have a tau that no file may have: what the planner tabulates is bounded all the same.
#[test]
fn the_weights_of_a_tau_near_0_take_no_more_memory_than_those_of_others() {
    let kitchen = super::kitchen();
    for tau in [1e-5, f64::MIN_POSITIVE] {
        let model = ChoiceModel::up_to_draws(&kitchen, &ChoiceParameters { tau, ..ChoiceParameters::default() }, 32);
        assert!(model.tabulated() <= 33 * 33 * 256, "{tau}: {} weights", model.tabulated());
    }
}

#[test]
fn a_number_that_is_not_finite_comes_into_no_log() {
    let folder = folder("finite");
    let header = LogReader::open(Path::new("tests/golden/format-1-hand.jsonl")).expect("a golden log").header;
    let recording = folder.join("recording");
    let begun = SimulatedLogState::open(&recording, &header).expect("a recording can be begun");
    let SimulatedLogState::Begun { mut log, .. } = begun else { panic!("there is no recording yet") };
    let stamped = |seq, event| TimestampedEvent { seq, time: SessionTime::ZERO, event };
    for force_n in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let moment = ArmSample { force_n, ..ArmSample::default() };
        let refused = log.append(&stamped(0, Event::RobotMoves(moment))).expect_err("no log can hold it");
        assert!(refused.to_string().contains("not finite"), "{refused}");
    }
    log.append(&stamped(0, Event::SessionEnded)).expect("the log goes on");
    log.flush().expect("the log can be written");
    let mut read = LogReader::open(&recording).expect("the log can be read");
    assert_eq!(read.next_line().expect("a line").expect("an event").stamped, stamped(0, Event::SessionEnded));
    assert!(read.next_line().expect("no more").is_none());
    fs::remove_dir_all(folder).expect("the folder can be removed");
}
