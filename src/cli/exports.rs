//! `tomcom export`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::list::exists;
use super::output::{OutputFormat, print, progress};
use crate::edge::recordings;
use crate::run::bids_export::{self, BidsSummary};

/// Exports recordings for other programs.
///
/// As a BIDS data set (Brain Imaging Data Structure, 1.10 and later): a session for each recording with its events, gaze as eye-tracking
/// recording, questionnaires as phenotype. The recordings stay as they are.
#[derive(Debug, Args)]
#[command(after_help = "Labels of participants are the letters and digits of their codes; what is changed is told.\n\
                  Example: tomcom export sessions --bids ../bids\nMore: docs/exports.md")]
pub(super) struct ExportArgs {
    /// Folders of recordings, or recordings.
    #[arg(value_name = "RECORDING", default_value = "sessions")]
    recordings: Vec<PathBuf>,
    /// Write a BIDS data set into this folder, which is made, or is empty.
    #[arg(long, value_name = "DIR", required = true)]
    bids: Option<PathBuf>,
    /// With --bids: export also what wizards and participants typed (notes, reasons, answers in words), in which names may stand.
    #[arg(long, requires = "bids")]
    words: bool,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// What was exported, as JSON.
#[derive(Debug, Serialize)]
struct ExportSummary {
    /// The BIDS data set.
    bids: Option<BidsSummary>,
}

/// `tomcom export`.
pub(super) fn export(args: &ExportArgs) -> Result<(), Failure> {
    let recordings = meant(&args.recordings)?;
    let mut bids = None;
    if let Some(folder) = &args.bids {
        let bar = progress(recordings.len() as u64, "recordings");
        bids = Some(bids_export::export(&recordings, folder, args.words, || bar.inc(1))?);
        bar.finish_and_clear();
    }
    let text = bids.as_ref().map(bids_export::describe).unwrap_or_default();
    print(args.format, &ExportSummary { bids }, || text)
}

/// The recordings that are meant by paths, each once.
fn meant(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut all = Vec::new();
    for path in paths {
        exists(path)?;
        let found = if path.is_dir() { recordings::of_folder(path)? } else { vec![path.clone()] };
        for recording in found {
            if !all.contains(&recording) {
                all.push(recording);
            }
        }
    }
    Ok(all)
}
