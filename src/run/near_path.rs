//! Suggestions for mistyped paths.

use std::fs;
use std::path::{Component, Path, PathBuf};

/// Largest number of wrong letters in a mistyped name for which a path is suggested.
const MOST_EDITS: usize = 2;

/// The existing path that is nearest to a path that does not exist: each missing name is replaced by the most similar
/// existing name. `None` if there is no similar path, or the path exists.
pub fn nearest(path: &Path) -> Option<PathBuf> {
    let mut found = PathBuf::new();
    for part in path.components() {
        let Component::Normal(name) = part else {
            found.push(part);
            continue;
        };
        if found.join(name).exists() {
            found.push(name);
            continue;
        }
        let folder = if found.as_os_str().is_empty() { Path::new(".") } else { found.as_path() };
        let wanted = name.to_string_lossy();
        // At least half of the letters of a name must be right.
        let most = MOST_EDITS.min(wanted.chars().count() / 2);
        let names = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
        let near =
            names.map(|name| (strsim::osa_distance(&wanted, &name), name)).filter(|(edits, _)| *edits <= most).min()?;
        found.push(near.1);
    }
    (found != path).then_some(found)
}
