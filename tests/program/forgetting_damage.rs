//! Damaged files in the way of `tomcom forget`: told truly, and nothing half done.

use std::fs;

use crate::forgetting::RecordingsFolder;

#[test]
fn bytes_that_are_no_utf_8_stay_as_they_are() {
    let lab = RecordingsFolder::of_two_people("latin-1");
    lab.study();
    // As a spreadsheet saves it: with its own ends of lines, and "überholt" in Latin-1.
    let text = lab.text("study/trials.csv").replace('\n', "\r\n").replacen(",true,,", ",true,?berholt,", 4);
    let latin: Vec<u8> = text.bytes().map(|byte| if byte == b'?' { 0xfc } else { byte }).collect();
    assert_eq!(latin.iter().filter(|&&byte| byte == 0xfc).count(), 4, "{text}");
    lab.put("study/trials.csv", &latin);
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert_eq!(code, Some(0), "{told}");
    let kept: Vec<&[u8]> =
        latin.split_inclusive(|&byte| byte == b'\n').filter(|line| !line.starts_with(b"seed1-P01")).collect();
    assert_eq!(fs::read(lab.at("study/trials.csv")).expect("the table"), kept.concat());
    assert_eq!(kept.len(), 3);
}

#[test]
fn a_damaged_table_is_told_and_those_beside_it_stay_until_it_is_gone() {
    for (name, damage) in [
        ("header", (|text: &str| text.replacen("participant", "part", 1)) as fn(&str) -> String),
        ("no-header", |text| text.split_once('\n').expect("lines").1.to_string()),
        ("short-row", |text| text.replacen("seed1-P01-2,P01,", "P01,", 1)),
        ("quotation-mark", |text| text.replacen(",timed,", ",\"timed,", 1)),
    ] {
        let lab = RecordingsFolder::of_two_people(&format!("damaged-{name}"));
        lab.study();
        let text = lab.text("study/trials.csv");
        assert_ne!(damage(&text), text, "{name}");
        lab.put("study/trials.csv", damage(&text));
        let before = lab.files();
        let (code, told) = lab.forget(&["P01", "--yes"]);
        assert!(code == Some(1) && told.contains("study/trials.csv: ") && told.contains(" damaged"), "{name}: {told}");
        let after = lab.files();
        assert!(!lab.at("seed1-P01-1").exists() && !lab.at("seed1-P01-2").exists(), "{told}");
        for (path, bytes) in before.iter().filter(|(path, _)| path.ends_with(".csv")) {
            assert_eq!(after.get(path), Some(bytes), "{name}: {path}");
        }
        if name == "short-row" {
            assert!(
                told.contains("study/participants.csv: 1 row is about the participant; this table is changed together"),
                "{told}"
            );
            let (code, told) = lab.forget(&["P01", "--yes"]);
            assert!(code == Some(1) && told.contains("study/participants.csv: "), "it is told again: {told}");
            lab.put("study/trials.csv", &text);
            assert_eq!(lab.forget(&["P01", "--yes"]).0, Some(0), "mended, it is changed with the others");
            assert!(lab.files().values().all(|bytes| !String::from_utf8_lossy(bytes).contains("P01")));
        }
    }
}

#[test]
fn a_header_says_whose_a_recording_is_and_else_the_settings() {
    let lab = RecordingsFolder::of_two_people("headers");
    let damage = |recording: &str| {
        let log = format!("{recording}/events.jsonl");
        let text = lab.text(&log);
        lab.put(&log, &text[text.len() / 3..]);
    };
    fs::remove_file(lab.at("seed1-P01-1/session.toml")).expect("removed");
    damage("seed1-P01-2");
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert_eq!(code, Some(0), "either is enough: {told}");
    assert!(!lab.at("seed1-P01-1").exists() && !lab.at("seed1-P01-2").exists());
    damage("seed1-P02-1");
    lab.put("seed1-P02-1/session.toml", "[participant\n");
    lab.put("other/events.jsonl", "{\"event\":\"of another program\"}\n");
    let before = lab.files();
    let (code, told) = lab.forget(&["P02", "--yes"]);
    assert!(code == Some(1) && told.contains("seed1-P02-1: a recording that does not say whose it is"), "{told}");
    assert!(!lab.at("seed1-P02-2").exists() && !told.contains("other: "), "{told}");
    for (path, bytes) in before.iter().filter(|(path, _)| !path.starts_with("seed1-P02-2")) {
        assert_eq!(lab.files().get(path), Some(bytes), "{path}");
    }
    let (code, told) = lab.forget(&["P02", "--yes"]);
    assert!(
        code == Some(1)
            && told.contains("no files of participant P02 that can be deleted")
            && told.contains("seed1-P02-1: "),
        "{told}"
    );
    // An empty log, as a power cut leaves it.
    lab.put("seed1-P02-1/events.jsonl", "");
    fs::remove_file(lab.at("seed1-P02-1/session.toml")).expect("removed");
    let (code, told) = lab.forget(&["P02", "--yes"]);
    assert!(code == Some(1) && told.contains("seed1-P02-1: "), "{told}");
}

#[test]
fn a_link_leads_nowhere_and_a_pipe_is_not_waited_for() {
    let lab = RecordingsFolder::of_two_people("links");
    std::os::unix::fs::symlink(lab.at("seed1-P02-1"), lab.at("seed1-P01-1/linked")).expect("linked");
    std::os::unix::fs::symlink(lab.at("seed1-P02-1/events.jsonl"), lab.at("linked.csv")).expect("linked");
    let pipe = lab.at("pipe/events.jsonl");
    fs::create_dir(pipe.parent().expect("a folder")).expect("made");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|made| made.success()));
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(code == Some(1) && told.contains("seed1-P01-1/linked: "), "{told}");
    assert!(lab.at("seed1-P02-1/events.jsonl").exists() && pipe.exists());
    assert!(!lab.at("seed1-P01-1/events.jsonl").exists() && !lab.at("seed1-P01-2").exists(), "{told}");
}
