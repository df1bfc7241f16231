//! The allowed ranges of the numbers in layout files. The ranges for session files are in `session::ranges`; recipe
//! files have no numbers.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::base::number_range::{NumberRange, OutOfRange, range_of};

const SECONDS: &str = "s";
const SHOWN: &str = "less is not seen, more is as long as a trial";
const FRACTION: &str = "fractions of the display, which ends at 1";
const SIDE: &str = "less is not seen, more does not fit on the display";

/// The allowed ranges of the numbers in layout files.
pub const RANGES: [NumberRange; 11] = [
    NumberRange::real("display.width_m", [0.1, 20.0], "m", "from a telephone to a wall"),
    NumberRange::real("display.height_m", [0.1, 20.0], "m", "from a telephone to a wall"),
    NumberRange::real("table.height_m", [-2.0, 2.0], "m", "the robot does not reach further up or down"),
    NumberRange::real("table.served_shown_s", [0.1, 3_600.0], SECONDS, SHOWN),
    NumberRange::real("table.new_order_after_s", [0.1, 3_600.0], SECONDS, SHOWN),
    NumberRange::real("*.display.x", [0.0, 1.0], "", FRACTION),
    NumberRange::real("*.display.y", [0.0, 1.0], "", FRACTION),
    NumberRange::real("*.display.w", [0.001, 1.0], "", SIDE),
    NumberRange::real("*.display.h", [0.001, 1.0], "", SIDE),
    NumberRange::real("*.*.at_m", [-5.0, 5.0], "m", "buttons are on one table, around the robot's base"),
    NumberRange::whole("*.*.gamepad", [0.0, 63.0], "", "no gamepad or button box has more buttons"),
];

/// Checks that all numbers in the text of a layout file lie within their allowed ranges. Other errors of the text are
/// ignored.
///
/// # Errors
/// The first number outside of its allowed range, with its position.
pub fn check(text: &str) -> Result<(), OutOfRange> {
    let Ok(document) = DeTable::parse(text) else { return Ok(()) };
    in_table(document.get_ref(), "")
}

fn in_table(table: &DeTable, path: &str) -> Result<(), OutOfRange> {
    table.iter().try_for_each(|(name, value)| {
        let inner = if path.is_empty() { name.get_ref().to_string() } else { format!("{path}.{}", name.get_ref()) };
        in_value(value, &inner)
    })
}

fn in_value(value: &Spanned<DeValue>, path: &str) -> Result<(), OutOfRange> {
    let number = match value.get_ref() {
        DeValue::Table(table) => return in_table(table, path),
        DeValue::Array(values) => return values.iter().try_for_each(|value| in_value(value, path)),
        DeValue::Float(number) => number.as_str().parse().unwrap_or(f64::NAN),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).map_or(f64::NAN, |n| n as f64),
        _ => return Ok(()),
    };
    let Some(range) = range_of(&RANGES, path).filter(|range| !range.holds(number)) else { return Ok(()) };
    Err(OutOfRange { place: Some(value.span()), ..range.violation(path, number) })
}
