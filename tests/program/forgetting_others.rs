//! What `tomcom forget` leaves alone: what is of others, and what other programs wrote.

use std::fs;

use tomcom::edge::files::read_session;
use tomcom::edge::log::LogWriter;
use tomcom::session::LogHeader;

use crate::forgetting::RecordingsFolder;

#[test]
fn the_code_1_is_looked_for_where_a_participant_is_named_and_nowhere_else() {
    let lab = RecordingsFolder::of_two_people("one");
    lab.give("seed1-P01-1", "1");
    lab.give("seed1-P01-2", "1");
    lab.study();
    lab.put("old/participants.csv", "id,age\n1,31\n2,1\n");
    lab.put("old/trials.csv", "1,2,3\n4,5,1\n");
    lab.put("notes.txt", "1 apple for 1 participant\n");
    lab.put("1.txt", "1");
    lab.put("page.html", "<td>1</td>");
    lab.put("figures.json", "{\"trials\": 1}");
    let before = lab.files();
    assert!(String::from_utf8_lossy(&before["study/actions.csv"]).contains(",1,"), "of others there are ones, too");
    let (code, told) = lab.forget(&["1", "--yes"]);
    assert_eq!(code, Some(0), "{told}");
    let after = lab.files();
    for (path, bytes) in &before {
        let is_gone = path.starts_with("seed1-P01") || path == "study/report.html";
        assert_eq!(after.contains_key(path), !is_gone, "{path}");
        let kept =
            |line: &&[u8]| !path.starts_with("study/") || !line.starts_with(b"1,") && !line.starts_with(b"seed1-P01");
        let kept: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').filter(kept).collect();
        assert!(is_gone || after[path] == kept.concat(), "{path}");
    }
    assert!(
        lab.text("study/participants.csv").lines().count() == 2 && lab.text("study/trials.csv").lines().count() == 3
    );
}

#[test]
fn codes_that_new_sessions_refuse_are_forgotten_where_somebody_has_them_and_nothing_else_is() {
    let lab = RecordingsFolder::of_two_people("words");
    lab.study();
    lab.put("none.txt", "none");
    let before = lab.files();
    assert_eq!(lab.forget(&["--yes", "P01,"]).0, Some(2), "no code");
    for code in ["none", "human", "trials"] {
        let (exit, told) = lab.forget(&["--yes", code]);
        assert_eq!(exit, Some(1), "{code} is nobody's: {told}");
    }
    assert_eq!(lab.forget(&["--yes", "-7"]).0, Some(2), "an option that there is none of");
    assert_eq!(lab.files(), before);
    // Recordings of whoever wrote them with another program.
    for (recording, code) in [("seed1-P01-1", "none"), ("seed1-P01-2", "-7"), ("seed1-P02-1", "seed1-P03")] {
        lab.give(recording, code);
        let (exit, told) = lab.run(&["replay", lab.at(recording).to_str().expect("UTF-8"), "--verify"]);
        assert_eq!(exit, Some(0), "it opens all the same: {told}");
    }
    lab.study();
    for (recording, code) in [("seed1-P01-1", "none"), ("seed1-P01-2", "-7")] {
        let (exit, told) = lab.forget(&["--yes", "--", code]);
        assert!(exit == Some(0) && !lab.at(recording).exists(), "{told}");
        assert!(
            !lab.text("study/trials.csv").contains(recording) && !lab.text("study/actions.csv").contains(recording)
        );
        assert!(lab.text("study/trials.csv").contains("seed1-P02-1,seed1-P03,simulated"));
        assert!(lab.text("study/trials.csv").contains(",none,false,true,"), "conditions stay");
    }
    // That code is also what P03 of seed 1 would be called in a table.
    let (exit, told) = lab.forget(&["--yes", "seed1-P03"]);
    assert!(exit == Some(1) && told.contains("participants.csv: "), "{told}");
    assert!(!lab.at("seed1-P02-1").exists() && lab.text("study/participants.csv").contains("seed1-P03"));
    assert!(lab.at("seed1-P02-2").exists() && lab.at("none.txt").exists());
}

#[test]
fn such_codes_are_refused_for_new_sessions() {
    let lab = RecordingsFolder::of_two_people("new-sessions");
    for code in ["none", "-7", "007", "TRUE"] {
        let (exit, told) = lab.run(&["operate", "sessions/default.toml", &format!("--code={code}")]);
        assert!(exit == Some(2) && told.contains(&format!("code = \"{code}\": ")), "{told}");
    }
}

#[test]
fn tables_of_other_programs_stay_as_they_are_and_are_told_where_they_name_the_participant() {
    let lab = RecordingsFolder::of_two_people("foreign");
    lab.put("ages/participants.csv", "participant,age\nP01,31\nP02,32\n");
    lab.put("excel/participants.csv", "participant;kind\r\nP01;simulated\r\n");
    lab.put("other/participants.csv", "id,age\nP03,31\n");
    lab.put("other/list.csv", "id,age\nP01,31\n");
    lab.put("report.html", "<td>P01</td>");
    lab.put("page.html", "<td>P01</td>");
    lab.put("text.txt", "P01 seed1-P01-1");
    lab.put("seed1-P01-1.mp4", "a video");
    let before = lab.files();
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert_eq!(code, Some(1), "something is left: {told}");
    let (_, left) = told.split_once("not deleted:\n").expect("what is left");
    let left: Vec<&str> = left.lines().collect();
    assert_eq!(left.len(), 4, "{told}");
    assert!(
        left[0].contains("ages/participants.csv: 1 row is about the participant, in a table that tomcom did not write")
    );
    assert!(left[1].contains("excel/participants.csv: the table names the participant"), "{told}");
    assert!(left[2].contains("report.html: a report that does not say who made it"), "{told}");
    assert!(
        left[3].contains("seed1-P01-1.mp4: the file has the name of one of the participant's recordings"),
        "{told}"
    );
    let after = lab.files();
    for (path, bytes) in
        before.iter().filter(|(path, _)| !path.starts_with("seed1-P01-1/") && !path.starts_with("seed1-P01-2/"))
    {
        assert_eq!(after.get(path), Some(bytes), "{path}");
    }
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(code == Some(1) && told.contains("excel/participants.csv"), "it is told until it is gone: {told}");
}

#[test]
fn files_of_others_in_a_recordings_folder_stay_with_the_settings_that_say_whose_it_is() {
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
    assert_eq!(
        left,
        [&["seed1-P01-1/consent.pdf", "seed1-P01-1/session.toml"].map(str::to_string)[..], &nested].concat()
    );
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(code == Some(1) && told.contains("consent.pdf: "), "it is told as long as it is there: {told}");
    fs::remove_file(lab.at("seed1-P01-1/consent.pdf")).expect("removed");
    assert_eq!(lab.forget(&["P01", "--yes"]).0, Some(0));
    assert!(!lab.at("seed1-P01-1").exists());
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
