//! The program `tomcom-research`: each command small, what it refuses, and what the pages show of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use snapbox::Assert;

#[path = "../../../tests/program/docs/markdown.rs"]
#[allow(dead_code, reason = "the program's tests use all of it")]
mod markdown;

use self::markdown::{Block, Page};
use crate::files::{place, read};
use crate::{folder, recorded, session};

const RESEARCH: &str = env!("CARGO_BIN_EXE_tomcom-research");

fn research(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(RESEARCH);
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().expect("tomcom-research runs")
}

/// The one JSON object that it prints with these arguments, in the project's folder.
fn found(arguments: &[&str]) -> Value {
    let output = research(&[arguments, &["--format", "json"]].concat(), &place(""));
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// What it says where it refuses.
fn refused(arguments: &[&str], folder: &Path) -> String {
    let output = research(arguments, folder);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    assert!(output.stdout.is_empty() && !told.contains("panicked"), "{arguments:?}: {told}");
    told
}

/// The recordings of a folder, as the program names them.
fn short_recordings(name: &str) -> (PathBuf, Vec<String>) {
    let mut files = session("default.toml");
    files.spec.seed = 7;
    files.spec.trial.presses = 60;
    (files.spec.assistant.rollout.rollouts, files.spec.assistant.rollout.least_rollouts) = (8, 8);
    let out = folder(name);
    let recordings = recorded(&files, 2, &out);
    (out, recordings.iter().map(|recording| recording.display().to_string()).collect())
}

#[test]
fn each_command_measures_recordings() {
    let (out, recordings) = short_recordings("commands");
    let (all, one) = (out.display().to_string(), recordings[0].as_str());
    let beliefs = found(&["beliefs", &all]);
    assert_eq!((&beliefs["recordings"], &beliefs["participants"]), (&Value::from(2), &Value::from(2)));
    for key in ["auc", "auc_locations", "auc_recipes", "auc_baseline", "auc_recency"] {
        assert!(beliefs[key].as_f64().is_some_and(|area| area > 0.5), "{key} in {beliefs}");
    }
    assert!(beliefs["log_likelihood"]["informed"].as_f64() > beliefs["log_likelihood"]["uniform"].as_f64());
    let planner = found(&["planner", one, "--steps", "4", "--reference-steps", "2"]);
    assert_eq!((&planner["steps"], &planner["reference_steps"]), (&Value::from(4), &Value::from(2)));
    assert!(planner["reference_ratio"].as_f64().is_some_and(|ratio| ratio > 0.0), "{planner}");
    let speed = found(&["speed", one]);
    assert!(speed["gaze_us"]["n"].as_u64() > Some(0) && speed["action_us"]["n"].as_u64() > Some(0), "{speed}");
    // What is summed up counts once, whatever path leads to it; a copy is told.
    let copy = out.join("copy.jsonl");
    fs::copy(Path::new(one).join("events.jsonl"), &copy).expect("copied");
    let copy = copy.display().to_string();
    let alone = found(&["offers", one]);
    assert_eq!(found(&["offers", one, &format!("{one}/events.jsonl")]), alone);
    let twice = research(&["offers", one, &copy, "--format", "json"], &place(""));
    assert_eq!(serde_json::from_slice::<Value>(&twice.stdout).expect("JSON"), alone);
    let told = String::from_utf8_lossy(&twice.stderr).into_owned();
    assert!(told.contains("1 recording is a copy, and is not counted: "), "{told}");
    let told = refused(&["beliefs", one, "--choose-on", &copy], &place(""));
    assert!(told.contains("a recording that is named for two purposes"), "{told}");
    assert!(refused(&["speed", "Cargo.toml"], &place("")).contains("no log of a session"));
}

#[test]
fn a_sweep_and_a_picture_replace_their_own_files_alone() {
    let out = folder("replaced");
    fs::create_dir_all(out.join("grid")).expect("a folder");
    let grid = out.join("grid").display().to_string();
    let picture = out.join("slow.svg").display().to_string();
    let sweep =
        ["sweep", "sessions/burger.toml", "--arm", "timed", "--sweep", "gaze=off", "--concept", "none", "--out", &grid];
    let cohort = ["--cohort", "slow", "--trials", "2", "--arm", "timed", "--picture", &picture];
    let robustness = [&["robustness", "sessions/people/robustness.toml"][..], &cohort].concat();
    for (arguments, file) in [(&sweep[..], "grid/sweep.csv"), (&robustness[..], "slow.svg")] {
        fs::write(out.join(file), "of somebody else\n").expect("written");
        let output = research(arguments, &place(""));
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && told.contains("a file is there that is not"), "{arguments:?}: {told}");
        assert_eq!(fs::read_to_string(out.join(file)).expect("a file"), "of somebody else\n");
        fs::remove_file(out.join(file)).expect("removed");
        assert!(research(arguments, &place("")).status.success(), "{arguments:?}");
        assert!(research(arguments, &place("")).status.success(), "{arguments:?} again");
        assert!(out.join(file).exists());
    }
    let of_concept = ["sweep", "sessions/default.toml", "--concept", "tom", "--sweep", "cost=1", "--out", &grid];
    assert!(refused(&of_concept, &place("")).contains("a setting that only tom-com uses"));
    let seeds = ["robustness", "sessions/people/robustness.toml", "--seed", "1", "--choose-seed", "1"];
    assert!(refused(&seeds, &place("")).contains("another seed than --seed"));
}

