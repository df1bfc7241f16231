//! Damaged files in the way of `tomcom forget`: told truly, and nothing half done.

use std::fs;

use crate::forgetting::{RecordingsFolder, ended};

#[test]
fn bytes_that_are_no_utf_8_stay_as_they_are() {
    let lab = RecordingsFolder::of_two_people("latin-1");
    lab.study();
    // As a spreadsheet saves it: with its own ends of lines, and "überholt" in Latin-1.
    let text = lab.text("study/trials.csv").replace('\n', "\r\n").replacen(",true,,", ",true,?berholt,", 4);
    let latin: Vec<u8> = text.bytes().map(|byte| if byte == b'?' { 0xfc } else { byte }).collect();
    assert_eq!(latin.iter().filter(|&&byte| byte == 0xfc).count(), 4, "{text}");
    lab.put("study/trials.csv", &latin);
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    let kept: Vec<&[u8]> =
        latin.split_inclusive(|&byte| byte == b'\n').filter(|line| !line.starts_with(b"seed1-P01")).collect();
    assert_eq!(fs::read(lab.at("study/trials.csv")).expect("the table"), kept.concat());
    assert_eq!(kept.len(), 3);
    ended(lab.forget(&["p02", "--yes"]), 1, &["no files of participant p02 in ", "did you mean P02?"]);
}

#[test]
fn a_damaged_table_stays_and_is_told_until_it_is_mended() {
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
        let told = ended(lab.forget(&["P01", "--yes"]), 1, &["study/trials.csv: ", " damaged"]);
        assert_eq!(lab.text("study/trials.csv"), damage(&text), "{name}");
        assert!(!lab.at("seed1-P01-1").exists() && !lab.at("seed1-P01-2").exists(), "{told}");
        ended(lab.forget(&["P01", "--yes"]), 1, &["study/trials.csv: "]);
        lab.put("study/trials.csv", &text);
        assert_eq!(lab.forget(&["P01", "--yes"]).0, Some(0), "mended, it is changed");
        assert!(lab.files().values().all(|bytes| !String::from_utf8_lossy(bytes).contains("P01")));
    }
}

#[test]
fn the_table_of_trials_tells_whose_the_recordings_are_until_all_tables_beside_it_are_changed() {
    let lab = RecordingsFolder::of_two_people("trials-last");
    lab.study();
    let actions = lab.text("study/actions.csv");
    lab.put("study/actions.csv", actions.replacen("seed1-P02-1,", "", 1));
    ended(lab.forget(&["P01", "--yes"]), 1, &["actions.csv: line ", "trials.csv: rows are"]);
    // No recording says any more whose the rows are.
    assert!(!lab.at("seed1-P01-1").exists() && lab.text("study/trials.csv").contains(",P01,"));
    lab.put("study/actions.csv", &actions);
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(lab.files().values().all(|bytes| !String::from_utf8_lossy(bytes).contains("P01")));
}

#[test]
fn what_a_kill_in_the_middle_leaves_is_gone_on_with() {
    let lab = RecordingsFolder::of_two_people("killed");
    lab.study();
    let (rows, trials) = (lab.text("study/participants.csv"), lab.text("study/trials.csv"));
    let log = lab.at("seed1-P01-2/events.jsonl");
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    let done = lab.files();
    // Some tables are changed, with a new one beside its old one, and of a recording only the settings are left.
    for settings_alone in [true, false] {
        let again = RecordingsFolder::of_two_people("killed");
        again.study();
        fs::remove_file(lab.at("study/report.html")).expect("deleted");
        lab.put("study/actions.csv", &done["study/actions.csv"]);
        lab.put("study/trials.csv.tomcom-a1B2c3.new", &done["study/trials.csv"]);
        fs::remove_file(&log).expect("deleted");
        if !settings_alone {
            fs::remove_file(lab.at("seed1-P01-2/session.toml")).expect("deleted");
        }
        assert!(lab.text("study/trials.csv") == trials && lab.text("study/participants.csv") == rows);
        ended(lab.forget(&["P01", "--yes"]), 0, &[]);
        fs::remove_file(lab.at("study/trials.csv.tomcom-a1B2c3.new")).expect("a table without the participant");
        let after: Vec<String> = lab.files().into_keys().collect();
        assert_eq!(after, done.keys().cloned().collect::<Vec<String>>());
        assert!(lab.files().values().all(|bytes| !String::from_utf8_lossy(bytes).contains("P01")));
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
    ended(lab.forget(&["P01", "--yes"]), 0, &[]);
    assert!(!lab.at("seed1-P01-1").exists() && !lab.at("seed1-P01-2").exists());
    damage("seed1-P02-1");
    lab.put("seed1-P02-1/session.toml", "[participant\n");
    lab.put("other/events.jsonl", "{\"event\":\"of another program\"}\n");
    let before = lab.files();
    let told = ended(lab.forget(&["P02", "--yes"]), 1, &["seed1-P02-1: a recording that does not say whose it is"]);
    assert!(!lab.at("seed1-P02-2").exists() && !told.contains("other: "), "{told}");
    for (path, bytes) in before.iter().filter(|(path, _)| !path.starts_with("seed1-P02-2")) {
        assert_eq!(lab.files().get(path), Some(bytes), "{path}");
    }
    ended(lab.forget(&["P02", "--yes"]), 1, &["no files of participant P02 that can be deleted", "seed1-P02-1: "]);
    // An empty log, as a power cut leaves it.
    lab.put("seed1-P02-1/events.jsonl", "");
    fs::remove_file(lab.at("seed1-P02-1/session.toml")).expect("removed");
    ended(lab.forget(&["P02", "--yes"]), 1, &["seed1-P02-1: "]);
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
    let told = ended(lab.forget(&["P01", "--yes"]), 1, &["seed1-P01-1/linked: "]);
    assert!(lab.at("seed1-P02-1/events.jsonl").exists() && pipe.exists());
    assert!(!lab.at("seed1-P01-1/events.jsonl").exists() && !lab.at("seed1-P01-2").exists(), "{told}");
}
