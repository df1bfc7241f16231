//! The house keeps its own rules: who imports whom, what is not named where, how long a file is.

mod imports;
mod names;

use std::path::{Path, PathBuf};

use imports::Imports;

/// The rooms from the ground up; a room imports only from rooms of lower floors.
const FLOORS: [&[&str]; 16] = [
    &["base"],
    &["kitchen"],
    &["robot", "gaze"],
    &["mind"],
    &["measures"],
    &["communication"],
    &["participant", "wizard", "arm"],
    &["session"],
    &["history"],
    &["analysis"],
    &["console", "study", "display"],
    &["scene"],
    &["edge"],
    &["run"],
    &["cli"],
    &["main", "lib"],
];
/// The first floor that touches the outside.
const EDGE: usize = 12;
/// Files stay under about 400 lines.
const MAX_LINES: usize = 420;

/// Rooms in which circles of files still stand, with the number of files in them. The numbers only go down, to none.
const FILES_IN_CIRCLES: [(&str, usize); 1] = [("edge", 3)];

/// Names that stand for the outside, for time or chance that no seed decides, or for an order that is not fixed.
const BANNED_BELOW_EDGE: [&str; 20] = [
    "std::fs",
    "std::net",
    "std::env",
    "std::thread",
    "std::process",
    "std::io",
    "SystemTime",
    "Instant",
    "async ",
    "await",
    "println!",
    "eprintln!",
    "print!(",
    "dbg!",
    "HashMap",
    "HashSet",
    "rand::rng(",
    "rand::random",
    "thread_rng",
    "static mut",
];

/// Crates that only some rooms may name; a file name stands for that file alone.
const ONLY_IN: [(&str, &[&str]); 14] = [
    ("ratatui", &["src/console", "src/edge"]),
    ("crossterm", &["src/console", "src/edge"]),
    ("tokio", &["src/edge", "src/run", "src/main.rs", "src/cli.rs"]),
    ("re_sdk", &["src/edge/rerun.rs", "src/edge/rerun"]),
    ("re_sdk_types", &["src/edge/rerun.rs", "src/edge/rerun"]),
    ("re_protos", &["src/edge/rerun"]),
    ("tonic", &["src/edge/rerun"]),
    ("tonic_web", &["src/edge/rerun"]),
    ("tower_layer", &["src/edge/rerun"]),
    ("zeromq", &["src/edge"]),
    ("nalgebra", &["src/arm", "src/scene", "src/edge/rerun.rs"]),
    ("urdf_rs", &["src/arm"]),
    ("rapier3d", &["src/arm"]),
    ("maud", &["src/study"]),
];

struct Source {
    path: PathBuf,
    room: String,
    /// The text without comments.
    code: String,
    lines: usize,
}

impl Source {
    fn floor(&self) -> usize {
        floor(&self.room).unwrap_or_else(|| panic!("{}: a room without a floor", self.path.display()))
    }
}

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

fn sources() -> Vec<Source> {
    let mut paths = Vec::new();
    collect(Path::new("src"), &mut paths);
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a source file");
        let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or("")).collect();
        Source { room: room(&path), code: code.join("\n"), lines: text.lines().count(), path }
    };
    paths.into_iter().map(read).collect()
}

fn collect(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => collect(&path, into),
            false if path.extension().is_some_and(|extension| extension == "rs") => into.push(path),
            false => {}
        }
    }
}

fn room(path: &Path) -> String {
    path.components().nth(1).expect("below src").as_os_str().to_string_lossy().replace(".rs", "")
}

fn imports() -> Imports {
    let files: Vec<PathBuf> = sources().into_iter().map(|source| source.path).collect();
    Imports::read(&files)
}

#[test]
fn imports_go_one_way() {
    let imports = imports();
    for source in sources() {
        let own = source.floor();
        for other in imports.named_by(&source.path) {
            let is_fine = room(other) == source.room || floor(&room(other)).is_some_and(|other| other < own);
            assert!(is_fine, "{} (room {}) imports from {}", source.path.display(), source.room, other.display());
        }
    }
}

/// Files that import each other in a circle can only be understood, and changed, all at once.
#[test]
fn imports_form_no_new_circle() {
    let imports = imports();
    let circles = imports.circles();
    for (name, known) in FILES_IN_CIRCLES {
        let here: Vec<&Vec<&Path>> = circles.iter().filter(|circle| room(circle[0]) == name).collect();
        let files: usize = here.iter().map(|circle| circle.len()).sum();
        let told: Vec<String> = here.iter().map(|circle| told(circle, &imports)).collect();
        assert!(files <= known, "{files} files of {name} stand in circles, {known} did:\n{}", told.join("\n"));
    }
    let known = |circle: &&Vec<&Path>| FILES_IN_CIRCLES.iter().any(|(name, _)| room(circle[0]) == *name);
    let new: Vec<String> =
        circles.iter().filter(|circle| !known(circle)).map(|circle| told(circle, &imports)).collect();
    assert!(new.is_empty(), "files import each other in circles:\n{}", new.join("\n"));
}

