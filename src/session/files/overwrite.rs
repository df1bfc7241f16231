//! Check before the program overwrites a file: an existing file is replaced only if this program wrote it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;

use crate::files::replace_file;

/// Number of bytes in which a file's kind is looked for.
const HEAD: u64 = 1 << 16;

/// Whether a file can be written to this path. `is_own` receives the beginning of an existing file and returns whether
/// this program wrote it; `what` names such files in the error. Empty files, pipes and devices contain nothing that
/// could be lost.
pub fn check(path: &Path, what: &str, is_own: impl FnOnce(&[u8]) -> bool) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(data) if data.is_file() => {}
        Ok(_) => return Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    }
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    if head.is_empty() || is_own(&head) {
        return Ok(());
    }
    let found = format!("a file is there that is not {what} of tomcom; choose another name, or delete it first");
    Err(io::Error::new(ErrorKind::AlreadyExists, found))
}

/// Writes a file under a path that the user gave, after [`check`]. The file is replaced when the new content is
/// complete, so that a full disk does not destroy the old one; where a link leads, the file is replaced and the link
/// stays. Pipes and devices are written to.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(data) if data.is_file() => replace_file::replace(&path.canonicalize()?, bytes),
        Ok(_) => OpenOptions::new().write(true).open(path)?.write_all(bytes),
        Err(_) => replace_file::replace(path, bytes),
    }
}

/// Without its line end and without a byte order mark.
pub fn first_line(head: &[u8]) -> &[u8] {
    let line = head.split(|byte| matches!(byte, b'\r' | b'\n')).next().unwrap_or_default();
    line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line)
}
