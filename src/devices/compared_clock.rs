//! Offset between this computer's clock and another clock, estimated from replies to time requests. The other clock is
//! that of Pupil Capture, or that of the Lab Streaming Layer.

use std::time::{Duration, Instant};

/// Number of clock replies averaged for the offset between two clocks (as Pupil Labs does).
pub(super) const ANSWERS: usize = 10;
/// Largest difference between two replies' offsets that the replies' delays do not explain, in seconds. Beyond it, the
/// other clock was slewed between the replies, and they are not averaged. Capture's Time Sync slews its clock by 0.5 ms
/// every 0.1 s, up to 10 ms in a row; clocks drift by far less.
const SLEWED_S: f64 = 0.0005;
/// Least change of the offset, beyond what slow replies explain, by which the other clock counts as set, in seconds.
const SET_S: f64 = 0.01;

/// A step of the other clock: somebody or something set that clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DeviceClockStep {
    /// Size of the other clock's step in seconds; negative if the clock was set back.
    pub by_s: f64,
    /// Instant before the step at which the other clock's offset was last found unchanged.
    pub known_at: Instant,
}

/// Estimator of the other clock's offset: mean over the latest replies, without slow replies and without replies from
/// before the clock was slewed. A delay in one direction shifts a reply's offset by half of the delay.
#[derive(Debug)]
pub(super) struct ClockOffsetEstimator {
    anchor: Instant,
    /// For each reply, the other clock's time minus seconds since the anchor, and the round-trip time in seconds; the
    /// newest reply is last.
    answers: Vec<(f64, f64)>,
    /// Instant at which the latest reply of the other clock arrived.
    known_at: Instant,
}

impl ClockOffsetEstimator {
    /// An estimator of a clock's offset without any reply yet.
    pub fn new() -> ClockOffsetEstimator {
        let now = Instant::now();
        ClockOffsetEstimator { anchor: now, answers: Vec::new(), known_at: now }
    }

    /// Adds a reply to a time request; returns the step of the other clock, if the reply shows one.
    pub fn take(&mut self, asked: Instant, answered: Instant, device_s: f64) -> Option<DeviceClockStep> {
        let since = |at: Instant| at.saturating_duration_since(self.anchor).as_secs_f64();
        let (offset, took_s) = (device_s - (since(asked) + since(answered)) / 2.0, since(answered) - since(asked));
        // A reply's offset is uncertain by half of its round-trip time; the mean of earlier replies is uncertain by no
        // more than the shortest round trip.
        let unsure_s = took_s / 2.0 + self.least_s().unwrap_or(0.0);
        let before = self.offset().filter(|before| (before - offset).abs() > SET_S + unsure_s);
        let step = before.map(|before| DeviceClockStep { by_s: offset - before, known_at: self.known_at });
        let is_past = |(old, old_took_s): &(f64, f64)| (old - offset).abs() > SLEWED_S + (old_took_s + took_s) / 2.0;
        match (step, self.answers.iter().rposition(is_past)) {
            (Some(_), _) => self.answers.clear(),
            (None, Some(last)) => drop(self.answers.drain(..=last)),
            (None, None) => {}
        }
        if self.answers.len() == ANSWERS {
            self.answers.remove(0);
        }
        self.answers.push((offset, took_s));
        self.known_at = answered;
        step
    }

    /// Shortest round trip of a request for the other clock's time, in seconds.
    fn least_s(&self) -> Option<f64> {
        self.answers.iter().map(|(_, took_s)| *took_s).min_by(f64::total_cmp)
    }

