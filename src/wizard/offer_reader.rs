//! How the scripted wizard reads offers of the assistant: after a while it takes an offer, or leaves it.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::settings::OfferReading;
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::communication::offer::UNREAD;

/// The reader of offers in one trial.
#[derive(Clone, Debug)]
pub struct OfferReader {
    spec: OfferReading,
    /// Standard deviation of the logarithm of the reading time.
    spread: f64,
    /// Its own stream, so that the wizard's own judgement is the same with and without offers.
    random: Stream,
    /// The offer that will be taken, by its sequence number, and when.
    takes: Option<(SessionTime, u64)>,
}

impl OfferReader {
    /// The reader of a trial; its random stream is seeded by (seed, trial).
    pub fn new(spec: OfferReading, spread: f64, seed: u64, trial: u64) -> OfferReader {
        OfferReader { spec, spread, random: stream(seed, "wizard's reading of offers", trial), takes: None }
    }

    /// Time at which an offer is taken; `None` if none is.
    pub fn due(&self) -> Option<SessionTime> {
        self.takes.map(|(time, _)| time)
    }

    /// An offer opens: decides whether it will be taken, and when. An offer that opens replaces the one before.
    pub fn on_offer(&mut self, now: SessionTime, offer: u64) {
        let normal: f64 = StandardNormal.sample(&mut self.random);
        let is_taken = self.random.random::<f64>() < self.spec.takes;
        let reading = SessionTime::from_secs_f64(self.spec.reads_s * (self.spread * normal).exp());
        self.takes = is_taken.then(|| (now + reading.max(UNREAD), offer));
    }

    /// The offer to take now, if one is due.
    pub fn take(&mut self, now: SessionTime) -> Option<u64> {
        self.takes.take_if(|(time, _)| *time <= now).map(|(_, offer)| offer)
    }

    /// Delays what is due until `time`, if it is due before.
    pub fn wait_until(&mut self, time: SessionTime) {
        self.takes = self.takes.map(|(due, offer)| (due.max(time), offer));
    }

    /// Postpones the taking of an offer by the duration `by` of a pause.
    pub fn postpone(&mut self, by: SessionTime) {
        self.takes = self.takes.map(|(time, offer)| (time + by, offer));
    }
}
