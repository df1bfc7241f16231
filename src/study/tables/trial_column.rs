//! Declaration of a column of the table of trials.

use std::borrow::Cow;

use crate::column::{CsvCell, CsvColumn, CsvRow};
use crate::effect::StudyMeasure;
use crate::trial_statistics::TrialStatistics;

/// Declaration of a column in the table of trials.
pub(super) enum TrialColumn {
    Plain(CsvColumn<TrialStatistics>),
    /// A measure that the report compares between assisted and unassisted trials.
    Compared(StudyMeasure),
}

/// Declares a column of the table of trials that the report does not compare.
pub(super) fn plain(
    name: &'static str,
    unit: &'static str,
    meaning: impl Into<Cow<'static, str>>,
    value: fn(&TrialStatistics) -> CsvCell<'_>,
) -> TrialColumn {
    TrialColumn::Plain(TrialStatistics::column(name, unit, meaning, value))
}
