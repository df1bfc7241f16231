//! Recordings that are closed: excluded, and compared with assistants.

use std::fs;

use serde_json::Value;

use super::{check, complaint};
use crate::program::{done, folder, json, session_file};

#[test]
fn a_closed_recording_is_excluded_and_taken_back_and_the_figures_say_so() {
    let out = folder("exclude");
    let session = out.join("session.toml");
    let text = fs::read_to_string("sessions/default.toml").expect("the default session");
    let layouts = format!("{}/layouts", env!("CARGO_MANIFEST_DIR"));
    let text = text.replace("../layouts", &layouts).replace("seconds = 900.0", "seconds = 10.0");
    fs::write(&session, text).expect("written");
    let (session, out) = (session.to_str().expect("a path in UTF-8"), out.to_str().expect("a path in UTF-8"));
    let simulate = ["simulate", session, "--trials", "2", "--seed", "7", "--out", out];
    let before = json(&simulate);
    let recording = format!("{out}/seed7-S001");
    let log = fs::read(format!("{recording}/events.jsonl")).expect("a log");
    let standing = || json(&["replay", &recording])["excluded"].clone();
    assert_eq!(standing(), Value::Null);
    check(&["exclude", &recording, "--reason", "the tracker slipped"], 0);
    assert_eq!(standing(), "the tracker slipped");
    let after = json(&simulate);
    assert_eq!((&after["excluded"], &after["trials"], &before["excluded"]), (&1.into(), &1.into(), &0.into()));
    assert_eq!(fs::read(format!("{recording}/events.jsonl")).expect("a log"), log, "the log stays as it is");
    let told = check(&["replay", &recording], 0);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("left out of the analysis: excluded: the tracker slipped"), "{told}");
    check(&["exclude", &recording, "--back"], 0);
    assert_eq!(standing(), Value::Null);
    let rulings = fs::read_to_string(format!("{recording}/exclusion.toml")).expect("what was said");
    assert_eq!(rulings.matches("[[ruling]]").count(), 2, "nothing is forgotten:\n{rulings}");
    assert!(complaint(&["exclude", &recording, "--reason", ""]).contains("a reason of 1 to 200 characters"));
    assert!(complaint(&["exclude", out, "--reason", "x"]).contains("where one recording is meant"));
    fs::write(format!("{recording}/exclusion.toml"), "[[ruling]]\nexcluded = 1\n").expect("written");
    let told = complaint(&["replay", &recording, "--format", "json"]);
    assert!(told.contains("exclusion.toml:2") && told.contains("[[ruling]]"), "{told}");
}

