//! Gaze from a stream of the Lab Streaming Layer (LSL), read by a separate thread. The stream may come and go.
//!
//! Samples are stamped by the sender's LSL clock; `lsl_time_correction` maps these stamps to this computer's LSL clock.
//! If a sender stamps samples by another clock, that clock's offset is estimated from the samples' arrival, as for
//! lines of JSON.

use std::io;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::gaze_stamps::StreamStamps;
use super::library::{DiscoveredLslStream, LslInletHandle, LslLibrary, LslStreamWatch};
use super::{described, gaze_streams, predicate};
use crate::compared_clock::{ANSWERS, ClockOffsetEstimator};
use crate::gaze_input::{TrackerMessage, WAITING};
use tomcom_core::gaze::GazeSample;
use tomcom_session::settings::LslGazeSpec;

/// Time for which a gaze stream is looked for before the thread checks whether the session goes on, in seconds.
const LOOK_S: f64 = 1.0;
/// Time limit for connecting to a gaze stream, for its metadata, and for the first clock comparison, in seconds.
const CONNECT_S: f64 = 5.0;
/// Longest time for which one wait for a gaze sample lasts, in seconds.
const SAMPLE_S: f64 = 0.2;
/// Period of comparing LSL's clock with this computer's.
const COMPARE: Duration = Duration::from_secs(1);
/// Longest time for which the program's end waits for the end of the reading thread.
const END: Duration = Duration::from_secs(2);
/// Pause before the next attempt to read a gaze stream that could not be read.
const RETRY: Duration = Duration::from_secs(1);

/// Waits, when it is dropped, for the end of the reading thread, since liblsl must not be in use when the program ends.
/// The receiver of gaze messages must be dropped before this value.
#[derive(Debug)]
pub struct InletThreadGuard(mpsc::Receiver<()>);

impl Drop for InletThreadGuard {
    fn drop(&mut self) {
        // An LSL library that hangs does not delay the end of the program beyond the time limit.
        let _ = self.0.recv_timeout(END);
    }
}

/// Reads the gaze stream in a separate thread until the session no longer listens. `display_m` is the size of the
/// display in metres.
///
/// # Errors
/// The thread cannot be started.
pub fn follow(
    library: LslLibrary,
    stream: LslGazeSpec,
    display_m: [f64; 2],
) -> io::Result<(Receiver<TrackerMessage>, InletThreadGuard)> {
    let ((news, heard), (end, ended)) = (channel(WAITING), mpsc::channel());
    let several = Vec::new();
    let mut inlet = GazeInlet { library, stream, display_m, news, lost: 0, complaint: None, several };
    let work = move || {
        inlet.run();
        // The side that waits for this thread may already have ended.
        let _ = end.send(());
    };
    thread::Builder::new().name("lsl-gaze".to_string()).spawn(work)?;
    Ok((heard, InletThreadGuard(ended)))
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

/// Compares LSL's clock on this computer with the program's own clock.
pub(super) fn compare(clock: &mut ClockOffsetEstimator, library: &LslLibrary) {
    let asked = Instant::now();
    let lsl_s = library.local_clock();
    clock.take(asked, Instant::now(), lsl_s);
}
