//! Session time.

use std::fmt;
use std::ops::{Add, Sub};

use serde::{Deserialize, Serialize};

/// A time within a session, in nanoseconds since the session began. The wall clock and the clocks of eye trackers are
/// kept apart from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SessionTime(pub u64);

impl SessionTime {
    /// The beginning of the session.
    pub const ZERO: SessionTime = SessionTime(0);

    /// The session time `seconds` after the beginning of the session; negative values and NaN give zero.
    pub fn from_secs_f64(seconds: f64) -> Self {
        SessionTime((seconds.max(0.0) * 1e9).round() as u64)
    }

    /// A time that is written as clocks show it, `1:34`, or in seconds, `94.6`; `None` for other text. It is the last one that
    /// is shown so, since what is smaller is left out: every event of that time is before it.
    pub fn from_clock(text: &str) -> Option<Self> {
        let (minutes, seconds) = text.split_once(':').unwrap_or(("0", text));
        let (minutes, seconds): (u32, f64) = (minutes.parse().ok()?, seconds.parse().ok()?);
        let most = if text.contains(':') { 60.0 } else { f64::INFINITY };
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len() as u32);
        let left_out = SessionTime((1_000_000_000 / 10_u64.saturating_pow(decimals)).saturating_sub(1));
        let begins = SessionTime::from_secs_f64(f64::from(minutes) * 60.0 + seconds);
        (0.0..most).contains(&seconds).then_some(begins + left_out)
    }

    /// Seconds since the session began.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e9
    }

    /// Whole milliseconds since the session began. As on every clock here, what is smaller is left out.
    pub fn ms(self) -> u64 {
        self.0 / 1_000_000
    }

    /// Whether a clock in whole seconds shows a later time than at `end`.
    pub fn is_shown_after(self, end: SessionTime) -> bool {
        self.ms() / 1000 > end.ms() / 1000
    }

    /// To the tenth of a second: `6:42.3`.
    pub fn with_tenths(self) -> String {
        format!("{self}.{}", self.ms() / 100 % 10)
    }

    /// To the millisecond: `6:42.305`.
    pub fn with_ms(self) -> String {
        format!("{self}.{:03}", self.ms() % 1000)
    }

    /// Seconds to the millisecond: `402.305`.
    pub fn in_seconds(self) -> String {
        format!("{}.{:03}", self.ms() / 1000, self.ms() % 1000)
    }

    /// Seconds from the session time `earlier` to this time; zero if `earlier` is later.
    pub fn secs_since(self, earlier: SessionTime) -> f64 {
        (self - earlier).as_secs_f64()
    }
}

impl Add for SessionTime {
    type Output = SessionTime;
    fn add(self, other: SessionTime) -> SessionTime {
        SessionTime(self.0.saturating_add(other.0))
    }
}

impl Sub for SessionTime {
    type Output = SessionTime;
    fn sub(self, other: SessionTime) -> SessionTime {
        SessionTime(self.0.saturating_sub(other.0))
    }
}

impl fmt::Display for SessionTime {
    /// Session time in minutes and seconds, as on the console's clock: `6:42`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0 / 1_000_000_000;
        write!(f, "{}:{:02}", seconds / 60, seconds % 60)
    }
}
