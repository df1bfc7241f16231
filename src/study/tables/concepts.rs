//! Table of the prevention counts of communication concepts.

use crate::study::column::{Column, Table, TableCell, TableRow};
use crate::study::prevention::PreventionCounts;
use crate::study::roc::SweptTrial;
use crate::study::trial::Trial;

/// A concept with one parameter value in an unassisted trial.
#[derive(Clone, Copy, Debug)]
pub struct ConceptRow<'a> {
    trial: &'a Trial,
    swept: &'a SweptTrial,
}

/// Rows for all concepts that were evaluated on a trial.
pub fn concepts(trial: &Trial) -> impl Iterator<Item = ConceptRow<'_>> {
    trial.swept.iter().map(move |swept| ConceptRow { trial, swept })
}

impl TableRow for ConceptRow<'_> {
    const TABLE: Table = Table::Concepts;

    fn columns() -> Vec<Column<Self>> {
        let count = |name, unit, meaning, count: fn(&PreventionCounts) -> u64| {
            Self::column(name, unit, meaning, move |row| count(&row.swept.count).into())
        };
        let parameter = "cost of communication in presses (tom-com), threshold (tom), presses proposed (dev)";
        let inside = "on an aspect that was believed right while another one had an episode";
        vec![
            Self::column("recording", "", "as in trials; unassisted trials that count", |row| {
                (&row.trial.recording).into()
            }),
            Self::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
            Self::column("concept", "", "tom-com, tom or dev", |row| row.swept.concept.name().into()),
            Self::column("parameter", "", parameter, |row| TableCell::Number(row.swept.parameter)),
            count("presses", "presses", "of the human", |count| count.presses),
            count("signals", "signals", "that would have been sent; for dev presses proposed", |count| count.signals),
            count("related", "errors", "belief related", |count| count.related),
            count("prevented", "errors", "belief related, that would have been prevented", |count| count.prevented),
            count("outside", "presses", "of the human outside of false belief episodes", |count| count.outside),
            count("false_presses", "presses", "of those, with a false signal before them", |count| count.false_presses),
            count("false_inside", "signals", inside, |count| count.false_inside),
            count("harmless", "signals", "on a wrong belief that led to no error", |count| count.harmless),
        ]
    }
}
