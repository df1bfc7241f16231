//! Conversion of the time stamps of a Lab Streaming Layer (LSL) stream into times on this computer.

use std::time::Instant;

use crate::edge::compared_clock::ClockOffsetEstimator;
use crate::edge::gaze_input::TrackerMessage;
use crate::edge::sender_clock::SenderClock;

/// Largest age of the first sample, in seconds, at which its time stamp still counts as one of LSL's clock.
const OLDEST_S: f64 = 2.0;
/// Largest time by which the first sample's stamp may lie in the future, in seconds, to count as one of LSL's clock;
/// comparing the clocks of two computers is more exact than this.
const AHEAD_S: f64 = 0.05;
/// Least change of the clock correction from which the sender's clock counts as set, in seconds.
const SET_S: f64 = 0.01;

/// Maps time stamps of a gaze stream to instants. A stamp plus the correction is a time of this computer's LSL clock.
/// If the first sample shows that it is not, the offset is estimated from the samples' arrival; if several samples
/// agree that the sender's clock was set, the mapping follows the change. Stamps that do not advance as time does are
/// not used.
#[derive(Debug)]
pub(super) struct StreamStamps {
    /// Correction that is added to the stream's stamps, in seconds.
    correction_s: Option<f64>,
    /// Instant at which the clock correction was last found unchanged.
    known_at: Instant,
    sender: SenderClock,
    /// Seconds by which the sender's clock is ahead of LSL's clock; `None` before the first sample.
    ahead_s: Option<f64>,
    /// Whether the time stamps come from another clock than LSL's.
    is_foreign: bool,
}

impl StreamStamps {
    /// Mapping for a stream with this clock correction; `None` if the two computers' clocks could not be compared.
    pub fn new(correction_s: Option<f64>) -> StreamStamps {
        let now = Instant::now();
        StreamStamps { correction_s, known_at: now, sender: SenderClock::new(now), ahead_s: None, is_foreign: false }
    }

    /// Takes over a new clock correction; returns a message if the clock of the sender's computer was set.
    pub fn correct(&mut self, correction_s: Option<f64>) -> Option<TrackerMessage> {
        let (correction_s, now) = (correction_s?, Instant::now());
        let by_s = self.correction_s.map(|before| before - correction_s).filter(|by_s| by_s.abs() > SET_S);
        let step = by_s.map(|by_s| TrackerMessage::ClockSet { by_s, known_at: self.known_at });
        if by_s.is_some() {
            self.sender = SenderClock::new(now);
        }
        (self.correction_s, self.known_at) = (Some(correction_s), now);
        step
    }

    /// Whether the time stamps do not advance as time does.
    pub fn is_faulty(&self) -> bool {
        self.sender.is_faulty()
    }

