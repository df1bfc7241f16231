//! How a column of the table of trials is declared.

use crate::study::column::{Column, TableCell, TableRow};
use crate::study::effect::StudyMeasure;
use crate::study::trial_statistics::Trial;

/// Declaration of a column in the table of trials.
pub(super) enum TrialColumn {
    Plain(Column<Trial>),
    /// A measure that is compared between assisted and unassisted trials.
    Compared(StudyMeasure),
}

/// A column that is not compared.
pub(super) fn plain(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&Trial) -> TableCell<'_>,
) -> TrialColumn {
    TrialColumn::Plain(Trial::column(name, unit, meaning, value))
}
