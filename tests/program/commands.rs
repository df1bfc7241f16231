//! The commands as they are typed: exit codes, what is on stdout, and what is said about wrong files.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde::Deserialize;
use serde_json::Value;
use serial_test::serial;

use crate::tmux::TOMCOM;

/// Runs the program with these arguments and demands the exit code.
fn check(arguments: &[&str], code: i32) -> Output {
    let output = Command::new(TOMCOM).args(arguments).output().expect("the program starts");
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
#[serial]
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
#[serial]
fn simulate_records_what_replay_verifies() {
    let out = folder("simulate");
    let out = out.to_str().expect("a path in UTF-8");
    let simulate =
        ["simulate", "sessions/default.toml", "--trials", "2", "--seed", "7", "--arm", "timed", "--out", out];
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
#[serial]
fn a_simulation_replaces_itself_and_no_other_recording() {
    let out = folder("replaced");
    let out = out.to_str().expect("a path in UTF-8");
    let log = Path::new(out).join("seed7-S001/events.jsonl");
    let simulate = |session: &'static str| ["simulate", session, "--seed", "7", "--arm", "timed", "--out", out];
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
#[serial]
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
#[serial]
fn wrong_files_and_arguments_are_named_with_what_would_be_right() {
    let session = folder("wrong").join("keyboard.toml");
    let sushi = fs::canonicalize("layouts/sushi.toml").expect("the layout");
    let keyboard = "[participant]\nkind = \"keyboard\"\ngaze = \"none\"\n";
    fs::write(&session, format!("layout = \"{}\"\n{keyboard}", sushi.display())).expect("a file");
    assert!(complaint(&["simulate", &session.display().to_string()]).contains("simulated"));
    assert!(complaint(&["replay", "nowhere", "--verify"]).contains("nowhere"));
    assert!(complaint(&["replay", "Cargo.toml", "--verify"]).contains("Cargo.toml:1:"));
    assert!(complaint(&["replay", "Cargo.toml"]).contains("no log of a session"));
    assert!(complaint(&["kitchen", "recipes/sushi.toml"]).contains("recipes/sushi.toml:1: found a recipe file"));
    assert!(complaint(&["kitchen", "sessions/default.toml"]).contains("found a session file"));
    assert!(complaint(&["simulate", "layouts/sushi.toml"]).contains("found a layout file"));
    complaint(&["simulate", "sessions/default.toml", "--trials", "0"]);
    complaint(&["simulate", "sessions/default.toml", "--arm", "both"]);
    complaint(&["dance"]);
}

/// An edit of a file that makes it wrong, or a wrong file, and the message that it has to give.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bad {
    /// What kind of file it is.
    file: String,
    replace: Option<String>,
    with: Option<String>,
    text: Option<String>,
    /// Where the message points: the line with this text, the `nth` one; the whole file without it.
    at: Option<String>,
    nth: Option<usize>,
    found: String,
    remedy: String,
}

#[test]
#[serial]
fn each_bad_file_has_its_own_message_with_file_line_and_remedy() {
    let mut paths: Vec<PathBuf> =
        fs::read_dir("tests/bad").expect("tests/bad").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let mut messages: Vec<String> = Vec::new();
    for path in &paths {
        let text = fs::read_to_string(path).expect("a case");
        let bad: Bad = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let name = path.file_stem().expect("a name").to_string_lossy();
        assert!(name.starts_with(&format!("{}-", bad.file)), "{name} is not named after its kind");
        let message = told_about(&name, &bad);
        assert!(!messages.contains(&message), "{name}: said before: {message}");
        messages.push(message);
    }
    let of_kind = |kind: &str| {
        let names = paths.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy());
        names.filter(|name| name.starts_with(kind)).count()
    };
    let kinds = ["layout", "recipes", "session", "plan", "keys", "parameters", "questionnaire", "log"];
    let counts: Vec<String> = kinds.iter().map(|kind| format!("{} {kind}", of_kind(kind))).collect();
    assert!(kinds.iter().all(|kind| of_kind(kind) >= 5), "{counts:?}");
    println!("{} bad files, each with its own message: {}", messages.len(), counts.join(", "));
}

/// The message of the program about such a file among others that are right: what was found, and what would be right.
fn told_about(name: &str, bad: &Bad) -> String {
    let folder = folder(&format!("bad/{name}"));
    let (file, command): (&str, &[&str]) = match bad.file.as_str() {
        "layout" => ("layouts/sushi.toml", &["kitchen", "layouts/sushi.toml"]),
        "recipes" => ("recipes/sushi.toml", &["kitchen", "layouts/sushi.toml"]),
        "session" => ("sessions/default.toml", &["keys", "sessions/default.toml"]),
        "plan" => ("sessions/study.toml", &["plan", "sessions/study.toml"]),
        "keys" => ("sessions/keys.toml", &["keys", "sessions/default.toml"]),
        "parameters" => ("sessions/parameters.toml", &["keys", "sessions/parameterised.toml"]),
        "questionnaire" => ("sessions/questionnaires/acceptance.toml", &["plan", "sessions/study.toml"]),
        "log" => ("recording/events.jsonl", &["replay", "recording", "--format", "json"]),
        other => panic!("{name}: the kind {other}"),
    };
    let session = fs::read_to_string("sessions/default.toml").expect("the default session");
    let with_keys = session.replacen("# keys = ", "keys = ", 1);
    assert_ne!(session, with_keys, "the default session shows how a key file is named");
    let read = |path: &str| fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let files = [
        ("layouts/sushi.toml", read("layouts/sushi.toml")),
        ("recipes/sushi.toml", read("recipes/sushi.toml")),
        ("sessions/default.toml", with_keys),
        ("sessions/keys.toml", String::new()),
        ("sessions/parameterised.toml", format!("human_model = \"parameters.toml\"\n{}", read("sessions/study.toml"))),
        ("sessions/parameters.toml", String::new()),
        ("sessions/study.toml", read("sessions/study.toml")),
        ("sessions/questionnaires/acceptance.toml", read("sessions/questionnaires/acceptance.toml")),
        ("recording/events.jsonl", read("tests/golden/format-1-hand.jsonl")),
    ];
    let mut edited = String::new();
    for (path, text) in files {
        let text = if path == file { edit(name, bad, &text) } else { text };
        fs::create_dir_all(folder.join(path).parent().expect("a folder")).expect("a folder");
        fs::write(folder.join(path), &text).expect("a file");
        edited = if path == file { text } else { edited };
    }
    let lines = || edited.lines().enumerate();
    let line = bad.at.as_ref().map_or(1, |at| {
        let found = lines().filter(|(_, line)| line.contains(at.as_str())).nth(bad.nth.unwrap_or(1) - 1);
        found.map_or_else(|| panic!("{name}: no line with {at}"), |(index, _)| index + 1)
    });
    let mut program = Command::new(TOMCOM);
    let output = program.args(command).current_dir(&folder).output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{name}: {told}");
    assert!(output.stdout.is_empty() && !told.contains("panicked"), "{name}: {told}");
    let said = |text: &str| told.lines().find_map(|line| Some(line.split_once(text)?.1.to_string()));
    let found = said(&format!("{file}:{line}: found ")).unwrap_or_else(|| panic!("{name}: not of line {line}: {told}"));
    let remedy = said("  help: ").unwrap_or_else(|| panic!("{name}: no remedy: {told}"));
    assert!(!bad.found.is_empty() && found.contains(&bad.found), "{name}: found {found}");
    assert!(!bad.remedy.is_empty() && remedy.contains(&bad.remedy), "{name}: remedy {remedy}");
    format!("{found}; {remedy}")
}

/// The wrong text of a file that was right.
fn edit(name: &str, bad: &Bad, right: &str) -> String {
    match (&bad.replace, &bad.with, &bad.text) {
        (Some(replace), Some(with), None) => {
            assert!(right.contains(replace.as_str()), "{name}: nothing to replace");
            right.replacen(replace.as_str(), with, 1)
        }
        (None, None, Some(text)) => text.clone(),
        _ => panic!("{name}: either an edit or a text"),
    }
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
#[serial]
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
#[serial]
fn a_key_file_that_is_not_there_is_told() {
    let session = session_with_keys("no-keys", "");
    fs::remove_file(Path::new(&session).with_file_name("keys.toml")).expect("a file");
    let told = complaint(&["keys", &session]);
    assert!(told.contains("session.toml:3: found keys = \"keys.toml\", which cannot be read"), "{told}");
}

#[test]
#[serial]
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
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("FAILED  recordings        /proc/nowhere is not there yet, and /proc"), "{told}");
    assert!(!told.contains("free space"), "where there is no disk, none of it is free:\n{told}");
}

