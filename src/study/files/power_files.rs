//! Output file of the command `tomcom power`: the table of statistical power.

use std::io;
use std::path::Path;

use crate::drawn_study::SignificanceTestMethod;
use crate::power_answer::{PowerSummary, SampleSizePower, TestPower};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;

/// A column of the table of statistical power: its name, and the function that computes its value for a row.
type PowerColumn = (&'static str, fn(&SampleSizePower, &TestPower) -> String);

const COLUMNS: [PowerColumn; 12] = [
    ("participants", |size, _| size.participants.to_string()),
    ("method", |_, one| method(one.test.method).to_string()),
    ("arm", |_, one| one.test.arm.name().to_string()),
    ("against", |_, one| one.test.against.name().to_string()),
    ("studies", |_, one| one.found.studies.to_string()),
    ("rejected", |_, one| one.found.rejected.to_string()),
    ("rejected_uncorrected", |_, one| one.found.rejected_uncorrected.to_string()),
    ("unknown", |_, one| one.found.unknown.to_string()),
    ("share", |_, one| format!("{:.4}", one.found.share)),
    ("low", |_, one| format!("{:.4}", one.found.interval[0])),
    ("high", |_, one| format!("{:.4}", one.found.interval[1])),
    ("least_ratio", |_, one| one.least_ratio.map_or(String::new(), |ratio| format!("{ratio:.4}"))),
];

fn method(method: SignificanceTestMethod) -> &'static str {
    match method {
        SignificanceTestMethod::MixedAnova => "mixed_anova",
        SignificanceTestMethod::LinearMixedModel => "linear_mixed_model",
    }
}

/// Checks that the table of statistical power can be written to this path.
///
/// # Errors
/// There is a file at the path that this program did not write.
pub fn check_table(path: &Path) -> FileResult<()> {
    let names = COLUMNS.map(|(name, _)| name).join(",");
    overwrite::check(path, "a table of power", |head| overwrite::first_line(head) == names.as_bytes())
        .map_err(|reason| FileError::unwritable(path, reason))
}

/// Writes the table of statistical power (CSV): a row for each number of participants and each test.
///
/// # Errors
/// The file cannot be written.
pub fn write_table(path: &Path, found: &PowerSummary) -> FileResult<()> {
    let write = || -> io::Result<()> {
        let mut table = csv::Writer::from_writer(Vec::new());
        table.write_record(COLUMNS.map(|(name, _)| name))?;
        for size in &found.sizes {
            for one in &size.tests {
                table.write_record(COLUMNS.map(|(_, value)| value(size, one)))?;
            }
        }
        let bytes = table.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
        overwrite::write(path, &bytes)
    };
    write().map_err(|reason| FileError::unwritable(path, reason))
}
