//! Command `tomcom-research offers`: for how long offers stand, and whether a wizard who reads an offer and then presses `enter`
//! sends the signal that was read.
//!
//! A simulated hand reads the screen at random moments of the trial's running time and presses `enter` 0.6 to 1.2 s
//! later. [`offers::meant`] tells which signal the key would send; nothing is sent, so offers are measured also in
//! recordings in which nobody could send signals.

use std::path::Path;

use rand::RngExt;
use serde::Serialize;

use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::text::{count, percent};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::{Offer, OfferCloseReason};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Signal, unavailable};
use tomcom_core::measures::median;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::LogReader;
use tomcom_session::{Session, apply, offers};
use tomcom_study::analysis::offer_summary::{OfferSummary, TimedOffer};
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

/// Mean time between two readings of the screen by the scripted hand, in seconds.
const BETWEEN_READINGS_S: f64 = 0.5;
/// Least and largest time from the reading of an offer to the press of the key `enter`, in seconds.
const HAND_S: [f64; 2] = [0.6, 1.2];
/// An offer reopens if the same signal is offered within this time after its close, in seconds.
const REOPENS_S: f64 = 5.0;

/// Results of the scripted hand: how often its key `enter` meant the offer that the hand had read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OfferReadingCounts {
    /// Number of readings of an offer on the screen that were followed by the key while the trial ran.
    pub readings: u64,
    /// Number of readings after which the key meant the offer that the hand had read.
    pub as_read: u64,
    pub something_else: u64,
    pub nothing: u64,
}

/// Steadiness of offers: the output of `tomcom-research offers`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OfferSteadinessSummary {
    pub recordings: u64,
    pub offers: OfferSummary,
    /// Median time for which the assistant's recommendation stayed the same before it was turned into offers, in
    /// seconds; null without recommendations.
    pub raw_median_s: Option<f64>,
    pub hand: OfferReadingCounts,
    /// Number of closed offers, without those that the wizard used and those that the end of the trial closed.
    pub could_reopen: u64,
    pub reopened: u64,
    /// Share of closed offers that reopened within 5 s; null without such offers.
    pub reopened_share: Option<f64>,
    /// Time during which any offer was open, in seconds.
    pub open_s: f64,
    /// Share of the time with an open offer in which the latest recommendation gave the offered signal a net benefit of
    /// 0 or below; null without offers.
    pub share_at_or_below_0: Option<f64>,
}

/// An offer that the scripted hand has read.
#[derive(Clone, Debug)]
struct Reading {
    key_at: SessionTime,
    /// Sequence number of the offer that the scripted hand has read; `None` if no offer was on the screen.
    read: Option<u64>,
}

/// Measures the steadiness of offers in one recording. [`Self::before`] is called before each event, [`Self::after`]
/// after each event.
#[derive(Clone, Debug)]
pub struct OfferSteadinessTally {
    random: Stream,
    next_reading: Option<SessionTime>,
    readings: Vec<Reading>,
    hand: OfferReadingCounts,
    open_s: f64,
    at_or_below_0_s: f64,
    /// The signal that the assistant recommends at present, and the time since which the recommended signal is the
    /// same.
    raw: Option<(Signal, SessionTime)>,
    raw_s: Vec<f64>,
}

impl OfferSteadinessTally {
    /// A measurement for one recording; the scripted hand's random stream is seeded by the session's seed and trial.
    pub fn new(session: &Session) -> OfferSteadinessTally {
        OfferSteadinessTally {
            random: stream(session.spec.seed, "reading hand", session.trial),
            next_reading: None,
            readings: Vec::new(),
            hand: OfferReadingCounts::default(),
            open_s: 0.0,
            at_or_below_0_s: 0.0,
            raw: None,
            raw_s: Vec::new(),
        }
    }

    /// Counts the time from the last event to the next event, which is at `now`.
    pub fn before(&mut self, session: &Session, now: SessionTime) {
        if !session.is_running() {
            // After a pause the scripted hand forgets what it read, and reads the screen anew.
            (self.next_reading, self.readings) = (None, Vec::new());
            return;
        }
        if let Some(offer) = session.offers.open() {
            let passed_s = now.secs_since(session.time);
            self.open_s += passed_s;
            if session.advice.as_ref().is_some_and(|advice| is_at_or_below_0(advice, offer)) {
                self.at_or_below_0_s += passed_s;
            }
        }
        self.read_until(session, now);
    }

