//! Recordings as a BIDS data set: every event has a row, durations are those of the log, and no two codes become one label.

use strum::VariantNames;
use tomcom_session::event::MEANINGS;
use tomcom_study::analysis::bids::dataset::{BidsLabelMap, session_label};
use tomcom_study::bids_export::{BidsSummary, describe, export};
use tomcom_study::pass::reading::AnalysisScope;
use tomcom_study::pass::{self, AnalysisRequest, NamedRecordings};

use crate::support::*;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bids").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.parent().expect("a folder")).expect("the folder of tests");
    folder
}

fn golden(names: &[&str], out: &Path, with_words: bool) -> BidsSummary {
    let logs: Vec<PathBuf> = names.iter().map(|name| Path::new("tests/golden").join(format!("{name}.jsonl"))).collect();
    export(&logs, out, with_words, || ()).expect("golden recordings are exported")
}

/// The rows of a table by their column.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().map(|line| line.split('\t').map(str::to_string).collect::<Vec<String>>());
    let names = lines.next().expect("names of columns");
    let row = |cells: Vec<String>| {
        assert_eq!(cells.len(), names.len(), "{}: {cells:?}", path.display());
        names.iter().cloned().zip(cells).collect()
    };
    lines.map(row).collect()
}

fn log(name: &str) -> Vec<Value> {
    let text = fs::read_to_string(format!("tests/golden/{name}.jsonl")).expect("a golden recording");
    text.lines().skip(1).map(|line| serde_json::from_str(line).expect("an event")).collect()
}

#[test]
fn every_event_of_the_golden_recordings_has_its_row() {
    let known: BTreeSet<&str> = MEANINGS.iter().map(|(kind, _)| *kind).collect();
    // A person and simulated participants are not in one data set.
    for names in [&["format-3-hand"][..], &["format-3-simulated", "format-3-offers"]] {
        let out = folder("rows");
        let summary = golden(names, &out, false);
        assert_eq!(summary.recordings.len(), names.len());
        for one in &summary.recordings {
            let name = one.recording.file_stem().expect("a name").to_string_lossy().into_owned();
            let (events, counts) = (log(&name), one.rows);
            let all = counts.events + counts.gaze + counts.eye_events + counts.arm;
            assert_eq!(all, events.len() as u64, "{name}: {counts:?}");
            for row in rows(&out.join(format!("{}_events.tsv", one.place))) {
                let seq: usize = row["seq"].parse().expect("a number");
                assert_eq!(events[seq]["kind"], row["trial_type"].as_str());
                assert!(known.contains(row["trial_type"].as_str()), "{} has no meaning", row["trial_type"]);
                let time: u64 = row["onset"].replace('.', "").parse().expect("nanoseconds");
                assert_eq!(events[seq]["t_ns"], time);
            }
        }
        let notes = names.iter().flat_map(|name| log(name)).filter(|event| event["kind"] == "marker").count();
        let words = format!("left out: {notes} notes, reasons and answers");
        let told = describe(&summary);
        assert_eq!(told.contains(&words), notes > 0, "{told}");
    }
}

#[test]
fn every_kind_of_event_but_samples_has_a_meaning() {
    let names: BTreeSet<&str> = Event::VARIANTS.iter().copied().collect();
    let meant: BTreeSet<&str> = MEANINGS.iter().map(|(kind, _)| *kind).collect();
    let missing: Vec<&&str> = names.symmetric_difference(&meant).collect();
    assert_eq!(missing, [&"gaze", &"robot_moves"]);
}

#[test]
fn events_last_until_what_they_begin_is_over() {
    let (name, out) = ("format-3-hand", folder("durations"));
    let summary = golden(&[name], &out, false);
    let (events, rows) = (log(name), rows(&out.join(format!("{}_events.tsv", summary.recordings[0].place))));
    let time = |event: &Value| event["t_ns"].as_u64().expect("a time");
    for (begins, ends) in [
        ("trial_started", &["trial_ended"][..]),
        ("trial_paused", &["trial_resumed", "trial_ended"]),
        ("robot_stopped", &["robot_resumed", "trial_ended", "session_ended"]),
        ("signal_shown", &["signal_ended", "signal_shown", "trial_ended"]),
    ] {
        let begun: Vec<&BTreeMap<String, String>> = rows.iter().filter(|row| row["trial_type"] == begins).collect();
        assert!(!begun.is_empty(), "{begins}");
        for row in begun {
            let seq: usize = row["seq"].parse().expect("a number");
            let over =
                events[seq + 1..].iter().find(|event| ends.iter().any(|end| event["kind"] == *end)).expect("an end");
            let lasted = time(over) - time(&events[seq]);
            assert_eq!(row["duration"], format!("{}.{:09}", lasted / 1_000_000_000, lasted % 1_000_000_000), "{row:?}");
        }
    }
    assert!(rows.iter().filter(|row| row["trial_type"] == "press").all(|row| row["duration"] == "0"));
}