#[test]
fn compare_sets_assistants_beside_what_was_sent_and_opens_what_differs() {
    let out = folder("compare");
    let session = &session_file(
        &out,
        "[trial]\nseconds = 60.0\n[assistant]\nconcept = \"tom\"\n[human.inference]\nbeliefs = 32\nstates = 8\n",
    );
    let out = out.to_str().expect("a path in UTF-8");
    let arguments = ["simulate", session, "--trials", "2", "--condition", "assistant", "--out", out];
    let recordings = json(&arguments);
    let recordings: Vec<&str> =
        recordings["recordings"].as_array().expect("recordings").iter().filter_map(Value::as_str).collect();
    let found = json(&[&["compare"], &recordings[..], &["--with", "dev"]].concat());
    let pairs = found["pairs"].as_array().expect("pairs");
    let names: Vec<[&str; 2]> =
        pairs.iter().map(|pair| ["of", "with"].map(|key| pair[key].as_str().unwrap_or_default())).collect();
    assert_eq!(names, [["assistant", "tom"], ["assistant", "dev"], ["tom", "dev"]]);
    for key in ["recall", "precision", "f1", "kappa", "median_lead_s", "chance_recall", "window_actions"] {
        assert!(pairs[0][key].is_number(), "{key} in {}", pairs[0]);
    }
    assert!(pairs[0]["recall"].as_f64() > pairs[0]["chance_recall"].as_f64(), "{}", pairs[0]);
    let one = &found["recordings"][0];
    let differences = one["differences"].as_array().expect("differences");
    assert!(!differences.is_empty());
    let knew = &differences[differences.len() - 1]["knew"];
    assert_eq!(knew["beliefs"].as_array().map(Vec::len), Some(16), "every aspect");
    assert!(knew["advice"].is_object(), "{knew}");
    let only = json(&["compare", recordings[0], "--only", "dev"]);
    let only_pairs = only["pairs"].as_array().expect("pairs");
    assert_eq!(only_pairs.len(), 1, "{only_pairs:?}");
    assert_eq!((&only_pairs[0]["of"], &only_pairs[0]["with"]), (&pairs[1]["of"], &pairs[1]["with"]));
    let about_dev = |difference: &&Value| ["by", "not_by"].iter().all(|key| difference[key] != "tom");
    let expected: Vec<&Value> = differences.iter().filter(about_dev).collect();
    let found: Vec<&Value> = only["recordings"][0]["differences"].as_array().expect("differences").iter().collect();
    assert!(!found.is_empty() && found.len() < differences.len(), "{} of {}", found.len(), differences.len());
    assert_eq!(found, expected, "with the numbers that they have among all");
    let listed = check(&["compare", recordings[0], "--with", "dev"], 0);
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    // To the millisecond: else the viewer would stand before the moment.
    let moment = listed.split_once(" --at ").and_then(|(_, rest)| rest.lines().next()).expect("a moment");
    assert!(moment.rsplit_once('.').is_some_and(|(_, ms)| ms.len() == 3), "{moment}");
    let opened = check(&["compare", recordings[0], "--with", "dev", "--open", "1"], 0);
    let opened = String::from_utf8_lossy(&opened.stdout).into_owned();
    for told in [
        "not sent by",
        "false beliefs, by the estimate",
        "true contents of the kitchen: ",
        "panels on the wizard's screen: ",
    ] {
        assert!(opened.contains(told), "{told} in\n{opened}");
    }
    assert!(complaint(&["compare", recordings[0], "--open", "999"]).contains("the number of a difference in the list"));
    assert!(complaint(&["compare", recordings[0], "--seed", "3"]).contains("--seed, with recordings"));
    let told = complaint(&["compare", recordings[0], "--rerun-listen", "127.0.0.1:9876"]);
    assert!(told.contains("--rerun-listen, with recordings"), "{told}");
    assert!(complaint(&["compare", session, "--open", "1"]).contains("--open, with a session file"));
    assert!(complaint(&["compare", session, "--only", "tom"]).contains("--only, with a session file"));
    assert!(complaint(&["compare", "tests/golden"]).contains("a folder without recordings"));
    // What conditions do to errors is another question.
    let told = |with: &str| String::from_utf8_lossy(&check(&["compare", recordings[0], with], 0).stdout).into_owned();
    let study = "how errors differ between the conditions (unassisted, ToM) tells tomcom study RECORDING";
    assert!(!told(recordings[1]).contains("tomcom study"));
    check(&["simulate", session, "--trials", "1", "--condition", "none", "--out", &format!("{out}/alone")], 0);
    assert!(told(&format!("{out}/alone")).contains(study));
    let swept = json(&["compare", recordings[0], "--sweep"]);
    let swept: Vec<u64> =
        swept["pairs"].as_array().expect("pairs").iter().filter_map(|pair| pair["window_actions"].as_u64()).collect();
    assert_eq!(swept, (0..=10).collect::<Vec<u64>>());
}

