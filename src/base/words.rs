//! Numbers in words: a number with its noun in singular or plural.

/// A number with its noun in singular or plural: "1 press", "2 presses".
pub fn count(number: impl Into<u64>, one: &str, many: &str) -> String {
    let number = number.into();
    format!("{number} {}", if number == 1 { one } else { many })
}
