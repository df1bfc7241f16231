//! Declaration of a column of the table of trials.

use crate::study::column::{Column, TableCell, TableRow};
use crate::study::effect::StudyMeasure;
use crate::study::trial_statistics::Trial;

/// Declaration of a column in the table of trials.
pub(super) enum TrialColumn {
    Plain(Column<Trial>),
    /// A measure that the report compares between assisted and unassisted trials.
    Compared(StudyMeasure),
}

/// Declares a column that the report does not compare.
pub(super) fn plain(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: fn(&Trial) -> TableCell<'_>,
) -> TrialColumn {
    TrialColumn::Plain(Trial::column(name, unit, meaning, value))
}
