//! Key files, and keys of a kitchen that clash with the console's.

use std::fs;
use std::path::Path;

use super::{check, complaint};
use crate::program::folder;

#[test]
fn a_kitchen_takes_no_key_from_the_console() {
    let folder = folder("keys");
    let text = fs::read_to_string("layouts/sushi.toml").expect("the layout");
    let recipes = fs::canonicalize("recipes/sushi.toml").expect("the recipes");
    let text = text.replace("../recipes/sushi.toml", &recipes.display().to_string());
    let cases = [
        ("signal = \"w\"", "signal = \"1\"", "the key \"1\" for \"order_2\", which the console has for"),
        ("signal = \"w\"", "signal = \"Q\"", "for \"order_2\", which \"order_1\" has already"),
        ("key = \"x\"", "key = \"?\"", "the key \"?\" for \"trash\", which the console has for \"show this help\""),
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
fn a_key_file_that_is_not_there_is_told() {
    let session = session_with_keys("no-keys", "");
    fs::remove_file(Path::new(&session).with_file_name("keys.toml")).expect("a file");
    let told = complaint(&["keys", &session]);
    assert!(told.contains("session.toml:3: found keys = \"keys.toml\", which cannot be read"), "{told}");
}
