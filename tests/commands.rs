//! The commands as they are typed: exit codes, what is on stdout, and what is said about wrong files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Runs the program with these arguments and demands the exit code.
fn check(arguments: &[&str], code: i32) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_tomcom")).args(arguments).output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "tomcom {arguments:?}\n{told}");
    output
}

/// The one JSON object on stdout.
fn figures(arguments: &[&str], code: i32) -> Value {
    let output = check(arguments, code);
    serde_json::from_slice(&output.stdout).expect("one JSON object on stdout")
}

/// What is said on stderr about something wrong.
fn complaint(arguments: &[&str]) -> String {
    let output = check(arguments, 2);
    assert!(output.stdout.is_empty(), "{arguments:?} prints something although it is wrong");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("commands").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn kitchen_prints_the_state_space_and_the_plans() {
    let sushi = figures(&["kitchen", "layouts/sushi.toml", "--format", "json"], 0);
    assert_eq!(sushi["states"], "83878450387200000");
    assert_eq!(sushi["aspects"].as_array().map(Vec::len), Some(16));
    let plans = sushi["plans"].as_array().expect("plans");
    let mut lengths: Vec<u64> = plans.iter().filter_map(|plan| plan["actions"].as_u64()).collect();
    lengths.sort_unstable();
    assert_eq!(lengths, [15, 15, 16, 16, 18, 19]);
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = figures(&["kitchen", layout, "--format", "json"], 0);
        for plan in kitchen["plans"].as_array().expect("plans") {
            let presses = plan["presses"].as_array().map(|presses| presses.len() as u64);
            assert_eq!(presses, plan["actions"].as_u64(), "{layout}: {plan}");
        }
        check(&["kitchen", layout], 0);
    }
}

#[test]
fn simulate_records_what_replay_verifies() {
    let out = folder("simulate");
    let out = out.to_str().expect("a path in UTF-8");
    let simulate = ["simulate", "sessions/default.toml", "--trials", "2", "--seed", "7", "--out", out];
    let found = figures(&[&simulate[..], &["--format", "json"]].concat(), 0);
    for key in ["trials", "human_actions", "robot_actions", "errors", "signals", "orders_served", "presses_per_order"] {
        assert!(found[key].is_number(), "{key} in {found}");
    }
    for key in ["belief_related_errors", "sequences", "mean_sequence_length"] {
        assert!(found[key].is_number(), "{key} in {found}");
    }
    let recordings = found["recordings"].as_array().expect("recordings");
    assert_eq!(recordings.len(), 2);
    let mut related = 0;
    for recording in recordings {
        let recording = recording.as_str().expect("a path");
        let verified = figures(&["replay", recording, "--verify", "--format", "json"], 0);
        assert_eq!((&verified["verified"], &verified["cut"]), (&Value::Bool(true), &Value::Bool(false)));
        let replayed = figures(&["replay", recording, "--format", "json"], 0);
        assert_eq!(replayed["events"], verified["events"]);
        related += replayed["belief_related_errors"].as_u64().expect("a number of errors");
        let log = fs::read_to_string(Path::new(recording).join("events.jsonl")).expect("a log");
        let header: Value = serde_json::from_str(log.lines().next().unwrap_or_default()).expect("a header");
        assert_eq!((header.get("started"), &header["session"]["trial"]["condition"]), (None, &Value::from("none")));
    }
    assert_eq!(found["belief_related_errors"].as_u64(), Some(related), "replays find the causes that simulate found");
    let paths: Vec<&str> = recordings.iter().filter_map(Value::as_str).collect();
    let checked = figures(&[&["replay"], &paths[..], &["--check-beliefs", "--format", "json"]].concat(), 0);
    assert_eq!((&checked["recordings"], &checked["human_actions"]), (&Value::from(2), &found["human_actions"]));
    for key in ["auc", "auc_locations", "auc_recipes", "auc_baseline"] {
        assert!(checked[key].as_f64().is_some_and(|area| area > 0.5), "{key} in {checked}");
    }
    assert!(checked["log_likelihood"]["informed"].as_f64() > checked["log_likelihood"]["uniform"].as_f64());
    check(&[&["replay"], &paths[..]].concat(), 2);
    // What was changed does not verify, which is an answer and no wrong argument.
    let log = Path::new(recordings[0].as_str().expect("a path")).join("events.jsonl");
    let text = fs::read_to_string(&log).expect("a log").replacen("take nori", "take rice", 1);
    fs::write(&log, text).expect("the log can be written");
    let log = log.to_str().expect("a path in UTF-8");
    assert_eq!(figures(&["replay", log, "--verify", "--format", "json"], 1)["verified"], Value::Bool(false));
}

