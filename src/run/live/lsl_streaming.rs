//! Live streams of the Lab Streaming Layer: samples of every event go to a thread, so that the session never waits for
//! the network.

use std::rc::Rc;

use crate::console::console_model::LslStatus;
use crate::run::clock::SessionClock;
use crate::run::operator_station::OperatorStation;
use tomcom_core::base::text::count;
use tomcom_devices::lsl::{LslCounts, LslSampleConverter, LslStreams, StreamSample};
use tomcom_session::engine::SessionEngine;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::{Session, TimestampedEvent};

/// Sends a session's samples to its LSL streams.
pub(super) struct LslStreaming {
    maker: LslSampleConverter,
    streams: Rc<LslStreams>,
    /// Numbers of lost LSL samples that the wizard was told last.
    told: LslCounts,
}

impl LslStreaming {
    /// The LSL streams for a recording with this name, which begins now; `None` if the session sends none.
    ///
    /// # Errors
    /// The LSL streams cannot be opened, for this reason; the session can continue without them.
    pub fn open(
        station: &mut OperatorStation,
        session: &Session,
        recording: &str,
        clock: &SessionClock,
    ) -> Result<Option<LslStreaming>, String> {
        let streams = station.lsl.streams(session).map_err(|error| error.to_string())?;
        let open = |streams: Rc<LslStreams>| {
            let (maker, told) = (LslSampleConverter::new(session, recording), streams.counts());
            let streaming = LslStreaming { maker, streams, told };
            streaming.send(streaming.maker.opening(session, session.time), clock);
            streaming
        };
        Ok(streams.map(open))
    }

    /// Sends the samples of events that have just been recorded. `belief`: the belief estimate after the last event.
    pub fn tell(
        &mut self,
        events: &[TimestampedEvent],
        engine: &SessionEngine,
        belief: &BeliefSnapshot,
        clock: &SessionClock,
    ) {
        let samples = self.maker.samples(events, engine.session(), engine.judged(), belief);
        self.send(samples, clock);
    }

    fn send(&self, samples: Vec<StreamSample>, clock: &SessionClock) {
        let timed = |sample: StreamSample| (clock.instant_of(sample.time), sample);
        self.streams.tell(samples.into_iter().map(timed).collect());
    }

    pub fn status(&self) -> LslStatus {
        let LslCounts { sent, dropped, refused } = self.streams.counts();
        let names = self.streams.descriptions.iter().map(|stream| stream.outlet.name().to_string()).collect();
        LslStatus { streams: names, sent, lost: dropped + refused }
    }

    /// Message to the wizard about LSL samples that were lost since the last call.
    pub fn complaint(&mut self) -> Option<String> {
        let now = self.streams.counts();
        let before = std::mem::replace(&mut self.told, now);
        let (dropped, refused) = (now.dropped - before.dropped, now.refused - before.refused);
        match (dropped, refused) {
            (0, 0) => None,
            (_, 0) => Some(format!("LSL: {} dropped, the session goes on", count(dropped, "sample", "samples"))),
            _ => Some(format!("LSL: {} refused by liblsl, the session goes on", count(refused, "sample", "samples"))),
        }
    }
}
