//! `tomcom power`, `tomcom arms` and frozen plans, as people and job arrays run them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{self, done, json, refused, tomcom};

/// An empty folder for the test of this name, with the paper's plan and short trials in it.
fn folder(name: &str) -> (PathBuf, String) {
    let folder = program::folder(&format!("power-{name}"));
    let text = fs::read_to_string("sessions/paper.toml").expect("the paper's session");
    let root = format!("\"{}/", env!("CARGO_MANIFEST_DIR"));
    // As tomcom simulate sets them, so that recordings have the digest of the plan.
    let text = text.replace("[trial]", "[trial]\ncondition = \"none\"") + "\n[assistant]\nshadow = \"off\"\n";
    let text = text.replace("\"../", &root).replace("presses = 304", "presses = 40");
    let text = text.replace("participants = 14", "participants = 4").replace("block = 14", "block = 4");
    let plan = folder.join("short.toml");
    fs::write(&plan, text).expect("written");
    (folder, plan.display().to_string())
}

#[test]
fn shards_of_a_pool_are_joined_and_answer_as_the_whole() {
    let (folder, plan) = folder("shards");
    let at = |name: &str| folder.join(name).display().to_string();
    let (whole, one, two, joined) = (at("whole.jsonl"), at("1.jsonl"), at("2.jsonl"), at("joined.jsonl"));
    let (table, picture) = (at("power.csv"), at("power.svg"));
    let asked = ["--studies", "40", "--sizes", "6,8", "--format", "json"];
    let of_whole = done(&[&["power", &plan, "--pool", "8", "--out", &whole][..], &asked].concat());
    for (shard, file) in [("1/2", &one), ("2/2", &two)] {
        assert_eq!(
            done(&["power", &plan, "--pool", "8", "--shard", shard, "--out", file]),
            "",
            "a shard has no answer"
        );
    }
    let files = ["--csv", &table, "--picture", &picture];
    let from = ["power", &plan, "--from", &two, &one, "--out", &joined];
    assert_eq!(done(&[&from[..], &files, &asked].concat()), of_whole);
    assert_eq!(fs::read(&whole).expect("a pool"), fs::read(&joined).expect("a pool"));
    let found: Value = serde_json::from_str(&of_whole).expect("one JSON object");
    assert_eq!((found["pool"].as_u64(), found["sizes"][1]["participants"].as_u64()), (Some(8), Some(8)));
    assert_eq!(found["needed"][0]["method"], "mixed_anova");
    let rows = fs::read_to_string(&table).expect("a table");
    assert!(
        rows.starts_with("participants,method,arm,against,studies,rejected,") && rows.lines().count() == 5,
        "{rows}"
    );
    let drawn = fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.starts_with("<svg ") && drawn.ends_with("</svg>\n"), "{drawn}");
    let arms = done(&["arms", &plan, "--from", &whole]);
    assert!(arms.contains("| wizard | 8 |") && arms.contains("errors per press of the human, by condition"), "{arms}");
    refused(&["power", &plan, "--from", &one], "4 of 8 participants");
    refused(&["power", "sessions/paper.toml", "--from", &whole], "a pool of another plan or other settings");
    refused(&["power", &plan, "--pool", "8", "--picture", &plan], "a file is there that is not a picture");
    refused(
        &["power", "sessions/study.toml", "--arm", "timed"],
        "the condition wizard, which would be simulated as none",
    );
    let usage = tomcom(&["power", &plan, "--shard", "1/2"]);
    assert_eq!(usage.status.code(), Some(2), "a shard needs a file: {usage:?}");
    for ratio in ["0", "1.2", "much"] {
        assert_eq!(tomcom(&["power", &plan, "--effect", ratio]).status.code(), Some(2), "{ratio}");
    }
}

#[test]
fn the_type_i_error_needs_unassisted_trials_alone() {
    let (folder, plan) = folder("null");
    let pool = folder.join("null.jsonl").display().to_string();
    let text = done(&["power", &plan, "--pool", "8", "--null", "--studies", "40", "--sizes", "8", "--out", &pool]);
    assert!(text.contains("Without an effect the test finds one in"), "{text}");
    let lines = fs::read_to_string(&pool).expect("a pool");
    assert_eq!(lines.lines().count(), 1 + 16);
    assert!(lines.lines().skip(1).all(|line| line.contains("\"arm\":\"none\"") && line.contains("\"signals\":0")));
    let of_fifth = ["--effect", "0.2", "--studies", "40", "--sizes", "8"];
    let strong = json(&[&["power", &plan, "--from", &pool], &of_fifth[..]].concat());
    assert_eq!(strong["ratio"].as_f64(), Some(0.2));
    refused(&["power", &plan, "--from", &pool], "a pool that has only unassisted trials");
    refused(&["arms", &plan, "--from", &pool], "a pool that has only unassisted trials");
}