#[test]
#[serial]
fn doctor_looks_at_what_a_session_names() {
    let layout = Path::new(env!("CARGO_MANIFEST_DIR")).join("layouts/sushi.toml");
    let session = folder("doctor-session").join("session.toml");
    let taken = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = taken.local_addr().expect("an address").port();
    let session_path = session.to_str().expect("a path in UTF-8");
    let verdict = |settings: &str, name: &str| {
        fs::write(&session, format!("layout = \"{}\"\n{settings}", layout.display())).expect("a session file");
        let found = figures(&["doctor", session_path, "--format", "json"], 1);
        let check = found["checks"].as_array().and_then(|checks| checks.iter().find(|check| check["name"] == name));
        let told = |key: &str| check.and_then(|check| check[key].as_str()).unwrap_or_default().to_string();
        (told("verdict"), told("found"))
    };
    for (kind, gaze, expected) in [("simulated", "simulated", "warning"), ("display", "mouse", "failed")] {
        let page = format!("[participant]\nkind = \"{kind}\"\ngaze = \"{gaze}\"\n[display]\nport = {port}\n");
        let (found, words) = verdict(&page, "wall display");
        assert_eq!((found.as_str(), words.contains(&port.to_string())), (expected, true), "{kind}: {words}");
    }
    let (found, words) = verdict(&format!("[participant]\ngaze = \"json\"\ngaze_port = {port}\n"), "gaze");
    assert_eq!((found.as_str(), words.contains(&port.to_string())), ("failed", true), "{words}");
    let nobody = "[participant]\ngaze = \"pupil\"\n[tracker]\nport = 1\n";
    let (found, words) = verdict(nobody, "eye tracker");
    assert_eq!((found.as_str(), words.contains("127.0.0.1:1")), ("failed", true), "{words}");
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pupil/gaze_positions_on_surface_wall.csv");
    for (file, expected) in [(surface.as_path(), "ok"), (Path::new("nowhere.csv"), "failed")] {
        let settings = format!("[participant]\ngaze = \"file\"\n[tracker]\nfile = \"{}\"\n", file.display());
        let (found, words) = verdict(&settings, "gaze");
        assert_eq!(found, expected, "{words}");
    }
    assert!(complaint(&["doctor", "sessions/nowhere.toml"]).contains("sessions/nowhere.toml"));
}

