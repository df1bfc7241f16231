//! Replaces a small file as a whole: a program that reads the file meanwhile, or after a crash, finds the old content
//! or the new content.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Suffix of the new file's name until the file is renamed.
const NEW: &str = ".new";

/// A file that is being written, and that replaces the old file when it is complete.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    new: PathBuf,
    out: BufWriter<File>,
}

impl Replacement {
    /// Begins a new file beside `path`.
    ///
    /// # Errors
    /// The folder cannot be written to.
    pub fn begin(path: &Path) -> io::Result<Replacement> {
        let mut new = path.as_os_str().to_os_string();
        new.push(NEW);
        let new = PathBuf::from(new);
        Ok(Replacement { path: path.to_path_buf(), out: BufWriter::new(File::create(&new)?), new })
    }

    /// Appends bytes to the new file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)
    }

    /// Writes the new file to the disk and renames it, so that it replaces the old file.
    ///
    /// # Errors
    /// The folder cannot be written to.
    pub fn finish(self) -> io::Result<()> {
        let file = self.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()?;
        fs::rename(&self.new, &self.path)
    }
}

/// Writes the content to a new file beside `path`, and renames it to `path`.
///
/// # Errors
/// The folder cannot be written to.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Replacement::begin(path)?;
    file.write(bytes)?;
    file.finish()
}
