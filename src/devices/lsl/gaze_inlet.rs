//! Gaze from a stream of the Lab Streaming Layer (LSL), read by a separate thread. The stream may come and go.
//!
//! Samples are stamped by the sender's LSL clock; `lsl_time_correction` maps these stamps to this computer's LSL clock.
//! If a sender stamps samples by another clock, that clock's offset is estimated from the samples' arrival, as for
//! lines of JSON.

use std::sync::mpsc;
use std::time::{Duration, Instant};
use std::{io, thread};

use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::library::{DiscoveredLslStream, LslInletHandle, LslLibrary, LslStreamWatch};
use super::{COMPARE, LslThreadGuard, described, gaze_streams, predicate};
use crate::compared_clock::{ANSWERS, ClockOffsetEstimator};
use crate::gaze_input::{TrackerMessage, WAITING};
use crate::sender_clock::SenderClock;
use tomcom_core::gaze::GazeSample;
use tomcom_session::settings::LslGazeSpec;

/// Time for which a gaze stream is looked for before the thread checks whether the session goes on, in seconds.
const LOOK_S: f64 = 1.0;
/// Time limit for connecting to a gaze stream, for its metadata, and for the first clock comparison, in seconds.
const CONNECT_S: f64 = 5.0;
/// Longest time for which one wait for a gaze sample lasts, in seconds.
const SAMPLE_S: f64 = 0.2;
/// Pause before the next attempt to read a gaze stream that could not be read.
const RETRY: Duration = Duration::from_secs(1);

/// Reads the gaze stream in a separate thread until the session no longer listens. `display_m` is the size of the
/// display in metres.
///
/// # Errors
/// The thread cannot be started.
pub fn follow(
    library: LslLibrary,
    stream: LslGazeSpec,
    display_m: [f64; 2],
) -> io::Result<(Receiver<TrackerMessage>, LslThreadGuard)> {
    let ((news, heard), (end, ended)) = (channel(WAITING), mpsc::channel());
    let several = Vec::new();
    let mut inlet = GazeInlet { library, stream, display_m, news, lost: 0, complaint: None, several };
    let work = move || {
        inlet.run();
        // The side that waits for this thread may already have ended.
        let _ = end.send(());
    };
    thread::Builder::new().name("lsl-gaze".to_string()).spawn(work)?;
    Ok((heard, LslThreadGuard(ended)))
}

/// Names by which settings can refer to a gaze stream's channels: labels, or numbers for channels without a label.
pub fn channel_names(found: &DiscoveredLslStream, patience_s: f64) -> Option<Vec<String>> {
    let labels = found.connect(patience_s)?.labels(patience_s)?;
    let name = |(index, label): (usize, String)| if label.is_empty() { (index + 1).to_string() } else { label };
    Some(labels.into_iter().enumerate().map(name).collect())
}

/// The channel that the settings name but that is not among these labels; `None` if no channel is missing.
pub fn missing_channel(stream: &LslGazeSpec, labels: &[String]) -> Option<String> {
    channels(stream, labels).err()
}

/// Indices of the gaze stream's channels for x, y and confidence.
///
/// # Errors
/// The name of the channel that is missing.
fn channels(stream: &LslGazeSpec, labels: &[String]) -> Result<GazeChannels, String> {
    let place = |name: &String| {
        let by_number = name.parse::<usize>().ok().filter(|number| (1..=labels.len()).contains(number));
        let by_label = labels.iter().position(|label| label == name);
        by_label.or(by_number.map(|number| number - 1)).ok_or_else(|| name.clone())
    };
    let confidence = stream.confidence.as_ref().map(place).transpose()?;
    Ok(GazeChannels { x: place(&stream.x)?, y: place(&stream.y)?, confidence })
}

/// Error: nobody receives the gaze any more, so that reading has to end.
struct NobodyListens;

/// Reader of a gaze stream of the Lab Streaming Layer.
struct GazeInlet {
    library: LslLibrary,
    stream: LslGazeSpec,
    display_m: [f64; 2],
    news: Sender<TrackerMessage>,
    /// Number of gaze samples that were dropped and have not been reported yet.
    lost: u64,
    /// Why the gaze stream cannot be read, if that was reported to the wizard.
    complaint: Option<String>,
    /// The streams among which the settings do not choose, as last reported.
    several: Vec<String>,
}

impl GazeInlet {
    fn run(&mut self) {
        while !self.news.is_closed() {
            if self.look().is_err() {
                return;
            }
        }
    }

    /// Looks for the gaze stream, and reads it until it is lost.
    fn look(&mut self) -> Result<(), NobodyListens> {
        let found = gaze_streams(self.library, &self.stream, LOOK_S);
        self.tell_several(&found)?;
        let numbers = found.iter().find(|one| !one.is_text());
        // Where several streams fit, none is taken: it could be another person's gaze.
        let Some(chosen) = numbers.or(found.first()).filter(|_| self.several.is_empty()) else { return Ok(()) };
        if let Some(reason) = self.read(chosen)?
            && self.complaint.as_ref() != Some(&reason)
        {
            self.complaint = Some(reason.clone());
            self.tell(TrackerMessage::Lost(reason))?;
        }
        thread::sleep(RETRY);
        Ok(())
    }

