//! Recordings that are cut, still written, or broken.

use super::{by_hand, folder, session};
use crate::support::*;

/// The recording's text, changed, is refused with a message that names `line` and says all of `says`.
fn refused(log: &Path, line: usize, says: &[&str], change: impl Fn(&str) -> String) {
    let broken = log.with_file_name("broken.jsonl");
    fs::write(&broken, change(&fs::read_to_string(log).expect("a recording"))).expect("the folder can be written");
    let error = RecordingReplay::open(&broken).and_then(|mut replay| replay.run()).expect_err("a broken recording");
    // Where lines are wrapped depends on the length of the path.
    let told = format!("{:?}", miette::Report::new(error)).split_whitespace().collect::<Vec<_>>().join(" ");
    let place = format!("broken.jsonl:{line}:");
    for text in std::iter::once(place.as_str()).chain(says.iter().copied()) {
        assert!(told.contains(text), "{text:?} is not in\n{told}");
    }
}

#[test]
fn empty_lines_at_the_end_of_a_recording_are_no_damage() {
    let (log, _) = by_hand("default.toml", ArmKind::Timed, "blank", 5);
    let text = fs::read_to_string(&log).expect("a recording");
    let path = log.with_file_name("blank.jsonl");
    for end in ["\n", "\n\n\n", "\r\n", " \t\n", "  "] {
        fs::write(&path, format!("{text}{end}")).expect("the folder can be written");
        let mut log = LogReader::open(&path).expect("a recording");
        let last = log.last_event().expect("it can be read");
        assert_eq!(last.map(|last| last.event), Some(Event::SessionEnded), "{end:?}");
        while log.next_line().unwrap_or_else(|error| panic!("{end:?}: {error}")).is_some() {}
        assert!(!log.is_cut() && log.events() == text.lines().count() as u64 - 1, "{end:?}");
    }
    for empty in ["\n\n", "\n \n\n"] {
        refused(&path, 3, &["an empty line before another event"], |_| {
            text.replacen("\n{\"seq\":1,", &format!("{empty}{{\"seq\":1,"), 1)
        });
    }
}

#[test]
fn what_is_appended_to_a_live_recording_is_there_at_once_and_nothing_is_lost_silently() {
    let files = session("default.toml");
    let kitchen = Arc::new(files.kitchen.kitchen);
    let header = LogHeader::new(files.spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
    let root = folder("prompt");
    let [mut log, second] =
        [1, 2].map(|_| LogWriter::create_live(&root, "2026-03-14", &header).expect("the folder can be written"));
    let names = [&log, &second].map(|log| log.folder().file_name().map(|name| name.to_string_lossy().into_owned()));
    assert_eq!(names, [1, 2].map(|n| Some(format!("2026-03-14-P01-{n}"))));
    let mut engine = SessionEngine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen));
    let events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    let written = fs::read_to_string(log.folder().join(LOG_NAME)).expect("a recording");
    assert_eq!(written.lines().count(), events.len() + 1);
    let no_folder = LogWriter::create_live(&log.folder().join(LOG_NAME), "2026-03-14", &header);
    assert!(no_folder.expect_err("a file is no folder").to_string().contains("cannot be written"));
}

#[test]
fn no_broken_byte_makes_the_reader_panic() {
    let (log, _) = by_hand("burger.toml", ArmKind::Timed, "bytes", 11);
    let text = fs::read(&log).expect("a recording");
    let path = log.with_file_name("bytes.jsonl");
    let mut random = stream(11, "bytes", 0);
    for _ in 0..150 {
        let mut broken = text.clone();
        for _ in 0..random.random_range(1..4) {
            // Half of the changes are in the header and the first events, where more depends on them.
            let within = if random.random() { broken.len() } else { 12_000 };
            broken[random.random_range(0..within)] = random.random_range(9..128);
        }
        fs::write(&path, &broken).expect("the folder can be written");
        let _ = verify(&path).map_err(|error| format!("{:?}", miette::Report::new(error)));
    }
}
