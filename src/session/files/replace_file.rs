//! Writes a small file as a whole: a program that reads the file meanwhile, or after a crash or on a full disk, finds
//! the old content or the new content. New files have names that nobody can know before, and no link is followed.

use std::fs;
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Until it is renamed, a new file is named after the old one, with `WRITER`, `RANDOM` letters and digits, and `NEW`.
const NEW: &str = ".new";
const WRITER: &str = ".tomcom-";
const RANDOM: usize = 6;

/// An empty file beside `path`, which is removed unless it is renamed. All users may read it whom the process's file
/// mode allows to.
pub(crate) fn new_beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = path.file_name().ok_or(ErrorKind::InvalidInput)?.to_os_string();
    prefix.push(WRITER);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(NEW).rand_bytes(RANDOM);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(path.parent().unwrap_or(Path::new("")))
}

/// A file that replaces the old one when it is complete; otherwise nothing of it is left.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    out: BufWriter<NamedTempFile>,
}

impl Replacement {
    /// Begins a new file beside `path`, under a name that no other file has.
    pub fn begin(path: &Path) -> io::Result<Replacement> {
        Ok(Replacement { path: path.to_path_buf(), out: BufWriter::new(new_beside(path)?) })
    }

    /// Path of the file that is replaced.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of the new file until it is renamed.
    pub fn new_path(&self) -> &Path {
        self.out.get_ref().path()
    }

    /// Writes the new file to the disk, with the permissions of the old one.
    pub fn complete(&mut self) -> io::Result<()> {
        self.out.flush()?;
        let file = self.out.get_ref().as_file();
        match fs::metadata(&self.path) {
            Ok(old) => file.set_permissions(old.permissions())?,
            Err(reason) if reason.kind() == ErrorKind::NotFound => {}
            Err(reason) => return Err(reason),
        }
        file.sync_all()
    }

    /// Completes the new file and renames it.
    pub fn finish(mut self) -> io::Result<()> {
        self.complete()?;
        self.out.into_inner()?.persist(&self.path)?;
        Ok(())
    }
}

impl Write for Replacement {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Seek for Replacement {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}

/// Writes the content to a new file beside `path`, and renames it to `path`.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Replacement::begin(path)?;
    file.write_all(bytes)?;
    file.finish()
}

/// As [`replace`], but leaves it to the system when it is on the disk: for files that can be made again.
pub fn put(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = new_beside(path)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// Writes a file that must not exist yet.
pub fn create(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = new_beside(path)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist_noclobber(path)?;
    Ok(())
}

/// Name of the file that a file of this name was to replace; the name itself if no program has left such a file.
pub fn replaced_name(name: &str) -> &str {
    let Some(begun) = name.strip_suffix(NEW) else { return name };
    match begun.rsplit_once(WRITER) {
        Some((replaced, random))
            if random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric()) =>
        {
            replaced
        }
        _ => begun,
    }
}
