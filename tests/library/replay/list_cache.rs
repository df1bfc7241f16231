//! Figures of closed recordings that are kept from one list to the next.

use std::fs;

use tomcom::edge::list_cache::{CachedRecordingNumbers, ClosedLogHeader, ListCache};
use tomcom_session::log::LogReader;
use tomcom_session::settings::ArmKind;
use tomcom_session::study_arm::StudyArm;

use super::simulated;

#[test]
fn figures_are_found_again_by_the_log_and_not_after_it_was_changed() {
    let out = simulated("default.toml", ArmKind::Timed, "list-cache", 1, 9817);
    let recording = fs::read_dir(&out).expect("a folder").next().expect("a recording").expect("an entry").path();
    let glance = ClosedLogHeader::read(&recording).expect("a closed log");
    let header = LogReader::open(&recording).expect("a log").header;
    assert_eq!((&glance.code, glance.condition), (&header.session.participant.code, header.session.trial.condition));
    assert_eq!(glance.date, header.started);
    let caches = out.join("caches");
    let figures = CachedRecordingNumbers { arm: StudyArm::None, trial_s: 0.1 + 0.2, errors: 7 };
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), None);
    ListCache::in_folder(&caches).keep([(glance.digest.clone(), figures)]);
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), Some(figures));
    let file = caches.join("lists.jsonl");
    let kept = fs::read_to_string(&file).expect("a file");
    assert!(!kept.contains(&glance.code) && !kept.contains("seed"), "{kept}");
    // Lines of others, or half a line, are passed over; without the file nothing is known.
    fs::write(&file, format!("{{}}\nwhat\n{kept}{}", &kept[..20])).expect("written");
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), Some(figures));
    fs::remove_file(&file).expect("removed");
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), None);
    // Another byte at the end, and a log that is not closed.
    let log = recording.join("events.jsonl");
    let text = fs::read_to_string(&log).expect("a log");
    let end = text.trim_end().rfind("\"t_ns\":").expect("a time") + 7;
    fs::write(&log, format!("{}1{}", &text[..end], &text[end..])).expect("written");
    assert_ne!(ClosedLogHeader::read(&recording).expect("still closed").digest, glance.digest);
    fs::write(&log, &text[..text.len() - 1]).expect("written");
    assert_eq!(ClosedLogHeader::read(&recording), None, "the last line has no end");
}
