//! Format of the lines of the gaze input: samples {"t": seconds, "x": 0..1, "y": 0..1, "confidence": 0..1, "age":
//! seconds}, of which only x and y are needed, and the line with which a sender at another computer pairs, {"pair":
//! "CODE"}. Coordinates are fractions of the wall display, with the origin at the top left; t is the time on the
//! tracker's own clock, age the time since the sample was taken.

use std::time::{Duration, Instant};

use serde::Deserialize;

use super::gaze_input::{GazeSenderRejection, TrackerMessage};
use tomcom_core::base::text::printable;
use tomcom_core::gaze::GazeSample;

/// Largest age of a gaze sample, in seconds; a larger age is an error of the sender.
const MAX_AGE_S: f64 = 60.0;
/// Number of characters that are shown of data that are no JSON object.
const SHOWN: usize = 24;
/// Beginnings of requests in HTTP (RFC 9110, section 9).
const HTTP: [&[u8]; 7] = [b"GET ", b"POST ", b"PUT ", b"HEAD ", b"OPTIONS ", b"DELETE ", b"PATCH "];

#[derive(Deserialize)]
struct SampleLine {
    #[serde(default)]
    t: Option<f64>,
    x: f64,
    y: f64,
    #[serde(default)]
    confidence: Option<f64>,
    #[serde(default)]
    age: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PairingLine {
    pair: String,
}

/// Whether bytes begin a JSON object; `None` if there are too few bytes to decide.
pub(super) fn begins_object(bytes: &[u8]) -> Option<bool> {
    let mut signs = bytes.iter().filter(|byte| !byte.is_ascii_whitespace());
    match (signs.next(), signs.next()) {
        (Some(b'{'), Some(next)) => Some(matches!(next, b'"' | b'}')),
        (Some(b'{') | None, None) => None,
        _ => Some(false),
    }
}

/// Why data that do not begin a JSON object are no lines of gaze.
pub(super) fn opening_fault(bytes: &[u8]) -> GazeSenderRejection {
    let text = bytes.trim_ascii_start();
    // In UTF-16 every second byte of ASCII is zero.
    let is_ascii = |byte: u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    let is_wide = |zero: usize| {
        let mut pairs = text.chunks_exact(2).take(4);
        text.len() >= 2 && pairs.all(|pair| pair[zero] == 0 && is_ascii(pair[1 - zero]))
    };
    if matches!(text, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]) || is_wide(0) || is_wide(1) {
        return GazeSenderRejection::Utf16;
    }
    if text.starts_with(b"\xef\xbb\xbf") {
        return GazeSenderRejection::ByteOrderMark;
    }
    if HTTP.iter().any(|method| text.starts_with(method)) {
        return GazeSenderRejection::HttpRequest;
    }
    let start: String = String::from_utf8_lossy(&text[..text.len().min(4 * SHOWN)]).chars().take(SHOWN).collect();
    GazeSenderRejection::NoObject(printable(start.trim_end()).into_owned())
}

/// Why a first line that is longer than `most` bytes is no line of gaze.
pub(super) fn long_line_fault(line: &[u8], most: usize) -> GazeSenderRejection {
    let mut signs = line.iter().filter(|byte| !byte.is_ascii_whitespace() && **byte != b',').peekable();
    while let Some(sign) = signs.next() {
        if *sign == b'}' && signs.peek() == Some(&&b'{') {
            return GazeSenderRejection::NoLineBreak;
        }
    }
    GazeSenderRejection::LongLine(most)
}

/// The pairing code in a line of the gaze input; `None` if the line is no pairing line.
pub fn code_in(line: &[u8]) -> Option<String> {
    serde_json::from_slice::<PairingLine>(line).ok().map(|line| line.pair)
}

/// Parses a line of the gaze input that arrived at this instant; `None` for an empty line.
pub fn parse(line: &[u8], arrived: Instant) -> Option<TrackerMessage> {
    if line.trim_ascii().is_empty() {
        return None;
    }
    let found = serde_json::from_slice::<SampleLine>(line).or_else(|_| serde_json::from_slice(&without_nan(line)));
    let Ok(found) = found else { return Some(TrackerMessage::Malformed(1)) };
    let has_age = found.age.is_none_or(|age_s| (0.0..=MAX_AGE_S).contains(&age_s));
    // Points outside the display are valid; a confidence outside 0 to 1 shows that the sender uses another format.
    let is_share = found.confidence.is_none_or(|confidence| (0.0..=1.0).contains(&confidence));
    if !(found.x.is_finite() && found.y.is_finite() && is_share && has_age) {
        return Some(TrackerMessage::Malformed(1));
    }
    let device_ns = match found.t.map(|t| device_ns(t).ok_or(t)).transpose() {
        Ok(device_ns) => device_ns,
        Err(t) => return Some(TrackerMessage::WrongTime(t)),
    };
    let sample = GazeSample { device_ns, ..GazeSample::new(found.x, found.y, found.confidence.unwrap_or(f64::NAN)) };
    let taken = found.age.and_then(|age_s| arrived.checked_sub(Duration::from_secs_f64(age_s)));
    Some(TrackerMessage::Sample(sample, taken))
}