/// A circle with the imports that tie it.
fn told(circle: &[&Path], imports: &Imports) -> String {
    let ties = circle.iter().flat_map(|file| {
        let inside = imports.used_by(file).into_iter().filter(|other| circle.contains(other));
        inside.map(|other| format!("  {} -> {}\n", file.display(), other.display())).collect::<Vec<_>>()
    });
    format!("{} files\n{}", circle.len(), ties.collect::<String>())
}

#[test]
fn nothing_left_of_the_edge_touches_the_outside() {
    for source in sources().iter().filter(|source| source.floor() < EDGE) {
        for name in BANNED_BELOW_EDGE {
            // The maps of rustc-hash have no random seed: their order is the same in every run.
            let at = source.code.lines().position(|line| line.replace("FxHashMap", "").contains(name));
            assert!(at.is_none(), "{}:{}: {name}", source.path.display(), at.unwrap_or_default() + 1);
        }
    }
}

#[test]
fn outside_crates_are_named_only_where_they_belong() {
    for source in sources() {
        for (name, places) in ONLY_IN {
            let is_allowed = places.iter().any(|place| source.path.starts_with(place));
            // A path of our own (`crate::edge::rerun::…`) names a module, not the crate.
            let ours = source.code.matches(&format!("::{name}::")).count();
            let paths = source.code.matches(&format!("{name}::")).count();
            let is_foreign = paths > ours || source.code.contains(&format!("use {name}"));
            assert!(is_allowed || !is_foreign, "{} names {name}", source.path.display());
        }
    }
}

/// A clock that can be set is no measure of time: what has to be measured is measured with the monotonic one.
#[test]
fn the_wall_clock_is_named_in_one_file() {
    for source in sources() {
        let is_clock = source.path == Path::new("src/edge/clock.rs");
        assert!(is_clock || !source.code.contains("SystemTime"), "{}", source.path.display());
    }
}

#[test]
fn files_stay_short() {
    for source in sources() {
        assert!(source.lines <= MAX_LINES, "{}: {} lines", source.path.display(), source.lines);
    }
}

#[test]
fn test_files_stay_short() {
    let mut paths = Vec::new();
    ["tests", "benches", "examples"].iter().for_each(|folder| collect(Path::new(folder), &mut paths));
    for path in paths.iter().filter(|path| !path.starts_with("tests/fuzz")) {
        let lines = std::fs::read_to_string(path).expect("a source file").lines().count();
        assert!(lines <= MAX_LINES, "{}: {lines} lines: split it by theme", path.display());
    }
}

/// Tests that run the program share terminals, ports and a disk with each other.
#[test]
fn tests_of_the_program_run_one_after_another() {
    let mut paths = Vec::new();
    collect(Path::new("tests/program"), &mut paths);
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("a source file");
        let (tests, serial) = (text.matches("#[test]\n").count(), text.matches("#[test]\n#[serial]\n").count());
        assert_eq!(tests, serial, "{}: a test is not #[serial]", path.display());
    }
}

/// Paths in backticks that begin with a folder or file of the repository.
#[test]
fn every_path_in_the_architecture_exists() {
    let text = std::fs::read_to_string("ARCHITECTURE.md").expect("ARCHITECTURE.md");
    let roots = ["src/", "tests/", "layouts/", "recipes/", "sessions/", "benches/", ".ci/"];
    let quoted = text.split('`').skip(1).step_by(2);
    for path in quoted.filter(|path| roots.iter().any(|root| path.starts_with(root)) && !path.contains(' ')) {
        for path in braced(path) {
            let is_there = match path.split_once('*') {
                Some((folder, _)) => Path::new(folder.rsplit_once('/').map_or(folder, |(folder, _)| folder)).exists(),
                None => Path::new(path.split(':').next().unwrap_or(&path)).exists(),
            };
            assert!(is_there, "ARCHITECTURE.md names {path}");
        }
    }
}

/// `src/{a,b}` stands for `src/a` and `src/b`.
fn braced(path: &str) -> Vec<String> {
    match (path.split_once('{'), path.split_once('}')) {
        (Some((before, rest)), Some((_, after))) => {
            let list = rest.split('}').next().unwrap_or_default();
            list.split(',').map(|name| format!("{before}{}{after}", name.trim())).collect()
        }
        _ => vec![path.to_string()],
    }
}
