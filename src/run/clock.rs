//! Clocks of the program. Session time comes from the monotonic clock. The wall clock can be set and can jump; the
//! program uses it only for names and headers of recordings, and records its jumps in the log.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use tomcom_core::base::time::SessionTime;
use tomcom_session::files::WallTime;

/// Gap between two readings of the clock after which the program counts as having been suspended.
const STANDSTILL: Duration = Duration::from_secs(1);
/// Least change of the difference between wall clock and session time that counts as a jump, in milliseconds.
const JUMP_MS: i64 = 500;

/// Time of the monotonic clock since its first reading, in nanoseconds.
pub fn monotonic_ns() -> u64 {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    BEGAN.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

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

    pub fn at(&mut self, now: Instant) -> SessionTime {
        let gap = now.saturating_duration_since(self.looked);
        self.looked = now;
        if gap > STANDSTILL {
            self.stood += gap;
        }
        let passed = now.saturating_duration_since(self.began).saturating_sub(self.stood);
        self.offset + SessionTime(passed.as_nanos() as u64)
    }

    pub fn jump_at(&mut self, now: SessionTime, wall: WallTime) -> Option<i64> {
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
