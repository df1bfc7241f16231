//! Table of the beliefs about each state aspect before each human press.

use crate::column::{CsvColumn, CsvRow, CsvTable};
use tomcom_core::mind::AspectBelief;
use tomcom_core::mind::AspectEstimate;

/// Row of the table of beliefs: estimated and recorded belief about one state aspect before a press of the human.
#[derive(Clone, Copy, Debug)]
pub struct BeliefRow<'a> {
    /// Name of the recording in tables.
    pub recording: &'a str,
    /// Sequence number of the press in the log.
    pub seq: u64,
    /// True value of the state aspect.
    pub truth: &'a str,
    /// Estimate of the belief about the aspect before the press.
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
