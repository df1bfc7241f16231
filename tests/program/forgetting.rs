//! `tomcom forget`: it asks first, forgets a person everywhere, and leaves alone what is of others.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tomcom::run::files::read_session;
use tomcom::run::simulate::{SimulationRequest, simulate};
use tomcom_session::LogHeader;
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::{LogWriter, RecordingLock};

use crate::program::{TOMCOM, files_below};

/// A folder with recordings, and the folder that the program takes for the system's one for temporary files.
pub struct RecordingsFolder {
    pub root: PathBuf,
    pub temporary: PathBuf,
}

impl RecordingsFolder {
    /// Folders without anything in them.
    pub fn empty(name: &str) -> RecordingsFolder {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("forgetting").join(name);
        let _ = fs::remove_dir_all(&folder);
        let made = RecordingsFolder { root: folder.join("recordings"), temporary: folder.join("temporary") };
        for one in [&made.root, &made.temporary] {
            fs::create_dir_all(one).expect("made");
        }
        made
    }

    /// Four short trials of the paper's plan: two of P01 and two of P02.
    pub fn of_two_people(name: &str) -> RecordingsFolder {
        let made = RecordingsFolder::empty(name);
        let mut files = read_session(Path::new("sessions/paper.toml")).expect("the paper's session");
        files.spec.trial.presses = 10;
        let simulation = SimulationRequest { files, trials: 4, shard: SimulationShard::WHOLE, out: made.root.clone() };
        simulate(&simulation, || ()).expect("the folder can be written");
        made
    }

    pub fn at(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }

    pub fn put(&self, path: &str, bytes: impl AsRef<[u8]>) {
        let path = self.at(path);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, bytes).expect("written");
    }

    pub fn text(&self, path: &str) -> String {
        fs::read_to_string(self.at(path)).expect(path)
    }

    /// Makes a recording one of somebody with another code.
    pub fn give(&self, recording: &str, code: &str) {
        let (log, settings) = (format!("{recording}/events.jsonl"), format!("{recording}/session.toml"));
        let old = if recording.contains("P01") { "P01" } else { "P02" };
        let (header, events) =
            self.text(&log).split_once('\n').map(|(a, b)| (a.to_string(), b.to_string())).expect("lines");
        let renamed = header.replace(&format!("\"code\":\"{old}\""), &format!("\"code\":\"{code}\""));
        assert_ne!(renamed, header);
        self.put(&log, format!("{renamed}\n{events}"));
        let renamed = self.text(&settings).replace(&format!("code = \"{old}\""), &format!("code = \"{code}\""));
        self.put(&settings, renamed);
    }

    /// Analyses the recordings into `study`.
    pub fn study(&self) {
        let root = self.root.to_str().expect("UTF-8");
        let (code, told) = self.run(&["study", root, "--skip", "concepts"]);
        assert_eq!(code, Some(0), "{told}");
    }

    /// Runs the program without a terminal; its exit code and all that it prints.
    pub fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::new(TOMCOM);
        let done = command.args(arguments).env("TMPDIR", &self.temporary).stdin(Stdio::null()).output();
        let done = done.expect("the program starts");
        (done.status.code(), String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned())
    }

    pub fn forget(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let root = self.root.to_str().expect("UTF-8");
        self.run(&[&["forget", "--in", root], arguments].concat())
    }

    /// A recording in a folder that is gone, and in whose place nothing can be saved; where it was saved.
    pub fn rescued(&self, root: &str) -> PathBuf {
        let mut log = LogWriter::create_live(&self.at(root), "2026-03-14", &header()).expect("a recording");
        fs::remove_dir_all(self.at(root)).expect("removed");
        self.put(root, "");
        let told = log.check(false).expect_err("it is gone").to_string();
        told.split_once("is in ").expect("where it was saved").1.into()
    }

    /// Every file, with what is in it, by its path.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let name = |path: &Path| path.strip_prefix(&self.root).expect("below it").display().to_string();
        files_below(&self.root).iter().map(|path| (name(path), fs::read(path).expect("a file"))).collect()
    }
}

