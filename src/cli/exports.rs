//! The command `tomcom export`.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use serde::Serialize;

use super::failure::Failure;
use super::output::{OutputFormat, print, progress};
use crate::run::options::DEFAULT_OUT;
#[cfg(not(feature = "mcap"))]
use tomcom_session::features::{Feature, MissingFeature};
use tomcom_session::files::file_error::FileResult;
use tomcom_study::annotation_export::{self, AnnotationFormat, AnnotationSummary};
use tomcom_study::bids_export::{self, BidsSummary};
use tomcom_study::files::recordings;
#[cfg(feature = "mcap")]
use tomcom_study::mcap_export::{self, McapSummary};
use tomcom_study::parallel;

/// Exports recordings for other programs.
///
/// As a BIDS data set (Brain Imaging Data Structure, 1.10 and later): a session for each recording with its events,
/// gaze as eye-tracking recording, questionnaires as phenotype. As MCAP, for robotics tools: joints, frames and log in
/// Foxglove's types, gaze, beliefs and events. As annotations beside the recording's films, for ELAN and BORIS, and as
/// subtitles. The logs stay as they are.
#[derive(Debug, Args)]
#[command(
    override_usage = "tomcom export [OPTIONS] --bids <DIR> [RECORDING]...\n       tomcom export [OPTIONS] --mcap|--elan|--boris|--vtt [RECORDING]..."
)]
#[command(group(ArgGroup::new("what").required(true).multiple(true).args(["bids", "mcap", "elan", "boris", "vtt"])))]
#[command(after_help = "Labels of participants are the letters and digits of their codes; what is changed is told.\n\
                  Examples: tomcom export sessions --bids ../bids\n          \
                  tomcom export sessions/2026-03-14-P07-1 --mcap\nMore: docs/exports.md")]
pub(super) struct ExportArgs {
    /// Folders of recordings, or recordings.
    #[arg(value_name = "RECORDING", default_value = DEFAULT_OUT)]
    recordings: Vec<PathBuf>,
    /// Write a BIDS data set into this folder, which must be empty or not exist yet.
    #[arg(long, value_name = "DIR")]
    bids: Option<PathBuf>,
    /// Write recording.mcap into the folder of each recording.
    #[arg(long)]
    mcap: bool,
    /// Write recording.eaf for ELAN into the folder of each recording: a tier for presses, errors, signals, each false
    /// belief (by the estimate), notes and each rater's codes, with the films of tomcom video.
    #[arg(long)]
    elan: bool,
    /// Write recording.boris, a project of BORIS with the same, into the folder of each recording.
    #[arg(long)]
    boris: bool,
    /// Write recording.vtt, the same as subtitles (WebVTT), into the folder of each recording.
    #[arg(long)]
    vtt: bool,
    /// With --elan, --boris or --vtt: only presses and errors, for raters who are to code them blind.
    #[arg(long)]
    blind: bool,
    /// With --bids: also export what wizards and participants typed (notes, reasons, answers in words), which can
    /// contain names.
    #[arg(long, requires = "bids")]
    words: bool,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// A build without MCAP exports none.
#[cfg(not(feature = "mcap"))]
type McapSummary = ();

/// JSON output of the export.
#[derive(Debug, Serialize)]
struct ExportSummary {
    /// Summary of the BIDS data set.
    bids: Option<BidsSummary>,
    /// Summary of the MCAP files with their numbers of messages.
    mcap: Option<Vec<McapSummary>>,
    /// Files of annotations.
    annotations: Option<Vec<AnnotationSummary>>,
}

pub(super) fn export(args: &ExportArgs) -> Result<(), Failure> {
    let recordings = meant(&args.recordings)?;
    let mut bids = None;
    if let Some(folder) = &args.bids {
        let bar = progress(recordings.len() as u64, "recordings");
        bids = Some(bids_export::export(&recordings, folder, args.words, || bar.inc(1))?);
        bar.finish_and_clear();
    }
    let mut text = bids.as_ref().map(bids_export::describe).unwrap_or_default();
    let mut mcap = None;
    if args.mcap {
        let (summaries, told) = export_mcap(&recordings)?;
        mcap = Some(summaries);
        text += &told;
    }
    let asked =
        [(args.elan, AnnotationFormat::Elan), (args.boris, AnnotationFormat::Boris), (args.vtt, AnnotationFormat::Vtt)];
    let formats: Vec<AnnotationFormat> =
        asked.into_iter().filter_map(|(is_asked, format)| is_asked.then_some(format)).collect();
    if args.blind && formats.is_empty() {
        let help = "--blind with --elan, --boris or --vtt";
        return Err(Failure::Wrong(miette::miette!(help = help, "found --blind without an export of annotations")));
    }
    let mut annotations = None;
    if !formats.is_empty() {
        let files = each(&recordings, |recording| annotation_export::export(recording, &formats, args.blind))?;
        let summaries: Vec<AnnotationSummary> = files.into_iter().flatten().collect();
        text += &annotation_export::describe(&summaries);
        annotations = Some(summaries);
    }
    print(args.format, &ExportSummary { bids, mcap, annotations }, || text)
}

/// Exports recordings as MCAP files; the summaries, and their text.
#[cfg(feature = "mcap")]
fn export_mcap(recordings: &[PathBuf]) -> Result<(Vec<McapSummary>, String), Failure> {
    let summaries = each(recordings, mcap_export::export)?;
    let text = mcap_export::describe(&summaries);
    Ok((summaries, text))
}

#[cfg(not(feature = "mcap"))]
fn export_mcap(_: &[PathBuf]) -> Result<(Vec<McapSummary>, String), Failure> {
    Err(MissingFeature(Feature::Mcap).into())
}

/// Exports each of the recordings, on all processors.
fn each<T: Send>(recordings: &[PathBuf], export: impl Fn(&Path) -> FileResult<T> + Sync) -> Result<Vec<T>, Failure> {
    let bar = progress(recordings.len() as u64, "recordings");
    let done = parallel::each(recordings, |recording| export(recording), || bar.inc(1));
    bar.finish_and_clear();
    Ok(done.into_iter().collect::<FileResult<Vec<T>>>()?)
}

/// Collects the recordings at or below these paths, each recording once.
fn meant(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut all = Vec::new();
    for path in paths {
        let found = if path.is_dir() { recordings::of_folder(path)? } else { vec![path.clone()] };
        for recording in found {
            if !all.contains(&recording) {
                all.push(recording);
            }
        }
    }
    Ok(all)
}
