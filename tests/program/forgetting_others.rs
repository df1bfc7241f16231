//! What `tomcom forget` leaves alone: what is of others, and what other programs wrote.

use std::fs;

use tomcom::edge::files::read_session;
use tomcom_session::LogHeader;
use tomcom_session::log::LogWriter;

use crate::forgetting::RecordingsFolder;

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
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert_eq!(code, Some(0), "{told}");
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
    assert_eq!(lab.forget(&["P01", "--yes"]).0, Some(0));
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
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(
        code == Some(1) && told.contains("consent.pdf: in the folder of one of the participant's recordings"),
        "{told}"
    );
    let left: Vec<String> = lab.files().into_keys().filter(|path| path.starts_with("seed1-P01")).collect();
    let nested = ["events.jsonl", "session.toml"].map(|name| format!("seed1-P01-2/nested/{name}"));
    assert_eq!(left, [&["seed1-P01-1/consent.pdf".to_string()][..], &nested].concat());
    // What an analysis of the recording alone left in it goes with it.
    let recording = lab.at("seed1-P02-2");
    let (code, told) = lab.run(&["study", recording.to_str().expect("UTF-8"), "--skip", "concepts"]);
    assert!(code == Some(0) && recording.join("study/report.html").exists(), "{told}");
    let (code, told) = lab.forget(&["P02", "--yes"]);
    assert!(code == Some(0) && !recording.exists(), "{told}");
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
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(
        code == Some(1) && told.contains("a/codes.csv: it names a recording, and recordings of several people"),
        "{told}"
    );
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
        let files = read_session(std::path::Path::new("sessions/default.toml")).expect("a session");
        let header = LogHeader::new(files.spec, 0, files.kitchen.layout, files.kitchen.recipes);
        let mut log = LogWriter::create_live(&lab.at(root), "2026-03-14", &header).expect("a recording");
        fs::remove_dir_all(lab.at(root)).expect("removed");
        // Nothing can be saved where it was.
        lab.put(root, "");
        let told = log.check(false).expect_err("it is gone").to_string();
        let (_, saved) = told.split_once("is in ").expect("where it was saved");
        let to = lab.temporary.join(format!("tomcom-rescued-{}", root.len())).join("2026-03-14-P01-1");
        fs::create_dir_all(to.parent().expect("a folder")).expect("made");
        fs::rename(saved, &to).expect("moved");
        fs::remove_dir(std::path::Path::new(saved).parent().expect("a folder")).expect("nothing else is in it");
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
        let (code, told) =
            lab.run(&[&["review"], &arguments.iter().map(String::as_str).collect::<Vec<&str>>()[..]].concat());
        assert_eq!(code, Some(0), "{told}");
        stream
    });
    let (code, told) = lab.forget(&["P01"]);
    assert!(code == Some(2) && told.contains(&own.display().to_string()), "it is listed first: {told}");
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert_eq!(code, Some(0), "{told}");
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
