//! Offers: recommendations as the wizard sees them. An offer opens, stays unchanged long enough to be read, and closes
//! for a reason.
//!
//! This file has the types, the thresholds, and the memory of the present and the previous offers. The rules of offers
//! are in `session::offers`, since they need the trial's clock and the state of the kitchen.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::concept::{BenefitUnit, ConceptName};
use super::recommendation::SignalReason;
use super::signal::Signal;
use crate::base::time::SessionTime;
use crate::measures::matching::SignalKind;

/// Time after its opening in which an offer closes only if the wizard takes it, if its signal becomes impossible, or if
/// the trial ends.
pub const HOLD: SessionTime = SessionTime(1_500_000_000);
/// Time after the close of an offer in which no other offer opens.
pub const GAP: SessionTime = SessionTime(1_000_000_000);
/// Time after its opening in which the wizard cannot have read an offer yet: the key `enter` then refers to the
/// previous offer.
pub const UNREAD: SessionTime = SessionTime(300_000_000);
/// Time after its close in which an offer can still be taken by a wizard who has read it and is about to press the key.
pub const TAKEN_AFTER: SessionTime = SessionTime(1_300_000_000);

/// What an offer suggests, as the log has it: a proposal of presses stands apart from the signals that a wizard can send.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LoggedOffer {
    Signal(Signal),
    Presses(Vec<String>),
}

impl LoggedOffer {
    fn serialize<S: Serializer>(signal: &Signal, serializer: S) -> Result<S::Ok, S::Error> {
        let logged = match signal.clone() {
            Signal::Propose(presses) => LoggedOffer::Presses(presses),
            signal => LoggedOffer::Signal(signal),
        };
        Serialize::serialize(&logged, serializer)
    }

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Signal, D::Error> {
        Ok(match <LoggedOffer as Deserialize>::deserialize(deserializer)? {
            LoggedOffer::Signal(signal) => signal,
            LoggedOffer::Presses(presses) => Signal::Propose(presses),
        })
    }
}

/// The value of an offered signal: in presses, or for the concept ToM in probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferWorth {
    /// Expected saving of the signal in presses; for the concept ToM the expected belief deviation.
    pub benefit: f64,
    /// Standard error of the signal's expected saving, in the same unit.
    pub standard_error: f64,
    /// Net benefit: benefit minus the cost of communication; for the concept ToM minus the threshold.
    pub net: f64,
}

/// Content of an offer to the wizard, which does not change while the offer is open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OfferedAdvice {
    /// The offered signal. A wizard sees the presses that the concept DEV proposes, but cannot send them.
    #[serde(flatten, with = "LoggedOffer")]
    pub what: Signal,
    /// Sequence number of the event for which the recommendation was computed.
    pub for_seq: u64,
    /// The value of the offered signal when the offer opened; `None` for proposed presses, and where an external concept
    /// gave no value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worth: Option<OfferWorth>,
    /// The false belief behind the offer and the press that the signal would prevent, as far as they are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<SignalReason>,
    /// The reason in the concept's own words; only external concepts give one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub words: Option<String>,
    /// Whether a wizard could see the offer: there is a console, or a script that reads offers, and the session's
    /// settings show recommendations.
    pub visible: bool,
}

/// By which kind of key the wizard sent the signal of an offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OfferKeyKind {
    /// The wizard sent the signal by the key `enter`, which takes the present offer.
    Taken,
    /// The wizard sent the signal by the signal's own key.
    OwnKey,
}

/// When and how the wizard sent the signal of an offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OfferUse {
    /// The kind of key with which the wizard sent the signal.
    pub how: OfferKeyKind,
    /// Session time at which the wizard sent the signal.
    pub at: SessionTime,
}

/// An offer: a recommendation that is shown to the wizard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Sequence number of the event `offer_opened`, by which `offer_closed` and `signal_shown` refer to the offer.
    pub seq: u64,
    /// Session time at which the offer opened.
    pub opened: SessionTime,
    /// How and when the wizard sent the offer's signal while the offer could be taken; `None` if the wizard did not.
    pub used: Option<OfferUse>,
    /// The content of the offer: what is offered, and the reason.
    pub advice: OfferedAdvice,
}

impl Offer {
    /// The signal that the wizard can send; `None` if the offer proposes presses.
    pub fn signal(&self) -> Option<&Signal> {
        Some(&self.advice.what).filter(|signal| signal.kind() != SignalKind::Proposal)
    }
}