#[test]
fn a_plan_is_frozen_once_and_the_study_says_whether_it_is_that_one() {
    let (folder, plan) = folder("frozen");
    let at = |name: &str| folder.join(name).display().to_string();
    let (file, out, recordings) = (at("short.frozen"), at("none-yet"), at("recordings"));
    let frozen = json(&["plan", &plan, "--out", &out, "--freeze", &file]);
    let digest = frozen["digest"].as_str().expect("a digest").to_string();
    refused(&["plan", &plan, "--out", &out, "--freeze", &file], "a file that is there already");
    done(&["simulate", &plan, "--out", &recordings]);
    let study = |extra: &[&str]| {
        done(&[&["study", &recordings, "--skip", "concepts,events", "--frozen", &file], extra].concat())
    };
    let text = study(&[]);
    assert!(text.contains("Preregistered: the plan \"paper\" was frozen when no recording of it was there"), "{text}");
    assert!(text.contains(&format!("SHA-256 {}…", &digest[..12])), "{text}");
    let report = fs::read_to_string(Path::new(&recordings).join("study/report.html")).expect("a report");
    assert!(report.contains("Preregistered") && report.contains(&digest), "the report says so");
    fs::remove_dir_all(Path::new(&recordings).join("seed1-P03-2")).expect("removed");
    fs::remove_dir_all(Path::new(&recordings).join("seed1-P03-1")).expect("removed");
    let found: Value = serde_json::from_str(&study(&["--format", "json"])).expect("one JSON object");
    // P03 can still come.
    let check = &found["preregistration"];
    assert_eq!((check["differences"].as_array().map(Vec::len), &check["to_come"][0]), (Some(0), &Value::from("P03")));
    let report = fs::read_to_string(Path::new(&recordings).join("study/report.html")).expect("a report");
    assert!(report.contains("So far as preregistered"), "the report says so");
    // Nothing is recorded under another plan.
    let session = fs::read_to_string(&plan).expect("a session file");
    for (now, before) in [("presses = 41", "presses = 40"), ("participants = 5", "participants = 4")] {
        fs::write(&plan, session.replacen(before, now, 1)).expect("written");
        let line = session.lines().position(|line| line.starts_with(before)).expect("a setting") + 1;
        for told in [
            format!("short.toml:{line}: found {now}, changed since the plan was frozen"),
            format!("{before}, as it was frozen"),
        ] {
            refused(&["operate", &plan, "--code", "P01", "--frozen", &file], &told);
            refused(&["plan", &plan, "--out", &out, "--frozen", &file], &told);
        }
    }
    fs::write(&plan, &session).expect("written");
    let output = tomcom(&["plan", &plan, "--out", &out, "--frozen", &file]);
    assert!(output.status.success() && String::from_utf8_lossy(&output.stderr).contains("is the one that was frozen"));
    // What differs is told setting by setting, also of recordings under another version.
    fs::write(&plan, session.replacen("presses = 40", "presses = 41", 1)).expect("written");
    let others = at("others");
    done(&["simulate", &plan, "--trials", "2", "--out", &others]);
    let text = done(&["study", &others, "--skip", "concepts,events", "--frozen", &file]);
    // Below title and first sentence, before everything else.
    assert!(text.lines().nth(2).is_some_and(|line| line.starts_with("Not as preregistered: ")), "{text}");
    let report = fs::read_to_string(Path::new(&others).join("study/report.html")).expect("a report");
    assert!(report.find("Not as preregistered") < report.find("class=\"lead\""), "{report}");
    assert!(text.contains("which changed since: trial.presses from 40 to 41. "), "{text}");
    let part = at("part.jsonl");
    done(&["study", &others, "--skip", "concepts,events", "--shard", "1/1", "--out", &part]);
    let joined = done(&["study", "--from", &part, "--out", &at("joined"), "--frozen", &file]);
    assert!(joined.contains("which changed since: trial.presses from 40 to 41. "), "{joined}");
    // A code outside of the plan is told when it is set, and again where its trials are missed.
    let moved = Path::new(&others).join("seed1-P01-1").display().to_string();
    let correct = |code: &str| {
        let output = tomcom(&["correct", &moved, "--code", code, "--reason", "typed wrong"]);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = correct("P15");
    // P05 would be somebody else.
    let words = "P15 is no participant of the plan \"paper\" in sessions/paper.toml (P01 to P14 (14)), so";
    assert!(told.contains(words) && !told.contains("did you mean"), "{told}");
    assert!(told.contains("has no recording of trial 1 of P01 any more"), "{told}");
    let text = done(&["study", &others, "--skip", "concepts,events"]);
    assert!(text.contains("P15 (a corrected code, perhaps none of the plan) trial 2"), "{text}");
    assert!(text.contains("seed1-P01-1 (P01 is P15); tomcom correct RECORDING --undo"), "{text}");
    fs::write(&plan, &session).expect("written");
    let text = fs::read_to_string(&file).expect("frozen");
    fs::write(&file, text.replacen("\"level\": 0.95", "\"level\": 0.90", 1)).expect("written");
    refused(&["study", &recordings, "--skip", "concepts,events", "--frozen", &file], "it was changed after");
}
