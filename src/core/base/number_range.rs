//! Allowed ranges of the numbers in settings files, and the check of a settings file against a table of ranges.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

/// The allowed range of one number of a settings file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberRange {
    /// The number's path in the settings, from the outermost table on: `human.decision.tau`. A `*` stands for any one
    /// name.
    pub path: &'static str,
    /// The least allowed value of the number, included.
    pub least: f64,
    /// The greatest allowed value of the number, included.
    pub most: f64,
    /// Whether only whole numbers are allowed.
    pub is_whole: bool,
    /// The unit of the number; empty if it has none.
    pub unit: &'static str,
    /// Why values below or above the range are not allowed.
    pub reason: &'static str,
}

/// Error: a number of a settings file is outside of its allowed range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found}, wanted {remedy}")]
pub struct OutOfRange {
    /// The number's path in the settings, from the outermost table on.
    pub path: String,
    /// The number as it was found: `tau = -3`.
    pub found: String,
    /// What the number would have to be, in words.
    pub remedy: String,
    /// Position of the number in the file's text, in bytes; `None` if no text was checked.
    pub place: Option<Range<usize>>,
}

impl NumberRange {
    /// The allowed range of a decimal number.
    pub const fn real(path: &'static str, range: [f64; 2], unit: &'static str, reason: &'static str) -> NumberRange {
        NumberRange { path, least: range[0], most: range[1], is_whole: false, unit, reason }
    }

    /// The allowed range of a whole number.
    pub const fn whole(path: &'static str, range: [f64; 2], unit: &'static str, reason: &'static str) -> NumberRange {
        NumberRange { path, least: range[0], most: range[1], is_whole: true, unit, reason }
    }

    /// Whether a settings file may have this value.
    pub fn holds(&self, value: f64) -> bool {
        (self.least..=self.most).contains(&value)
    }

    pub(crate) fn violation(&self, path: &str, value: f64) -> OutOfRange {
        let key = path.rsplit('.').next().unwrap_or(path);
        OutOfRange {
            path: path.to_string(),
            found: format!("{key} = {}", written(value)),
            remedy: self.to_string(),
            place: None,
        }
    }

    fn is_of(&self, path: &str) -> bool {
        let (mut wanted, mut names) = (self.path.split('.'), path.split('.'));
        loop {
            match (wanted.next(), names.next()) {
                (None, None) => return true,
                (Some(wanted), Some(name)) if wanted == "*" || wanted == name => {}
                _ => return false,
            }
        }
    }
}

/// A number as people write it: in exponent notation where it would have many zeros.
fn written(value: f64) -> String {
    let size = value.abs();
    if size >= 1e16 || (size > 0.0 && size < 1e-6) { format!("{value:e}") } else { value.to_string() }
}

impl fmt::Display for NumberRange {
    /// The range in words: "a number from 0.01 to 100 per press: …".
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = if self.is_whole { "a whole number" } else { "a number" };
        write!(out, "{number} from {} to {}", self.least, self.most)?;
        if !self.unit.is_empty() {
            write!(out, " {}", self.unit)?;
        }
        write!(out, ": {}", self.reason)
    }
}

/// The range of the number with this path, from a table of ranges.
pub fn range_of<'a>(ranges: &'a [NumberRange], path: &str) -> Option<&'a NumberRange> {
    ranges.iter().find(|range| range.is_of(path))
}

/// All numbers of a settings object with their paths, in the order of the settings; the numbers of a list have the path
/// of the list. `around` is the path of the tables that contain the settings ("human"), or empty if no table contains
/// them.
///
/// # Errors
/// A whole number that no TOML file can hold.
pub fn numbers(settings: &impl Serialize, around: &str) -> Result<Vec<(String, f64)>, OutOfRange> {
    let value = toml::Value::try_from(settings).map_err(|error| OutOfRange {
        path: around.to_string(),
        found: error.to_string(),
        remedy: format!("numbers up to {}", i64::MAX),
        place: None,
    })?;
    let mut found = Vec::new();
    collect(&value, around, &mut found);
    Ok(found)
}

fn collect(value: &toml::Value, path: &str, found: &mut Vec<(String, f64)>) {
    match value {
        toml::Value::Integer(number) => found.push((path.to_string(), *number as f64)),
        toml::Value::Float(number) => found.push((path.to_string(), *number)),
        toml::Value::Array(values) => values.iter().for_each(|value| collect(value, path, found)),
        toml::Value::Table(table) => {
            for (name, value) in table {
                let inner = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                collect(value, &inner, found);
            }
        }
        toml::Value::String(_) | toml::Value::Boolean(_) | toml::Value::Datetime(_) => {}
    }
}

/// Checks that all these numbers of a settings file lie within their allowed ranges.
///
/// # Errors
/// The first number outside of its range.
pub fn check_file(ranges: &[NumberRange], numbers: &[(String, f64)]) -> Result<(), OutOfRange> {
    let ranged = numbers.iter().filter_map(|(path, value)| Some((range_of(ranges, path)?, path, *value)));
    let mut wrong = ranged.filter(|(range, _, value)| !range.holds(*value));
    wrong.next().map_or(Ok(()), |(range, path, value)| Err(range.violation(path, value)))
}
