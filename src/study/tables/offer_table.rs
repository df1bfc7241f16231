//! Table of the offers that a wizard could see in a trial.

use crate::analysis::offer_summary::TimedOffer;
use crate::column::{CsvColumn, CsvRow, CsvTable};
use tomcom_core::communication::Signal;
use tomcom_core::communication::offer::{OfferCloseReason, OfferKeyKind, OfferedCommunication};
use tomcom_core::mind::rounded;

/// Row of the table of offers: an offer to the wizard in a recording.
#[derive(Clone, Copy, Debug)]
pub struct OfferRow<'a> {
    /// Name of the recording in tables.
    pub recording: &'a str,
    /// The offer with the times at which it opened, closed and was sent.
    pub timed: &'a TimedOffer,
}

impl OfferRow<'_> {
    fn act(&self) -> &OfferedCommunication {
        &self.timed.offer.advice.what
    }

    fn target(&self) -> String {
        match self.act() {
            OfferedCommunication::Signal(signal) => signal.target().unwrap_or_default().to_string(),
            OfferedCommunication::Presses(presses) => presses.join(" "),
        }
    }
}

fn kind_name(what: &OfferedCommunication) -> &'static str {
    match what {
        OfferedCommunication::Signal(Signal::ShowRecipe(_)) => "recipe",
        OfferedCommunication::Signal(Signal::Highlight(_)) => "highlight",
        OfferedCommunication::Signal(Signal::Propose(_)) | OfferedCommunication::Presses(_) => "proposal",
    }
}

fn key_name(how: OfferKeyKind) -> &'static str {
    match how {
        OfferKeyKind::Taken => "enter",
        OfferKeyKind::OwnKey => "own",
    }
}

impl CsvRow for OfferRow<'_> {
    const TABLE: CsvTable = CsvTable::Offers;

    fn columns() -> Vec<CsvColumn<Self>> {
        let worth = "presses; for tom a probability";
        let closed = "reason of the close: taken, own_key, impossible, fell (no longer worth it), replaced, trial_ended; \
                      empty: the recording was cut";
        let key = "key that sent the offered signal while it could be taken: enter or own (the signal's own key); empty: not sent";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("offer", "", "sequence number of offer_opened in the log", |row| row.timed.offer.seq.into()),
            Self::column("time_s", "s", "time of its opening on the trial's clock", |row| {
                rounded(row.timed.opened_s).into()
            }),
            Self::column("kind", "", "recipe, highlight or proposal", |row| kind_name(row.act()).into()),
            Self::column("target", "", "location of the signal, or the proposed presses", |row| row.target().into()),
            Self::column("benefit", worth, "expected saving at the opening; for tom the belief deviation", |row| {
                row.timed.offer.advice.worth.map(|worth| worth.benefit).into()
            }),
            Self::column("net", worth, "benefit minus the cost of communication or the threshold", |row| {
                row.timed.offer.advice.worth.map(|worth| worth.net).into()
            }),
            Self::column("stood_s", "s", "time for which it was open, without pauses", |row| {
                row.timed.stood_s.map(rounded).into()
            }),
            Self::column("closed", "", closed, |row| row.timed.reason.map(OfferCloseReason::name).into()),
            Self::column("key", "", key, |row| row.timed.offer.used.map(|used| key_name(used.how)).into()),
            Self::column("reaction_s", "s", "time from the opening to that key, without pauses", |row| {
                row.timed.reaction_s.map(rounded).into()
            }),
        ]
    }
}