    /// Reports the streams of numbers that fit the settings, if there are several, and when there are no longer several.
    fn tell_several(&mut self, found: &[DiscoveredLslStream]) -> Result<(), NobodyListens> {
        let mut several: Vec<String> = found.iter().filter(|one| !one.is_text()).map(described).collect();
        several.sort();
        if several.len() == 1 {
            several.clear();
        }
        if several == self.several {
            return Ok(());
        }
        self.several.clone_from(&several);
        self.tell(TrackerMessage::SeveralStreams(several))
    }

    /// Reads the gaze stream until it is lost; returns why the stream cannot be read, or `None` if it only vanished
    /// before it was connected.
    fn read(&mut self, found: &DiscoveredLslStream) -> Result<Option<String>, NobodyListens> {
        let [name, _, host] = found.identity();
        if found.is_text() {
            return Ok(Some(format!("the stream {name} has texts, not numbers")));
        }
        let Some(inlet) = found.connect(CONNECT_S) else { return Ok(None) };
        let Some(labels) = inlet.labels(CONNECT_S) else { return Ok(None) };
        let channels = match channels(&self.stream, &labels) {
            Ok(channels) => channels,
            Err(missing) => {
                let there: Vec<&str> = labels.iter().map(String::as_str).filter(|label| !label.is_empty()).collect();
                let there = if there.is_empty() { "no labels".to_string() } else { there.join(", ") };
                return Ok(Some(format!("the stream {name} has no channel \"{missing}\"; it has {there}")));
            }
        };
        self.tell(TrackerMessage::Connected(format!("{name} on {host}")))?;
        self.complaint = None;
        let watch = self.library.watch(&predicate(&self.stream));
        self.pass(&inlet, &channels, watch.as_ref())?;
        Ok(Some(format!("the stream {name} on {host} ended")))
    }

    /// Passes on gaze samples until the LSL stream is lost. `watch` finds streams that could have been meant instead.
    fn pass(
        &mut self,
        inlet: &LslInletHandle,
        channels: &GazeChannels,
        watch: Option<&LslStreamWatch>,
    ) -> Result<(), NobodyListens> {
        let mut clock = ClockOffsetEstimator::new();
        (0..ANSWERS).for_each(|_| compare(&mut clock, &self.library));
        let mut stamps = StreamStamps::new(inlet.time_correction(CONNECT_S));
        // The library kept samples meanwhile, which are late.
        inlet.flush();
        let (mut compared, mut values) = (Instant::now(), Vec::new());
        loop {
            let pulled = inlet.pull(&mut values, SAMPLE_S);
            if self.news.is_closed() {
                return Err(NobodyListens);
            }
            if compared.elapsed() >= COMPARE {
                compared = Instant::now();
                compare(&mut clock, &self.library);
                if let Some(step) = stamps.correct(inlet.time_correction(0.0)) {
                    self.tell(step)?;
                }
                if let Some(watch) = watch {
                    self.tell_several(&watch.streams())?;
                }
            }
            match pulled {
                Ok(Some(stamp_s)) => self.take(stamp_s, &values, channels, &mut stamps, &clock),
                Ok(None) => {}
                Err(_) if stamps.is_faulty() => return self.tell(TrackerMessage::Stamps(None)),
                Err(_) => return Ok(()),
            }
        }
    }

    /// Passes a gaze sample of an LSL stream on to the session.
    fn take(
        &mut self,
        stamp_s: f64,
        values: &[f64],
        channels: &GazeChannels,
        stamps: &mut StreamStamps,
        clock: &ClockOffsetEstimator,
    ) {
        let value = |channel: usize| values.get(channel).copied().unwrap_or(f64::NAN);
        let point = [value(channels.x), value(channels.y)];
        let confidence = channels.confidence.map_or(1.0, value);
        // A tracker that does not see the eyes sends NaN, which is neither a sample nor a fault.
        if point.iter().any(|coordinate| coordinate.is_nan()) || confidence.is_nan() {
            return;
        }
        let [x, y] = self.stream.to_display(point, self.display_m);
        if !(x.is_finite() && y.is_finite() && (0.0..=1.0).contains(&confidence)) {
            self.offer(TrackerMessage::Malformed(1));
            return;
        }
        let (taken, told) = stamps.taken(stamp_s, clock, Instant::now());
        if let Some(told) = told {
            self.offer(told);
        }
        let sample = GazeSample { device_ns: Some((stamp_s * 1e9) as i64), ..GazeSample::new(x, y, confidence) };
        self.offer(TrackerMessage::Sample(sample, Some(taken)));
    }

    /// Sends a message that must not be lost; waits if the session is slow to receive messages.
    fn tell(&self, news: TrackerMessage) -> Result<(), NobodyListens> {
        self.news.blocking_send(news).map_err(|_| NobodyListens)
    }

    /// Sends a message that may be dropped, and counts messages that were dropped.
    fn offer(&mut self, news: TrackerMessage) {
        self.lost += u64::from(self.news.try_send(news).is_err());
        if self.lost > 0 && self.news.try_send(TrackerMessage::Overrun(self.lost)).is_ok() {
            self.lost = 0;
        }
    }
}

/// Indices of the coordinates and of the confidence among the stream's channels.
struct GazeChannels {
    x: usize,
    y: usize,
    confidence: Option<usize>,
}

pub(super) fn compare(clock: &mut ClockOffsetEstimator, library: &LslLibrary) {
    let asked = Instant::now();
    let lsl_s = library.local_clock();
    clock.take(asked, Instant::now(), lsl_s);
}

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