/// Why an offer to the wizard closed.
#[allow(missing_docs, reason = "`words` says each")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OfferCloseReason {
    Taken,
    OwnKey,
    Impossible,
    Fell,
    Replaced,
    TrialEnded,
}

impl OfferCloseReason {
    /// Name of the reason in logs and tables.
    pub fn name(self) -> &'static str {
        match self {
            OfferCloseReason::Taken => "taken",
            OfferCloseReason::OwnKey => "own_key",
            OfferCloseReason::Impossible => "impossible",
            OfferCloseReason::Fell => "fell",
            OfferCloseReason::Replaced => "replaced",
            OfferCloseReason::TrialEnded => "trial_ended",
        }
    }

    /// The reason for which an offer closed, in words.
    pub fn words(self) -> &'static str {
        match self {
            OfferCloseReason::Taken => "taken",
            OfferCloseReason::OwnKey => "sent by its own key",
            OfferCloseReason::Impossible => "no longer possible",
            OfferCloseReason::Fell => "no longer worth it",
            OfferCloseReason::Replaced => "another is better",
            OfferCloseReason::TrialEnded => "the trial ended",
        }
    }
}

/// A closed offer, with the time and the reason of its close.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedOffer {
    /// The offer as it was when it closed.
    pub offer: Offer,
    /// Session time at which the offer closed.
    pub closed: SessionTime,
    /// The reason for which this offer closed.
    pub reason: OfferCloseReason,
}

/// The offers of a trial: the open offer, and the closed offers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OfferHistory {
    present: Option<Offer>,
    closed: Vec<ClosedOffer>,
}

impl OfferHistory {
    /// The offer on the wizard's screen, which is open and whose signal has not been sent; `None` if there is none.
    pub fn open(&self) -> Option<&Offer> {
        self.present.as_ref().filter(|offer| offer.used.is_none())
    }

    /// The offer that has not been closed, even if its signal has just been sent.
    pub fn unclosed(&self) -> Option<&Offer> {
        self.present.as_ref()
    }

    /// The offer of the trial that closed last.
    pub fn last(&self) -> Option<&ClosedOffer> {
        self.closed.last()
    }

    /// All closed offers of the trial, in order.
    pub fn closed(&self) -> &[ClosedOffer] {
        &self.closed
    }

    /// The present offer or the last closed offer, if it has this sequence number.
    pub fn find(&self, seq: u64) -> Option<&Offer> {
        self.present.iter().chain(self.last().map(|last| &last.offer)).find(|offer| offer.seq == seq)
    }

    /// Opens an offer to the wizard.
    pub fn opens(&mut self, seq: u64, now: SessionTime, advice: OfferedAdvice) {
        self.present = Some(Offer { seq, opened: now, used: None, advice });
    }

    /// Closes the open offer, if there is one.
    pub fn closes(&mut self, now: SessionTime, reason: OfferCloseReason) {
        self.closed.extend(self.present.take().map(|offer| ClosedOffer { offer, closed: now, reason }));
    }

    /// Records that the wizard sent a signal. The sending counts for the open offer and, if `with_last`, for the last
    /// closed offer, if that offered the same signal.
    pub fn sends(&mut self, signal: &Signal, used: OfferUse, with_last: bool) {
        let last = self.closed.last_mut().filter(|_| with_last).map(|last| &mut last.offer);
        for offer in self.present.iter_mut().chain(last).filter(|offer| offer.signal() == Some(signal)) {
            offer.used.get_or_insert(used);
        }
    }
}

/// Thresholds of net benefit at which offers close, in the unit of the concept's net benefit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfferCloseThresholds {
    /// An offer closes when the net benefit of its signal is below this.
    pub closes_below: f64,
    /// An offer closes when another signal's net benefit exceeds that of its signal by at least this.
    pub better_by: f64,
}

impl OfferCloseThresholds {
    /// The thresholds of offers for a concept; offers of all concepts open above a net benefit of 0.
    ///
    /// ToM-Com: half a press, which is a third of the cost of communication and several standard errors of the benefit.
    /// ToM: 0.1 of probability; one look at a place changes the belief about that place by more. DEV: its proposals
    /// have no net benefit.
    pub fn for_concept(name: ConceptName) -> OfferCloseThresholds {
        match name.unit() {
            BenefitUnit::Presses | BenefitUnit::None => OfferCloseThresholds { closes_below: -0.5, better_by: 0.5 },
            BenefitUnit::Deviation => OfferCloseThresholds { closes_below: -0.1, better_by: 0.1 },
        }
    }
}
