//! How the scripted wizard reads offers of the assistant: after a while the wizard takes an offer, or ignores it.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::settings::OfferReading;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::UNREAD;

/// The part of the scripted wizard that reads the assistant's offers in one trial.
#[derive(Clone, Debug)]
pub struct OfferReader {
    spec: OfferReading,
    /// Standard deviation of the logarithm of the time for reading an offer.
    spread: f64,
    /// Random stream of the reader; the stream is separate so that the wizard's own judgement is the same with and
    /// without offers.
    random: Stream,
    /// The offer that the wizard will take: the time of the taking, and the offer's sequence number.
    takes: Option<(SessionTime, u64)>,
}

impl OfferReader {
    /// Creates the reader of offers in a trial; its random stream is seeded by (seed, trial).
    pub fn new(spec: OfferReading, spread: f64, seed: u64, trial: u64) -> OfferReader {
        OfferReader { spec, spread, random: stream(seed, "wizard's reading of offers", trial), takes: None }
    }

    /// Time at which the wizard will take an offer; `None` if the wizard will take no offer.
    pub fn due(&self) -> Option<SessionTime> {
        self.takes.map(|(time, _)| time)
    }

    /// Reacts to an offer that opens: decides whether the wizard will take the offer, and when. The new offer replaces
    /// the previous offer.
    pub fn on_offer(&mut self, now: SessionTime, offer: u64) {
        let normal: f64 = StandardNormal.sample(&mut self.random);
        let is_taken = self.random.random::<f64>() < self.spec.takes;
        let reading = SessionTime::from_secs_f64(self.spec.reads_s * (self.spread * normal).exp());
        self.takes = is_taken.then(|| (now + reading.max(UNREAD), offer));
    }

    /// The offer that the wizard takes now, if one is due.
    pub fn take(&mut self, now: SessionTime) -> Option<u64> {
        self.takes.take_if(|(time, _)| *time <= now).map(|(_, offer)| offer)
    }

    /// Delays the taking of an offer until `time`, if the taking is due earlier.
    pub fn wait_until(&mut self, time: SessionTime) {
        self.takes = self.takes.map(|(due, offer)| (due.max(time), offer));
    }

    /// Postpones the taking of an offer by the duration `by` of a pause.
    pub fn postpone(&mut self, by: SessionTime) {
        self.takes = self.takes.map(|(time, offer)| (time + by, offer));
    }
}