/// Converts a gaze sample's time stamp to nanoseconds; `None` if the stamp is too large to be a time. Stamps are seconds
/// of any clock, which may be negative; larger ones are milliseconds, microseconds or nanoseconds since 1970, which differ
/// by three digits each. A stamp counts in the largest unit in which it is at most the year 2262.
fn device_ns(t: f64) -> Option<i64> {
    const MOST: f64 = i64::MAX as f64;
    let ns = [1e9, 1e6, 1e3, 1.0].map(|ns_per_unit| (t * ns_per_unit).round());
    ns.into_iter().find(|ns| ns.abs() < MOST).map(|ns| ns as i64)
}

/// A line in which numbers that are not known are `null`. Python's `json` writes them as `NaN`, which is no JSON. Words in
/// strings do not matter, since all that is read of a line is numbers.
fn without_nan(line: &[u8]) -> Vec<u8> {
    String::from_utf8_lossy(line).replace("NaN", "null").into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_time_stamp_is_seconds_or_finer_units_since_1970() {
        let since_1970_s = 1_764_057_600.25;
        for unit in [1.0, 1e3, 1e6, 1e9] {
            let ns = device_ns(since_1970_s * unit).expect("a time");
            assert!(ns.abs_diff(1_764_057_600_250_000_000) < 500, "{unit}: {ns}");
            assert_eq!(device_ns(-since_1970_s * unit), Some(-ns), "{unit}");
        }
        assert_eq!([12.5, -0.001, -3.5].map(device_ns), [12_500_000_000, -1_000_000, -3_500_000_000].map(Some));
        // Test: between the usual ranges of two units.
        assert_eq!([5e10, -5e13, 5e16].map(device_ns), [5e16, -5e16, 5e16].map(|ns| Some(ns as i64)));
        for wrong in [1e20, -1e20, f64::MAX, f64::NAN, f64::INFINITY] {
            assert_eq!(device_ns(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_sample_of_known_age_was_taken_so_long_before_it_arrived() {
        let arrived = Instant::now() + Duration::from_secs(100);
        let with = |age: &str| {
            let line = format!("{{\"t\": 7, \"x\": 0, \"y\": 1, \"confidence\": 1, \"age\": {age}}}");
            parse(line.as_bytes(), arrived).expect("a line")
        };
        let sample = GazeSample { device_ns: Some(7_000_000_000), ..GazeSample::new(0.0, 1.0, 1.0) };
        let before = |age_s| TrackerMessage::Sample(sample, Some(arrived - Duration::from_secs_f64(age_s)));
        assert_eq!([with("0"), with("0.125"), with("60")], [before(0.0), before(0.125), before(60.0)]);
        assert_eq!(with("null"), TrackerMessage::Sample(sample, None));
        for wrong in ["-0.001", "60.1", "\"1\"", "1e999"] {
            assert_eq!(with(wrong), TrackerMessage::Malformed(1), "{wrong}");
        }
    }

    #[test]
    fn a_sample_without_confidence_is_a_sample() {
        for confidence in ["", ", \"confidence\": null", ", \"confidence\": NaN"] {
            let line = format!("{{\"x\": 0.25, \"y\": 1{confidence}}}");
            let Some(TrackerMessage::Sample(sample, None)) = parse(line.as_bytes(), Instant::now()) else {
                panic!("{line}: no sample")
            };
            assert!(sample.confidence.is_nan() && (sample.x, sample.y) == (0.25, 1.0), "{line}: {sample:?}");
        }
        for wrong in ["{\"x\": NaN, \"y\": 1, \"confidence\": NaN}", "{\"x\": 0, \"y\": 1, \"confidence\": \"high\"}"] {
            assert_eq!(parse(wrong.as_bytes(), Instant::now()), Some(TrackerMessage::Malformed(1)), "{wrong}");
        }
    }

    #[test]
    fn a_pairing_line_has_the_code_and_nothing_else() {
        assert_eq!(code_in(b" {\"pair\": \"abc 234\"}\r"), Some("abc 234".to_string()));
        for other in
            ["{\"pair\": 7}", "{\"pair\": \"A\", \"x\": 0}", "{}", "{\"x\": 0, \"y\": 0, \"confidence\": 1}", "ABC234"]
        {
            assert_eq!(code_in(other.as_bytes()), None, "{other}");
        }
        // Test: for the parser of samples, a pairing line is malformed.
        assert_eq!(parse(b"{\"pair\": \"ABC234\"}", Instant::now()), Some(TrackerMessage::Malformed(1)));
    }
}
