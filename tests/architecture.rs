//! What Cargo cannot say about the sources: which rooms of one crate may import which, and what is named only where the outside
//! begins (`src/devices`, `src/run`).

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of the crates that have several, from the ground up; a room imports only from rooms before it.
const ROOMS: [(&str, &[&str]); 2] = [
    ("src/core", &["base", "kitchen", "gaze", "robot", "mind", "measures", "communication"]),
    ("src", &["console", "run", "cli"]),
];
/// What decides nothing by the outside, by time or by chance: the crates below the program, and its rooms that see nothing of the outside.
const PURE: [&str; 8] = ["core", "people", "arm", "session", "study", "devices/sight", "devices/scene", "console"];
/// What reads and writes files among these.
const OF_FILES: [&str; 4] = ["src/session/files", "src/session/log", "src/study/files", "src/study/mcap_export.rs"];
/// Names of the outside, of time and chance that no seed decides, and of orders that are not fixed.
const BANNED: [&str; 20] = [
    "std::fs",
    "std::net",
    "std::env",
    "std::thread",
    "std::process",
    "std::io",
    "SystemTime",
    "Instant::",
    "async ",
    ".await",
    "println!",
    "eprintln!",
    "dbg!",
    "HashMap<",
    "HashMap::",
    "HashSet<",
    "HashSet::",
    "rand::rng",
    "rand::random",
    "rand::seq",
];

/// The source files below a folder, each with its lines of code (without comments).
fn sources(folder: &Path) -> Vec<(PathBuf, Vec<String>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("an entry of the folder").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a source file");
            let code = text.lines().map(|line| line.split("//").next().unwrap_or_default().replace("FxHash", "Fx"));
            found.push((path, code.collect()));
        }
    }
    found
}

#[test]
fn nothing_below_devices_and_run_touches_the_outside() {
    let mut files = 0;
    for (path, lines) in PURE.iter().flat_map(|room| sources(&Path::new("src").join(room))) {
        if OF_FILES.iter().any(|folder| path.starts_with(folder)) {
            continue;
        }
        files += 1;
        for (number, line) in lines.iter().enumerate() {
            let found = BANNED.iter().find(|name| line.contains(**name));
            assert!(found.is_none(), "{}:{}: {found:?}", path.display(), number + 1);
        }
    }
    assert!(files > 100, "only {files} files were read");
}

#[test]
fn rooms_import_one_way() {
    let below = |(folder, rooms): &(&'static str, &'static [&'static str])| {
        let (folder, rooms) = (Path::new(folder), *rooms);
        rooms.iter().enumerate().map(move |(floor, room)| (folder.join(room), &rooms[floor + 1..])).collect::<Vec<_>>()
    };
    for (room, above) in ROOMS.iter().flat_map(below) {
        for (path, lines) in sources(&room) {
            for (number, line) in lines.iter().enumerate() {
                let found = above.iter().find(|other| line.contains(&format!("crate::{other}::")));
                assert!(found.is_none(), "{}:{}: imports {found:?}", path.display(), number + 1);
            }
        }
    }
}

/// Simulated participants plan by themselves: the cost to go defines their errors and drives the assistant.
#[test]
fn simulated_participants_know_neither_cost_to_go_nor_human_model() {
    for (path, lines) in sources(Path::new("src/people/participant")) {
        let found =
            lines.iter().find(|line| ["cost_to_go", "CostToGo", "HumanModel"].iter().any(|name| line.contains(name)));
        assert_eq!(found, None, "{}", path.display());
    }
}

#[test]
fn what_the_architecture_names_exists() {
    let text = fs::read_to_string("ARCHITECTURE.md").expect("ARCHITECTURE.md");
    let paths: Vec<&str> = text.split('`').skip(1).step_by(2).filter(|word| word.starts_with("src/")).collect();
    assert!(paths.len() > 5, "ARCHITECTURE.md names {paths:?}");
    for path in paths.iter().filter(|path| !path.contains(['{', '*', ' '])) {
        assert!(Path::new(path).exists(), "ARCHITECTURE.md names {path}");
    }
}
