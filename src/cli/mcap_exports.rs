//! Export of recordings as MCAP files, for `tomcom export`.

use std::path::PathBuf;

use super::failure::Failure;
use super::output::progress;
use tomcom_study::mcap_export::{self, McapSummary};

/// What the export of one recording tells.
pub(super) type ExportedMcap = McapSummary;

/// Exports recordings as MCAP files; returns the summaries, and their text.
pub(super) fn export(recordings: &[PathBuf]) -> Result<(Vec<ExportedMcap>, String), Failure> {
    let bar = progress(recordings.len() as u64, "recordings");
    let done = tomcom_study::parallel::each(recordings, |recording| mcap_export::export(recording), || bar.inc(1));
    bar.finish_and_clear();
    let summaries = done.into_iter().collect::<Result<Vec<McapSummary>, _>>()?;
    let text = mcap_export::describe(&summaries);
    Ok((summaries, text))
}