#[test]
fn what_was_typed_is_exported_only_if_it_is_asked_for() {
    let name = "format-3-hand";
    let note = log(name).iter().find(|event| event["kind"] == "marker").expect("a note")["note"].clone();
    let note = note.as_str().expect("words").split_whitespace().collect::<Vec<&str>>().join(" ");
    let of = |with_words: bool| {
        let out = folder(if with_words { "typed" } else { "not-typed" });
        let summary = golden(&[name], &out, with_words);
        rows(&out.join(format!("{}_events.tsv", summary.recordings[0].place)))
    };
    assert!(of(false).iter().all(|row| !row.contains_key("words")));
    assert!(of(true).iter().any(|row| row["words"].contains(&note)), "{note}");
    // So is the reason of an exclusion; that there is one is always told.
    let recording = folder("excluded-recording");
    fs::create_dir(&recording).expect("a folder");
    fs::copy("tests/golden/format-3-simulated.jsonl", recording.join(LOG_NAME)).expect("a log");
    tomcom_session::log::rule(&recording, true, "tracker slipped").expect("excluded");
    for (with_words, why) in [(false, "excluded"), (true, "excluded: tracker slipped")] {
        let out = folder("excluded");
        let summary = export(std::slice::from_ref(&recording), &out, with_words, || ()).expect("exported");
        let sub = summary.recordings[0].place.split('/').next().expect("a participant");
        let session = &rows(&out.join(sub).join(format!("{sub}_sessions.tsv")))[0];
        assert_eq!((session["excluded"].as_str(), session["left_out"].as_str()), ("1", why));
        assert_eq!(rows(&out.join("participants.tsv"))[0]["left_out"], "1");
    }
}

#[test]
fn a_folder_with_something_in_it_is_refused() {
    let out = folder("full");
    golden(&["format-3-simulated"], &out, false);
    let error =
        export(&[PathBuf::from("tests/golden/format-3-simulated.jsonl")], &out, false, || ()).expect_err("refused");
    assert!(error.to_string().contains("not empty"), "{error}");
    // What cannot be read leaves no folder behind.
    let damaged = folder("damaged");
    fs::create_dir(&damaged).expect("a folder");
    let log = fs::read_to_string("tests/golden/format-3-simulated.jsonl").expect("a log").replacen("\"seq\":9,", "", 1);
    fs::write(damaged.join(LOG_NAME), log).expect("a log");
    let request = AnalysisRequest {
        paths: vec![damaged.clone()],
        out: damaged.join("new/study"),
        scope: AnalysisScope { concepts: false, events: true, raters: None },
        frozen: None,
    };
    let found = NamedRecordings::find(&request.paths, &[]).expect("a recording");
    assert!(pass::study(&request, &found, || ()).is_err());
    assert!(export(&request.paths, &damaged.join("new/bids"), false, || ()).is_err());
    assert!(!damaged.join("new").exists());
}

#[test]
fn no_two_codes_have_one_label_and_a_changed_one_is_told() {
    let codes = ["P07", "p07", "P-07", "P_07", "A1", "-", "_", "P07x2"];
    let labels = BidsLabelMap::from_names(codes);
    let made: BTreeSet<String> =
        codes.iter().map(|code| labels.label(code).expect("a label").to_ascii_lowercase()).collect();
    assert_eq!(made.len(), codes.len(), "{labels:?}");
    assert!(made.iter().all(|label| label.chars().all(|c| c.is_ascii_alphanumeric())), "{labels:?}");
    assert_eq!(
        (labels.label("P07"), labels.label("A1"), labels.label("P07x2")),
        (Some("P07"), Some("A1"), Some("P07x2"))
    );
    let changed: Vec<String> = labels.changed().into_iter().map(|(code, _)| code).collect();
    assert_eq!(changed, ["-", "P-07", "P_07", "_", "p07"]);
}

#[test]
fn recordings_outside_of_a_plan_are_counted() {
    let mut taken = BTreeSet::new();
    let labels: Vec<String> = (0..3).map(|_| session_label(None, &mut taken)).collect();
    assert_eq!(labels, ["01", "02", "03"]);
}