/// The header of a trial of the default session.
pub fn header() -> LogHeader {
    let files = read_session(Path::new("sessions/default.toml")).expect("a session");
    LogHeader::new(files.spec, 0, files.kitchen.layout, files.kitchen.recipes)
}

/// Asserts that the program ended with this code and said all of this; what it said.
pub fn ended((code, told): (Option<i32>, String), expected: i32, says: &[&str]) -> String {
    assert_eq!(code, Some(expected), "{told}");
    says.iter().for_each(|words| assert!(told.contains(words), "{words:?} is not in\n{told}"));
    told
}

/// A record of training on these recordings.
fn record(wizard: &str, recordings: &[&str]) -> String {
    let judged = |name: &&str| {
        format!(
            "{{\"recording\":\"{name}\",\"complete\":true,\"presses\":1,\"signals\":[],\"beliefs\":[],\"measures\":{},\"kappa_with_oneself\":null}}",
            serde_json::to_string(&tomcom_core::measures::wizard_performance::WizardMeasures::from_signals(&[], None))
                .expect("JSON")
        )
    };
    let judged: Vec<String> = recordings.iter().map(judged).collect();
    format!(
        "{{\"wizard\":\"{wizard}\",\"at\":\"2026-03-14T10:00:00Z\",\"minutes\":1.0,\"speed\":1.0,\"criterion\":{{\"hits\":0.6,\"wrong\":0.4}},\"met\":true,\"recordings\":[{}]}}",
        judged.join(",")
    )
}

#[test]
fn forgetting_asks_first_and_a_wizards_code_is_that_of_the_training() {
    let lab = RecordingsFolder::of_two_people("asks");
    lab.put("training/W1-1.json", record("W1", &["seed1-P01-1", "seed9-S001"]));
    lab.put("training/W1-2.json", record("W1", &["seed1-P01-1"]));
    lab.put("training/W2-1.json", record("W2", &["seed9-S001"]));
    let is_there = |path: &str| lab.at(path).exists();
    let before = lab.files();
    let told = ended(lab.forget(&["P01"]), 2, &["seed1-P01-1 (recording)", "nothing was deleted", "--yes"]);
    assert!(told.contains("    events.jsonl, session.toml\n"), "every file is listed: {told}");
    assert_eq!(lab.files(), before);
    ended(lab.forget(&["P01", "--yes"]), 0, &["the plan paper still asks for P01: leave the code in the plan"]);
    assert!(!is_there("seed1-P01-1") && !is_there("seed1-P01-2") && !is_there("training/W1-2.json"));
    let left = lab.text("training/W1-1.json");
    assert!(left.contains("seed9-S001") && !left.contains("P01"), "what was trained on others stays: {left}");
    assert_eq!(lab.forget(&["P01", "--yes"]).0, Some(1), "there is nothing left");
    ended(lab.forget(&["W1", "--yes"]), 0, &[]);
    assert!(!is_there("training/W1-1.json") && is_there("training/W2-1.json"));
    ended(lab.forget(&["Jane Doe", "--yes"]), 2, &[]);
}

/// Tables that were made before the correction have the old code.
#[test]
fn rows_from_before_a_code_was_corrected_go_with_the_recording() {
    let lab = RecordingsFolder::of_two_people("corrected");
    lab.study();
    let recording = lab.at("seed1-P01-1").display().to_string();
    ended(lab.run(&["correct", &recording, "--code", "P88", "--reason", "typed wrong"]), 0, &[]);
    ended(lab.forget(&["P88", "--yes"]), 0, &[]);
    for table in ["actions", "trials"] {
        let left = lab.text(&format!("study/{table}.csv"));
        assert!(!left.contains("seed1-P01-1") && left.contains("seed1-P01-2"), "{table}: {left}");
    }
}

