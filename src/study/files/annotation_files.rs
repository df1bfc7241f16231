//! Files of annotations beside a log, which other programs may have changed since.

use std::path::{Path, PathBuf};

use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;

/// Writes a file of annotations. A file in which the words `untouched` are missing was saved by another program, with what
/// somebody annotated there, and is kept.
pub fn write(path: &Path, text: &str, untouched: &str) -> FileResult<()> {
    let is_own = |head: &[u8]| head.windows(untouched.len()).take(256).any(|part| part == untouched.as_bytes());
    let written = overwrite::check(path, "an export, as it was written,", is_own);
    let written = written.and_then(|()| overwrite::write(path, text.as_bytes()));
    written.map_err(|reason| {
        FileError::not_written(
            path,
            reason,
            "a file that was annotated elsewhere is kept: import its codes, then rename it",
        )
    })
}

/// The folder of a recording as a whole path.
pub fn whole(folder: &Path) -> FileResult<PathBuf> {
    folder.canonicalize().map_err(|reason| FileError::unreadable(folder, reason, "the folder of a recording"))
}