#[test]
fn a_folder_is_listed_and_is_no_recording_where_one_is_meant() {
    let out = folder("list");
    let session = &session_file(&out, "[trial]\nseconds = 20.0\n[human.inference]\nbeliefs = 32\nstates = 8\n");
    let out = out.to_str().expect("a path in UTF-8");
    check(&["simulate", session, "--trials", "4", "--seed", "7", "--arm", "timed", "--out", out], 0);
    // The second is cut, the third excluded, the fourth no log.
    let log = format!("{out}/seed7-S002/events.jsonl");
    let lines = fs::read_to_string(&log).expect("a log");
    let cut: Vec<&str> = lines.lines().take(lines.lines().count() / 2).collect();
    fs::write(&log, cut.join("\n") + "\n").expect("cut");
    check(&["exclude", &format!("{out}/seed7-S003"), "--reason", "interrupted"], 0);
    fs::write(format!("{out}/seed7-S004/events.jsonl"), "{}\n").expect("damaged");
    let list = json(&["list", out]);
    let rows = list["recordings"].as_array().expect("a list");
    let column = |name: &str| rows.iter().map(|row| row[name].clone()).collect::<Vec<_>>();
    assert_eq!(column("code"), [Value::Null, "S001".into(), "S002".into(), "S003".into()]);
    assert_eq!(column("state"), ["unreadable", "whole", "cut", "excluded"]);
    let found = json(&["list", out, "s003", "excluded"]);
    assert_eq!(found["recordings"], Value::from(vec![rows[3].clone()]), "a row with both words");
    let told = check(&["list", out, "s003", "unheard"], 0);
    let told = String::from_utf8_lossy(&told.stderr);
    assert!(told.contains("has \"unheard\" in its line") && !told.contains("s003"), "{told}");
    assert_eq!((&rows[3]["reason"], &rows[1]["kind"]), (&"excluded: interrupted".into(), &"simulated_trial".into()));
    let whole = json(&["replay", &format!("{out}/seed7-S001")]);
    assert_eq!((&rows[1]["errors"], &rows[1]["trial_s"]), (&whole["errors"], &whole["trial_s"]));
    assert_eq!((&rows[1]["condition"], &rows[1]["arm"]), (&"none".into(), &"none".into()));
    // Figures of closed recordings are kept for the next list; what stands beside a log holds all the same.
    assert_eq!(json(&["list", out]), list);
    check(&["exclude", &format!("{out}/seed7-S001"), "--reason", "a rehearsal"], 0);
    assert_eq!(json(&["list", out])["recordings"][1]["state"], "excluded");
    let told = String::from_utf8_lossy(&check(&["list", out], 0).stdout).into_owned();
    assert!(told.contains("excluded    seed7-S003  (excluded: interrupted)"), "{told}");
    assert!(told.ends_with(&format!("4 recordings in {out}\n")), "{told}");
    for command in [&["replay", out][..], &["replay", out, "--verify"], &["compare", out]] {
        let told = complaint(command);
        assert!(told.contains("found a folder with 4 recordings, where one recording is meant"), "{told}");
        assert!(told.contains(&format!("{out}/seed7-S001, {out}/seed7-S002")), "{told}");
    }
    // All that are damaged are named at once; excluded, they are left out, and the others are read.
    let damaged = ["seed7-S004", "seed7-S005"].map(|name| format!("{out}/{name}"));
    fs::create_dir(&damaged[1]).expect("a folder");
    fs::write(format!("{}/events.jsonl", damaged[1]), "{}\n").expect("damaged");
    let told = complaint(&["codes", out]);
    assert!(told.contains("2 recordings with errors: ") && damaged.iter().all(|one| told.contains(one)), "{told}");
    damaged.iter().for_each(|one| drop(check(&["exclude", one, "--reason", "disk full"], 0)));
    let told = String::from_utf8_lossy(&check(&["list", out, "excluded", "full"], 0).stdout).into_owned();
    assert!(told.contains("(excluded: disk full; unreadable: ") && told.contains("2 recordings in "), "{told}");
    let told = String::from_utf8_lossy(&check(&["codes", out], 0).stderr).into_owned();
    let left_out =
        "2 recordings are excluded, and cannot be read, and left out: seed7-S004 (excluded: disk full), seed7-S005";
    assert!(told.contains(left_out), "{told}");
    // All recordings of a folder are meant; another folder in it is none.
    damaged.iter().for_each(|one| fs::remove_dir_all(one).expect("removed"));
    fs::create_dir_all(format!("{out}/study")).expect("a folder");
    let coded = json(&["codes", out]);
    assert_eq!(coded["recordings"].as_array().map(Vec::len), Some(3), "{coded}");
    let told = complaint(&["study", out, "--raters", "ra", "Rb"]);
    assert!(told.contains("no codes of the rater ra"), "{told}");
    assert!(complaint(&["exclude", &format!("{out}/seed7-S002"), "--back"]).contains("no exclusion of"));
    // All recordings of a participant are excluded at once, and included again.
    let state = |code: &str| {
        let list = json(&["list", out]);
        let rows = list["recordings"].as_array().expect("a list").clone();
        rows.into_iter().find(|row| row["code"] == code).expect("a recording")["reason"].clone()
    };
    let ruled = json(&["exclude", out, "--code", "S002", "--reason", "asked for it"]);
    assert_eq!((ruled.as_array().map(Vec::len), &ruled[0]["excluded"]), (Some(1), &true.into()), "{ruled}");
    assert_eq!((state("S002"), state("S003")), ("excluded: asked for it".into(), "excluded: interrupted".into()));
    let told =
        String::from_utf8_lossy(&check(&["exclude", out, "--code", "S002", "--reason", "x"], 0).stdout).into_owned();
    assert!(told.contains("all recordings of S002 are excluded already"), "{told}");
    check(&["exclude", out, "--code", "S002", "--back"], 0);
    assert_eq!(state("S002"), Value::Null);
    // What was excluded by itself stays so.
    let back = check(&["exclude", out, "--code", "S003", "--back"], 0);
    assert!(String::from_utf8_lossy(&back.stderr).contains("seed7-S003 stays excluded"), "{back:?}");
    assert_eq!(state("S003"), "excluded: interrupted");
    assert!(complaint(&["exclude", out, "--code", "S09", "--reason", "x"]).contains("found no recording of S09"));
    let usage = complaint(&["exclude", &format!("{out}/seed7-S002")]);
    assert!(usage.contains("<--reason <REASON>|--back>"), "{usage}");
    assert!(usage.contains("tip: for example: tomcom exclude sessions/2026-03-14-P07-1 --reason"), "{usage}");
    let usage = complaint(&["correct", &format!("{out}/seed7-S002"), "--code", "P03"]);
    assert!(usage.contains("--code P03 --reason \"the code of the day before\""), "{usage}");
    assert!(complaint(&["list", &format!("{out}/seed7-S001/nothing")]).contains("found no folder of this name"));
}

