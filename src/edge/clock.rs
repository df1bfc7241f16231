//! Clocks of the program. Session time comes from the monotonic clock. The wall clock can be set and can jump; the
//! program uses it only for names and headers of recordings, and records its jumps in the log.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::base::time::SessionTime;

/// Gap between two readings of the clock after which the program counts as having been suspended.
const STANDSTILL: Duration = Duration::from_secs(1);
/// Least change of the difference between wall clock and session time that counts as a jump, in milliseconds.
const JUMP_MS: i64 = 500;

/// Clock of a live session (session time). The clock stops while the program is suspended or blocked for more than a
/// second, so that pending actions of robot and participant do not all happen at once afterwards.
#[derive(Clone, Debug)]
pub struct SessionClock {
    /// Session time at the instant `began`, when the clock was started.
    offset: SessionTime,
    began: Instant,
    looked: Instant,
    /// Total time since `began` for which the program was suspended.
    stood: Duration,
    /// Wall clock minus session time at the last comparison of the two, in milliseconds.
    ahead_ms: i64,
}

impl SessionClock {
    /// Starts a session clock that shows `offset` now.
    pub fn start(offset: SessionTime) -> SessionClock {
        let now = Instant::now();
        let ahead_ms = WallTime::now().unix_ms as i64 - millis(offset);
        SessionClock { offset, began: now, looked: now, stood: Duration::ZERO, ahead_ms }
    }

    /// The present session time.
    pub fn now(&mut self) -> SessionTime {
        self.at(Instant::now())
    }

    /// Instant at which the clock will reach a session time if the program is not suspended meanwhile.
    pub fn instant_of(&self, time: SessionTime) -> Instant {
        self.began + self.stood + Duration::from_nanos((time - self.offset).0)
    }

    /// Jump of the wall clock since the last call of this function, in milliseconds; `None` if there was none.
    pub fn jump(&mut self) -> Option<i64> {
        let wall = WallTime::now();
        let now = self.now();
        self.jump_at(now, wall)
    }

    fn at(&mut self, now: Instant) -> SessionTime {
        let gap = now.saturating_duration_since(self.looked);
        self.looked = now;
        if gap > STANDSTILL {
            self.stood += gap;
        }
        let passed = now.saturating_duration_since(self.began).saturating_sub(self.stood);
        self.offset + SessionTime(passed.as_nanos() as u64)
    }

    fn jump_at(&mut self, now: SessionTime, wall: WallTime) -> Option<i64> {
        let ahead_ms = wall.unix_ms as i64 - millis(now);
        let by_ms = ahead_ms - self.ahead_ms;
        if by_ms.abs() < JUMP_MS {
            return None;
        }
        self.ahead_ms = ahead_ms;
        Some(by_ms)
    }
}

fn millis(time: SessionTime) -> i64 {
    (time.0 / 1_000_000) as i64
}

/// A date and time of the wall clock, in UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallTime {
    /// Milliseconds since 1970-01-01 (UTC).
    unix_ms: u64,
}

impl WallTime {
    /// The present wall clock time; a computer clock before 1970 gives 1970.
    pub fn now() -> WallTime {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        WallTime { unix_ms: since_1970.as_millis() as u64 }
    }

    /// Date of the wall clock time, as in "2026-03-14".
    pub fn date(self) -> String {
        let (year, month, day) = civil(self.unix_ms / 86_400_000);
        format!("{year:04}-{month:02}-{day:02}")
    }

    /// Date and time in UTC, as in "2026-03-14T09:26:53.589Z" (RFC 3339).
    pub fn rfc3339(self) -> String {
        let ms = self.unix_ms % 86_400_000;
        let (hours, minutes, seconds) = (ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60);
        format!("{}T{hours:02}:{minutes:02}:{seconds:02}.{:03}Z", self.date(), ms % 1000)
    }
}

/// Year, month and day from a number of days since 1970-01-01, in the Gregorian calendar (H. Hinnant,
/// "chrono-compatible low-level date algorithms", civil_from_days).
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
    fn session_time_knows_no_wall_clock_and_stands_still_with_the_program() {
        let offset = SessionTime(5_000_000_000);
        let mut clock = SessionClock::start(offset);
        let (began, wall) = (clock.began, WallTime::now());
        let after = |ms: u64| began + Duration::from_millis(ms);
        let shows = |ms: u64| offset + SessionTime(ms * 1_000_000);
        let wall_after = |ms: i64| WallTime { unix_ms: (wall.unix_ms as i64 + ms) as u64 };
        assert_eq!(clock.at(after(400)), shows(400));
        assert_eq!(clock.jump_at(shows(400), wall_after(410)), None);
        // Test: the wall clock is set forward by an hour, then back again. Each jump is reported once, and no session
        // time passes.
        let told = clock.jump_at(shows(400), wall_after(3_600_400)).expect("a jump");
        assert!((told - 3_600_000).abs() < 100, "{told}");
        assert_eq!(clock.jump_at(shows(400), wall_after(3_600_400)), None);
        assert!(clock.jump_at(shows(400), wall_after(400)).is_some_and(|by_ms| by_ms < -3_599_000));
        // In this test, the computer is suspended for a minute.
        assert_eq!(clock.at(after(60_400)), shows(400));
        assert!(clock.jump_at(shows(400), wall_after(60_400)).is_some_and(|by_ms| (59_900..60_100).contains(&by_ms)));
        assert_eq!(clock.at(after(60_500)), shows(500));
        assert_eq!(clock.instant_of(shows(700)), after(60_700));
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        let at = |unix_s: u64| WallTime { unix_ms: unix_s * 1000 }.rfc3339();
        assert_eq!(at(0), "1970-01-01T00:00:00.000Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59.000Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00.000Z");
        assert_eq!(at(1_798_761_599), "2026-12-31T23:59:59.000Z");
    }
}
