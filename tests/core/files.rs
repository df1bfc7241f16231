//! The repository's files. The tests of a member run in the member's folder; paths here start at the top.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::files::LayoutSpec;

/// Where a file or folder of the repository is.
pub fn place(path: impl AsRef<Path>) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

pub fn read(path: impl AsRef<Path>) -> String {
    let path = place(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The kitchen of a layout file.
pub fn load(layout: impl AsRef<Path>) -> Kitchen {
    let layout = layout.as_ref();
    let text = read(layout);
    let spec: LayoutSpec = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", layout.display()));
    let recipes = read(layout.with_file_name(spec.recipes.get_ref()));
    Kitchen::from_toml(&text, &recipes).unwrap_or_else(|error| panic!("{}: {error}", layout.display()))
}

/// The kitchen of one of the layouts in `layouts`.
pub fn kitchen(name: &str) -> Arc<Kitchen> {
    Arc::new(load(format!("layouts/{name}.toml")))
}
