//! Numbers with their nouns.

/// "1 press", "2 presses": a number with what it counts.
pub fn count(number: impl Into<u64>, one: &str, many: &str) -> String {
    let number = number.into();
    format!("{number} {}", if number == 1 { one } else { many })
}
