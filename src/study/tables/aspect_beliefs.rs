//! Table of the beliefs about each aspect before each human press.

use crate::mind::AspectBelief;
use crate::mind::witness::AspectEstimate;
use crate::study::column::{Column, Table, TableRow};

/// Estimated and recorded belief about an aspect before a human press.
#[derive(Clone, Copy, Debug)]
pub struct BeliefRow<'a> {
    pub recording: &'a str,
    /// Log number of the press event.
    pub seq: u64,
    /// True value of the aspect.
    pub truth: &'a str,
    pub estimate: &'a AspectEstimate,
    /// Recorded belief of a simulated participant.
    pub believed: Option<&'a AspectBelief>,
}

impl TableRow for BeliefRow<'_> {
    const TABLE: Table = Table::Beliefs;

    fn columns() -> Vec<Column<Self>> {
        let seq = "of the human's press that it is from before, as in actions";
        let believed = "of simulated participants: that of the truth for it";
        vec![
            Self::column("recording", "", "as in trials", |row| row.recording.into()),
            Self::column("seq", "", seq, |row| row.seq.into()),
            Self::column("aspect", "", "state aspect: a location's content, or a dish's recipe", |row| {
                (&row.estimate.aspect).into()
            }),
            Self::column("truth", "", "its true value", |row| row.truth.into()),
            Self::column("estimate", "", "the value that is expected to be believed most", |row| {
                (&row.estimate.believes).into()
            }),
            Self::column("estimate_p_truth", "probability", "expected, of the truth", |row| {
                row.estimate.p_truth.into()
            }),
            Self::column("estimate_precision", "", "sum of the Dirichlet's alphas", |row| {
                row.estimate.precision.into()
            }),
            Self::column("believed", "", "of simulated participants: the likeliest value for it", |row| {
                row.believed.map(|own| &own.believes).into()
            }),
            Self::column("believed_p_truth", "probability", believed, |row| row.believed.map(|own| own.p_truth).into()),
        ]
    }
}
