//! The house keeps its own rules: who imports whom, what is not named where, and that ARCHITECTURE.md names
//! what exists.

mod documents;
mod imports;
mod outside;
mod sources;

use std::path::Path;

use imports::Imports;
use sources::{Source, room, sources};

/// The rooms from the ground up; a room imports only from rooms of lower floors.
const FLOORS: [&[&str]; 17] = [
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
    &["display"],
    &["console", "study"],
    &["scene"],
    &["edge"],
    &["run"],
    &["cli"],
    &["main", "lib"],
];
/// The first floor that touches the outside.
const EDGE: usize = 13;

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

fn floor_of(source: &Source) -> usize {
    floor(&source.room()).unwrap_or_else(|| panic!("{}: a room without a floor", source.path.display()))
}

#[test]
fn imports_go_one_way() {
    let imports = Imports::read(&sources());
    for source in sources() {
        let own = floor_of(&source);
        for other in imports.named_by(&source.path) {
            let is_fine = room(other) == source.room() || floor(&room(other)).is_some_and(|other| other < own);
            assert!(is_fine, "{} (room {}) imports from {}", source.path.display(), source.room(), other.display());
        }
    }
}

/// Simulated participants plan by themselves: the cost to go defines their errors and drives the assistant.
#[test]
fn simulated_participants_know_no_cost_to_go() {
    for source in sources().iter().filter(|source| source.room() == "participant") {
        let names = ["cost_to_go", "CostToGo"].map(|name| source.text.contains(name));
        assert_eq!(names, [false; 2], "{} names the cost to go", source.path.display());
    }
}

/// Files that import each other in a circle can only be understood, and changed, all at once.
#[test]
fn imports_form_no_circle() {
    let imports = Imports::read(&sources());
    let circles: Vec<String> = imports.circles().iter().map(|circle| told(circle, &imports)).collect();
    assert!(circles.is_empty(), "files import each other in circles:\n{}", circles.join("\n"));
}

/// A circle with the imports that tie it.
fn told(circle: &[&Path], imports: &Imports) -> String {
    let ties = circle.iter().flat_map(|file| {
        let inside = imports.used_by(file).into_iter().filter(|other| circle.contains(other));
        inside.map(|other| format!("  {} -> {}\n", file.display(), other.display())).collect::<Vec<_>>()
    });
    format!("{} files\n{}", circle.len(), ties.collect::<String>())
}
