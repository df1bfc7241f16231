//! Sends streams of the Lab Streaming Layer from a separate thread. The session never waits: if the thread is too slow,
//! samples are dropped and counted.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use super::gaze_inlet::compare;
use super::library::{LslLibrary, LslOutletHandle};
use super::lsl_error::LslError;
use crate::compared_clock::{ANSWERS, ClockOffsetEstimator};
use crate::lsl::{LslSampleValues, StreamDescription};
use tomcom_session::settings::LslOutlet;

/// Number of packets of samples that may wait to be sent: the packets of 20 seconds at 200 gaze samples per second.
const WAITING: usize = 4096;
/// Time limit within which the LSL library has to offer the streams.
const BEGIN: Duration = Duration::from_secs(10);
/// Time for which streams are still offered after their last sample, if a program reads them, since the library sends
/// from threads of its own.
const LINGER: Duration = Duration::from_millis(500);
/// Longest time for which the end of the program waits for the end of the sending thread.
const END: Duration = Duration::from_secs(2);
/// Period of comparing LSL's clock with this computer's.
const COMPARE: Duration = Duration::from_secs(1);

/// A sample for a stream, with the time of the event that it describes.
#[derive(Clone, Debug, PartialEq)]
pub struct LslSample {
    /// LSL stream to which the sample is sent.
    pub outlet: LslOutlet,
    /// Instant of the event that the sample describes.
    pub at: Instant,
    /// Values of the sample, one for each channel.
    pub values: LslSampleValues,
}

/// Numbers of samples sent over LSL, dropped, and refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LslCounts {
    /// Number of samples that the library accepted.
    pub sent: u64,
    /// Number of samples dropped because the sending thread was too slow.
    pub dropped: u64,
    /// Number of samples that the LSL library refused.
    pub refused: u64,
}

#[derive(Debug, Default)]
struct Counters {
    sent: AtomicU64,
    dropped: AtomicU64,
    refused: AtomicU64,
}

/// LSL streams that are offered to other programs until this value is dropped.
#[derive(Debug)]
pub struct LslStreams {
    /// Descriptions of the LSL streams that are offered.
    pub descriptions: Vec<StreamDescription>,
    /// Queue to the sending thread; `None` once no more samples will be sent.
    packets: Option<SyncSender<Vec<LslSample>>>,
    counters: Arc<Counters>,
    done: Receiver<()>,
}

impl LslStreams {
    /// Offers these LSL streams to other programs.
    ///
    /// # Errors
    /// The LSL library refuses one of the streams, or does not answer.
    pub fn offer(library: LslLibrary, descriptions: Vec<StreamDescription>) -> Result<LslStreams, LslError> {
        let (packets, told) = sync_channel::<Vec<LslSample>>(WAITING);
        let (begun, begins) = channel();
        let (end, done) = channel();
        let (counters, streams) = (Arc::new(Counters::default()), descriptions.clone());
        let counted = counters.clone();
        let work = move || {
            let outlets = match offer_all(library, &streams) {
                Ok(outlets) => outlets,
                Err(error) => return drop(begun.send(Err(error))),
            };
            if begun.send(Ok(())).is_ok() {
                send(library, &outlets, &told, &counted);
            }
            if outlets.values().any(LslOutletHandle::has_consumers) {
                thread::sleep(LINGER);
            }
            drop(outlets);
            // The side that waits for this thread may already have ended.
            let _ = end.send(());
        };
        thread::Builder::new().name("lsl".to_string()).spawn(work).map_err(|_| LslError::NoThread)?;
        begins.recv_timeout(BEGIN).map_err(|_| LslError::NoThread)??;
        Ok(LslStreams { descriptions, packets: Some(packets), counters, done })
    }

    /// Queues samples for sending, or drops the samples if the sending thread is too slow.
    pub fn tell(&self, samples: Vec<LslSample>) {
        let Some(packets) = self.packets.as_ref().filter(|_| !samples.is_empty()) else { return };
        if let Err(TrySendError::Full(samples) | TrySendError::Disconnected(samples)) = packets.try_send(samples) {
            self.counters.dropped.fetch_add(samples.len() as u64, Relaxed);
        }
    }

    /// Numbers of samples sent, dropped and refused so far.
    pub fn counts(&self) -> LslCounts {
        let Counters { sent, dropped, refused } = &*self.counters;
        LslCounts { sent: sent.load(Relaxed), dropped: dropped.load(Relaxed), refused: refused.load(Relaxed) }
    }
}

impl Drop for LslStreams {
    fn drop(&mut self) {
        self.packets = None;
        // An LSL library that hangs does not delay the end of the program beyond the time limit.
        let _ = self.done.recv_timeout(END);
    }
}

fn offer_all(
    library: LslLibrary,
    streams: &[StreamDescription],
) -> Result<BTreeMap<LslOutlet, LslOutletHandle>, LslError> {
    streams.iter().map(|stream| Ok((stream.outlet, library.offer(stream)?))).collect()
}

/// Sends the queued samples over LSL until the queue is closed.
fn send(
    library: LslLibrary,
    outlets: &BTreeMap<LslOutlet, LslOutletHandle>,
    told: &Receiver<Vec<LslSample>>,
    counters: &Counters,
) {
    let mut clock = ClockOffsetEstimator::new();
    (0..ANSWERS).for_each(|_| compare(&mut clock, &library));
    let mut compared = Instant::now();
    loop {
        let packet = match told.recv_timeout(COMPARE) {
            Ok(packet) => packet,
            Err(RecvTimeoutError::Timeout) => Vec::new(),
            Err(RecvTimeoutError::Disconnected) => return,
        };
        if compared.elapsed() >= COMPARE {
            compared = Instant::now();
            compare(&mut clock, &library);
        }
        for sample in &packet {
            let outlet = outlets.get(&sample.outlet).zip(clock.device_s(sample.at));
            let is_taken = outlet.is_some_and(|(outlet, time_s)| match &sample.values {
                LslSampleValues::Numbers(values) => outlet.push_numbers(values, time_s),
                LslSampleValues::Texts(values) => outlet.push_texts(values, time_s),
            });
            let counter = if is_taken { &counters.sent } else { &counters.refused };
            counter.fetch_add(1, Relaxed);
        }
    }
}
