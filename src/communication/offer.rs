//! Offers: recommendations as the wizard sees them. An offer opens, stands still long enough to be read, and closes for a reason.
//!
//! This file has the types, the thresholds, and the memory of the present and the last offer. The rules stand in
//! `session::offers`, since they need the trial's clock and the state of the kitchen.

use serde::{Deserialize, Serialize};

use super::concept_name::ConceptName;
use super::recommendation::Reason;
use super::signal::Signal;
use crate::base::time::SessionTime;

/// In this time after its opening an offer closes only if it is taken, becomes impossible, or the trial ends.
pub const HOLD: SessionTime = SessionTime(1_500_000_000);
/// After the close of an offer none opens for this time.
pub const GAP: SessionTime = SessionTime(1_000_000_000);
/// In this time after its opening an offer cannot have been read: `enter` means the one before.
pub const UNREAD: SessionTime = SessionTime(300_000_000);
/// For this time after its close an offer can still be taken: the wizard has read it, and the hand is on its way.
pub const TAKEN_AFTER: SessionTime = SessionTime(1_300_000_000);

/// What is offered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OfferedAct {
    /// A signal to the participant.
    Signal(Signal),
    /// Presses that DEV proposes, by the names of their buttons. They are shown to the wizard, who cannot send them.
    Presses(Vec<String>),
}

/// The value of an offered signal, in presses; for ToM in probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferWorth {
    /// Expected saving; for ToM the expected belief deviation.
    pub benefit: f64,
    /// Standard error of the benefit.
    pub standard_error: f64,
    /// Benefit minus the cost of communication; for ToM minus the threshold.
    pub net: f64,
}

/// Content of an offer. It does not change while the offer is open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferedAdvice {
    /// What is offered.
    #[serde(flatten)]
    pub what: OfferedAct,
    /// Sequence number of the event for which the recommendation was computed.
    pub for_seq: u64,
    /// Its value at the opening; `None` for proposed presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worth: Option<OfferWorth>,
    /// Believed value, true value and the press that the signal would prevent, as far as they are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<Reason>,
    /// Whether a wizard could see it: there is a console or a script that reads offers, and the session's settings show recommendations.
    pub visible: bool,
}

/// How the signal of an offer was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OfferUse {
    /// By the key that takes the offer.
    Taken,
    /// By the signal's own key.
    OwnKey,
}

/// When and how the signal of an offer was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UsedOffer {
    /// By which key.
    pub how: OfferUse,
    /// When, in session time.
    pub at: SessionTime,
}

/// An offer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Sequence number of its `offer_opened`, by which `offer_closed` and `signal_shown` name it.
    pub seq: u64,
    /// When it opened, in session time.
    pub opened: SessionTime,
    /// How the wizard sent its signal while it was open or could still be taken, if it was sent.
    pub used: Option<UsedOffer>,
    /// What is offered, and why.
    pub advice: OfferedAdvice,
}

impl Offer {
    /// The offered signal; `None` for proposed presses.
    pub fn signal(&self) -> Option<&Signal> {
        match &self.advice.what {
            OfferedAct::Signal(signal) => Some(signal),
            OfferedAct::Presses(_) => None,
        }
    }
}

/// Why an offer closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OfferEnd {
    /// The wizard took it.
    Taken,
    /// The wizard sent its signal by the signal's own key.
    OwnKey,
    /// Its signal cannot be sent any more.
    Impossible,
    /// Its net benefit fell below the threshold; the proposal of presses is out of date.
    Fell,
    /// Another signal became better.
    Replaced,
    /// The trial ended.
    TrialEnded,
}

impl OfferEnd {
    /// All reasons.
    pub const ALL: [OfferEnd; 6] = [
        OfferEnd::Taken,
        OfferEnd::OwnKey,
        OfferEnd::Impossible,
        OfferEnd::Fell,
        OfferEnd::Replaced,
        OfferEnd::TrialEnded,
    ];

