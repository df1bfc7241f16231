//! Tables of what happens in a trial beside presses: communications that were sent or that a concept would have sent,
//! offers, gaze, beliefs; and of the errors that concepts would have prevented.

use crate::analysis::offer_summary::TimedOffer;
use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::prevention::PreventionCounts;
use crate::roc::ConceptPreventionCounts;
use crate::trial_statistics::{TrialDetails, TrialStatistics};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::offer::{OfferCloseReason, OfferKeyKind, OfferedCommunication};
use tomcom_core::kitchen::{Kitchen, LocationId};
use tomcom_core::measures::matching::{CommunicationEvent, CommunicationKind};
use tomcom_core::mind::AspectBelief;
use tomcom_core::mind::{AspectEstimate, rounded};

/// Row of the table of communications: a communication that was sent, or that a concept would have sent.
#[derive(Clone, Copy, Debug)]
pub struct CommunicationRow<'a> {
    pub recording: &'a str,
    pub kitchen: &'a Kitchen,
    /// Sender of the communication: wizard, assistant, or the concept of a hypothetical communication.
    pub lane: &'a str,
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

/// Row of the table of offers: an offer to the wizard in a recording.
#[derive(Clone, Copy, Debug)]
pub struct OfferRow<'a> {
    pub recording: &'a str,
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

fn offer_kind_name(what: &OfferedCommunication) -> &'static str {
    match what {
        OfferedCommunication::Signal(Signal::ShowRecipe(_)) => "recipe",
        OfferedCommunication::Signal(Signal::Highlight(_)) => "highlight",
        OfferedCommunication::Signal(Signal::Propose(_)) | OfferedCommunication::Presses(_) => "proposal",
    }
}

fn offer_key_name(how: OfferKeyKind) -> &'static str {
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
            Self::column("kind", "", "recipe, highlight or proposal", |row| offer_kind_name(row.act()).into()),
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
            Self::column("key", "", key, |row| row.timed.offer.used.map(|used| offer_key_name(used.how)).into()),
            Self::column("reaction_s", "s", "time from the opening to that key, without pauses", |row| {
                row.timed.reaction_s.map(rounded).into()
            }),
        ]
    }
}

/// Row of the table of concepts: a concept with one value of its parameter in an unassisted trial.
#[derive(Clone, Copy, Debug)]
pub struct ConceptRow<'a> {
    trial: &'a TrialStatistics,
    swept: &'a ConceptPreventionCounts,
}

pub fn concepts<'a>(trial: &'a TrialStatistics, details: &'a TrialDetails) -> impl Iterator<Item = ConceptRow<'a>> {
    details.swept.iter().map(move |swept| ConceptRow { trial, swept })
}

impl CsvRow for ConceptRow<'_> {
    const TABLE: CsvTable = CsvTable::Concepts;

    fn columns() -> Vec<CsvColumn<Self>> {
        let count = |name, unit, meaning, count: fn(&PreventionCounts) -> u64| {
            Self::column(name, unit, meaning, move |row| count(&row.swept.count).into())
        };
        let parameter = "cost of communication in presses (tom-com), threshold (tom), presses proposed (dev)";
        vec![
            Self::column("recording", "", "as in trials; unassisted trials that count", |row| {
                (&row.trial.recording).into()
            }),
            Self::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
            Self::column("concept", "", "tom-com, tom or dev", |row| row.swept.concept.name().into()),
            Self::column("parameter", "", parameter, |row| CsvCell::Number(row.swept.parameter)),
            count("presses", "presses", "human presses in the trial", |count| count.presses),
            count("signals", "signals", "hypothetical signals; for dev, proposals", |count| count.signals),
            count("related", "errors", "belief related", |count| count.related),
            count("prevented", "errors", "belief related errors that the signals would have prevented", |count| {
                count.prevented
            }),
            count("outside", "presses", "human presses outside of false belief episodes", |count| count.outside),
            count("false_presses", "presses", "human presses with a useless signal right before them", |count| {
                count.false_presses
            }),
            count("false_inside", "signals", "useless signals during a false belief episode", |count| {
                count.false_inside
            }),
            Self::column(
                "harmless",
                "signals",
                "signals about a false belief that led to no error; empty where such beliefs are not known, as with people",
                |row| row.swept.count.harmless.into(),
            ),
            count("contents", "contents", "as signals; for dev, proposed presses", |count| count.contents),
            count(
                "useless",
                "signals",
                "signals that are not the first about a false belief with errors to follow",
                |count| count.useless,
            ),
            Self::column("beliefs_from", "", "as in trials: recorded, consensus or raters", |row| {
                row.trial.beliefs.as_ref().map(|beliefs| beliefs.basis.name()).into()
            }),
            Self::column(
                "lead_s",
                "s",
                "mean time from a useful signal to the first error that it would have prevented; empty without useful signals, and for dev",
                |row| row.swept.count.lead_s().filter(|_| row.swept.concept != ConceptName::Dev).into(),
            ),
        ]
    }
}

