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

/// A number with this many decimal places, or as a power of ten where these would show nothing of it, or too much:
/// "0.0300", "1e-6", "1e18".
pub fn short(value: f64, digits: usize) -> String {
    let size = value.abs();
    let is_shown = size == 0.0 || (0.1_f64.powi(digits as i32 - 1)..1e6).contains(&size);
    if is_shown || !value.is_finite() {
        return format!("{value:.digits$}");
    }
    let power = format!("{value:.2e}");
    let (digits, exponent) = power.split_once('e').unwrap_or((&power, "0"));
    format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// A share of 1 in percent, with one decimal place: "12.5 %"; "-" if it is not known.
pub fn percent(share: Option<f64>) -> String {
    share.map_or("-".to_string(), |share| format!("{:.1} %", 100.0 * share))
}
