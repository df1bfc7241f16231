//! The command `tomcom new`: a lab's folder.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::output::{put, put_aside};
use tomcom_core::base::text::count;
use tomcom_session::files::carried;

/// Writes a folder to begin with: sessions, kitchens, questionnaires, tutorials.
///
/// The files are those that the program carries, to be changed as the lab needs them. Nothing is overwritten: files that
/// are there already stay as they are.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom new lab\nMore: docs/first-study.md")]
pub(super) struct NewArgs {
    /// The folder, which need not exist yet.
    pub(super) folder: PathBuf,
}

/// What stands in the folder beside what the program carries.
const OWN: [(&str, &str); 5] = [
    ("README.md", include_str!("lab.md")),
    ("scripts/read_recording.R", include_str!("../../examples/read_recording.R")),
    ("scripts/read_recording.py", include_str!("../../examples/read_recording.py")),
    ("scripts/read_tables.R", include_str!("../../examples/read_tables.R")),
    ("scripts/read_tables.py", include_str!("../../examples/read_tables.py")),
];

pub(super) fn new(args: &NewArgs) -> Result<(), Failure> {
    let folder = &args.folder;
    let (mut written, mut there) = (0_u64, Vec::new());
    for (path, text) in OWN.iter().chain(carried::FILES) {
        let path = folder.join(path);
        match write_new(&path, text) {
            Ok(()) => written += 1,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => there.push(path),
            Err(error) => {
                let help = "a folder in which files can be written";
                let found = miette::miette!(help = help, "{}: cannot be written: {error}", path.display());
                return Err(Failure::Failed(found));
            }
        }
    }
    let mut told = format!("{}: {} written\n", folder.display(), count(written, "file", "files"));
    for path in there {
        told += &format!("{} was there, and stays as it is\n", path.display());
    }
    told += &format!("Next: cd {}, and tomcom --out try. README.md says what else.\n", folder.display());
    Ok(put(&told)?)
}

/// Says, where these settings are those that the program carries, that they are, and where recordings go.
pub(super) fn tell_carried(settings: &Path, out: Option<&Path>) {
    if carried::instead_of(settings).is_none() {
        return;
    }
    let place = |out: &Path| std::path::absolute(out).unwrap_or(out.to_path_buf()).display().to_string();
    let recordings = out.map_or(String::new(), |out| format!("Recordings go to {}. ", place(out)));
    put_aside(&format!(
        "No lab's folder is here: {} is the one that tomcom carries. {recordings}tomcom new DIR writes a folder to begin with.\n",
        settings.display()
    ));
}

/// Fails with `AlreadyExists` where there is a file.
fn write_new(path: &Path, text: &str) -> io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::OpenOptions::new().write(true).create_new(true).open(path)?.write_all(text.as_bytes())
}