#[test]
fn a_path_that_is_nearly_right_gets_a_suggestion() {
    let out = folder("nearly");
    fs::create_dir_all(out.join("seed7-S001")).expect("a folder");
    fs::copy("tests/golden/format-3-hand.jsonl", out.join("seed7-S001/events.jsonl")).expect("a recording");
    let out = out.display().to_string();
    let wrong = format!("{out}/seed7-S01");
    let wanted = format!("; did you mean {out}/seed7-S001?");
    for command in [&["replay", &wrong][..], &["replay", &wrong, "--verify"], &["study", &wrong], &["list", &wrong]] {
        let told = complaint(command);
        assert_eq!(told.matches(&wanted).count(), 1, "{command:?}: {told}");
    }
    for command in ["plan", "operate", "power", "simulate"] {
        // A mere name is looked for in sessions/.
        for wrong in ["sessions/studdy.toml", "study.toml"] {
            let told = complaint(&[command, wrong]);
            assert!(told.contains(&format!("{wrong}: cannot be read")), "{told}");
            assert!(told.contains("; did you mean sessions/study.toml?"), "{told}");
        }
    }
    let far = complaint(&["replay", &format!("{out}/another"), "--verify"]);
    assert!(!far.contains("did you mean") && far.contains("cannot be read"), "{far}");
}