/// What names the code without being the participant's is no reason to fail.
#[test]
fn files_that_stay_and_name_the_code_are_told() {
    let lab = RecordingsFolder::of_two_people("named");
    let [recording, frozen, root] = ["seed1-P01-1", "paper.frozen", ""].map(|path| lab.at(path).display().to_string());
    ended(lab.run(&["correct", &recording, "--code", "P88", "--reason", "typed wrong"]), 0, &[]);
    ended(lab.run(&["plan", "sessions/paper.toml", "--out", &root, "--freeze", &frozen]), 0, &[]);
    lab.put("plan.toml", "[plan]\nparticipants = [\"P01\", \"P02\"]\n");
    let told = ended(lab.forget(&["P01", "--yes"]), 0, &["these stay, and name P01 ("]);
    let of_recording = ["correction.toml", "events.jsonl", "session.toml"].map(|name| format!("seed1-P01-1/{name}"));
    for path in ["paper.frozen", "plan.toml"].map(str::to_string).iter().chain(&of_recording) {
        assert!(told.contains(&format!("  {}\n", lab.at(path).display())), "{path}: {told}");
    }
    assert!(!lab.at("seed1-P01-2").exists(), "{told}");
    let above = lab.root.parent().and_then(Path::to_str).expect("UTF-8");
    ended(lab.run(&["forget", "p88", "--in", above]), 1, &["no files of participant p88 in ", "did you mean P88?"]);
}

#[test]
fn a_participant_is_forgotten_everywhere_and_nobody_else() {
    let lab = RecordingsFolder::of_two_people("everywhere");
    lab.study();
    let (_, told) = lab.run(&["review", lab.at("seed1-P01-1").to_str().expect("UTF-8"), "--save"]);
    assert!(told.contains("recording.rrd"), "{told}");
    // What a kill before the log leaves behind, of a later part.
    lab.put("seed1-P01-1-part2/session.toml", lab.text("seed1-P01-1/session.toml"));
    lab.put("seed1-P01-1/codes-R1.csv", "rater,press,cause,aspect\n");
    lab.put("seed1-P01-1/codes-R1 (1).csv", "rater,press,cause,aspect\n");
    lab.put("seed1-P01-1/correction.toml", "");
    // What a kill while codes or tables were written leaves behind.
    lab.put("seed1-P01-1/codes-R1.csv.tomcom-a1B2c3.new", "press,cause,aspect\n");
    lab.put("study/trials.csv.tomcom-a1B2c3.new", lab.text("study/trials.csv"));
    lab.put("codes.csv", "recording,rater,press,cause,aspect\nseed1-P01-1,R1,4,slip,\nseed1-P02-1,P01,4,slip,\n");
    // A session file of somebody is no recording, whoever it is for.
    lab.put("pilot/session.toml", "layout = \"x\"\n[participant]\ncode = \"P01\"\n");
    let (before, study) = (lab.files(), lab.text("study/trials.csv"));
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    let after = lab.files();
    for (path, bytes) in &before {
        let is_gone = path.starts_with("seed1-P01") || path == "study/report.html";
        let is_table = path.starts_with("study/") || path == "codes.csv";
        assert_eq!(after.contains_key(path), !is_gone, "{path}");
        if is_table && !is_gone {
            // All lines but those of P01 are as they were.
            let kept = |line: &&[u8]| !line.starts_with(b"P01,") && !line.starts_with(b"seed1-P01");
            let kept: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').filter(kept).collect();
            assert_eq!(String::from_utf8_lossy(&after[path]), String::from_utf8_lossy(&kept.concat()), "{path}");
        } else if !is_gone {
            assert_eq!(&after[path], bytes, "{path}");
        }
    }
    assert_eq!(
        after.len() + before.keys().filter(|path| !after.contains_key(*path)).count(),
        before.len(),
        "nothing is new"
    );
    assert!(!lab.at("seed1-P01-1").exists() && !lab.at("seed1-P01-1-part2").exists(), "nor are empty folders left");
    assert!(study.contains("seed1-P01-2,P01,") && !lab.text("study/trials.csv").contains("P01"));
    assert!(lab.text("codes.csv").contains("seed1-P02-1,P01,"), "a rater of that code is another person");
}

