//! Replaces a small file as a whole: a program that reads it meanwhile, or after a crash, finds the old content or the
//! new one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Suffix of the name of the new file before it is renamed.
const NEW: &str = ".new";

/// Writes the content to a new file beside `path`, and renames it to `path`.
///
/// # Errors
/// The folder cannot be written to.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut name = path.as_os_str().to_os_string();
    name.push(NEW);
    let mut file = File::create(&name)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(&name, path)
}
