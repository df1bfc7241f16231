//! The time stamps of the pictures of a film that Pupil Capture recorded: `world_timestamps.npy` beside `world.mp4`, an
//! array of numpy.

use std::path::{Path, PathBuf};

use tomcom_session::files::file_error::{FileError, FileResult, read_bytes};

/// Some weeks of pictures, in bytes.
const MOST_BYTES: u64 = 1 << 28;
const REMEDY: &str =
    "the time stamps as Pupil Capture writes them: an array of numpy with a number of 64 bits for each picture";
const MAGIC: &[u8] = b"\x93NUMPY";

/// The time stamps that belong to this film, if there are any.
pub fn beside(film: &Path) -> Option<PathBuf> {
    let mut name = film.file_stem()?.to_os_string();
    name.push("_timestamps.npy");
    Some(film.with_file_name(name)).filter(|path| path.is_file())
}

/// Time stamps in seconds on Capture's clock.
///
/// # Errors
/// The file cannot be read, or is no such array.
pub fn read(path: &Path) -> FileResult<Vec<f64>> {
    let bytes = read_bytes(path, MOST_BYTES).map_err(|reason| FileError::unreadable(path, reason, REMEDY))?;
    parse(&bytes).map_err(|found| FileError::from_finding(path, found, REMEDY.to_string()))
}

/// The numbers of an array of numpy; the error says what was found.
pub fn parse(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let broken = || "no array of numpy".to_string();
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(broken)?;
    let (length, rest) = match rest {
        [1, _, low, high, rest @ ..] => (usize::from(u16::from_le_bytes([*low, *high])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err(broken()),
    };
    let (head, data) = rest.split_at_checked(length).ok_or_else(broken)?;
    let head = String::from_utf8_lossy(head);
    let kind = entry(&head, "'descr':").unwrap_or_default().trim_matches('\'');
    let shape =
        head.split("'shape':").nth(1).and_then(|rest| rest.split_once('(')?.1.split_once(')')).map(|(shape, _)| shape);
    let number = shape.and_then(|shape| shape.trim().trim_end_matches(',').trim().parse::<usize>().ok());
    if kind != "<f8" {
        return Err(format!("an array of the kind \"{}\"", tomcom_core::base::text::printable(kind)));
    }
    let Some(number) = number else { return Err("an array of another shape than a row".to_string()) };
    let (numbers, left) = data.as_chunks::<8>();
    if numbers.len() != number || !left.is_empty() {
        return Err(format!("{number} time stamps in {} bytes", data.len()));
    }
    let stamps: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    match stamps.iter().all(|stamp| stamp.is_finite()) {
        true => Ok(stamps),
        false => Err("a time stamp that is no number".to_string()),
    }
}

/// The text of an entry of numpy's head, up to the next comma.
fn entry<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    head.split(name).nth(1)?.split(',').next().map(str::trim)
}
