//! Writes a small file as a whole: a program that reads the file meanwhile, or after a crash or on a full disk, finds
//! the old content or the new content. New files have names that nobody can know before, and no link is followed.

use std::fs;
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Suffix of the new file's name until the file is renamed.
const NEW: &str = ".new";
/// What stands between the old file's name and the random part of the new file's name.
const WRITER: &str = ".tomcom-";
/// Length of the random part of the new file's name, in letters and digits.
const RANDOM: usize = 6;

/// Creates an empty file beside `path`, which is removed again if it is not renamed. All users may read it whom the
/// process's file mode allows to.
///
/// # Errors
/// The folder cannot be written to, or `path` names no file.
pub fn new_beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = path.file_name().ok_or(ErrorKind::InvalidInput)?.to_os_string();
    prefix.push(WRITER);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(NEW).rand_bytes(RANDOM);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(path.parent().unwrap_or(Path::new("")))
}

/// A file that is being written, and that replaces the old file when it is complete. Nothing of it is left if it is
/// not completed.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    out: BufWriter<NamedTempFile>,
}

impl Replacement {
    /// Begins a new file beside `path`, under a name that no other file has.
    ///
    /// # Errors
    /// The folder cannot be written to.
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

    /// Writes the new file to the disk, with the permissions of the old file, if there is one.
    ///
    /// # Errors
    /// The disk is full, or the old file's permissions cannot be read.
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

    /// Completes the new file and renames it, so that it replaces the old file.
    ///
    /// # Errors
    /// The folder cannot be written to, or the disk is full.
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
///
/// # Errors
/// The folder cannot be written to, or the disk is full.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Replacement::begin(path)?;
    file.write_all(bytes)?;
    file.finish()
}

/// Writes the content as [`replace`] does, but leaves it to the system when it is on the disk: for files that can be made
/// again.
///
/// # Errors
/// The folder cannot be written to, or the disk is full.
pub fn put(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = new_beside(path)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// Writes a file that must not exist yet.
///
/// # Errors
/// There is a file at the path, the folder cannot be written to, or the disk is full.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_when_it_is_complete_and_what_stands_beside_it_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (path, beside) = (folder.path().join("codes.csv"), folder.path().join("codes.csv.new"));
        fs::write(&path, "old").unwrap();
        fs::write(&beside, "of somebody else").unwrap();
        let mut begun = Replacement::begin(&path).unwrap();
        let name = begun.new_path().file_name().unwrap().to_str().unwrap().to_string();
        assert_eq!(replaced_name(&name), "codes.csv", "{name}: a file that a killed program leaves is known");
        begun.write_all(b"half").unwrap();
        begun.complete().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        drop(begun);
        assert_eq!(names(folder.path()), ["codes.csv", "codes.csv.new"], "nothing is left of what was not completed");
        replace(&path, b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_to_string(&beside).unwrap(), "of somebody else");
        assert_eq!(names(folder.path()).len(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn the_new_file_has_the_permissions_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("codes.csv");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        let (made, put_there) = (folder.path().join("made"), folder.path().join("put"));
        fs::write(&made, "").unwrap();
        put(&put_there, b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&put_there), mode(&made), "a new file has the permissions that the system gives to new files");
    }

    #[test]
    fn a_file_that_a_killed_program_left_is_known_by_the_name_that_it_was_to_get() {
        for name in ["codes.csv", "codes.csv.new", "codes.csv.tomcom-a1B2c3.new"] {
            assert_eq!(replaced_name(name), "codes.csv", "{name}");
        }
        assert_eq!(replaced_name("codes.tomcom-x.new"), "codes.tomcom-x");
    }
}
