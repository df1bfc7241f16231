//! The files that the program carries, so that it runs without a checkout, and `tomcom new` writes a lab's folder.

use std::path::Path;

macro_rules! carried {
    ($($path:literal)*) => {
        /// Paths from the lab's folder, with their texts.
        pub const FILES: &[(&str, &str)] = &[$(($path, include_str!(concat!("../../../", $path)))),*];
    };
}

carried! {
    "layouts/burger.toml"
    "layouts/sushi.toml"
    "recipes/burger.toml"
    "recipes/sushi.toml"
    "sessions/all-arms.toml"
    "sessions/arms.toml"
    "sessions/burger.toml"
    "sessions/default.toml"
    "sessions/paper.toml"
    "sessions/people/accepted.toml"
    "sessions/people/robustness.toml"
    "sessions/probes.toml"
    "sessions/questionnaires/acceptance.de.toml"
    "sessions/questionnaires/acceptance.toml"
    "sessions/questionnaires/demographics.de.toml"
    "sessions/questionnaires/demographics.toml"
    "sessions/questionnaires/nasa-tlx.de.toml"
    "sessions/questionnaires/nasa-tlx.toml"
    "sessions/questionnaires/sus.de.toml"
    "sessions/questionnaires/sus.toml"
    "sessions/study.toml"
    "sessions/tutorials/burger.de.toml"
    "sessions/tutorials/burger.toml"
    "sessions/tutorials/sushi.de.toml"
    "sessions/tutorials/sushi.toml"
}

/// The text of a carried file; `None` if there is none with this path.
pub(crate) fn text(path: &Path) -> Option<&'static str> {
    FILES.iter().find(|(carried, _)| Path::new(carried) == path).map(|(_, text)| *text)
}
