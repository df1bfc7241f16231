//! Table of errors that communication concepts would have prevented.

use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::concept_totals::ConceptPreventionCounts;
use crate::prevention::PreventionCounts;
use crate::trial_details::TrialDetails;
use crate::trial_statistics::TrialStatistics;
use tomcom_core::communication::concept::ConceptName;

/// Row of the table of concepts: a concept with one value of its parameter in an unassisted trial.
#[derive(Clone, Copy, Debug)]
pub struct ConceptRow<'a> {
    trial: &'a TrialStatistics,
    swept: &'a ConceptPreventionCounts,
}

/// Rows for all communication concepts that were evaluated on a trial.
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
