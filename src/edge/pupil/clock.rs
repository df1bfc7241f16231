//! Offset of Pupil Capture's clock, from its answers to time requests.

use std::time::{Duration, Instant};

/// Number of clock replies averaged for the offset (as Pupil Labs does).
pub(super) const ANSWERS: usize = 10;
/// A change of the offset by more than this means that the clock was set, in seconds.
const SET_S: f64 = 0.25;

/// The offset of Capture's clock: mean over the latest replies without slow ones. A delay in one direction shifts a reply's offset by
/// half of the delay.
#[derive(Debug)]
pub(super) struct PupilClock {
    anchor: Instant,
    /// Pupil time minus seconds since the anchor, and round trip time in seconds, the newest last.
    answers: Vec<(f64, f64)>,
}

impl PupilClock {
    /// A clock that was not compared with Pupil's yet.
    pub fn new() -> PupilClock {
        PupilClock { anchor: Instant::now(), answers: Vec::new() }
    }

    /// Adds a reply to a time request.
    pub fn take(&mut self, asked: Instant, answered: Instant, pupil_s: f64) {
        let since = |at: Instant| at.saturating_duration_since(self.anchor).as_secs_f64();
        let (offset, took_s) = (pupil_s - (since(asked) + since(answered)) / 2.0, since(answered) - since(asked));
        // A clock that was set starts anew.
        if self.offset().is_some_and(|before| (before - offset).abs() > SET_S + took_s) {
            self.answers.clear();
        }
        if self.answers.len() == ANSWERS {
            self.answers.remove(0);
        }
        self.answers.push((offset, took_s));
    }

    fn offset(&self) -> Option<f64> {
        let least_s = self.answers.iter().map(|(_, took_s)| *took_s).fold(f64::INFINITY, f64::min);
        let quick = self.answers.iter().filter(|(_, took_s)| *took_s <= 2.0 * least_s).map(|(offset, _)| *offset);
        let (sum, count) = quick.fold((0.0, 0u32), |(sum, count), offset| (sum + offset, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Instant of a Pupil time.
    pub fn instant(&self, pupil_s: f64) -> Option<Instant> {
        let since_s = pupil_s - self.offset()?;
        match Duration::try_from_secs_f64(since_s.abs()) {
            Ok(by) if since_s < 0.0 => self.anchor.checked_sub(by),
            Ok(by) => self.anchor.checked_add(by),
            Err(_) => None,
        }
    }

    /// Pupil time of an instant.
    pub fn pupil_s(&self, at: Instant) -> Option<f64> {
        let since_s = match at.checked_duration_since(self.anchor) {
            Some(after) => after.as_secs_f64(),
            None => -self.anchor.duration_since(at).as_secs_f64(),
        };
        Some(since_s + self.offset()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_follows_the_answers_that_came_at_once_and_one_that_was_set() {
        let mut clock = PupilClock::new();
        let at = |ms: u64| clock.anchor + Duration::from_millis(ms);
        let [anchor, later] = [at(0), at(5000)];
        let after = |ms: u64| anchor + Duration::from_millis(ms);
        assert_eq!(clock.instant(7.0), None);
        // Capture's clock is 100 s ahead; every third answer is late by 40 ms.
        for second in 0..30u64 {
            let asked = 1000 * second;
            let late = if second % 3 == 1 { 40 } else { 0 };
            clock.take(after(asked), after(asked + 2 + late), 100.0 + asked as f64 / 1000.0 + 0.001);
        }
        let found = clock.instant(105.0).expect("a moment");
        let off = found.max(later) - found.min(later);
        assert!(off < Duration::from_micros(10), "{off:?}");
        assert!((clock.pupil_s(later).expect("a time") - 105.0).abs() < 1e-5);
        assert!((clock.pupil_s(anchor).expect("a time") - 100.0).abs() < 1e-5);
        clock.take(after(31_000), after(31_002), 7.0);
        assert!((clock.pupil_s(after(31_001)).expect("a time") - 7.0).abs() < 1e-9);
        assert_eq!(clock.instant(1e300), None);
    }
}
