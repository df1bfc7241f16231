//! Converts the time stamps of one sender's gaze samples to instants. Every sender has a clock of its own, so that no
//! sender can move the clock of another one.

use std::time::{Duration, Instant};

use super::arrival::Arrival;
use super::gaze_input::TrackerMessage;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::device_clock::{ClockNews, ClockStep, DeviceClock};

/// Time before the sender's first message in which its samples can have been taken: a sender may begin with old ones.
const BEFORE: Duration = Duration::from_secs(86_400);

/// The clock of one sender of gaze, with the time that `DeviceClock` needs: it is [`BEFORE`] at `origin`.
#[derive(Debug)]
pub(super) struct SenderClock {
    origin: Instant,
    clock: DeviceClock,
    /// Device time and position of the last sample.
    last: Option<(i64, [u64; 2])>,
}

impl SenderClock {
    /// The clock of a sender whose first message arrives now.
    pub fn new(now: Instant) -> SenderClock {
        SenderClock { origin: now, clock: DeviceClock::default(), last: None }
    }

    /// Learns from a sample with this device time that arrived now; returns a message if the sample shows that the
    /// sender's clock was set, or whether its stamps can be used.
    pub fn learn(&mut self, device_ns: i64, arrived: Instant) -> Option<TrackerMessage> {
        Some(match self.clock.learn(device_ns, self.time(arrived))? {
            ClockNews::Set(ClockStep { by_ns, uncertain_since }) => {
                TrackerMessage::ClockSet { by_s: by_ns as f64 / 1e9, known_at: self.instant(uncertain_since) }
            }
            ClockNews::Stamps(verdict) => TrackerMessage::Stamps(verdict.err()),
        })
    }

    /// Instant at which a sample with this device time was taken; `None` if the stamps do not say it.
    pub fn taken(&self, device_ns: i64, arrived: Instant) -> Option<Instant> {
        Some(self.instant(self.clock.session_time(device_ns, self.time(arrived))?))
    }

    /// Whether the time stamps cannot be used.
    pub fn is_faulty(&self) -> bool {
        self.clock.is_faulty()
    }

    /// The messages of samples that arrived together, with the instants at which the samples were taken. The newest
    /// sample arrived soonest after it was taken, so all are learned from before the first one gets its time.
    pub fn stamp(&mut self, mut found: Vec<TrackerMessage>, arrival: Arrival) -> Vec<TrackerMessage> {
        let mut messages = Vec::new();
        for one in &found {
            // The age of a sample, if the sender knows it, says more than its stamp.
            let TrackerMessage::Sample(sample, None) = one else { continue };
            let Some(device_ns) = sample.device_ns else { continue };
            let mark = (device_ns, [sample.x.to_bits(), sample.y.to_bits()]);
            if arrival.is_known() && self.last.replace(mark) != Some(mark) {
                messages.extend(self.learn(device_ns, arrival.by));
            }
        }
        for one in &mut found {
            if let TrackerMessage::Sample(GazeSample { device_ns, .. }, taken @ None) = one {
                let by_stamp = device_ns.and_then(|device_ns| self.taken(device_ns, arrival.by));
                *taken = by_stamp.or_else(|| (!arrival.is_known()).then_some(arrival.after));
            }
        }
        messages.append(&mut found);
        messages
    }

    fn time(&self, at: Instant) -> SessionTime {
        SessionTime((BEFORE + at.saturating_duration_since(self.origin)).as_nanos() as u64)
    }

