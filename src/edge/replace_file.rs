//! Replaces a small file as a whole: whoever reads it meanwhile, or after a crash, finds the old content or the new one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Suffix of the file that is written before it takes the name.
const NEW: &str = ".new";

/// Writes a file beside `path` to the disk and gives it that name.
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
