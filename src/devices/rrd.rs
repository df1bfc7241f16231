//! State of a Rerun file (`.rrd`), from the file itself and from the checksums in the seal file beside it: whether it
//! is complete, which program version wrote it, whether it is unchanged, and whether it shows the present log.

use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::rerun::VERSION;
use super::stream_head::{BEGINS, MARK, MARK_END};
use crate::scene;
use tomcom_session::files::file_error::{open_regular, read_regular};
use tomcom_session::files::replace_file;
pub use tomcom_session::log::RRD_NAME;

/// Marker in the last bytes of a Rerun file that was written to its end.
const ENDS: &[u8] = b"FOOT";
/// Lengths of the file's beginning and end in which the version and the end marker are looked for, in bytes.
const HEAD: u64 = 4096;
const TAIL: u64 = 64;
/// Suffix that is added to a Rerun file's name for the name of its seal file.
const SEALED: &str = ".toml";
/// Number of bytes of a file that are read at a time.
const PIECE: usize = 1 << 16;

/// Text in the identity of every Rerun stream that this program version made of a recording from its beginning.
pub fn mark() -> String {
    format!("{MARK}{}{MARK_END}", scene::VERSION)
}

/// State of a Rerun file: missing, incomplete, outdated or complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RerunFileState {
    Missing,
    Cut,
    /// The Rerun file was written by another version, or begins in the middle of the session.
    Other,
    /// The Rerun file has no seal file, so it is unknown which log it shows.
    Unsealed,
    /// The bytes of the Rerun file have changed since the file was written.
    Damaged,
    /// The Rerun file was made from another log, or from this log before more was written to it.
    Stale,
    Whole,
}

impl RerunFileState {
    /// Why the Rerun file has to be made anew, in words; `None` if the file is complete, or did not exist.
    pub fn reason(self) -> Option<&'static str> {
        match self {
            RerunFileState::Missing | RerunFileState::Whole => None,
            RerunFileState::Cut => Some("the stream was not written to its end"),
            RerunFileState::Other => Some(
                "another version wrote the stream, or the stream began in the middle of the \
                                           session",
            ),
            RerunFileState::Unsealed => Some("nothing said which log the stream shows"),
            RerunFileState::Damaged => Some("the stream was damaged or exchanged"),
            RerunFileState::Stale => Some("the stream did not show the log as the log is now"),
        }
    }
}

/// Length and CRC-32 checksum of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sum {
    bytes: u64,
    crc32: u32,
}

impl Sum {
    fn from_file(path: &Path) -> io::Result<Sum> {
        let mut file = open_regular(path)?;
        let (mut hasher, mut bytes, mut piece) = (crc32fast::Hasher::new(), 0, vec![0; PIECE]);
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(Sum { bytes, crc32: hasher.finalize() }),
                read => {
                    hasher.update(&piece[..read]);
                    bytes += read as u64;
                }
            }
        }
    }
}

/// Content of the seal file of a completely written Rerun file: checksums of the file and of the logs that it shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Seal {
    stream: Sum,
    /// Checksums of the logs of all parts of the recording, those of the first part first.
    logs: Vec<Sum>,
}

impl Seal {
    fn path(stream: &Path) -> PathBuf {
        let mut name = stream.as_os_str().to_os_string();
        name.push(SEALED);
        PathBuf::from(name)
    }

    /// Reads the seal file; `None` if the file is missing or unreadable, in which case the Rerun file is made anew.
    fn read(stream: &Path) -> Option<Seal> {
        toml::from_str(&read_regular(&Seal::path(stream)).ok()?).ok()
    }
}

/// Writes the seal file of a completely written Rerun file, with checksums of the file and of the logs that it shows.
///
/// # Errors
/// One of the files cannot be read, or the folder cannot be written to.
pub fn seal(stream: &Path, logs: &[PathBuf]) -> io::Result<()> {
    let logs = logs.iter().map(|log| Sum::from_file(log)).collect::<io::Result<_>>()?;
    let seal = Seal { stream: Sum::from_file(stream)?, logs };
    let text = toml::to_string(&seal).map_err(io::Error::other)?;
    replace_file::put(&Seal::path(stream), text.as_bytes())
}

/// Determines the state of a Rerun file, compared with the logs that it should show.
///
/// # Errors
/// The file exists but cannot be read, or a log cannot be read.
pub fn state(path: &Path, logs: &[PathBuf]) -> io::Result<RerunFileState> {
    let mut file = match open_regular(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(RerunFileState::Missing),
        Err(error) => return Err(error),
    };
    let mut head = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut head)?;
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut tail = Vec::new();
    file.read_to_end(&mut tail)?;
    let has = |bytes: &[u8], what: &[u8]| bytes.windows(what.len()).any(|window| window == what);
    let version: Vec<u8> = VERSION.split('.').filter_map(|part| part.parse().ok()).collect();
    let is_ours =
        head.starts_with(BEGINS) && head[BEGINS.len()..].starts_with(&version) && has(&head, mark().as_bytes());
    if !has(&tail, ENDS) {
        return Ok(RerunFileState::Cut);
    }
    if !is_ours {
        return Ok(RerunFileState::Other);
    }
    let Some(seal) = Seal::read(path) else { return Ok(RerunFileState::Unsealed) };
    if Sum::from_file(path)? != seal.stream {
        return Ok(RerunFileState::Damaged);
    }
    let logs = logs.iter().map(|log| Sum::from_file(log)).collect::<io::Result<Vec<Sum>>>()?;
    Ok(if logs == seal.logs { RerunFileState::Whole } else { RerunFileState::Stale })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_says_whether_it_is_whole_and_ours_and_its_seal_whether_it_shows_this_log() {
        let folder = tempfile::tempdir().unwrap();
        let (path, logs) = (folder.path().join(RRD_NAME), [folder.path().join("events.jsonl")]);
        let is = |state: RerunFileState| assert_eq!(super::state(&path, &logs).unwrap(), state);
        fs::write(&logs[0], "the log").unwrap();
        is(RerunFileState::Missing);
        let whole = [b"RRF2\x00\x24\x03\x00 id ", mark().as_bytes(), &[7; 200], b"RRF2FOOT", &[0; 24]].concat();
        for (bytes, state) in [
            (whole.clone(), RerunFileState::Unsealed),
            (whole[..whole.len() - 100].to_vec(), RerunFileState::Cut),
            (Vec::new(), RerunFileState::Cut),
            ([b"RRF2\x00\x25\x00\x00", &whole[8..]].concat(), RerunFileState::Other),
            ([&whole[..12], b"another scene", &whole[40..]].concat(), RerunFileState::Other),
        ] {
            fs::write(&path, bytes).unwrap();
            is(state);
        }
        fs::write(&path, &whole).unwrap();
        seal(&path, &logs).unwrap();
        is(RerunFileState::Whole);
        let mut damaged = whole.clone();
        damaged[100] = 8;
        fs::write(&path, damaged).unwrap();
        is(RerunFileState::Damaged);
        fs::write(&path, &whole).unwrap();
        is(RerunFileState::Whole);
        fs::write(&logs[0], "the lag").unwrap();
        is(RerunFileState::Stale);
    }
}