    /// Name in logs and tables.
    pub fn name(self) -> &'static str {
        match self {
            OfferEnd::Taken => "taken",
            OfferEnd::OwnKey => "own_key",
            OfferEnd::Impossible => "impossible",
            OfferEnd::Fell => "fell",
            OfferEnd::Replaced => "replaced",
            OfferEnd::TrialEnded => "trial_ended",
        }
    }

    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            OfferEnd::Taken => "taken",
            OfferEnd::OwnKey => "sent by its own key",
            OfferEnd::Impossible => "no longer possible",
            OfferEnd::Fell => "no longer worth it",
            OfferEnd::Replaced => "another is better",
            OfferEnd::TrialEnded => "the trial ended",
        }
    }
}

/// A closed offer.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedOffer {
    /// The offer.
    pub offer: Offer,
    /// When it closed, in session time.
    pub closed: SessionTime,
    /// Why it closed.
    pub reason: OfferEnd,
}

/// The offers of a trial: the open one, and those that closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OfferBook {
    present: Option<Offer>,
    closed: Vec<ClosedOffer>,
}

impl OfferBook {
    /// The offer on the wizard's screen: open, and its signal has not been sent.
    pub fn open(&self) -> Option<&Offer> {
        self.present.as_ref().filter(|offer| offer.used.is_none())
    }

    /// The offer that has not been closed, also if its signal has just been sent.
    pub fn unclosed(&self) -> Option<&Offer> {
        self.present.as_ref()
    }

    /// The offer that closed last.
    pub fn last(&self) -> Option<&ClosedOffer> {
        self.closed.last()
    }

    /// All closed offers of the trial, in order.
    pub fn closed(&self) -> &[ClosedOffer] {
        &self.closed
    }

    /// The present or the last offer, by its sequence number.
    pub fn find(&self, seq: u64) -> Option<&Offer> {
        self.present.iter().chain(self.last().map(|last| &last.offer)).find(|offer| offer.seq == seq)
    }

    /// Opens an offer.
    pub fn opens(&mut self, seq: u64, now: SessionTime, advice: OfferedAdvice) {
        self.present = Some(Offer { seq, opened: now, used: None, advice });
    }

    /// Closes the open offer, if there is one.
    pub fn closes(&mut self, now: SessionTime, reason: OfferEnd) {
        self.closed.extend(self.present.take().map(|offer| ClosedOffer { offer, closed: now, reason }));
    }

    /// Notes that the wizard sent a signal. It concerns the open offer and, if `with_last`, the last one that closed, as far
    /// as they offered this signal.
    pub fn sends(&mut self, signal: &Signal, used: UsedOffer, with_last: bool) {
        let last = self.closed.last_mut().filter(|_| with_last).map(|last| &mut last.offer);
        for offer in self.present.iter_mut().chain(last).filter(|offer| offer.signal() == Some(signal)) {
            offer.used.get_or_insert(used);
        }
    }
}

/// Thresholds of offers, in the unit of the concept's net benefit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfferThresholds {
    /// An offer closes when its net benefit is below this.
    pub closes_below: f64,
    /// An offer closes when another is better by this.
    pub better_by: f64,
}

impl OfferThresholds {
    /// The thresholds for a concept; offers of all concepts open above a net benefit of 0.
    ///
    /// ToM-Com: half a press, a third of the cost of communication and several standard errors of the benefit. ToM: 0.1 of
    /// probability; one look at a place moves the belief about it by more. DEV: its proposals have no net benefit.
    pub fn for_concept(name: ConceptName) -> OfferThresholds {
        match name {
            ConceptName::TomCom | ConceptName::Dev | ConceptName::None => {
                OfferThresholds { closes_below: -0.5, better_by: 0.5 }
            }
            ConceptName::Tom => OfferThresholds { closes_below: -0.1, better_by: 0.1 },
        }
    }
}
