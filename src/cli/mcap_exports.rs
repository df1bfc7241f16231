//! Export of recordings as MCAP files, for `tomcom export`.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::failure::Failure;
use super::output::progress;
use crate::run::mcap_export::{self, McapSummary};

/// Exports recordings as MCAP files; returns the summary as JSON and as text.
pub(super) fn export(recordings: &[PathBuf]) -> Result<(Value, String), Failure> {
    let bar = progress(recordings.len() as u64, "recordings");
    let done = crate::run::parallel::each(recordings, |recording| mcap_export::export(recording), || bar.inc(1));
    bar.finish_and_clear();
    let summaries = done.into_iter().collect::<Result<Vec<McapSummary>, _>>()?;
    Ok((json!(summaries), mcap_export::describe(&summaries)))
}
