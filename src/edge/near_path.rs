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
        let near = names.map(|name| (edits(&wanted, &name), name)).filter(|(edits, _)| *edits <= most).min()?;
        found.push(near.1);
    }
    (found != path).then_some(found)
}

/// Number of letters to insert, delete, replace or swap with their neighbour to turn one name into the other (optimal
/// string alignment distance).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let changed = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = changed.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::edits;

    #[test]
    fn edits_are_insertions_deletions_exchanges_and_swaps() {
        for (a, b, number) in [
            ("seed7-S01", "seed7-S001", 1),
            ("sede7", "seed7", 1),
            ("", "ab", 2),
            ("S001", "S002", 1),
            ("abc", "abc", 0),
        ] {
            assert_eq!(edits(a, b), number, "{a} {b}");
            assert_eq!(edits(b, a), number, "{b} {a}");
        }
    }
}
