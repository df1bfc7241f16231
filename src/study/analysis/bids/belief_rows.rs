//! Tables of beliefs for the BIDS export: beliefs that simulated participants had, and the assistant's estimates.

use super::sample_rows::{LongTable, LongTableRow};
use super::tsv::{self, BidsColumn, BidsFile, TaskFacts};
use tomcom_core::mind::AspectBelief;
use tomcom_core::mind::AspectEstimate;
use tomcom_session::TimestampedEvent;
use tomcom_session::event::Event;

const SOURCES: &[(&str, &str)] = &[
    ("participant", "The belief of a simulated participant before its press"),
    ("estimate", "The belief estimate before the press, made from what could be known then"),
];

const COLUMNS: [BidsColumn; 7] = [
    BidsColumn::new("seq", "Number of the event in the log, as in the events"),
    BidsColumn::of_levels("source", SOURCES, "Whose probabilities they are"),
    BidsColumn::new("press", "Number (seq) of the press that an estimate belongs to"),
    BidsColumn::new("aspect", "What is believed something of: a place, or the recipe of a dish"),
    BidsColumn::new("believes", "The likeliest value"),
    BidsColumn::of_unit("p_truth", "1", "Probability of the true value"),
    BidsColumn::of_unit(
        "precision",
        "1",
        "Precision of the estimate: the sum of the parameters of its Dirichlet distribution",
    ),
];

/// Rows of the table of beliefs for an event of beliefs; none for other events.
pub(super) fn rows(stamped: &TimestampedEvent) -> Vec<LongTableRow> {
    let row = |source: &str, rest: [String; 5]| LongTableRow {
        table: LongTable::Beliefs,
        time: stamped.time,
        line: tsv::line([stamped.seq.to_string(), source.to_string()].into_iter().chain(rest)),
    };
    match &stamped.event {
        Event::ParticipantBelieves(belief) => {
            let of_aspect = |about: &AspectBelief| {
                let (p, none) = (about.p_truth.to_string(), tsv::NOTHING.to_string());
                row("participant", [none.clone(), about.aspect.clone(), about.believes.clone(), p, none])
            };
            belief.aspects.iter().map(of_aspect).collect()
        }
        Event::BeliefEstimated(estimate) => {
            let of_aspect = |about: &AspectEstimate| {
                let (p, precision) = (about.p_truth.to_string(), about.precision.to_string());
                let press = estimate.press.to_string();
                row("estimate", [press, about.aspect.clone(), about.believes.clone(), p, precision])
            };
            estimate.aspects.iter().map(of_aspect).collect()
        }
        _ => Vec::new(),
    }
}

/// First line of the table of beliefs.
pub(super) fn heading() -> String {
    tsv::line(tsv::names(&COLUMNS))
}

/// The sidecar file of the table of beliefs.
pub(super) fn sidecar(task: &TaskFacts) -> BidsFile {
    let mut about = tsv::described(&COLUMNS);
    task.tell(&mut about);
    about.insert("Description".to_string(), "Beliefs about the kitchen, an aspect a row".into());
    BidsFile::json("beh.json", &about.into())
}
