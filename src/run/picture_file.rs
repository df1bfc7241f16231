//! Pictures (SVG) that commands write into files of their own.

use std::path::Path;

use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;

/// Checks that a picture can be written to this path. `what` names the picture in messages.
///
/// # Errors
/// There is a file at the path that is no picture of this program.
pub fn check_picture(path: &Path, what: &str) -> FileResult<()> {
    overwrite::check(path, what, |head| head.starts_with(b"<svg "))
        .map_err(|reason| FileError::unwritable(path, reason))
}

/// Writes a picture, given as SVG text.
///
/// # Errors
/// The file cannot be written.
pub fn write_picture(path: &Path, svg: &str) -> FileResult<()> {
    overwrite::write(path, svg.as_bytes()).map_err(|reason| FileError::unwritable(path, reason))
}
