//! How a file of Rerun begins: which program wrote it, and what it shows. The rest of such a file is read by `rrd`, where
//! the program is built with Rerun.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The first bytes of a file of Rerun, before the version that wrote it.
pub const BEGINS: &[u8] = b"RRF2";
/// What the mark of every stream that this program makes of recordings begins with.
pub const MARK: &str = "tomcom-scene-";
/// What the mark ends with.
pub const MARK_END: &str = "-whole";
/// Protocol Buffers' tag of the identity in Rerun's `StoreId`: field 2, with a length before its content.
const IDENTITY_TAG: u8 = 0x12;
/// The identity of a stream is within so many bytes; that of hundreds of recordings side by side is longer.
const HEAD: u64 = 1 << 16;

/// The identity of a stream that this program made of whole recordings: the names of their folders, when they began, and the
/// mark, with spaces between. `None` if there is no such file, or it is anything else.
///
/// # Errors
/// The file is there and cannot be read.
pub fn identity(path: &Path) -> io::Result<Option<String>> {
    // Opening a pipe would wait for its other end.
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

/// The identity is a field of a Protocol Buffers message, with the field's tag and its length before it. Its end is known
/// by the mark. The tag is a control character, which the identity has none of: a length alone may look like a digit of it.
fn identity_in(head: &[u8]) -> Option<String> {
    let find = |from: usize, what: &str| head[from..].windows(what.len()).position(|bytes| bytes == what.as_bytes());
    let mark = find(0, MARK)?;
    let end = mark + find(mark, MARK_END)? + MARK_END.len();
    let start = (0..=mark).rev().find(|&start| {
        let before = head[..start].strip_suffix(length_prefix(end - start).as_slice());
        before.is_some_and(|before| before.ends_with(&[IDENTITY_TAG]))
    })?;
    String::from_utf8(head[start..end].to_vec()).ok()
}

/// A length as Protocol Buffers write it: seven bits a byte, the low ones first.
fn length_prefix(mut length: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    while length > 0x7f {
        bytes.push((length & 0x7f) as u8 | 0x80);
        length >>= 7;
    }
    bytes.push(length as u8);
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
                [BEGINS, b"\x00\x24\x03\x00\x12", &length_prefix(identity.len()), identity.as_bytes(), b"\x1a\x08"];
            assert_eq!(identity_in(&head.concat()), Some(identity));
        }
        assert_eq!(identity_in(b"RRF2 of another program"), None);
    }
}