    fn instant(&self, time: SessionTime) -> Instant {
        let since = Duration::from_nanos(time.0);
        match since.checked_sub(BEFORE) {
            Some(after) => self.origin + after,
            None => self.origin.checked_sub(BEFORE - since).unwrap_or(self.origin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tomcom_core::gaze::quality::TOO_OLD_S;

    /// A sample with these stamps; each is of another place.
    fn sample(t: Option<f64>, number: u64) -> TrackerMessage {
        let device_ns = t.map(|t| (t * 1e9) as i64);
        TrackerMessage::Sample(GazeSample { device_ns, ..GazeSample::new(number as f64 * 1e-4, 0.5, 1.0) }, None)
    }

    /// Ages of these samples when they were read, in seconds; `None` for those that count as taken when they are recorded.
    fn ages_s(messages: &[TrackerMessage], read: Instant) -> Vec<Option<f64>> {
        let age_s = |taken: &Instant| read.saturating_duration_since(*taken).as_secs_f64();
        let age = |one: &TrackerMessage| match one {
            TrackerMessage::Sample(_, taken) => Some(taken.as_ref().map(age_s)),
            _ => None,
        };
        messages.iter().filter_map(age).collect()
    }

    fn at(start: Instant, seconds: f64) -> Instant {
        start + Duration::from_secs_f64(seconds)
    }

    fn at_once(at: Instant) -> Arrival {
        Arrival { after: at, by: at }
    }

    #[test]
    fn what_waited_while_the_program_stood_still_is_not_from_now() {
        let start = Instant::now();
        for has_t in [false, true] {
            let mut clock = SenderClock::new(start);
            let t = |seconds: f64| has_t.then_some(50.0 + seconds);
            for number in 0..600u64 {
                let read = at(start, number as f64 / 120.0);
                let messages = clock.stamp(vec![sample(t(number as f64 / 120.0), number)], at_once(read));
                let age_s = ages_s(&messages, read)[0];
                assert!(age_s.is_none() != has_t && age_s.is_none_or(|age_s| age_s < 1e-6), "{number}: {age_s:?}");
            }
            // The program stands still from 5 s to 9 s; then all samples of that time are read together.
            let (after, by) = (at(start, 5.0), at(start, 9.0));
            let waited: Vec<TrackerMessage> =
                (600..1080).map(|number| sample(t(number as f64 / 120.0), number)).collect();
            let messages = clock.stamp(waited, Arrival { after, by });
            assert_eq!(messages.len(), 480, "no clock was set");
            for (number, age_s) in (600u64..).zip(ages_s(&messages, by)) {
                let age_s = age_s.expect("a time");
                let truth_s = 9.0 - number as f64 / 120.0;
                // Without stamps none of them can be told from one that waited all the time.
                let wanted_s = if has_t { truth_s } else { 4.0 };
                assert!((age_s - wanted_s).abs() < 1e-6, "{number}: {age_s} s");
                assert!(has_t || age_s > TOO_OLD_S);
            }
            let read = at(start, 9.01);
            let messages = clock.stamp(vec![sample(t(9.01), 2000)], at_once(read));
            assert!(ages_s(&messages, read)[0].is_none_or(|age_s| age_s < 1e-6), "{messages:?}");
        }
    }

    #[test]
    fn a_sender_that_begins_while_the_program_stands_still_gets_its_clock_from_later_samples() {
        let start = Instant::now();
        let mut clock = SenderClock::new(at(start, 4.0));
        let waited: Vec<TrackerMessage> = (0..480).map(|number| sample(Some(number as f64 / 120.0), number)).collect();
        let (after, by) = (start, at(start, 4.0));
        let ages = ages_s(&clock.stamp(waited, Arrival { after, by }), by);
        assert_eq!(ages, vec![Some(4.0); 480]);
        let read = at(start, 4.005);
        let messages = clock.stamp(vec![sample(Some(4.0), 480)], at_once(read));
        assert_eq!(ages_s(&messages, read), [Some(0.0)]);
    }

    #[test]
    fn samples_that_arrive_together_are_as_old_as_their_stamps_say() {
        let start = Instant::now();
        let mut clock = SenderClock::new(start);
        let together: Vec<TrackerMessage> =
            (0..880).map(|number| sample(Some(number as f64 / 120.0), number)).collect();
        let ages = ages_s(&clock.stamp(together, at_once(start)), start);
        for (number, age_s) in ages.into_iter().enumerate() {
            let wanted_s = (879 - number) as f64 / 120.0;
            assert!(age_s.is_some_and(|age_s| (age_s - wanted_s).abs() < 1e-6), "{number}: {age_s:?}");
        }
    }

    #[test]
    fn a_sample_that_is_sent_again_says_nothing_about_the_clock() {
        let start = Instant::now();
        let mut clock = SenderClock::new(start);
        for number in 0..600u64 {
            // For two seconds the tracker sees no eyes, and the sender repeats its last sample.
            let last = if (240..480).contains(&number) { 240 } else { number };
            let read = at(start, number as f64 / 120.0);
            let messages = clock.stamp(vec![sample(Some(last as f64 / 120.0), last)], at_once(read));
            assert!(messages.len() == 1 || messages[0] == TrackerMessage::Stamps(None), "{number}: {messages:?}");
        }
    }
}
