//! Creates files and folders in the system's folder for temporary files, where other users can put files and links of
//! any name. Everything is newly created: nothing that exists is used, and no link is followed. Only the user of the
//! program can read what is created.

use std::fs::{DirBuilder, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Number of file names that are tried before giving up.
const NAMES: u32 = 1000;

/// Creates the folder `NAME`, or else the first of `NAME-2`, `NAME-3`, … that does not exist.
///
/// # Errors
/// The folder cannot be created.
pub fn new_folder(below: &Path, name: &str) -> io::Result<PathBuf> {
    first_free(below, name, "", make_folder).map(|(path, ())| path)
}

/// Creates the empty file `STEM` with the name's ending, or else the first of `STEM-2`, `STEM-3`, … that does not
/// exist.
///
/// # Errors
/// The file cannot be created.
pub fn new_file(below: &Path, stem: &str, ending: &str) -> io::Result<(PathBuf, File)> {
    first_free(below, stem, ending, make_file)
}

/// Creates the first of `STEM`, `STEM-2`, `STEM-3`, …, each with the name's ending, that does not exist. `make` creates a
/// file or folder at a path, and refuses a path at which something exists.
///
/// # Errors
/// The file or folder cannot be created.
pub fn first_free<T>(
    below: &Path,
    stem: &str,
    ending: &str,
    make: impl Fn(&Path) -> io::Result<T>,
) -> io::Result<(PathBuf, T)> {
    for n in 1..=NAMES {
        let number = if n == 1 { String::new() } else { format!("-{n}") };
        let path = below.join(format!("{stem}{number}{ending}"));
        match make(&path) {
            Ok(made) => return Ok((path, made)),
            Err(reason) if reason.kind() == ErrorKind::AlreadyExists => {}
            Err(reason) => return Err(reason),
        }
    }
    Err(io::Error::from(ErrorKind::AlreadyExists))
}

#[cfg(unix)]
fn make_folder(path: &Path) -> io::Result<()> {
    std::os::unix::fs::DirBuilderExt::mode(&mut DirBuilder::new(), 0o700).create(path)
}

#[cfg(not(unix))]
fn make_folder(path: &Path) -> io::Result<()> {
    DirBuilder::new().create(path)
}

#[cfg(unix)]
fn make_file(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    OpenOptions::new().read(true).write(true).create_new(true).mode(0o600).open(path)
}

#[cfg(not(unix))]
fn make_file(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).write(true).create_new(true).open(path)
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn what_exists_is_left_as_it_is_and_no_link_is_followed() {
        let home = new_folder(&std::env::temp_dir(), &format!("tomcom-temporary-{}", std::process::id())).unwrap();
        let (others, nowhere) = (home.join("others"), home.join("nowhere"));
        fs::write(&others, "of somebody else").unwrap();
        symlink(&others, home.join("a.rrd")).unwrap();
        symlink(&nowhere, home.join("a-2.rrd")).unwrap();
        symlink(&home, home.join("b")).unwrap();
        let (file, _) = new_file(&home, "a", ".rrd").unwrap();
        let folder = new_folder(&home, "b").unwrap();
        assert_eq!((&file, &folder), (&home.join("a-3.rrd"), &home.join("b-2")));
        assert_eq!(fs::read_to_string(others).unwrap(), "of somebody else");
        assert!(!nowhere.exists());
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!((mode(&file), mode(&folder)), (0o600, 0o700));
        fs::remove_dir_all(home).unwrap();
    }
}
