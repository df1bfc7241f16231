//! Clocks of the program. Session time comes from the monotonic clock. The wall clock can be set and can jump; the
//! program uses it only for names and headers of recordings, and records its jumps in the log.

use std::time::{Duration, Instant};

use tomcom_core::base::time::SessionTime;
use tomcom_session::files::WallTime;

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
        let ahead_ms = WallTime::now().millis() - millis(offset);
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
        let ahead_ms = wall.millis() - millis(now);
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
        let wall_after = |ms: i64| wall.after_millis(ms);
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
}
