//! A study that is analysed in parts, as job arrays do it, and joined.

use std::fs;
use std::path::{Path, PathBuf};

use tomcom_study::roc::INTERPOLATED;

use crate::program::{self, done, refused, tomcom};

/// Number of parts, and of trials.
const PARTS: u64 = 8;

/// An empty folder for the test of this name, with a plan of short trials in it.
fn folder(name: &str) -> (PathBuf, String) {
    let folder = program::folder(&format!("parts-{name}"));
    fs::create_dir(folder.join("parts")).expect("a folder");
    let text = fs::read_to_string("sessions/paper.toml").expect("the paper's session");
    let text =
        text.replace("\"../", &format!("\"{}/", env!("CARGO_MANIFEST_DIR"))).replace("seed = 1 ", "seed = 9813 ");
    let text = text.replace("presses = 304", "presses = 30");
    let text = text.replace("participants = 14", "participants = 4").replace("block = 14", "block = 4");
    let plan = folder.join("short.toml");
    fs::write(&plan, text).expect("written");
    (folder, plan.display().to_string())
}

/// All files of a folder with their bytes, by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    let mut all: Vec<_> = entries.map(|path| (name(&path), fs::read(&path).expect("a file"))).collect();
    all.sort();
    all
}

/// Writes a changed copy of a part.
fn changed(part: &str, to: &Path, change: impl Fn(&str) -> String) -> String {
    let text = fs::read_to_string(part).expect("a part");
    let new = change(&text);
    assert_ne!(text, new, "nothing changes in {part}");
    fs::write(to, new).expect("written");
    to.display().to_string()
}

#[test]
fn eight_parts_are_analysed_each_by_itself_and_joined_to_the_bytes_of_one_analysis() {
    let (folder, plan) = folder("joined");
    let at = |name: &str| folder.join(name).display().to_string();
    let mut parts: Vec<String> = Vec::new();
    for number in 1..=PARTS {
        let (shard, own) = (format!("{number}/{PARTS}"), at(&format!("shards/{number}")));
        let part = at(&format!("parts/{number}.jsonl"));
        done(&["simulate", &plan, "--shard", &shard, "--out", &own]);
        assert_eq!(done(&["study", &own, "--shard", &shard, "--out", &part]), "", "a part has no results");
        parts.push(part);
    }
    let shards: Vec<String> = (1..=PARTS).map(|number| at(&format!("shards/{number}"))).collect();
    let of = |first: &[&str], paths: &[String], last: &[&str]| {
        let paths = paths.iter().map(String::as_str);
        done(&first.iter().copied().chain(paths).chain(last.iter().copied()).collect::<Vec<_>>())
    };
    let whole = of(&["study"], &shards, &["--out", &at("whole"), "--format", "json"]);
    let joined = of(&["study", "--from"], &parts, &["--out", &at("joined"), "--format", "json"]);
    assert_eq!(whole, joined);
    assert!(whole.contains("\"trials\": 8") && whole.contains("\"roc\""), "{whole}");
    let tables = files(&folder.join("whole"));
    assert!(tables.len() > 10 && tables.iter().any(|(name, _)| name == "report.html"), "{}", tables.len());
    assert!(tables == files(&folder.join("joined")), "tables or report differ");
    // One folder for all jobs is as good as a folder for each; the order of the parts does not matter.
    done(&["simulate", &plan, "--out", &at("together")]);
    for (number, part) in (1..=PARTS).zip(&parts) {
        let output = tomcom(&["study", &at("together"), "--shard", &format!("{number}/{PARTS}"), "--out", part]);
        let said = String::from_utf8_lossy(&output.stderr);
        let says = format!("part {number} of 8 of the study was analysed: 1 recording; 7 of other parts were left out");
        assert!(output.status.success() && said.contains(&says), "{output:?}");
    }
    parts.reverse();
    assert_eq!(of(&["study", "--from"], &parts, &["--out", &at("again"), "--format", "json"]), whole);
    assert!(tables == files(&folder.join("again")), "tables or report differ");
    // A recording that is gone is missed by the parts that saw it, and named by the join of those that did not.
    fs::remove_dir_all(folder.join("together/seed9813-P02-1")).expect("the third trial's recording");
    let part = |number: u64| {
        done(&[
            "study",
            &at("together"),
            "--shard",
            &format!("{number}/8"),
            "--out",
            &at(&format!("parts/{number}.jsonl")),
        ])
    };
    part(3);
    let arguments: Vec<&str> = ["study", "--from"].into_iter().chain(parts.iter().map(String::as_str)).collect();
    refused(&[&arguments[..], &["--out", &at("lost")]].concat(), "left out the recording seed9813-P02-1, which no");
    (1..=PARTS).for_each(|number| drop(part(number)));
    let less = of(&["study", "--from"], &parts, &["--out", &at("less")]);
    assert!(less.contains("7 trials of 4 participants"), "{less}");
    assert!(less.contains("\n1 trial of the plan \"paper\" has no recording: P02 trial 1\n"), "{less}");
    let report = fs::read_to_string(folder.join("less/report.html")).expect("a report");
    assert!(report.contains("has no recording: P02 trial 1"), "the report says it, too");
    assert!(less.contains(INTERPOLATED) && report.contains(INTERPOLATED), "{less}");
    assert!(!whole.contains("no recording") && !whole.contains("missing_trials"), "{whole}");
    refused(&["simulate", &plan, "--shard", "1/9", "--out", &at("none")], "--shard of 9 parts, with 8 trials");
    assert!(!folder.join("none").exists(), "nothing is simulated for too many parts");
}