#[test]
#[serial]
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
#[serial]
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

#[test]
#[serial]
fn compare_sets_assistants_beside_what_was_sent_and_opens_what_differs() {
    let out = folder("compare");
    let session = out.join("short.toml");
    let layout = Path::new(env!("CARGO_MANIFEST_DIR")).join("layouts/sushi.toml");
    let text = format!(
        "layout = \"{}\"\n[trial]\nseconds = 60.0\n[assistant]\nconcept = \"tom\"\n[human.inference]\nbeliefs = 32\nstates = 8\n",
        layout.display()
    );
    fs::write(&session, text).expect("a session file");
    let [session, out] = [&session, &out].map(|path| path.to_str().expect("a path in UTF-8"));
    let arguments =
        ["simulate", session, "--trials", "2", "--condition", "assistant", "--out", out, "--format", "json"];
    let recordings = figures(&arguments, 0);
    let recordings: Vec<&str> =
        recordings["recordings"].as_array().expect("recordings").iter().filter_map(Value::as_str).collect();
    let found = figures(&[&["compare"], &recordings[..], &["--with", "dev", "--format", "json"]].concat(), 0);
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
    let only = figures(&["compare", recordings[0], "--only", "dev", "--format", "json"], 0);
    let only_pairs = only["pairs"].as_array().expect("pairs");
    assert_eq!(only_pairs.len(), 1, "{only_pairs:?}");
    assert_eq!((&only_pairs[0]["of"], &only_pairs[0]["with"]), (&pairs[1]["of"], &pairs[1]["with"]));
    let about_dev = |difference: &&Value| ["by", "not_by"].iter().all(|key| difference[key] != "tom");
    let expected: Vec<&Value> = differences.iter().filter(about_dev).collect();
    let found: Vec<&Value> = only["recordings"][0]["differences"].as_array().expect("differences").iter().collect();
    assert!(!found.is_empty() && found.len() < differences.len(), "{} of {}", found.len(), differences.len());
    assert_eq!(found, expected, "with the numbers that they have among all");
    let opened = check(&["compare", recordings[0], "--with", "dev", "--open", "1"], 0);
    let opened = String::from_utf8_lossy(&opened.stdout).into_owned();
    for told in ["not said by", "believed wrong, by the estimate", "truly: ", "on the wizard's screen: "] {
        assert!(opened.contains(told), "{told} in\n{opened}");
    }
    assert!(complaint(&["compare", recordings[0], "--open", "999"]).contains("of the list of differences"));
    assert!(complaint(&["compare", recordings[0], "--seed", "3"]).contains("--seed, with recordings"));
    assert!(complaint(&["compare", session, "--open", "1"]).contains("--open, with a session"));
    assert!(complaint(&["compare", session, "--only", "tom"]).contains("--only, with a session"));
    assert!(complaint(&["compare", "tests/golden"]).contains("events.jsonl"));
    // What is summed up counts once, whatever path leads to it.
    let [one, same] = ["tests/golden/format-1-hand.jsonl", "tests/../tests/golden/format-1-hand.jsonl"];
    for command in [&["compare"][..], &["fit"], &["replay", "--check-beliefs"], &["replay", "--accuracy"]] {
        assert!(complaint(&[command, &[one, same]].concat()).contains("the same recording twice"), "{command:?}");
    }
    let swept = figures(&["compare", recordings[0], "--sweep", "--format", "json"], 0);
    let swept: Vec<u64> =
        swept["pairs"].as_array().expect("pairs").iter().filter_map(|pair| pair["window_actions"].as_u64()).collect();
    assert_eq!(swept, (0..=10).collect::<Vec<u64>>());
}

