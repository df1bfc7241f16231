//! Numbers as text: a number with its noun in singular or plural, and numbers that may be unknown.

/// A number with its noun in singular or plural: "1 press", "2 presses".
pub fn count(number: impl Into<u64>, one: &str, many: &str) -> String {
    let number = number.into();
    format!("{number} {}", if number == 1 { one } else { many })
}

/// A number with this many decimal places; "-" if it is not known.
pub fn decimal(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_string(), |value| format!("{value:.digits$}"))
}

/// A share of 1 in percent, with one decimal place: "12.5 %"; "-" if it is not known.
pub fn percent(share: Option<f64>) -> String {
    share.map_or("-".to_string(), |share| format!("{:.1} %", 100.0 * share))
}