#[test]
fn parts_that_do_not_make_one_study_are_refused() {
    let (folder, plan) = folder("refused");
    let at = |name: &str| folder.join(name).display().to_string();
    let out = at("results");
    done(&["simulate", &plan, "--out", &at("trials")]);
    let part = |number: u64, of: u64, name: &str, more: &[&str]| {
        let (shard, file) = (format!("{number}/{of}"), at(name));
        let trials = at("trials");
        done(&[&["study", &trials, "--shard", &shard, "--out", &file, "--skip"][..], more].concat());
        file
    };
    let (one, two) = (part(1, 2, "1.jsonl", &["concepts"]), part(2, 2, "2.jsonl", &["concepts"]));
    let join =
        |parts: &[&str], says: &str| refused(&[&["study", "--from"][..], parts, &["--out", &out]].concat(), says);
    join(&[&one], "1 of 2 parts, without 2");
    join(&[&one, &two, &one], "part 1 of 2 for the second time");
    let other = part(2, 3, "2-of-3.jsonl", &["concepts"]);
    join(&[&one, &other], "part 2 of 3, beside parts of 2");
    let other = part(2, 2, "less.jsonl", &["concepts,events"]);
    join(
        &[&one, &other],
        "a part that was analysed with --skip concepts,events, where the first file was with --skip concepts",
    );
    let program = format!("\"program\":\"{}\"", env!("CARGO_PKG_VERSION"));
    let other = changed(&two, &folder.join("old.jsonl"), |text| text.replace(&program, "\"program\":\"0.0.1\""));
    join(&[&one, &other], "a part of version 0.0.1 of the program");
    let other = changed(&two, &folder.join("plan.jsonl"), |text| text.replacen("[\"paper\",", "[\"another\",", 1));
    join(&[&one, &other], "beside a part of the plan \"paper\"");
    let other = changed(&one, &folder.join("same.jsonl"), |text| text.replacen("\"shard\":1,", "\"shard\":2,", 1));
    // The same recordings again are copies; those of the other part are missing all the same.
    join(&[&one, &other], "left out the recording seed9813-P01-2, which no other part has");
    // The same trials in other recordings are no copies.
    let again = changed(&one, &folder.join("again.jsonl"), |text| {
        text.replacen("\"shard\":1,", "\"shard\":2,", 1).replace("\"digest\":\"", "\"digest\":\"of another log ")
    });
    join(
        &[&one, &again],
        "a second recording of trial 1 of participant P01 (simulated, seed 9813) in the plan \"paper\"",
    );
    let line_ends = |text: &str| text.match_indices('\n').map(|(at, _)| at + 1).collect::<Vec<usize>>();
    let cut = |text: &str| text[..line_ends(text)[3]].to_string();
    let other = changed(&two, &folder.join("cut.jsonl"), cut);
    join(&[&one, &other], "the end after 1 of 4 recordings");
    let other = changed(&two, &folder.join("half.jsonl"), |text| text[..text.len() - 100].to_string());
    join(&[&one, &other], "a line without its end");
    join(&[&one, &plan], "a line that is not a line of a study's part");
    // Jobs that count from 0 analyse the recordings of other parts, and leave out what no part has.
    done(&["simulate", &plan, "--shard", "1/2", "--out", &at("own")]);
    let others = at("others.jsonl");
    done(&["study", &at("own"), "--shard", "2/2", "--out", &others, "--skip", "concepts"]);
    join(&[&one, &others], "a part that left out the recording seed9813-P01-2, which no other part has");
    // A part takes no other file's place, but that of the same part.
    refused(&["study", &at("trials"), "--shard", "1/2", "--out", &plan], "a file is there that is not the same part");
    refused(&["study", &at("trials"), "--shard", "1/2", "--out", &two], "a file is there that is not the same part");
    for options in [&["--shard", "1/2"][..], &["--from", &one], &["--shard", "1/2", "--out", &out, "--frozen", &plan]] {
        let output = tomcom(&[&["study", &at("trials")][..], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}: {output:?}");
    }
    assert!(!folder.join("results/report.html").exists(), "nothing is written of what was refused");
}
