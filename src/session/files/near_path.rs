//! Suggestions for mistyped paths.

use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::files::carried;
use tomcom_core::base::text;

/// A lab's folder of session files and recordings.
pub const SESSIONS: &str = "sessions";

/// The existing or carried path that is nearest to a path that does not exist: each missing name is replaced by the most
/// similar existing name, and a mere name is also looked for in `sessions/`. `None` if there is no similar path, or the
/// path exists.
fn nearest(path: &Path) -> Option<PathBuf> {
    let in_sessions = || {
        Some(Path::new(SESSIONS).join(path))
            .filter(|there| path.file_name() == Some(path.as_os_str()) && there.exists())
    };
    existing(path).or_else(in_sessions).or_else(|| carried::nearest(path))
}

/// "; did you mean FILE?", with the path from a folder as the user would write it; empty if no path is near.
pub fn did_you_mean(path: &Path, from: &Path) -> String {
    nearest(path)
        .map_or(String::new(), |near| format!("; did you mean {}?", near.strip_prefix(from).unwrap_or(&near).display()))
}

fn existing(path: &Path) -> Option<PathBuf> {
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
        let names = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
        found.push(text::nearest(&wanted, names)?);
    }
    (found != path).then_some(found)
}