#[test]
fn errors_of_a_recording_are_listed_as_commands_that_open_the_viewer_there() {
    let recording = "tests/golden/format-3-hand.jsonl";
    let list = |asked: &[&str]| {
        let output = check(&[&["review", recording][..], asked].concat(), 0);
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    let told = list(&["--errors", "--signals", "--beliefs"]);
    let line =
        |words: &str| told.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{words}: {told}"));
    for words in [", error 1: ", ", error 3: ", ", estimated false belief 1: ", ", signal 1: ", ", note 1: note 1"] {
        let (command, comment) = line(words).split_once("  # to ").expect("a comment");
        assert!(comment.split_once(words.trim_end()).is_some_and(|(until, _)| !until.is_empty()), "{comment}");
        let at = command.strip_prefix(&format!("tomcom review {recording} --at ")).expect("a command");
        // What is printed is taken: the refusal is of --errors beside it.
        assert!(complaint(&["review", recording, "--errors", "--at", at]).contains("--errors"), "{at}");
    }
    assert!(line(", estimated false belief 1: ").contains(": thinks "), "{told}");
    let until = ["a look", "a press of the", "a signal", "the kitchen", "another wrong value", "the trial ended"];
    for line in told.lines().filter(|line| line.contains(", estimated false belief")) {
        let end = line.split_once(" s, until ").map_or("", |(_, end)| end);
        assert!(until.iter().any(|until| end.starts_with(until)) && !line.contains("for 0.0 s"), "{line}");
    }
    // What was believed wrong before an error.
    assert!(
        told.lines()
            .any(|line| line.contains(", error ") && line.contains("; believed wrong before it, by the estimate: ")),
        "{told}"
    );
    // An order has one dish at a time.
    for believed in told.lines().filter_map(|line| line.split_once(", by the estimate: ")) {
        assert!(believed.1.matches("(order 1)").count() <= 1 && !believed.1.contains(" more"), "{believed:?}");
    }
    // The same for programs.
    let listed = json(&["review", recording, "--errors", "--beliefs"]);
    let listed = listed["landmarks"].as_array().expect("landmarks");
    assert!(listed.iter().any(|one| one["kind"] == "error" && one["from_s"].is_f64()), "{listed:?}");
    for one in listed {
        let held = match one["kind"].as_str() {
            Some("error") => &one["believed_wrong"]["estimate"][0],
            _ => one,
        };
        let told = |words: &str| held[words].is_string();
        assert!(held.is_null() || told("aspect") && told("believes") && told("truth"), "{one}");
        assert!(one["kind"] != "error" || one["press"].is_u64() && one["time_s"] == one["from_s"], "{one}");
        assert!(one["kind"] != "error" || one["cause_aspects"] == Value::Array(Vec::new()), "a person's causes: {one}");
    }
    let told = list(&["--errors", "--beliefs"]);
    let words: Vec<&str> = listed.iter().filter_map(|one| one["words"].as_str()).collect();
    assert!(told.lines().zip(&words).all(|(line, words)| line.ends_with(words)), "{told}");
    assert_eq!(words.len(), told.lines().count());
    assert!(complaint(&["review", recording, "--format", "json"]).contains("--errors"));
    let late = complaint(&["review", recording, "--at", "99:00"]);
    assert!(late.contains("found --at 99:00, after the end: the recording is ") && late.contains(", up to "), "{late}");
    // Each option lists its own only.
    let listed = list(&["--errors"]);
    assert!(listed.lines().all(|line| line.contains(", error ")), "{listed}");
    let told = list(&["--signals"]);
    let (notes, signals): (Vec<&str>, Vec<&str>) = told.lines().partition(|line| line.contains(", note "));
    assert!(notes.len() > 30, "{told}");
    for (number, line) in (1..).zip(signals) {
        assert!(line.contains(&format!(", signal {number}: ")) && line.contains("; hit: not known"), "{line}");
    }
    // What is as short as the estimate tells can be left out.
    let least = list(&["--beliefs", "--least", "5"]).lines().count();
    assert!(least < list(&["--beliefs"]).lines().count(), "{least}");
    assert!(complaint(&["review", recording, "--least", "5"]).contains("--beliefs"));
    // A time is the same to the millisecond wherever it is told.
    let replayed = done(&["replay", recording]);
    let told_at = |at: &str| replayed.lines().any(|line| line.trim_start().starts_with(&format!("{at} s  human")));
    for line in listed.lines() {
        let at = line.split_once(" --at ").and_then(|(_, rest)| rest.split_once("  # ")).expect("a command").0;
        let [minutes, seconds, ms] = at.split([':', '.']).collect::<Vec<_>>()[..] else { panic!("{at}") };
        let [minutes, seconds] = [minutes, seconds].map(|number| number.parse::<u32>().expect("a number"));
        assert!(told_at(&format!("{}.{ms}", 60 * minutes + seconds)), "{line}");
    }
    let errors = listed.lines().count() as u64;
    assert_eq!(Value::from(errors), json(&["replay", recording])["errors"]);
}