    /// Lets the scripted hand read the screen and press the key `enter` as often as is due before `now`.
    fn read_until(&mut self, session: &Session, now: SessionTime) {
        let mut next = self.next_reading.unwrap_or(session.time);
        while next < now {
            let open = session.offers.open().map(|offer| offer.seq);
            let [least_s, most_s] = HAND_S;
            let key_s = self.random.random_range(least_s..=most_s);
            let key_at = next + SessionTime::from_secs_f64(key_s);
            if next >= session.time && open.is_some() {
                self.readings.push(Reading { key_at, read: open });
            }
            let pause_s = 2.0 * BETWEEN_READINGS_S * self.random.random::<f64>();
            next = next + SessionTime::from_secs_f64(pause_s);
        }
        self.next_reading = Some(next);
        let (due, waiting) = std::mem::take(&mut self.readings).into_iter().partition(|one: &Reading| one.key_at < now);
        self.readings = waiting;
        for reading in due {
            self.press(session, &reading);
        }
    }

    fn press(&mut self, session: &Session, reading: &Reading) {
        let is_possible = |signal| unavailable(&session.kitchen, session.state, signal).is_none();
        let meant = offers::meant(session, reading.key_at).ok();
        let meant = meant.filter(|offer| offer.signal().is_none_or(is_possible)).map(|offer| offer.seq);
        self.hand.readings += 1;
        *match meant {
            None => &mut self.hand.nothing,
            meant if meant == reading.read => &mut self.hand.as_read,
            Some(_) => &mut self.hand.something_else,
        } += 1;
    }

    /// Notes the assistant's recommendation after an event.
    pub fn after(&mut self, session: &Session) {
        let best = session.advice.as_ref().and_then(|advice| advice.best.as_ref());
        if self.raw.as_ref().map(|(signal, _)| signal) == best {
            return;
        }
        if let Some((_, since)) = self.raw.take() {
            self.raw_s.push(session.age(since, session.time).as_secs_f64());
        }
        self.raw = best.map(|signal| (signal.clone(), session.time));
    }
}

fn is_at_or_below_0(advice: &Recommendation, offer: &Offer) -> bool {
    match offer.signal() {
        Some(signal) => advice.options.iter().any(|option| option.signal == *signal && option.net <= 0.0),
        None => advice.proposal.is_none(),
    }
}

#[derive(Clone, Debug, Default)]
pub struct OfferSteadinessSums {
    summary: OfferSteadinessSummary,
    offers: Vec<TimedOffer>,
    raw_s: Vec<f64>,
    at_or_below_0_s: f64,
}

impl OfferSteadinessSums {
    pub fn add(&mut self, tally: OfferSteadinessTally, session: &Session) {
        let sums = &mut self.summary;
        sums.recordings += 1;
        sums.hand.readings += tally.hand.readings;
        sums.hand.as_read += tally.hand.as_read;
        sums.hand.something_else += tally.hand.something_else;
        sums.hand.nothing += tally.hand.nothing;
        sums.open_s += tally.open_s;
        self.at_or_below_0_s += tally.at_or_below_0_s;
        self.raw_s.extend(tally.raw_s);
        let offers = TimedOffer::all(session);
        let [could_reopen, reopened] = reopenings(&offers);
        (sums.could_reopen, sums.reopened) = (sums.could_reopen + could_reopen, sums.reopened + reopened);
        self.offers.extend(offers);
    }

    pub fn summary(self) -> OfferSteadinessSummary {
        let OfferSteadinessSums { summary, offers, raw_s, at_or_below_0_s } = self;
        let share = |part: f64, all: f64| (all > 0.0).then(|| part / all);
        OfferSteadinessSummary {
            offers: OfferSummary::from_offers(&offers),
            raw_median_s: median(raw_s),
            reopened_share: share(summary.reopened as f64, summary.could_reopen as f64),
            share_at_or_below_0: share(at_or_below_0_s, summary.open_s),
            ..summary
        }
    }
}