#[test]
fn a_simulation_replaces_itself_and_no_other_recording() {
    let out = folder("replaced");
    let out = out.to_str().expect("a path in UTF-8");
    let log = Path::new(out).join("seed7-S001/events.jsonl");
    let simulate = |session: &'static str| ["simulate", session, "--seed", "7", "--out", out];
    check(&simulate("sessions/default.toml"), 0);
    let before = fs::read(&log).expect("a log");
    check(&simulate("sessions/default.toml"), 0);
    assert!(fs::read(&log).expect("a log") == before, "the same session is the same recording");
    let refused = check(&simulate("sessions/burger.toml"), 1);
    let told = String::from_utf8_lossy(&refused.stderr);
    assert!(told.contains("seed7-S001") && told.contains("the recording of another session"), "{told}");
    assert!(fs::read(&log).expect("a log") == before, "what was there is still there");
}

#[test]
fn a_kitchen_takes_no_key_from_the_console() {
    let folder = folder("keys");
    let text = fs::read_to_string("layouts/sushi.toml").expect("the layout");
    let recipes = fs::canonicalize("recipes/sushi.toml").expect("the recipes");
    let text = text.replace("../recipes/sushi.toml", &recipes.display().to_string());
    let cases = [
        ("signal = \"w\"", "signal = \"1\"", "the key \"1\" for \"order_2\", which the console has for"),
        ("signal = \"w\"", "signal = \"Q\"", "for \"order_2\", which \"order_1\" has already"),
        ("key = \"x\"", "key = \"?\"", "the key \"?\" for \"trash\", which the console has for \"this help\""),
    ];
    for (from, to, says) in cases {
        let path = folder.join("layout.toml");
        let wrong = text.replacen(from, to, 1);
        fs::write(&path, &wrong).expect("a file");
        let line = wrong.lines().position(|line| line.contains(to)).expect("the line") + 1;
        let told = complaint(&["kitchen", path.to_str().expect("a path in UTF-8")]);
        assert!(told.contains(&format!("layout.toml:{line}: found ")), "line {line} is not named in\n{told}");
        assert_eq!(told.matches(says).count(), 1, "{says:?} is once in\n{told}");
    }
}

#[test]
fn wrong_files_and_arguments_are_named_with_what_would_be_right() {
    let folder = folder("wrong");
    let session = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.to_str().expect("a path in UTF-8").to_string()
    };
    let sushi = fs::canonicalize("layouts/sushi.toml").expect("the layout");
    let layout = format!("layout = \"{}\"\n", sushi.display());
    let cases = [
        ("no-layout.toml", "seed = 1\n\nlayout = \"nowhere.toml\"\n".to_string(), 3, "nowhere.toml"),
        ("minus.toml", format!("{layout}[robot]\npress_s = -1.0\n"), 3, "a number above 0"),
        ("name.toml", format!("{layout}[participant]\ncode = \"Jane Doe\"\n"), 3, "never a name"),
        ("gaze.toml", format!("{layout}[participant]\nkind = \"keyboard\"\ngaze = \"simulated\"\n"), 4, "mouse"),
        ("unknown.toml", format!("{layout}[trial]\nlength = 3\n"), 3, "unknown field"),
        ("condition.toml", format!("{layout}[trial]\ncondition = \"both\"\n"), 3, "wizard"),
        ("broken.toml", format!("{layout}[trial\n"), 2, "found"),
    ];
    for (name, text, line, says) in cases {
        let told = complaint(&["simulate", &session(name, &text)]);
        assert!(told.contains(&format!("{name}:{line}:")), "{name}:{line} is not named in\n{told}");
        assert!(told.contains(says), "{says:?} is not in\n{told}");
    }
    let keyboard = format!("{layout}[participant]\nkind = \"keyboard\"\ngaze = \"none\"\n");
    assert!(complaint(&["simulate", &session("keyboard.toml", &keyboard)]).contains("simulated"));
    assert!(complaint(&["replay", "nowhere", "--verify"]).contains("nowhere"));
    assert!(complaint(&["replay", "Cargo.toml", "--verify"]).contains("Cargo.toml:1:"));
    assert!(complaint(&["replay", "Cargo.toml"]).contains("no log of a session"));
    assert!(complaint(&["kitchen", "recipes/sushi.toml"]).contains("recipes/sushi.toml:1: found a recipe file"));
    assert!(complaint(&["kitchen", "sessions/default.toml"]).contains("found a session file"));
    assert!(complaint(&["simulate", "layouts/sushi.toml"]).contains("found a layout file"));
    complaint(&["simulate", "sessions/default.toml", "--trials", "0"]);
    complaint(&["dance"]);
}

