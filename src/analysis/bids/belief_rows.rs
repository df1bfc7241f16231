//! Tables of beliefs for the BIDS export: beliefs that simulated participants had, and the assistant's estimates.

use super::tsv::{self, BidsColumn, BidsFile, TaskFacts};
use crate::session::TimestampedEvent;
use crate::session::event::Event;

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

/// Rows of the table of beliefs of one recording in the BIDS export.
#[derive(Debug, Default)]
pub(super) struct BeliefRows {
    rows: String,
    pub count: u64,
}

impl BeliefRows {
    pub(super) fn note(&mut self, stamped: &TimestampedEvent) {
        match &stamped.event {
            Event::ParticipantBelieves(belief) => {
                for about in &belief.aspects {
                    let (p, none) = (about.p_truth.to_string(), tsv::NOTHING.to_string());
                    self.add(
                        stamped.seq,
                        "participant",
                        [none.clone(), about.aspect.clone(), about.believes.clone(), p, none],
                    );
                }
            }
            Event::BeliefEstimated(estimate) => {
                for about in &estimate.aspects {
                    let (p, precision) = (about.p_truth.to_string(), about.precision.to_string());
                    let press = estimate.press.to_string();
                    self.add(
                        stamped.seq,
                        "estimate",
                        [press, about.aspect.clone(), about.believes.clone(), p, precision],
                    );
                }
            }
            _ => {}
        }
    }

    fn add(&mut self, seq: u64, source: &str, rest: [String; 5]) {
        self.rows += &tsv::line([seq.to_string(), source.to_string()].into_iter().chain(rest));
        self.count += 1;
    }

    /// The table of beliefs with its JSON sidecar file; no files if the recording has no beliefs.
    pub(super) fn into_files(self, task: &TaskFacts) -> Vec<BidsFile> {
        if self.count == 0 {
            return Vec::new();
        }
        let mut about = tsv::described(&COLUMNS);
        task.tell(&mut about);
        about.insert("Description".to_string(), "Beliefs about the kitchen, an aspect a row".into());
        let text = tsv::line(tsv::names(&COLUMNS)) + &self.rows;
        vec![BidsFile::new("beh.tsv", text), BidsFile::json("beh.json", &about.into())]
    }
}
