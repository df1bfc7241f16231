//! The pairing code: the console shows it, and pages and gaze senders at other computers have to send it.

use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

/// Letters and digits of pairing codes, without those that are easily confused.
const SIGNS: &[u8; 32] = b"ABCDEFGHJKLMNPQRSTUVWXYZ23456789";

/// An unpredictable pairing code of six characters. The code comes from the operating system's random source (through
/// the seeds of the standard library's hash maps), not from the session's seed, which is recorded.
pub(super) fn pairing_code() -> String {
    let bits = RandomState::new().hash_one("pairing code");
    (0..6).map(|place| char::from(SIGNS[(bits >> (5 * place)) as usize % SIGNS.len()])).collect()
}

/// Whether a typed text is the pairing code, ignoring case and spaces; texts are compared in constant time.
pub(super) fn is_code(typed: &str, code: &str) -> bool {
    let typed: Vec<u8> =
        typed.bytes().filter(u8::is_ascii_alphanumeric).map(|byte| byte.to_ascii_uppercase()).collect();
    let differing = typed.iter().zip(code.bytes()).filter(|(a, b)| **a != *b).count();
    typed.len() == code.len() && differing == 0
}