#[test]
fn nothing_goes_while_a_recording_is_being_written() {
    let lab = RecordingsFolder::of_two_people("locked");
    lab.study();
    let lock = RecordingLock::take(&lab.at("seed1-P01-2")).expect("a lock");
    let before = lab.files();
    ended(lab.forget(&["P01", "--yes"]), 1, &["nothing was deleted", "writes this recording"]);
    assert_eq!(lab.files(), before);
    assert_eq!(lab.forget(&["P02", "--yes"]).0, Some(0), "that of somebody else is no matter");
    drop(lock);
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(lab.files().keys().all(|path| path.starts_with("study/")), "{:?}", lab.files().keys());
    // Where no lock can be taken, as in a folder that cannot be written to, it is the same.
    let lab = RecordingsFolder::of_two_people("unlockable");
    fs::create_dir(lab.at("seed1-P01-2/lock")).expect("made");
    let before = lab.files();
    ended(lab.forget(&["P01", "--yes"]), 1, &["nothing was deleted", "seed1-P01-2"]);
    assert_eq!(lab.files(), before);
}

#[test]
fn json_lists_what_is_to_be_deleted_what_was_and_what_is_left() {
    let lab = RecordingsFolder::of_two_people("json");
    lab.study();
    lab.put("seed1-P01-1/notes.txt", "of another program");
    let listed = |arguments: &[&str]| {
        let root = lab.root.to_str().expect("UTF-8");
        let mut command = Command::new(TOMCOM);
        let command = command.args(["forget", "P01", "--in", root, "--format", "json"]).args(arguments);
        let done = command.env("TMPDIR", &lab.temporary).stdin(Stdio::null()).output().expect("the program starts");
        let json: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
        (done.status.code(), json)
    };
    let (code, asked) = listed(&[]);
    let (after, deleted) = listed(&["--yes"]);
    assert_eq!((code, after), (Some(2), Some(1)), "nobody to ask; something is left");
    assert_eq!((&asked["deleted"], &deleted["deleted"]), (&false.into(), &true.into()));
    for field in ["code", "recordings", "recording_files", "files", "tables", "trainings", "left"] {
        assert_eq!(asked[field], deleted[field], "what was listed was done: {field}");
    }
    let path = |path: &str| serde_json::Value::from(lab.at(path).display().to_string());
    assert_eq!(deleted["recordings"], serde_json::json!([path("seed1-P01-1"), path("seed1-P01-2")]));
    assert_eq!(deleted["recording_files"].as_array().map(Vec::len), Some(4));
    assert_eq!(deleted["files"][0], path("study/report.html"));
    let tables = deleted["tables"].as_array().expect("a list");
    assert_eq!(tables.last(), Some(&serde_json::json!([path("study/trials.csv"), 2])));
    assert_eq!(deleted["left"][0]["path"], path("seed1-P01-1/notes.txt"));
    assert!(
        deleted["left"][0]["reason"].as_str().is_some_and(|reason| reason.contains("tomcom did not write it")),
        "{deleted}"
    );
}

#[test]
fn files_of_other_programs_stay_as_they_are_whatever_stands_in_them() {
    let lab = RecordingsFolder::of_two_people("foreign");
    lab.put("ages/participants.csv", "participant,age\nP01,31\nP02,32\n");
    lab.put("old/trials.csv", "1,2,3\n4,5,1\n");
    lab.put("report.html", "<td>P01</td>");
    lab.put("figures.json", "{\"P01\": 1}");
    lab.put("text.txt", "P01 seed1-P01-1");
    lab.put("seed1-P01-1.mp4", "a video");
    let before = lab.files();
    let told = ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(told.contains("not looked for: copies, tables and exports in other folders, files of other"), "{told}");
    let after = lab.files();
    for (path, bytes) in &before {
        let is_gone = path.starts_with("seed1-P01-1/") || path.starts_with("seed1-P01-2/");
        assert_eq!(after.get(path), Some(bytes).filter(|_| !is_gone), "{path}");
    }
}