    /// Instant at which a sample that has just arrived was taken, from its time stamp; and a message if the sender's
    /// clock was set, or if its stamps cannot be used.
    pub fn taken(
        &mut self,
        stamp_s: f64,
        clock: &ClockOffsetEstimator,
        now: Instant,
    ) -> (Instant, Option<TrackerMessage>) {
        let corrected_s = stamp_s + self.correction_s.unwrap_or(0.0);
        let late_s = clock.device_s(now).map(|now_s| now_s - corrected_s);
        if self.ahead_s.is_none() {
            let is_lsl =
                self.correction_s.is_some() && late_s.is_some_and(|late_s| (-AHEAD_S..=OLDEST_S).contains(&late_s));
            (self.ahead_s, self.is_foreign) = (Some(0.0), !is_lsl);
        }
        let device_ns = (corrected_s * 1e9) as i64;
        let told = self.sender.learn(device_ns, now);
        if let Some(TrackerMessage::ClockSet { by_s, .. }) = told {
            self.ahead_s = self.ahead_s.map(|ahead_s| ahead_s + by_s);
        }
        let taken = match self.is_foreign || self.sender.is_faulty() {
            true => self.sender.taken(device_ns, now),
            false => clock.instant(corrected_s - self.ahead_s.unwrap_or(0.0)),
        };
        (taken.map_or(now, |taken| taken.min(now)), told)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use tomcom_core::gaze::device_clock::StampFault;

    /// Test data: this computer's clock, and LSL's clock, which is 100 s ahead of the seconds since `origin`.
    fn clocks() -> (Instant, ClockOffsetEstimator) {
        let (origin, mut clock) = (Instant::now(), ClockOffsetEstimator::new());
        for ms in 0..10 {
            let at = origin + Duration::from_millis(ms);
            clock.take(at, at, 100.0 + ms as f64 / 1000.0);
        }
        (origin, clock)
    }

    fn off_s(found: Instant, wanted: Instant) -> f64 {
        found.max(wanted).duration_since(found.min(wanted)).as_secs_f64()
    }

    #[test]
    fn stamps_of_lsl_are_corrected_and_a_delay_does_not_move_them() {
        let (origin, clock) = clocks();
        // Test: the sender's clock is 5 s behind; samples arrive 8 ms after they were taken, every fifth one after 40
        // ms.
        let mut stamps = StreamStamps::new(Some(5.0));
        for index in 0..400u64 {
            let taken = origin + Duration::from_millis(1000 + 5 * index);
            let delay = Duration::from_millis(if index % 5 == 4 { 40 } else { 8 });
            let (found, step) = stamps.taken(96.0 + 0.005 * index as f64, &clock, taken + delay);
            assert!(off_s(found, taken) < 1e-4 && step.is_none(), "{index}: {:?}", off_s(found, taken));
        }
    }

    #[test]
    fn stamps_that_are_set_are_followed_and_told_once() {
        let (origin, clock) = clocks();
        let mut stamps = StreamStamps::new(Some(0.0));
        let mut told = Vec::new();
        for index in 0..800u64 {
            let taken = origin + Duration::from_millis(1000 + 5 * index);
            let set_s = if index < 400 { 0.0 } else { -0.7 };
            let (found, step) =
                stamps.taken(101.0 + 0.005 * index as f64 + set_s, &clock, taken + Duration::from_millis(8));
            told.extend(step);
            if !(400..500).contains(&index) {
                assert!(off_s(found, taken) < 1e-3, "{index}: {}", off_s(found, taken));
            }
        }
        assert!(matches!(&told[..], [TrackerMessage::ClockSet { by_s, .. }] if (by_s + 0.7).abs() < 1e-6), "{told:?}");
    }

    #[test]
    fn stamps_of_another_clock_are_read_by_arrival() {
        let (origin, clock) = clocks();
        for correction in [Some(0.0), None] {
            let mut stamps = StreamStamps::new(correction);
            for index in 0..400u64 {
                let taken = origin + Duration::from_millis(1000 + 5 * index);
                // Test: the time stamps are seconds since 1970.
                let (found, step) =
                    stamps.taken(1.7e9 + 0.005 * index as f64, &clock, taken + Duration::from_millis(8));
                assert!(off_s(found, taken) < 0.009 && step.is_none(), "{index}: {}", off_s(found, taken));
            }
        }
    }

    #[test]
    fn stamps_that_do_not_run_with_time_are_told_and_not_used() {
        let (origin, clock) = clocks();
        // Test: the sender counts its samples, and is slower by 3 % than the rate that it assumes.
        let mut stamps = StreamStamps::new(Some(0.0));
        let mut told = Vec::new();
        for index in 0..4000u64 {
            let arrived = origin + Duration::from_micros(1_000_000 + 5150 * index);
            let (found, news) = stamps.taken(101.0 + 0.005 * index as f64, &clock, arrived);
            told.extend(news);
            assert!(off_s(found, arrived) < 0.2, "{index}: {}", off_s(found, arrived));
            assert!(index < 1000 || found == arrived, "{index}");
        }
        let [TrackerMessage::Stamps(Some(fault @ StampFault::Rate(_)))] = told[..] else { panic!("{told:?}") };
        assert_eq!(fault.words(), "t runs at 97 % of real time");
    }

    #[test]
    fn a_clock_that_was_set_is_told_by_its_correction() {
        let mut stamps = StreamStamps::new(Some(3.0));
        assert_eq!(stamps.correct(Some(3.004)), None);
        assert_eq!(stamps.correct(None), None);
        let told = stamps.correct(Some(2.5));
        assert!(matches!(told, Some(TrackerMessage::ClockSet { by_s, .. }) if (by_s - 0.504).abs() < 1e-9), "{told:?}");
    }
}
