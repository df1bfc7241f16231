//! Headers of recordings with wrong numbers, and numbers that no log can hold.

use std::fs;
use std::path::{Path, PathBuf};

use tomcom_core::base::time::SessionTime;
use tomcom_core::mind::choice::ChoiceModel;
use tomcom_core::mind::choice::ChoiceParameters;
use tomcom_core::robot::ArmSample;
use tomcom_session::log::{LOG_NAME, LogReader, SimulatedLogState};
use tomcom_session::{Event, TimestampedEvent};

use super::folder;

/// A log with another text in its header.
fn with_header(folder: &Path, wanted: &str, text: &str) -> PathBuf {
    let log = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden log");
    assert!(log.contains(wanted), "the header has {wanted}");
    let path = folder.join(LOG_NAME);
    fs::write(&path, log.replacen(wanted, text, 1)).expect("a file can be written");
    path
}

#[test]
fn a_header_has_the_numbers_that_files_may_have() {
    let folder = folder("headers");
    let read = |wanted: &str, text: &str| LogReader::open(&with_header(&folder, wanted, text));
    read("\"seconds\":", "\"seconds\":").expect("as it was");
    for (wanted, text, found) in [
        ("\"cost_of_communication\":1.5", "\"cost_of_communication\":1e308", "cost_of_communication = "),
        ("\"tau\":4.0", "\"tau\":0.00001", "tau = 0.00001"),
        ("\"tau\":4.0", "\"tau\":0.0", "tau = 0"),
        ("\"beliefs\":16", "\"beliefs\":0", "beliefs = 0"),
        ("\"shown_s\":4.0", "\"shown_s\":5000.0", "shown_s = 5000"),
        ("\"shown_s\":4.0", "\"shown_s\":-4.0", "shown_s = -4"),
        ("served_shown_s = 2.0", "served_shown_s = 9e9", "served_shown_s = 9000000000"),
        ("\"cost_of_communication\":1.5", "\"cost_of_communication\":1e999", "number out of range"),
        ("x = 0.26,", "x = inf,", "inf"),
    ] {
        let error = format!("{:?}", read(wanted, text).expect_err(text));
        assert!(error.contains(found), "{text}: {error}");
    }
    fs::remove_dir_all(folder).expect("the folder can be removed");
}

/// A caller of the library may have a tau that no file may have: what the planner tabulates is bounded all the same.
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
    let header = LogReader::open(Path::new("tests/golden/format-3-hand.jsonl")).expect("a golden log").header;
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
