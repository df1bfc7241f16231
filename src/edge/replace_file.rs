//! Writes a small file as a whole: a program that reads the file meanwhile, or after a crash or on a full disk, finds
//! the old content or the new content.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::temporary::first_free;

/// Suffix of the new file's name until the file is renamed.
const NEW: &str = ".new";
/// What stands between the old file's name and the number of the process that writes the new file.
const WRITER: &str = ".tomcom-";

/// A file that is being written, and that replaces the old file when it is complete. Nothing of it is left if it is
/// not completed.
#[derive(Debug)]
pub struct Replacement {
    path: PathBuf,
    new: PathBuf,
    out: BufWriter<File>,
    is_put: bool,
}

impl Replacement {
    /// Begins a new file beside `path`, under a name that no other file has.
    ///
    /// # Errors
    /// The folder cannot be written to.
    pub fn begin(path: &Path) -> io::Result<Replacement> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_name().ok_or(ErrorKind::InvalidInput)?.to_string_lossy();
        let stem = format!("{name}{WRITER}{}", std::process::id());
        let make = |new: &Path| OpenOptions::new().write(true).create_new(true).open(new);
        let (new, file) = first_free(folder, &stem, NEW, make)?;
        Ok(Replacement { path: path.to_path_buf(), new, out: BufWriter::new(file), is_put: false })
    }

    /// Path of the file that is replaced.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the new file to the disk, with the permissions of the old file, if there is one.
    ///
    /// # Errors
    /// The disk is full, or the old file's permissions cannot be read.
    pub fn complete(&mut self) -> io::Result<()> {
        self.out.flush()?;
        match fs::metadata(&self.path) {
            Ok(old) => self.out.get_ref().set_permissions(old.permissions())?,
            Err(reason) if reason.kind() == ErrorKind::NotFound => {}
            Err(reason) => return Err(reason),
        }
        self.out.get_ref().sync_all()
    }

    /// Completes the new file and renames it, so that it replaces the old file.
    ///
    /// # Errors
    /// The folder cannot be written to, or the disk is full.
    pub fn finish(mut self) -> io::Result<()> {
        self.complete()?;
        fs::rename(&self.new, &self.path)?;
        self.is_put = true;
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

impl Drop for Replacement {
    fn drop(&mut self) {
        if !self.is_put {
            // A new file that cannot be removed keeps no later one from being written.
            let _ = fs::remove_file(&self.new);
        }
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

/// Writes a file that must not exist yet. A file that cannot be written completely is removed again.
///
/// # Errors
/// There is a file at the path, the folder cannot be written to, or the disk is full.
pub fn create(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    if written.is_err() {
        // If the file cannot be removed, the error that is returned explains why it is cut.
        let _ = fs::remove_file(path);
    }
    written
}

/// Name of the file that a file of this name was to replace; the name itself if no program has left such a file.
pub fn replaced_name(name: &str) -> &str {
    let Some(begun) = name.strip_suffix(NEW) else { return name };
    match begun.rsplit_once(WRITER) {
        Some((replaced, writer)) if writer.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-') => replaced,
        _ => begun,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::temporary::new_folder;

    fn folder(name: &str) -> PathBuf {
        new_folder(&std::env::temp_dir(), &format!("tomcom-replace-{name}-{}", std::process::id())).unwrap()
    }

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
        let folder = folder("whole");
        let (path, beside) = (folder.join("codes.csv"), folder.join("codes.csv.new"));
        fs::write(&path, "old").unwrap();
        fs::write(&beside, "of somebody else").unwrap();
        let mut begun = Replacement::begin(&path).unwrap();
        begun.write_all(b"half").unwrap();
        begun.complete().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        drop(begun);
        assert_eq!(names(&folder), ["codes.csv", "codes.csv.new"], "nothing is left of a file that was not completed");
        // What a killed program with the same number left behind is in nobody's way.
        fs::write(folder.join(format!("codes.csv{WRITER}{}{NEW}", std::process::id())), "cut").unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_to_string(&beside).unwrap(), "of somebody else");
        assert_eq!(names(&folder).len(), 3);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn the_new_file_has_the_permissions_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder("permissions");
        let path = folder.join("codes.csv");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_file_that_a_killed_program_left_is_known_by_the_name_that_it_was_to_get() {
        for name in ["codes.csv", "codes.csv.new", "codes.csv.tomcom-12.new", "codes.csv.tomcom-12-3.new"] {
            assert_eq!(replaced_name(name), "codes.csv", "{name}");
        }
        assert_eq!(replaced_name("codes.tomcom-x.new"), "codes.tomcom-x");
    }
}
