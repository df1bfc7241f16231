//! Wrong files and arguments: each is named with what would be right.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use super::{check, complaint};
use crate::program::{TOMCOM, folder, session_file};

#[test]
fn wrong_files_and_arguments_are_named_with_what_would_be_right() {
    let session = session_file(&folder("wrong"), "[participant]\nkind = \"keyboard\"\ngaze = \"none\"\n");
    assert!(complaint(&["simulate", &session]).contains("simulated"));
    assert!(complaint(&["replay", "nowhere", "--verify"]).contains("nowhere"));
    assert!(complaint(&["replay", "Cargo.toml", "--verify"]).contains("Cargo.toml:1:"));
    assert!(complaint(&["replay", "Cargo.toml"]).contains("no log of a session"));
    assert!(complaint(&["kitchen", "recipes/sushi.toml"]).contains("recipes/sushi.toml:1: found a recipe file"));
    assert!(complaint(&["kitchen", "sessions/default.toml"]).contains("found a session file"));
    assert!(complaint(&["simulate", "layouts/sushi.toml"]).contains("found a layout file"));
    complaint(&["simulate", "sessions/default.toml", "--trials", "0"]);
    complaint(&["simulate", "sessions/default.toml", "--arm", "both"]);
    let told = complaint(&["export", "sessions", "--csv"]);
    assert!(told.contains("tables (CSV) are written by 'tomcom study'") && !told.contains("similar"), "{told}");
    for moment in ["1:60", "-3", "1:2:3", "x", "nan", ":30"] {
        assert!(complaint(&["review", "nowhere", &format!("--at={moment}")]).contains(moment), "{moment}");
    }
    for (word, hint) in [
        ("dance", "'tomcom --help' lists the commands"),
        ("sessions/default.toml", "'tomcom operate sessions/default.toml'"),
        ("nowhere.toml", "'tomcom operate nowhere.toml'"),
        ("tests/golden/format-3-hand.jsonl", "'tomcom replay tests/golden/format-3-hand.jsonl'"),
        ("tests", "'tomcom list tests'"),
        ("repaly", "'replay'"),
        ("operte", "'operate'"),
    ] {
        let told = complaint(&[word]);
        assert!(told.contains(hint), "{word}: {told}");
    }
    for (arguments, right) in [
        (&["power", "nowhere", "--sizes", "10;12"][..], "commas separate the values: --sizes 10,12\n"),
        (&["power", "nowhere", "--sizes", "ten"], "wanted a whole number from 4 to 1000\n"),
        (&["simulate", "nowhere", "--trials=-3"], "wanted a whole number from 1 to 100000\n"),
        (&["power", "nowhere", "--sizes", "12,2"], "wanted a whole number from 4 to 1000\n"),
        (
            &["fit", "nowhere", "--parameters", "tau;half-life"],
            "commas separate the values: --parameters tau,half-life\n",
        ),
        (&["study", "nowhere", "--skip", "concepts events"], "commas separate the values: --skip concepts,events\n"),
        (&["compare", "nowhere", "--with", "tom + dev"], "commas separate the values: --with tom,dev\n"),
    ] {
        let told = complaint(arguments);
        assert!(told.contains(right) && !told.contains("similar value"), "{told}");
    }
    let told = complaint(&["operate", "--listen", "0.0.0.0:50022"]);
    assert!(told.contains("an address without a port, such as 0.0.0.0;") && told.contains("[display]"), "{told}");
    assert!(complaint(&["operate", "--listen", "here"]).contains("an IP address of this computer"));
    assert!(complaint(&["arm"]).contains("--serve"));
    assert!(complaint(&["arm", "--serve", "--listen", "here"]).contains("an IP address of this computer"));
    assert!(complaint(&["arm", "--serve", "--program", "nowhere.script"]).contains("nowhere.script"));
    assert!(complaint(&["arm", "--serve", "--program", "Cargo.toml"]).contains("Cargo.toml: line "));
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
        ("sessions/parameterised.toml", parameterised(&read("sessions/study.toml"))),
        ("sessions/parameters.toml", String::new()),
        ("sessions/study.toml", read("sessions/study.toml")),
        ("sessions/questionnaires/acceptance.toml", read("sessions/questionnaires/acceptance.toml")),
        ("sessions/tutorials/sushi.toml", read("sessions/tutorials/sushi.toml")),
        ("recording/events.jsonl", read("tests/golden/format-3-hand.jsonl")),
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

/// This session with a file of parameters instead of its table of them.
fn parameterised(session: &str) -> String {
    let (before, human) = session.split_once("[human]\n").expect("a table");
    let (_, after) = human.split_once("\n\n").expect("a table after it");
    format!("human_model = \"parameters.toml\"\n{before}{after}")
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
        ("key = \"g\"", "key = \"?\"", "the key \"?\" for \"trash\", which the console has for \"show this help\""),
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

/// A session of the sushi kitchen with this key file, in a folder of its own; the path of the session file.
fn session_with_keys(name: &str, keys: &str) -> String {
    let folder = folder(name);
    fs::write(folder.join("keys.toml"), keys).expect("a file");
    session_file(&folder, "[console]\nkeys = \"keys.toml\"\n")
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
        ("trash = \"g\"", "trash = \"f9\""),
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
fn a_key_file_that_is_not_there_is_told() {
    let session = session_with_keys("no-keys", "");
    fs::remove_file(Path::new(&session).with_file_name("keys.toml")).expect("a file");
    let told = complaint(&["keys", &session]);
    assert!(told.contains("session.toml:3: found keys = \"keys.toml\", which cannot be read"), "{told}");
}
