//! File of a frozen (preregistered) study plan: one line with the digest, then the frozen content as JSON. The digest
//! is SHA-256 of every byte after the first line, so that it can be checked without this program (`tail -n +2 FILE |
//! sha256sum`).

use std::io::ErrorKind;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::frozen_plan::{FROZEN_FORMAT, FrozenPlan};
use tomcom_session::files::file_error::{FileError, FileResult, read_text};
use tomcom_session::files::replace_file;

/// Text in the first line of a frozen plan's file, before the digest.
const HEAD: &str = "tomcom frozen plan, SHA-256 of all that follows this line: ";
const REMEDY: &str = "a file that tomcom plan PLAN --freeze FILE wrote, unchanged";

/// Writes a frozen plan and returns its digest.
///
/// # Errors
/// A file of that name exists already, or the folder cannot be written to.
pub fn freeze(path: &Path, frozen: &FrozenPlan) -> FileResult<String> {
    // Writing JSON cannot fail here, since a plan contains only string keys and finite numbers.
    let body = serde_json::to_string_pretty(frozen).unwrap_or_default() + "\n";
    let digest = sha256(body.as_bytes());
    let written = replace_file::create(path, format!("{HEAD}{digest}\n{body}").as_bytes());
    written.map_err(|reason| match reason.kind() {
        ErrorKind::AlreadyExists => {
            let remedy = "another name for the file: a frozen plan is never overwritten".to_string();
            FileError::from_finding(path, "a file that is there already".to_string(), remedy)
        }
        _ => FileError::not_written(path, reason, "a new file in a folder that can be written to"),
    })?;
    Ok(digest)
}

/// Reads a frozen plan with its digest.
///
/// # Errors
/// The file cannot be read, is not a frozen plan, or was changed after it was frozen.
pub fn read_frozen(path: &Path) -> FileResult<(String, FrozenPlan)> {
    let text = read_text(path)?;
    let wrong = |place, found: String, remedy: &str| FileError::at(path, &text, Some(place), found, remedy.to_string());
    let first = text.lines().next().unwrap_or_default();
    let (Some(digest), Some((_, body))) = (first.strip_prefix(HEAD), text.split_once('\n')) else {
        return Err(wrong(0..first.len(), "no frozen plan".to_string(), REMEDY));
    };
    let found = sha256(body.as_bytes());
    if found != digest.trim_end() {
        return Err(wrong(
            HEAD.len()..first.len(),
            format!("a file with the SHA-256 {found}: it was changed after the plan was frozen"),
            REMEDY,
        ));
    }
    let frozen: FrozenPlan = serde_json::from_str(body).map_err(|error| {
        let start = text.len() - body.len();
        let before: usize = body.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        wrong(start + before..start + before, error.to_string(), "the version of the program that froze the plan")
    })?;
    if frozen.frozen_plan != FROZEN_FORMAT {
        let found = format!("a frozen plan of format {}", frozen.frozen_plan);
        return Err(wrong(0..first.len(), found, "the version of the program that froze the plan"));
    }
    Ok((digest.trim_end().to_string(), frozen))
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