/// A session of the sushi kitchen with this key file, in a folder of its own; the path of the session file.
fn session_with_keys(name: &str, keys: &str) -> String {
    let folder = folder(name);
    let sushi = fs::canonicalize("layouts/sushi.toml").expect("the layout");
    fs::write(folder.join("keys.toml"), keys).expect("a file");
    let session = folder.join("session.toml");
    fs::write(&session, format!("layout = \"{}\"\n[console]\nkeys = \"keys.toml\"\n", sushi.display()))
        .expect("a file");
    session.to_str().expect("a path in UTF-8").to_string()
}

#[test]
fn the_printed_keys_are_a_key_file_that_changes_nothing_until_it_is_changed() {
    let keys = |session: &str| String::from_utf8_lossy(&check(&["keys", session], 0).stdout).into_owned();
    let printed = keys("sessions/default.toml");
    assert_eq!(keys(&session_with_keys("same-keys", &printed)), printed);
    let changes = [
        ("stop_robot = \"space\"", "stop_robot = [\"space\", \"f12\"]"),
        ("start_pause = \".\"", "start_pause = \"f10\""),
        ("note_5 = \"5\"", "note_5 = []"),
        ("assembly_board = \"a\"  # highlight", "assembly_board = \"5\"  # highlight"),
        ("trash = \"x\"", "trash = \"f9\""),
    ];
    let changed = changes.iter().fold(printed, |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in\n{text}");
        text.replacen(from, to, 1)
    });
    let again = keys(&session_with_keys("other-keys", &changed));
    for (_, to) in changes {
        let (name, keys) = to.split_once(" = ").expect("a line");
        let keys = keys.split("  #").next().unwrap_or(keys);
        let is_it = |line: &str| line.split_once(" = ").is_some_and(|(n, k)| n == name && k.starts_with(keys));
        assert!(again.lines().any(is_it), "{to} is not in\n{again}");
    }
}

#[test]
fn each_wrong_key_file_is_told_with_its_line_and_what_would_be_right() {
    let cases = [
        ("[console]\nstop = \"f1\"\n", 2, "\"stop\", which nothing in [console] is called", "one of stop_robot"),
        ("[signals]\npot = \"p\"\n", 2, "nothing in [signals] is called", "cooking_pot"),
        ("[buttons]\n\n\"take tuna\" = \"t\"\n", 3, "nothing in [buttons] is called", "take salmon"),
        ("[console]\nhelp = \"hyper+x\"\n", 2, "help = \"hyper+x\", which is no key", "f1 to f12"),
        ("[console]\nhelp = \"f13\"\n", 2, "help = \"f13\", which is no key", "f1 to f12"),
        ("[console]\nhelp = \"K\"\n", 2, "a capital counts as its small letter", "a character such as"),
        ("[console]\nhelp = \"ctrl+i\"\n", 2, "which most terminals send as tab", "ctrl+k"),
        ("[console]\nhelp = \"ctrl+1\"\n", 2, "ctrl goes with a letter", "ctrl+k"),
        ("[console]\nhelp = \"\"\n", 2, "help = \"\", which is no key", "a character such as"),
        ("[console]\nhelp = [\"f1\", \"f1\"]\n", 2, "help = \"f1\" twice", "each key once"),
        ("[console]\nhelp = 1\n", 2, "integer `1`", "a key file, as tomcom keys prints it"),
        ("[console]\nquit = \"space\"\n", 2, "which is the robot stop, always", "another key"),
        ("[signals]\norder_1 = \"space\"\n", 2, "which is the robot stop, always", "another key"),
        ("[console]\nstop_robot = \"f1\"\n", 2, "without the space bar", "a list with \"space\""),
        ("[console]\nstop_robot = []\n", 2, "without the space bar", "a list with \"space\""),
        ("[console]\nquit = []\n", 2, "quit = []", "without one nobody gets out"),
        (
            "[console]\nhelp = \"f1\"\nquit = \"f1\"\n",
            3,
            "the key \"f1\" for quit, which is taken by help",
            "another key",
        ),
        ("[console]\nhelp = \"q\"\n", 2, "for help, which is taken by order_1", "order_1 has its own in [signals]"),
        ("[buttons]\ntrash = \"c\"\n", 2, "for trash, which is taken by cut", "cut has its own in [buttons]"),
        ("[replay]\nfaster = \"-\"\n", 2, "for faster, which is taken by slower", "another key"),
        ("[keys]\nhelp = \"f1\"\n", 1, "unknown field `keys`", "as tomcom keys prints it"),
        ("[console]\nhelp = \"f1\"\nhelp = \"f2\"\n", 3, "duplicate key", "as tomcom keys prints it"),
        ("[console\n", 1, "found", "as tomcom keys prints it"),
        ("layout = \"x\"\n", 1, "found a session file", "a key file, as tomcom keys prints it"),
    ];
    let mut told_before: Vec<String> = Vec::new();
    for (index, (text, line, found, remedy)) in cases.into_iter().enumerate() {
        let told = complaint(&["keys", &session_with_keys("wrong-keys", text)]);
        assert!(told.contains(&format!("keys.toml:{line}: found ")), "{index}: line {line} is not named in\n{told}");
        assert!(told.contains(found) && told.contains(remedy), "{index}: {found:?} or {remedy:?} is not in\n{told}");
        assert!(!told_before.contains(&told), "{index}: said before:\n{told}");
        told_before.push(told);
    }
    let session = session_with_keys("no-keys", "");
    fs::remove_file(Path::new(&session).with_file_name("keys.toml")).expect("a file");
    let told = complaint(&["keys", &session]);
    assert!(told.contains("session.toml:3: found keys = \"keys.toml\", which cannot be read"), "{told}");
}