/// A gaze run: successive gaze samples on one location, or on none.
#[derive(Clone, Copy, Debug)]
pub struct GazeRun {
    /// Location at which the gaze was; `None` if it was at no location, or not usable.
    pub location: Option<LocationId>,
    pub began: SessionTime,
    pub last: SessionTime,
    pub sums: [f64; 3],
    pub samples: u64,
}

impl GazeRun {
    /// Mean over the gaze run of x (`of` is 0), y (1) or confidence (2).
    fn mean(&self, of: usize) -> f64 {
        rounded(self.sums[of] / self.samples as f64)
    }
}

/// Row of the table of gaze: a gaze run with its recording.
#[derive(Clone, Copy, Debug)]
pub struct GazeRow<'a> {
    pub recording: &'a str,
    pub kitchen: &'a Kitchen,
    pub time_s: f64,
    pub run: GazeRun,
}

impl CsvRow for GazeRow<'_> {
    const TABLE: CsvTable = CsvTable::Gaze;

    fn columns() -> Vec<CsvColumn<Self>> {
        let time = "time of the run's first sample on the trial's clock";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("time_s", "s", time, |row| rounded(row.time_s).into()),
            Self::column("duration_s", "s", "time from the first to the last sample of the run", |row| {
                rounded(row.run.last.secs_since(row.run.began)).into()
            }),
            Self::column("location", "", "location at the gaze point; empty: none, or unusable samples", |row| {
                row.run.location.map(|location| &row.kitchen.location(location).name).into()
            }),
            Self::column("x", "width of the display", "mean horizontal gaze position, from the left", |row| {
                row.run.mean(0).into()
            }),
            Self::column("y", "height of the display", "mean vertical gaze position, from the top", |row| {
                row.run.mean(1).into()
            }),
            Self::column("confidence", "0 to 1", "mean confidence that the eye tracker reported", |row| {
                row.run.mean(2).into()
            }),
            Self::column("samples", "samples", "number of samples in the run; events.jsonl has every sample", |row| {
                row.run.samples.into()
            }),
        ]
    }
}

/// Row of the table of beliefs: estimated and recorded belief about one state aspect before a press of the human.
#[derive(Clone, Copy, Debug)]
pub struct BeliefRow<'a> {
    pub recording: &'a str,
    pub seq: u64,
    pub truth: &'a str,
    pub estimate: &'a AspectEstimate,
    /// Recorded belief about the aspect; `None` for people.
    pub believed: Option<&'a AspectBelief>,
}

impl CsvRow for BeliefRow<'_> {
    const TABLE: CsvTable = CsvTable::Beliefs;

    fn columns() -> Vec<CsvColumn<Self>> {
        let seq = "log number of the human press that follows, as in actions";
        let believed = "probability of the true value in a simulated participant's belief";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("seq", "", seq, |row| row.seq.into()),
            Self::column("aspect", "", "state aspect: a location's content, or a dish's recipe", |row| {
                (&row.estimate.aspect).into()
            }),
            Self::column("truth", "", "true value of the aspect", |row| row.truth.into()),
            Self::column("estimate", "", "most probable value in the estimated belief", |row| {
                (&row.estimate.believes).into()
            }),
            Self::column(
                "estimate_p_truth",
                "probability",
                "probability of the true value in the estimated belief",
                |row| row.estimate.p_truth.into(),
            ),
            Self::column(
                "estimate_precision",
                "",
                "precision of the estimate: sum of the Dirichlet parameters",
                |row| row.estimate.precision.into(),
            ),
            Self::column("believed", "", "most probable value in a simulated participant's belief", |row| {
                row.believed.map(|own| &own.believes).into()
            }),
            Self::column("believed_p_truth", "probability", believed, |row| row.believed.map(|own| own.p_truth).into()),
        ]
    }
}