/// Few presses, thought about little: what the commands print is looked at here, not how good it is.
const QUICK: &str = "[trial]
condition = \"none\"
presses = 30
[assistant.rollout]
horizon = 2
rollouts = 4
states = 2
least_rollouts = 2
";

#[test]
#[serial]
fn simulate_tells_what_holds_at_the_console_alone() {
    let folder = folder("unused");
    let path = |name: &str| folder.join(name).to_str().expect("a path in UTF-8").to_string();
    let [session, out] = ["session.toml", "out"].map(path);
    let layout = fs::canonicalize("layouts/sushi.toml").expect("the layout is there");
    let acting =
        QUICK.replace("\"none\"", "\"assistant\"").replace("[assistant.", "[assistant]\nshadow = \"on\"\n[assistant.");
    fs::write(&session, format!("layout = {layout:?}\n{acting}")).expect("the session can be written");
    let told = |arguments: &[&str]| {
        let output = check(&[&["simulate", &session, "--out", &out], arguments].concat(), 0);
        let told = String::from_utf8_lossy(&output.stderr);
        ["by --condition assistant", "by --shadow"].map(|option| told.contains(option))
    };
    assert_eq!(told(&[]), [true, true]);
    assert_eq!(told(&["--shadow", "--seed", "2"]), [true, false]);
    assert_eq!(told(&["--condition", "assistant", "--seed", "3"]), [false, true]);
}

#[test]
#[serial]
fn fit_writes_a_parameter_file_and_accuracy_tells_its_figures() {
    let folder = folder("fit");
    let path = |name: &str| folder.join(name).to_str().expect("a path in UTF-8").to_string();
    let [session, start, out, fitted] = ["session.toml", "start.toml", "out", "fitted.toml"].map(path);
    let layout = fs::canonicalize("layouts/sushi.toml").expect("the layout is there");
    let layout = layout.to_str().expect("a path in UTF-8");
    fs::write(&session, format!("layout = {layout:?}\n{QUICK}")).expect("the session can be written");
    let few = "[inference]\nbeliefs = 8\nstates = 4\nmax_beliefs = 8\npredictions = 4\n";
    fs::write(&start, few).expect("the parameters can be written");
    let simulated = figures(&["simulate", &session, "--out", &out, "--format", "json"], 0);
    let recording = simulated["recordings"][0].as_str().expect("a recording");
    let fit = ["fit", recording, "--start", &start, "--tries", "10", "--out", &fitted, "--format", "json"];
    let found = figures(&[&fit[..], &["--parameters", "tau,lapse"]].concat(), 0);
    assert_eq!(found["human_actions"], simulated["human_actions"]);
    let names: Vec<&str> =
        found["parameters"].as_array().expect("parameters").iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["tau", "lapse"]);
    // What was fitted is in force where a session names the file.
    fs::write(&session, format!("layout = {layout:?}\nhuman_model = {fitted:?}\n{QUICK}"))
        .expect("the session can be written");
    let again = figures(&["simulate", &session, "--out", &out, "--seed", "5", "--format", "json"], 0);
    let log = Path::new(again["recordings"][0].as_str().expect("a recording")).join("events.jsonl");
    let log = fs::read_to_string(log).expect("a log");
    let header: Value = serde_json::from_str(log.lines().next().unwrap_or_default()).expect("a header");
    let [in_force, fitted_tau] = [&header["session"]["human"]["decision"]["tau"], &found["parameters"][0]["value"]];
    assert!((in_force.as_f64().expect("a number") - fitted_tau.as_f64().expect("a number")).abs() < 1e-9);
    let accuracy = ["replay", recording, "--accuracy", "--steps", "6", "--reference-steps", "2", "--format", "json"];
    let found = figures(&accuracy, 0);
    assert_eq!((&found["steps"], &found["reference_steps"]), (&Value::from(6), &Value::from(2)));
    assert!(found["reference_ratio"].as_f64().is_some_and(|ratio| ratio > 0.0), "{found}");
    for key in ["same_decision", "benefit_rmse"] {
        assert!(found.get(key).is_some(), "{key} in {found}");
    }
    assert!(complaint(&["fit", &session]).contains("events.jsonl"));
}
