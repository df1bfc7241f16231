//! What ARCHITECTURE.md names exists.

use std::path::Path;

fn read(name: &str) -> String {
    std::fs::read_to_string(name).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Paths in backticks that begin with a folder or file of the repository.
#[test]
fn every_path_in_the_architecture_exists() {
    let text = read("ARCHITECTURE.md");
    let roots = ["src/", "tests/", "layouts/", "recipes/", "sessions/", "benches/", "docs/", "examples/", ".ci/"];
    let is_path = |path: &&str| roots.iter().any(|root| path.starts_with(root)) && !path.contains(' ');
    let paths: Vec<&str> = quoted(&text).filter(is_path).collect();
    assert!(!paths.is_empty(), "ARCHITECTURE.md names no path");
    for path in paths.into_iter().flat_map(braced) {
        let is_there = match path.split_once('*') {
            Some((folder, _)) => Path::new(folder.rsplit_once('/').map_or(folder, |(folder, _)| folder)).exists(),
            None => Path::new(path.split(':').next().unwrap_or(&path)).exists(),
        };
        assert!(is_there, "ARCHITECTURE.md names {path}");
    }
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
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