    fn offset(&self) -> Option<f64> {
        let least_s = self.least_s()?;
        let quick = self.answers.iter().filter(|(_, took_s)| *took_s <= 2.0 * least_s).map(|(offset, _)| *offset);
        let (sum, count) = quick.fold((0.0, 0u32), |(sum, count), offset| (sum + offset, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Instant on this computer that corresponds to a time of the other clock.
    pub fn instant(&self, device_s: f64) -> Option<Instant> {
        let since_s = device_s - self.offset()?;
        match Duration::try_from_secs_f64(since_s.abs()) {
            Ok(by) if since_s < 0.0 => self.anchor.checked_sub(by),
            Ok(by) => self.anchor.checked_add(by),
            Err(_) => None,
        }
    }

    /// Time of the other clock at an instant of this computer.
    pub fn device_s(&self, at: Instant) -> Option<f64> {
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
        let mut clock = ClockOffsetEstimator::new();
        let at = |ms: u64| clock.anchor + Duration::from_millis(ms);
        let [anchor, later] = [at(0), at(5000)];
        let after = |ms: u64| anchor + Duration::from_millis(ms);
        assert_eq!(clock.instant(7.0), None);
        // Test: the other clock is 100 s ahead; every third reply is late by 40 ms.
        for second in 0..30u64 {
            let asked = 1000 * second;
            let late = if second % 3 == 1 { 40 } else { 0 };
            let step = clock.take(after(asked), after(asked + 2 + late), 100.0 + asked as f64 / 1000.0 + 0.001);
            assert_eq!(step, None, "at {second} s");
        }
        let found = clock.instant(105.0).expect("a moment");
        let off = found.max(later) - found.min(later);
        assert!(off < Duration::from_micros(10), "{off:?}");
        assert!((clock.device_s(later).expect("a time") - 105.0).abs() < 1e-5);
        assert!((clock.device_s(anchor).expect("a time") - 100.0).abs() < 1e-5);
        assert_eq!(clock.take(after(29_500), after(29_502), 129.501), None);
        // Test: the other clock is set by 0.2 s, then by 20 ms; a slow reply of 60 ms does not count as a step.
        let step = clock.take(after(30_000), after(30_002), 130.201).expect("a step");
        assert!((step.by_s - 0.2).abs() < 0.002 && step.known_at == after(29_502), "{step:?}");
        assert!((clock.device_s(after(30_001)).expect("a time") - 130.201).abs() < 1e-9);
        assert_eq!(clock.take(after(30_250), after(30_310), 130.451), None);
        let step = clock.take(after(30_500), after(30_502), 130.681).expect("a step");
        assert!((step.by_s + 0.02).abs() < 0.002, "{step:?}");
        assert!(clock.take(after(31_000), after(31_002), 7.0).is_some());
        assert!((clock.device_s(after(31_001)).expect("a time") - 7.0).abs() < 1e-9);
        assert_eq!(clock.instant(1e300), None);
    }

    /// Recorded behaviour of Capture's Time Sync (`tests/pupil/time_sync.csv`), used in tests: seconds at which
    /// Capture's clock was asked and answered, Pupil time, and how far Pupil time was behind the true time.
    fn time_sync() -> Vec<[f64; 4]> {
        let numbers = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect::<Vec<f64>>();
        let table = include_str!("../../tests/pupil/time_sync.csv");
        table.lines().skip(1).map(|line| numbers(line).try_into().expect("four cells")).collect()
    }

    #[test]
    fn stamps_are_right_to_5_ms_while_time_sync_slews_the_clock() {
        let answers = time_sync();
        let bases: Vec<f64> = answers.iter().map(|[.., behind_s]| *behind_s).collect();
        let slewed_s: f64 = bases.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|by| *by < SET_S).sum();
        assert!(slewed_s > 0.015, "slewed by {slewed_s} s");
        let (mut clock, mut steps, mut wrong_s) = (ClockOffsetEstimator::new(), Vec::new(), 0.0_f64);
        for (index, [asked, answered, pupil_s, _]) in answers.iter().enumerate() {
            let at = |seconds: f64| clock.anchor + Duration::from_secs_f64(seconds);
            let (asked, answered) = (at(*asked), at(*answered));
            steps.extend(clock.take(asked, answered, *pupil_s));
            // A time stamp made at the next reply is converted with the offset estimated up to this reply.
            let Some([_, next_s, _, behind_s]) = answers.get(index + 1) else { continue };
            let told = clock.instant(next_s - behind_s).expect("a clock that was compared");
            let off_s = told.saturating_duration_since(clock.anchor).as_secs_f64() - next_s;
            // A step of the other clock is known from the next reply on.
            if (behind_s - bases[index]).abs() < SET_S {
                wrong_s = wrong_s.max(off_s.abs());
            }
        }
        assert!(wrong_s < 0.005, "wrong by {wrong_s} s");
        assert_eq!(
            steps.iter().map(|step| (step.by_s * 100.0).round() / 100.0).collect::<Vec<f64>>(),
            [0.05],
            "the jump"
        );
    }
}