/// Number of a trial's offers that could reopen, and number of those that did.
fn reopenings(offers: &[TimedOffer]) -> [u64; 2] {
    let (mut could_reopen, mut reopened) = (0, 0);
    for (index, one) in offers.iter().enumerate() {
        let (Some(stood_s), Some(reason)) = (one.stood_s, one.reason) else { continue };
        // A wizard can also send the signal of an offer that has just closed, and uses the offer by that.
        let is_used = one.offer.used.is_some();
        if is_used
            || !matches!(reason, OfferCloseReason::Impossible | OfferCloseReason::Fell | OfferCloseReason::Replaced)
        {
            continue;
        }
        could_reopen += 1;
        let until_s = one.opened_s + stood_s + REOPENS_S;
        let mut soon = offers[index + 1..].iter().take_while(|later| later.opened_s <= until_s);
        reopened += u64::from(soon.any(|later| later.offer.advice.what == one.offer.advice.what));
    }
    [could_reopen, reopened]
}

/// Measures how steady the offers of recordings are. `done` is called after each recording.
///
/// # Errors
/// A recording cannot be read or replayed.
pub fn measure(recordings: &GatheredRecordings, done: impl Fn() + Sync) -> FileResult<OfferSteadinessSummary> {
    let mut sums = OfferSteadinessSums::default();
    for one in parallel::each(&recordings.paths, |recording| tally(recording), done) {
        let (tally, session) = one?;
        sums.add(tally, &session);
    }
    Ok(sums.summary())
}

/// Measures the steadiness of offers in one recording. Since offers depend on the session's state only, no belief
/// estimate is computed.
fn tally(recording: &Path) -> FileResult<(OfferSteadinessTally, Session)> {
    let mut log = LogReader::open(recording)?;
    let mut session = log.session();
    let mut tally = OfferSteadinessTally::new(&session);
    while let Some(line) = log.next_line()? {
        tally.before(&session, line.stamped.time);
        apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
        tally.after(&session);
    }
    Ok((tally, session))
}

pub fn describe(found: &OfferSteadinessSummary) -> String {
    let seconds = |value: Option<f64>| value.map_or("-".to_string(), |s| format!("{s:.1} s"));
    let mut text = format!(
        "{} in {}\nstood {} in the median, {} at least (raw recommendations: {} in the median)\n",
        count(found.offers.all.n, "offer", "offers"),
        count(found.recordings, "recording", "recordings"),
        seconds(found.offers.all.median_s),
        seconds(found.offers.all.shortest_s),
        seconds(found.raw_median_s),
    );
    for (reason, one) in &found.offers.by_reason {
        let (median, shortest) = (seconds(one.median_s), seconds(one.shortest_s));
        text += &format!("  {}: {}, {median} in the median, {shortest} at least\n", reason.words(), one.n);
    }
    let hand = &found.hand;
    let share = |part: u64| percent((hand.readings > 0).then(|| part as f64 / hand.readings as f64));
    text + &format!(
        "a hand that presses enter 0.6 to 1.2 s after reading, {}: as read {}, something else {}, nothing {}\n\
         offered again within 5 s: {} of {} ({})\n\
         time with an open offer whose raw net benefit is at or below 0: {} of {:.0} s\n",
        count(hand.readings, "reading", "readings"),
        share(hand.as_read),
        share(hand.something_else),
        share(hand.nothing),
        found.reopened,
        found.could_reopen,
        percent(found.reopened_share),
        percent(found.share_at_or_below_0),
        found.open_s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use tomcom_core::communication::offer::{OfferKeyKind, OfferUse, OfferedAdvice};

    /// An offer of one signal that stands for 2 s from `opened_s` on and is outdone by another one.
    fn offer(opened_s: f64, used: Option<OfferUse>) -> TimedOffer {
        let what = Signal::Highlight("counter".to_string());
        let advice = OfferedAdvice { what, for_seq: 1, worth: None, reason: None, words: None, visible: true };
        let offer = Offer { seq: 2, opened: SessionTime::from_secs_f64(opened_s), advice, used };
        let reason = Some(OfferCloseReason::Replaced);
        TimedOffer { offer, opened_s, stood_s: Some(2.0), reason, sent: used.map(|used| used.at), reaction_s: None }
    }

    #[test]
    fn an_offer_that_was_used_just_after_its_close_is_none_that_could_reopen() {
        let used = OfferUse { how: OfferKeyKind::Taken, at: SessionTime::from_secs_f64(3.0) };
        assert_eq!(reopenings(&[offer(0.0, None), offer(4.0, None)]), [2, 1]);
        assert_eq!(reopenings(&[offer(0.0, Some(used)), offer(4.0, None)]), [1, 0]);
    }
}