#[test]
fn a_code_that_looks_like_one_with_a_seed_is_another_person() {
    let lab = RecordingsFolder::of_two_people("seeds");
    lab.give("seed1-P02-1", "seed1-P01");
    lab.give("seed1-P02-2", "seed1-P01");
    lab.study();
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(lab.at("seed1-P02-1").exists() && !lab.at("seed1-P01-1").exists());
    let left = lab.text("study/participants.csv");
    assert!(left.lines().count() == 2 && left.contains("\nseed1-P01,"), "{left}");
}

#[test]
fn files_of_others_in_a_recordings_folder_stay_and_are_told() {
    let lab = RecordingsFolder::of_two_people("strange");
    lab.put("seed1-P01-1/consent.pdf", "a scan");
    let nested = lab.at("seed1-P01-2/nested");
    fs::rename(lab.at("seed1-P02-1"), &nested).expect("moved");
    ended(lab.forget(&["P01", "--yes"]), 1, &["consent.pdf: in the folder of one of the participant's recordings"]);
    let left: Vec<String> = lab.files().into_keys().filter(|path| path.starts_with("seed1-P01")).collect();
    let nested = ["events.jsonl", "session.toml"].map(|name| format!("seed1-P01-2/nested/{name}"));
    assert_eq!(left, [&["seed1-P01-1/consent.pdf".to_string()][..], &nested].concat());
    // What an analysis of the recording alone left in it goes with it.
    let recording = lab.at("seed1-P02-2");
    ended(lab.run(&["study", recording.to_str().expect("UTF-8"), "--skip", "concepts"]), 0, &[]);
    assert!(recording.join("study/report.html").exists());
    ended(lab.forget(&["P02", "--yes"]), 0, &[]);
    assert!(!recording.exists());
}