#[test]
fn a_calibration_refuses_what_is_no_population() {
    let of = |words: &[&str]| refused(&[&["calibrate"], words].concat(), &place(""));
    assert!(of(&["figures", "sessions/default.toml", "3"]).contains("a session without a plan"));
    assert!(of(&["figures", "sessions/paper.toml", "3", "slips = 0.1"]).contains("slips, which is no parameter"));
    assert!(of(&["each", "sessions/paper.toml", "3", "sessions/default.toml"]).contains("missing field `vector`"));
}

/// Edits that make the battery wrong: what is replaced, by what, how often the new text is there up to the line that the
/// message names, what was found, what would be right.
const WRONG: [(&str, &str, usize, &str, &str); 6] = [
    ("gaze = \"none\"", "gaze = \"mouse\"", 1, "gaze that is not simulated", "gaze = \"simulated\" or \"none\""),
    (
        // In a cohort after others with the same trait.
        "checks = { median = 0.95, sigma = 0.3 }",
        "checks = { median = 1.5, sigma = 0.3 }",
        1,
        "median = 1.5",
        "a number from 0.000001 to 0.999999",
    ),
    ("name = \"slow\"", "name = \"base\"", 2, "name = \"base\"", "a name that no other cohort has"),
    (
        "session = \"../default.toml\"",
        "session = \"default.toml\"",
        1,
        "session = \"default.toml\", which cannot be read",
        "the path of a session file, relative to the battery's file",
    ),
    (
        "thoughtless = { median = 0.1, sigma = 0.4 } ",
        "careless = { median = 0.1, sigma = 0.4 } ",
        1,
        "careless",
        "thoughtless",
    ),
    (
        "",
        "session = \"../default.toml\"\ncohort = []\n",
        1,
        "a battery without cohorts",
        "at least one [[cohort]] with a name",
    ),
];

#[test]
fn a_wrong_battery_is_refused_with_file_line_and_remedy() {
    let right = read("sessions/people/robustness.toml");
    for (replaced, by, nth, says, remedy) in WRONG {
        let folder = pages_folder("battery");
        assert!(right.contains(replaced), "{replaced}");
        let text = if replaced.is_empty() { by.to_string() } else { right.replacen(replaced, by, 1) };
        let first = by.lines().next().expect("a line");
        let lines = (1..).zip(text.lines()).filter(|(_, line)| line.contains(first));
        let line = lines.map(|(line, _)| line).nth(nth - 1).expect("the edited line");
        fs::write(folder.join("sessions/people/robustness.toml"), &text).expect("written");
        let told = refused(&["robustness", "sessions/people/robustness.toml", "--arm", "timed"], &folder);
        let place = format!("robustness.toml:{line}: found ");
        let found = told.lines().find_map(|line| Some(line.split_once(&place)?.1)).unwrap_or_else(|| panic!("{told}"));
        assert!(found.contains(says) && told.contains(remedy), "{told}");
    }
}

