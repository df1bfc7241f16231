//! Table of communications that were sent, and of those that a concept would have sent.

use crate::column::{CsvColumn, CsvRow, CsvTable};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::measures::matching::{CommunicationEvent, CommunicationKind};
use tomcom_core::mind::rounded;

/// Row of the table of communications: a communication that was sent, or that a concept would have sent.
#[derive(Clone, Copy, Debug)]
pub struct CommunicationRow<'a> {
    /// Name of the recording in tables.
    pub recording: &'a str,
    /// The kitchen of the recording.
    pub kitchen: &'a Kitchen,
    /// Sender of the communication: wizard, assistant, or the concept of a hypothetical communication.
    pub lane: &'a str,
    /// The communication, with the number of presses before it and its time.
    pub sent: &'a CommunicationEvent,
    /// Sequence number of the offer that the communication took or met; `None` if the wizard could see no such offer.
    pub offer: Option<u64>,
    /// Whether another sender has a matching communication within the window; `None` without another sender.
    pub matched: Option<bool>,
}

fn kind_name(kind: CommunicationKind) -> &'static str {
    match kind {
        CommunicationKind::Recipe => "recipe",
        CommunicationKind::Highlight => "highlight",
        CommunicationKind::Proposal => "proposal",
    }
}

impl CsvRow for CommunicationRow<'_> {
    const TABLE: CsvTable = CsvTable::Communications;

    fn columns() -> Vec<CsvColumn<Self>> {
        let lane = "sender (wizard, assistant), or concept of a hypothetical signal (tom-com)";
        let offer = "the offer that it took or met, as in offers; empty: none was visible";
        let matched = "whether the other lane has the same signal within the window; empty: no other lane";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("lane", "", lane, |row| row.lane.into()),
            Self::column("time_s", "s", "time on the trial's clock", |row| {
                rounded(row.sent.clock.as_secs_f64()).into()
            }),
            Self::column("press", "presses", "number of human presses before it", |row| row.sent.press.into()),
            Self::column("kind", "", "recipe, highlight or proposal", |row| kind_name(row.sent.content.kind).into()),
            Self::column("target", "", "location that the communication is about", |row| {
                row.sent.content.target.map(|location| &row.kitchen.location(location).name).into()
            }),
            Self::column("matched", "", matched, |row| row.matched.into()),
            Self::column("offer", "", offer, |row| row.offer.into()),
        ]
    }
}
