//! Compares the recordings of a study with a frozen plan.

use std::path::Path;

use crate::edge::file_error::FileResult;
use crate::edge::frozen_file::read_frozen;
use crate::edge::log::LogReader;
use crate::study::preregistration::{Preregistration, RecordedPlan};

/// Comparison of these recordings with the frozen plan in a file.
///
/// # Errors
/// The file or a recording cannot be read, or the file was changed after the plan was frozen.
pub(super) fn check<'a>(file: &Path, recordings: impl Iterator<Item = &'a Path>) -> FileResult<Preregistration> {
    let (digest, frozen) = read_frozen(file)?;
    let recorded = |recording: &Path| {
        let spec = LogReader::open(recording)?.header.session;
        let plan = spec.step.map(|step| (step.plan, step.digest));
        Ok(RecordedPlan { participant: spec.participant.code, plan })
    };
    let recordings = recordings.map(recorded).collect::<FileResult<Vec<RecordedPlan>>>()?;
    Ok(Preregistration::new(digest, &frozen, &recordings))
}