/// A folder with the project's settings.
fn pages_folder(name: &str) -> PathBuf {
    let folder = folder(name);
    for from in ["layouts", "recipes", "sessions", "sessions/people"] {
        fs::create_dir_all(folder.join(from)).expect("a folder");
        for entry in fs::read_dir(place(from)).expect("the project's settings") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|kind| kind == "toml") {
                fs::copy(&path, folder.join(from).join(path.file_name().expect("a name"))).expect("copied");
            }
        }
    }
    folder
}

/// The blocks of the pages, each with its place, in which commands of this program stand.
fn blocks() -> Vec<(String, Block)> {
    let docs = fs::read_dir(place("docs")).expect("docs").map(|entry| entry.expect("an entry").path());
    let pages = docs.filter(|path| path.extension().is_some_and(|kind| kind == "md")).map(|path| Page::read(&path));
    let of_page = |page: Page| {
        let place = |block: &Block| format!("{}:{}", page.path.display(), block.line);
        let named: Vec<String> = page.blocks.iter().map(place).collect();
        named
            .into_iter()
            .zip(page.blocks)
            .filter(|(_, block)| block.text.contains("tomcom-research"))
            .collect::<Vec<_>>()
    };
    pages.flat_map(of_page).collect()
}

/// Two recordings of the default session are there, as the page makes them before.
#[test]
fn the_pages_show_what_the_commands_print() {
    let folder = pages_folder("pages");
    let mut files = session("default.toml");
    files.spec.seed = 7;
    recorded(&files, 2, &folder.join("recordings"));
    let mut run = 0;
    for (place, block) in blocks() {
        assert!(block.not_run.is_some(), "{place}: not marked as run by these tests");
        if block.not_run.as_deref() != Some("needs tomcom-research") {
            continue;
        }
        for (command, expected) in block.commands() {
            let words: Vec<&str> = command.split_whitespace().collect();
            let Some(("tomcom-research", arguments)) = words.split_first().map(|(first, rest)| (*first, rest)) else {
                panic!("{place}: {command}")
            };
            let output = research(arguments, &folder);
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{place}: {command}\n{told}");
            let in_snapbox = |line: &str| match line.trim() {
                "…" => "...\n".to_string(),
                _ => format!("{}\n", line.replace('…', "[..]")),
            };
            let expected: String = expected.unwrap_or_default().lines().map(in_snapbox).collect();
            let printed = String::from_utf8_lossy(&output.stdout).into_owned();
            if let Err(differs) = Assert::new().try_eq(Some(&place), printed.into(), expected.into()) {
                panic!("{place}: {command}\n{differs}");
            }
            run += 1;
        }
    }
    assert!(run >= 2, "the pages show {run} commands");
}

#[test]
fn the_pages_name_commands_and_options_that_exist_and_help_names_pages() {
    let help = |command: &str| {
        let output = research(&[command, "--help"], &place(""));
        assert!(output.status.success(), "tomcom-research {command} --help: {output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    for command in ["robustness", "sweep", "beliefs", "planner", "speed", "offers", "calibrate"] {
        let told = help(command);
        let page = told.split_whitespace().find(|word| word.starts_with("docs/")).expect("a page");
        assert!(place(page).exists(), "{command} --help leads to {page}");
    }
    for (place, block) in blocks() {
        for (command, _) in block.commands() {
            let words: Vec<&str> = command.split('#').next().unwrap_or_default().split_whitespace().collect();
            let Some(["tomcom-research", named, rest @ ..]) = words.get(..) else { continue };
            let told = help(named);
            for option in rest.iter().filter(|word| word.starts_with("--")) {
                let is_there = told.split(|c: char| !c.is_alphanumeric() && c != '-').any(|word| word == *option);
                assert!(is_there, "{place}: tomcom-research {named} has no {option}");
            }
        }
    }
}
