//! What a file of Rerun says of itself, without reading it: whether it is whole, and what wrote it.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use super::rerun::VERSION;
use crate::scene;

/// The name of the stream in the folder of a recording.
pub const RRD_NAME: &str = "recording.rrd";
/// How such a file begins, before the version of Rerun that wrote it: four bytes.
const BEGINS: &[u8] = b"RRF2";
/// What stands in its last bytes if it was written to its end.
const ENDS: &[u8] = b"FOOT";
/// Where these are looked for, in bytes.
const HEAD: u64 = 4096;
const TAIL: u64 = 64;

/// Stands in the name of every stream that holds a recording from its beginning, as this program would write it today.
pub fn mark() -> String {
    format!("tomcom-scene-{}-whole", scene::VERSION)
}

/// How a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RrdState {
    Missing,
    /// It was not written to its end.
    Cut,
    /// Another version wrote it, or it begins in the middle of the session.
    Other,
    Whole,
}

/// Looks at a file.
///
/// # Errors
/// It is there and cannot be read.
pub fn state(path: &Path) -> io::Result<RrdState> {
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(RrdState::Missing),
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
    Ok(match (is_ours, has(&tail, ENDS)) {
        (_, false) => RrdState::Cut,
        (true, true) => RrdState::Whole,
        (false, true) => RrdState::Other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_says_whether_it_is_whole_and_ours() {
        let folder = std::env::temp_dir().join(format!("tomcom-rrd-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(RRD_NAME);
        assert_eq!(state(&path).unwrap(), RrdState::Missing);
        let whole = [b"RRF2\x00\x24\x03\x00 id ", mark().as_bytes(), &[7; 200], b"RRF2FOOT", &[0; 24]].concat();
        for (bytes, is) in [
            (whole.clone(), RrdState::Whole),
            (whole[..whole.len() - 100].to_vec(), RrdState::Cut),
            (Vec::new(), RrdState::Cut),
            ([b"RRF2\x00\x25\x00\x00", &whole[8..]].concat(), RrdState::Other),
            ([&whole[..12], b"another scene", &whole[40..]].concat(), RrdState::Other),
        ] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(state(&path).unwrap(), is);
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
