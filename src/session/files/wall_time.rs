//! Dates and times of files beside recordings, from the wall clock, which can be set and can jump.

use jiff::Timestamp;

/// A date and time of the wall clock, in UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallTime(Timestamp);

impl WallTime {
    /// The present wall clock time.
    pub fn now() -> WallTime {
        WallTime(Timestamp::now())
    }

    /// Milliseconds since the beginning of 1970.
    pub fn millis(self) -> i64 {
        self.0.as_millisecond()
    }

    /// The time this many milliseconds later.
    pub fn after_millis(self, millis: i64) -> WallTime {
        WallTime(self.0 + jiff::SignedDuration::from_millis(millis))
    }

    /// Date of the wall clock time, as in "2026-03-14".
    pub fn date(self) -> String {
        self.0.strftime("%F").to_string()
    }

    /// Date and time in UTC, as in "2026-03-14T09:26:53.589Z" (RFC 3339).
    pub fn rfc3339(self) -> String {
        self.0.strftime("%FT%T.%3fZ").to_string()
    }
}
