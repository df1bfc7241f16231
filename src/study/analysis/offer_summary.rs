//! Statistics of the offers of a trial: how long they stood, why they closed, and whether the wizard sent the offered
//! signal.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::{Offer, OfferCloseReason, OfferKeyKind};
use tomcom_core::measures::median;
use tomcom_session::Session;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimedOffer {
    pub offer: Offer,
    pub opened_s: f64,
    /// Duration for which the offer stood, in seconds; `None` if the recording was cut while the offer was open.
    pub stood_s: Option<f64>,
    pub reason: Option<OfferCloseReason>,
    /// Time at which the wizard sent the offered signal, on the trial's clock; `None` if the signal was not sent.
    pub sent: Option<SessionTime>,
    pub reaction_s: Option<f64>,
}

impl TimedOffer {
    pub fn all(session: &Session) -> Vec<TimedOffer> {
        let timed = |offer: &Offer, closed: Option<(f64, OfferCloseReason)>| {
            let opened_s = session.trial_clock_at(offer.opened).as_secs_f64();
            let sent = offer.used.map(|used| session.trial_clock_at(used.at));
            TimedOffer {
                offer: offer.clone(),
                opened_s,
                stood_s: closed.map(|(closed_s, _)| closed_s - opened_s),
                reason: closed.map(|(_, reason)| reason),
                sent,
                reaction_s: sent.map(|sent| sent.as_secs_f64() - opened_s),
            }
        };
        let closed = session.offers.closed().iter();
        let closed =
            closed.map(|one| timed(&one.offer, Some((session.trial_clock_at(one.closed).as_secs_f64(), one.reason))));
        closed.chain(session.offers.unclosed().map(|open| timed(open, None))).collect()
    }

    pub fn visible(session: &Session) -> Vec<TimedOffer> {
        let all = TimedOffer::all(session).into_iter();
        all.filter(|one| one.offer.advice.visible).collect()
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfferDurations {
    pub n: u64,
    pub median_s: Option<f64>,
    pub shortest_s: Option<f64>,
}

impl OfferDurations {
    fn from_times(times: Vec<f64>) -> OfferDurations {
        let shortest_s = times.iter().copied().reduce(f64::min);
        OfferDurations { n: times.len() as u64, median_s: median(times), shortest_s }
    }

    pub fn describe(&self) -> String {
        let (Some(median_s), Some(shortest_s)) = (self.median_s, self.shortest_s) else { return String::new() };
        format!("offers: {}, {median_s:.1} s in the median, {shortest_s:.1} s at least\n", self.n)
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfferSummary {
    #[serde(flatten)]
    pub all: OfferDurations,
    pub by_reason: BTreeMap<OfferCloseReason, OfferDurations>,
    /// Number of offers whose signal was sent by the key that takes the offer (`enter`).
    pub taken: u64,
    /// Number of offers whose signal was sent by the signal's own key.
    pub by_own_key: u64,
    pub not_taken: u64,
    /// Median time from the opening to the key that sent the signal, in seconds; null if none was sent.
    pub reaction_s: Option<f64>,
}

impl OfferSummary {
    /// The summary of these offers. An offer that was still open where a recording was cut is not counted.
    pub fn from_offers<'a>(offers: impl IntoIterator<Item = &'a TimedOffer>) -> OfferSummary {
        let mut tally = OfferTally::default();
        offers.into_iter().for_each(|offer| tally.add(offer));
        tally.summary()
    }

    pub fn describe(&self) -> String {
        if self.all.n == 0 {
            return String::new();
        }
        let reaction = self.reaction_s.map_or(String::new(), |s| format!(", after {s:.1} s in the median"));
        let (durations, taken, by_own_key) = (self.all.describe(), self.taken, self.by_own_key);
        format!("{durations}        {taken} taken, {by_own_key} sent by their own key{reaction}\n")
    }
}

#[derive(Clone, Debug, Default)]
pub struct OfferTally {
    /// Durations and reaction times in seconds.
    stood: Vec<f64>,
    by_reason: BTreeMap<OfferCloseReason, Vec<f64>>,
    reactions: Vec<f64>,
    taken: u64,
    by_own_key: u64,
    not_taken: u64,
}

impl OfferTally {
    /// Adds an offer. An offer that was still open where a recording was cut is not counted.
    pub fn add(&mut self, one: &TimedOffer) {
        let (Some(stood_s), Some(reason)) = (one.stood_s, one.reason) else { return };
        self.stood.push(stood_s);
        self.by_reason.entry(reason).or_default().push(stood_s);
        self.reactions.extend(one.reaction_s);
        *match one.offer.used.map(|used| used.how) {
            Some(OfferKeyKind::Taken) => &mut self.taken,
            Some(OfferKeyKind::OwnKey) => &mut self.by_own_key,
            None => &mut self.not_taken,
        } += 1;
    }

    pub fn summary(self) -> OfferSummary {
        let of_reason = |(reason, times)| (reason, OfferDurations::from_times(times));
        OfferSummary {
            all: OfferDurations::from_times(self.stood),
            by_reason: self.by_reason.into_iter().map(of_reason).collect(),
            taken: self.taken,
            by_own_key: self.by_own_key,
            not_taken: self.not_taken,
            reaction_s: median(self.reactions),
        }
    }
}
