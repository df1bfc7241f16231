//! Beginning of a Rerun file: which program wrote the file, and which recordings it shows. The rest of such a file is
//! read by `rrd`, if the program is built with Rerun.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// First bytes of a Rerun file, before the version that wrote it.
pub const BEGINS: &[u8] = b"RRF2";
/// Beginning of the mark by which the program recognises its own Rerun files.
pub const MARK: &str = "tomcom-scene-";
/// End of the mark by which the program recognises its own Rerun files of whole recordings.
pub const MARK_END: &str = "-whole";
/// Protocol Buffers tag of the identity in Rerun's `StoreId`: field 2, with a length before its content.
const IDENTITY_TAG: u8 = 0x12;
/// Number of bytes from the file's beginning that contain the stream's identity; the identity is longer only for
/// hundreds of recordings side by side.
const HEAD: u64 = 1 << 16;

/// Identity of a Rerun file that this program made of whole recordings: the names of their folders, the times at which
/// they began, and the mark, separated by spaces. `None` if the file does not exist, or is anything else.
///
/// # Errors
/// The file exists but cannot be read.
pub fn identity(path: &Path) -> io::Result<Option<String>> {
    // Opening a named pipe would block.
    match fs::metadata(path) {
        Ok(data) if data.is_file() => {}
        Ok(_) => return Ok(None),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    }
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(head.starts_with(BEGINS).then(|| identity_in(&head)).flatten())
}

/// Finds the stream's identity in the file's first bytes. The identity is a field of a Protocol Buffers message, with
/// the field's tag and its length before it, and ends with the mark. The search includes the tag, a control character,
/// which cannot occur in an identity: a length alone may look like one of an identity's digits.
fn identity_in(head: &[u8]) -> Option<String> {
    let find = |from: usize, what: &str| head[from..].windows(what.len()).position(|bytes| bytes == what.as_bytes());
    let mark = find(0, MARK)?;
    let end = mark + find(mark, MARK_END)? + MARK_END.len();
    let start = (0..=mark).rev().find(|&start| {
        let before = head[..start].strip_suffix(varint((end - start) as u64).as_slice());
        before.is_some_and(|before| before.ends_with(&[IDENTITY_TAG]))
    })?;
    String::from_utf8(head[start..end].to_vec()).ok()
}

/// A number in the encoding of Protocol Buffers: seven bits per byte, lowest bits first.
pub(crate) fn varint(mut number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number > 0x7f {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_identity_is_found_whatever_its_length_and_the_byte_before_it() {
        for names in ["2026-03-14-P07-1", &"seed7-S001 seed7-S002 ".repeat(9)] {
            let identity = format!("{names} 2026-03-14T10:00:00Z {MARK}3{MARK_END}");
            let head =
                [BEGINS, b"\x00\x24\x03\x00\x12", &varint(identity.len() as u64), identity.as_bytes(), b"\x1a\x08"];
            assert_eq!(identity_in(&head.concat()), Some(identity));
        }
        assert_eq!(identity_in(b"RRF2 of another program"), None);
    }
}
