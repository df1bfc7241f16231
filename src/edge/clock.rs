//! The wall clock: only for the names of recordings and for the header of live ones.

use std::time::{SystemTime, UNIX_EPOCH};

/// A moment of the wall clock, in UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallTime {
    /// Milliseconds since 1970.
    unix_ms: u64,
}

impl WallTime {
    /// Now; a clock before 1970 counts as 1970.
    pub fn now() -> WallTime {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        WallTime { unix_ms: since_1970.as_millis() as u64 }
    }

    /// "2026-03-14".
    pub fn date(self) -> String {
        let (year, month, day) = civil(self.unix_ms / 86_400_000);
        format!("{year:04}-{month:02}-{day:02}")
    }

    /// "2026-03-14T09:26:53.589Z" (RFC 3339).
    pub fn rfc3339(self) -> String {
        let ms = self.unix_ms % 86_400_000;
        let (hours, minutes, seconds) = (ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60);
        format!("{}T{hours:02}:{minutes:02}:{seconds:02}.{:03}Z", self.date(), ms % 1000)
    }
}

/// Year, month and day of a number of days since 1970-01-01, in the Gregorian calendar (H. Hinnant, "chrono-compatible
/// low-level date algorithms", civil_from_days).
fn civil(days: u64) -> (u64, u64, u64) {
    let shifted = days + 719_468;
    let era = shifted / 146_097;
    let day_of_era = shifted % 146_097;
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    (year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let at = |unix_s: u64| WallTime { unix_ms: unix_s * 1000 }.rfc3339();
        assert_eq!(at(0), "1970-01-01T00:00:00.000Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59.000Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00.000Z");
        assert_eq!(at(1_798_761_599), "2026-12-31T23:59:59.000Z");
    }
}