#[test]
fn a_name_that_two_people_in_two_folders_have_is_told_and_not_guessed() {
    let lab = RecordingsFolder::of_two_people("ambiguous");
    for (from, to) in [("seed1-P01-1", "a/trial-1"), ("seed1-P02-1", "b/trial-1"), ("seed1-P01-2", "a/trial-2")] {
        fs::create_dir_all(lab.at(to).parent().expect("a folder")).expect("made");
        fs::rename(lab.at(from), lab.at(to)).expect("moved");
    }
    // Of both folders together the table of trials says whose each recording is.
    let (a, b, out) = (lab.at("a"), lab.at("b"), lab.at("study"));
    let told = lab.run(&[
        "study",
        a.to_str().unwrap(),
        b.to_str().unwrap(),
        "--skip",
        "concepts",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(told.0, Some(0), "{}", told.1);
    let codes = "recording,rater,press,cause,aspect\ntrial-1,R1,4,slip,\n";
    lab.put("a/codes.csv", codes);
    lab.put(
        "clear.csv",
        "recording,rater,press,cause,aspect\ntrial-2,R1,4,slip,\nb/trial-1,R1,4,slip,\na/trial-1,R1,4,slip,\n",
    );
    ended(lab.forget(&["P01", "--yes"]), 1, &["a/codes.csv: it names a recording, and recordings of several people"]);
    assert_eq!(lab.text("a/codes.csv"), codes);
    assert_eq!(lab.text("clear.csv"), "recording,rater,press,cause,aspect\nb/trial-1,R1,4,slip,\n");
    assert!(
        !lab.at("a/trial-1").exists() && !lab.at("a/trial-2").exists() && lab.at("b/trial-1/events.jsonl").exists()
    );
    let actions = lab.text("study/actions.csv");
    assert!(
        actions.contains("b/trial-1,") && !actions.contains("a/trial-1,") && !actions.contains("trial-2,"),
        "{actions}"
    );
}

#[test]
fn a_recording_that_was_saved_elsewhere_is_found_by_where_it_belongs() {
    let lab = RecordingsFolder::of_two_people("rescued");
    let rescue = |root: &str| {
        let saved = lab.rescued(root);
        let to = lab.temporary.join(format!("tomcom-rescued-{}", root.len())).join("2026-03-14-P01-1");
        fs::create_dir_all(to.parent().expect("a folder")).expect("made");
        fs::rename(&saved, &to).expect("moved");
        fs::remove_dir(saved.parent().expect("a folder")).expect("nothing else is in it");
        to
    };
    let (own, other) = (rescue("gone"), rescue("../of-another-study"));
    let without_a_note = lab.temporary.join("tomcom-rescued-1/2026-03-14-P01-1");
    fs::create_dir_all(&without_a_note).expect("made");
    fs::copy(own.join("events.jsonl"), without_a_note.join("events.jsonl")).expect("copied");
    let both = [lab.at("seed1-P01-1"), lab.at("seed1-P02-1")];
    let streams = [("tomcom-a-1.rrd", &both[..]), ("tomcom-b-1.rrd", &both[1..])].map(|(name, recordings)| {
        let stream = lab.temporary.join(name);
        let mut arguments: Vec<String> = recordings.iter().map(|recording| recording.display().to_string()).collect();
        arguments.extend([format!("--save={}", stream.display())]);
        ended(
            lab.run(&[&["review"], &arguments.iter().map(String::as_str).collect::<Vec<&str>>()[..]].concat()),
            0,
            &[],
        );
        stream
    });
    ended(lab.forget(&["P01"]), 2, &[&own.display().to_string()]);
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(!own.exists() && !own.parent().expect("a folder").exists(), "with the folder that was made for it");
    assert!(other.exists() && without_a_note.exists(), "P01 of another study is another person");
    assert!(
        !streams[0].exists() && streams[1].exists(),
        "a stream goes if it shows one of the participant's recordings"
    );
    let temporary = lab.temporary.to_str().expect("UTF-8");
    assert_eq!(lab.run(&["forget", "P01", "--yes", "--in", temporary]).0, Some(0), "whoever means those says so");
    assert!(!other.exists() && !without_a_note.exists());
}

#[test]
fn films_go_with_the_recording_in_whose_folder_they_lie_and_others_are_named() {
    let lab = RecordingsFolder::of_two_people("films");
    let outside = lab.temporary.join("room.mp4");
    lab.put("seed1-P01-1/hands.mp4", "a film");
    lab.put("seed1-P01-1/other.mp4", "a film that belongs to nothing");
    fs::write(&outside, "a film").expect("written");
    for film in [lab.at("seed1-P01-1/hands.mp4"), outside.clone()] {
        let (recording, film) = (lab.at("seed1-P01-1").display().to_string(), film.display().to_string());
        ended(
            lab.run(&["video", "attach", &recording, &film, "--offset", "1.5"]),
            0,
            &["1.500 s of the film, as given"],
        );
    }
    let text = lab.text("seed1-P01-1/video.json");
    assert!(text.contains("\"hands.mp4\"") && text.contains("room.mp4\""), "{text}");
    let told = ended(
        lab.forget(&["P01", "--yes"]),
        1,
        &[
            "hands.mp4, session.toml, video.json",
            "a film of the participant's recording seed1-P01-1, outside of its folder",
        ],
    );
    assert!(told.contains(&outside.display().to_string()) && outside.exists(), "{told}");
    assert!(!lab.at("seed1-P01-1/hands.mp4").exists() && lab.at("seed1-P01-1/other.mp4").exists(), "{told}");
}