#[test]
fn doctor_looks_at_the_machine_and_says_how_to_mend_it() {
    let out = folder("doctor");
    let found = figures(&["doctor", "--out", &out.join("new").display().to_string(), "--format", "json"], 1);
    let checks = found["checks"].as_array().expect("checks");
    let verdict = |name: &str| {
        checks.iter().find(|check| check["name"] == name).map(|check| check["verdict"].as_str().unwrap_or_default())
    };
    // Through a pipe there is no terminal, which the console needs.
    assert_eq!((&found["healthy"], verdict("terminal")), (&Value::Bool(false), Some("failed")));
    assert_eq!((verdict("recordings"), verdict("wall clock")), (Some("ok"), Some("ok")));
    assert!(fs::read_dir(&out).expect("the folder").next().is_none(), "it leaves nothing behind");
    for check in checks {
        assert_eq!(check["remedy"].is_string(), check["verdict"] != "ok", "{check}");
    }
    let told = check(&["doctor", "--out", "/proc/nowhere"], 1);
    assert!(String::from_utf8_lossy(&told.stdout).contains("FAILED  recordings"), "{told:?}");
}

#[test]
fn completions_and_man_pages_know_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = String::from_utf8_lossy(&check(&["completions", shell], 0).stdout).into_owned();
        assert!(text.contains("simulate") && text.contains("doctor"), "{shell}");
    }
    let page = String::from_utf8_lossy(&check(&["man"], 0).stdout).into_owned();
    assert!(page.contains("tomcom\\-operate") || page.contains("tomcom-operate"), "{page}");
    let page = String::from_utf8_lossy(&check(&["man", "operate"], 0).stdout).into_owned();
    assert!(page.contains("RECORDING") && page.contains(".TH tomcom-operate"), "{page}");
    complaint(&["man", "dance"]);
}

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
    let before = figures(&[&simulate[..], &["--format", "json"]].concat(), 0);
    let recording = format!("{out}/seed7-S001");
    let log = fs::read(format!("{recording}/events.jsonl")).expect("a log");
    let standing = || figures(&["replay", &recording, "--format", "json"], 0)["excluded"].clone();
    assert_eq!(standing(), Value::Null);
    check(&["exclude", &recording, "--reason", "the tracker slipped"], 0);
    assert_eq!(standing(), "the tracker slipped");
    let after = figures(&[&simulate[..], &["--format", "json"]].concat(), 0);
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
    assert!(complaint(&["exclude", out, "--reason", "x"]).contains("cannot be read"));
    fs::write(format!("{recording}/exclusion.toml"), "[[ruling]]\nexcluded = 1\n").expect("written");
    let told = complaint(&["replay", &recording, "--format", "json"]);
    assert!(told.contains("exclusion.toml:2") && told.contains("[[ruling]]"), "{told}");
}
