//! Tables of what happens in a trial beside presses: communications that were sent or that a concept would have sent,
//! offers, gaze, beliefs; and of the errors that concepts would have prevented.

use crate::analysis::offer_summary::TimedOffer;
use crate::column::{CsvRow, CsvTable, TableColumn, columns};
use crate::roc::ConceptPreventionCounts;
use crate::trial_statistics::{TrialDetails, TrialStatistics};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::offer::{OfferCloseReason, OfferKeyKind};
use tomcom_core::kitchen::{Kitchen, LocationId};
use tomcom_core::measures::matching::CommunicationEvent;
use tomcom_core::mind::{AspectBelief, AspectEstimate, rounded};

#[derive(Clone, Copy, Debug)]
pub struct CommunicationRow<'a> {
    pub recording: &'a str,
    pub kitchen: &'a Kitchen,
    pub lane: &'a str,
    pub sent: &'a CommunicationEvent,
    /// Sequence number of the offer that the communication took or met; `None` if the wizard could see no such offer.
    pub offer: Option<u64>,
    /// Whether another sender has a matching communication within the window; `None` without another sender.
    pub matched: Option<bool>,
}

impl CsvRow for CommunicationRow<'_> {
    const TABLE: CsvTable = CsvTable::Communications;

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => row.recording;
            "lane", "", "sender (wizard, assistant), or concept of a hypothetical signal (tom-com)" => row.lane;
            "time_s", "s", "time on the trial's clock" => rounded(row.sent.clock.as_secs_f64());
            "press", "presses", "number of human presses before it" => row.sent.press;
            "kind", "", "recipe, highlight or proposal" => row.sent.content.kind.name();
            "target", "", "location that the communication is about; empty: a proposal"
                => row.sent.content.target.map(|location| &row.kitchen.location(location).name);
            "matched", "", "whether the other lane has the same signal within the window; empty: no other lane"
                => row.matched;
            "offer", "", "the offer that it took or met, as in offers; empty: none was visible" => row.offer;
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct OfferRow<'a> {
    pub recording: &'a str,
    pub timed: &'a TimedOffer,
}

impl OfferRow<'_> {
    fn signal(&self) -> &Signal {
        &self.timed.offer.advice.what
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

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => row.recording;
            "offer", "", "sequence number of offer_opened in the log" => row.timed.offer.seq;
            "time_s", "s", "time of its opening on the trial's clock" => rounded(row.timed.opened_s);
            "kind", "", "recipe, highlight or proposal" => row.signal().kind().name();
            "target", "", "location of the signal, or the proposed presses" => row.signal().names().join(" ");
            "benefit", "presses; for tom a probability", "expected saving at the opening; for tom the belief deviation; empty: a proposal, or an external concept gave none"
                => row.timed.offer.advice.worth.map(|worth| worth.benefit);
            "net", "presses; for tom a probability", "benefit minus the cost of communication or the threshold; empty as benefit"
                => row.timed.offer.advice.worth.map(|worth| worth.net);
            "stood_s", "s", "time for which it was open, without pauses; empty: the recording was cut" => row.timed.stood_s.map(rounded);
            "closed", "", "reason of the close: taken, own_key, impossible, fell (no longer worth it), replaced, trial_ended; \
                empty: the recording was cut" => row.timed.reason.map(OfferCloseReason::name);
            "key", "", "key that sent the offered signal while it could be taken: enter or own (the signal's own \
                key); empty: not sent" => row.timed.offer.used.map(|used| offer_key_name(used.how));
            "reaction_s", "s", "time from the opening to that key, without pauses; empty as key" => row.timed.reaction_s.map(rounded);
        }
    }
}

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

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials; unassisted trials that count" => &row.trial.recording;
            "participant", "", "as in participants" => &row.trial.participant;
            "concept", "", "tom-com, tom or dev" => row.swept.concept.name();
            "parameter", "", "cost of communication in presses (tom-com), threshold (tom), presses proposed (dev)"
                => row.swept.parameter;
            "presses", "presses", "human presses in the trial" => row.swept.count.presses;
            "signals", "signals", "hypothetical signals; for dev, proposals" => row.swept.count.signals;
            "related", "errors", "belief related" => row.swept.count.related;
            "prevented", "errors", "belief related errors that the signals would have prevented"
                => row.swept.count.prevented;
            "outside", "presses", "human presses outside of false belief episodes" => row.swept.count.outside;
            "false_presses", "presses", "human presses with a useless signal right before them"
                => row.swept.count.false_presses;
            "false_inside", "signals", "useless signals during a false belief episode"
                => row.swept.count.false_inside;
            "harmless", "signals", "signals about a false belief that led to no error; empty where such beliefs are \
                not known, as with people" => row.swept.count.harmless;
            "contents", "contents", "as signals; for dev, proposed presses" => row.swept.count.contents;
            "useless", "signals", "signals that are not the first about a false belief with errors to follow"
                => row.swept.count.useless;
            "beliefs_from", "", "as in trials: recorded, consensus or raters"
                => row.trial.beliefs.as_ref().map(|beliefs| beliefs.basis.name());
            "lead_s", "s", "mean time from a useful signal to the first error that it would have prevented; empty \
                without useful signals, and for dev"
                => row.swept.count.lead_s().filter(|_| row.swept.concept != ConceptName::Dev);
        }
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

#[derive(Clone, Copy, Debug)]
pub struct GazeRow<'a> {
    pub recording: &'a str,
    pub kitchen: &'a Kitchen,
    pub time_s: f64,
    pub run: GazeRun,
}

impl CsvRow for GazeRow<'_> {
    const TABLE: CsvTable = CsvTable::Gaze;

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => row.recording;
            "time_s", "s", "time of the run's first sample on the trial's clock" => rounded(row.time_s);
            "duration_s", "s", "time from the first to the last sample of the run"
                => rounded(row.run.last.secs_since(row.run.began));
            "location", "", "location at the gaze point; empty: none, or unusable samples"
                => row.run.location.map(|location| &row.kitchen.location(location).name);
            "x", "width of the display", "mean horizontal gaze position, from the left" => row.run.mean(0);
            "y", "height of the display", "mean vertical gaze position, from the top" => row.run.mean(1);
            "confidence", "0 to 1", "mean confidence that the eye tracker reported" => row.run.mean(2);
            "samples", "samples", "number of samples in the run; events.jsonl has every sample" => row.run.samples;
        }
    }
}

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

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "recording", "", "as in trials" => row.recording;
            "seq", "", "log number of the human press that follows, as in actions" => row.seq;
            "aspect", "", "state aspect: a location's content, or a dish's recipe" => &row.estimate.aspect;
            "truth", "", "true value of the aspect" => row.truth;
            "estimate", "", "most probable value in the estimated belief" => &row.estimate.believes;
            "estimate_p_truth", "probability", "probability of the true value in the estimated belief"
                => row.estimate.p_truth;
            "estimate_precision", "", "precision of the estimate: sum of the Dirichlet parameters"
                => row.estimate.precision;
            "believed", "", "most probable value in a simulated participant's belief; empty: a person's"
                => row.believed.map(|own| &own.believes);
            "believed_p_truth", "probability", "probability of the true value in a simulated participant's belief; empty: a person's"
                => row.believed.map(|own| own.p_truth);

        }
    }
}
