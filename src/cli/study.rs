//! The command `tomcom study`, which analyses a study.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::data::two_raters;
use super::failure::Failure;
use super::list::exists;
use super::output::{OutputFormat, print, progress};
use crate::run::study::reading::AnalysisScope;
use crate::run::study::{self, AnalysisRequest, NamedRecordings, StudyError};

/// Analyses the recordings of a study: report and tables.
///
/// Errors and their causes, effect of assistance, similarity of wizard and assistant, comparison of concepts. Writes a
/// report (HTML) and tables (CSV).
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom study recordings\n          tomcom study shards/* --out results --format json\nMore: docs/study.md, docs/analysis.md"
)]
pub(super) struct StudyArgs {
    /// Folders with recordings in them, or recordings, of one kitchen.
    #[arg(required = true, value_name = "DIR")]
    paths: Vec<PathBuf>,
    /// Folder for report.html and the tables; by default the folder "study" in the first DIR.
    #[arg(long)]
    out: Option<PathBuf>,
    /// The two raters whose codes of errors are taken; by default the two with the most complete codes of a recording.
    #[arg(long, value_names = ["A", "B"], num_args = 2)]
    raters: Option<Vec<String>>,
    /// Compare the recordings with a plan that was frozen with tomcom plan PLAN --freeze FILE, and say what differs.
    #[arg(long, value_name = "FILE")]
    frozen: Option<PathBuf>,
    /// Parts to skip, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',')]
    skip: Vec<Skip>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// Parts of the analysis that can be skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Skip {
    /// The comparison of concepts, which plans at every press.
    Concepts,
    /// Rows of the large tables actions, communications, beliefs and gaze.
    Events,
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Failure {
        match error {
            StudyError::File(error) => Failure::from(*error),
            StudyError::Export(error) => Failure::Failed(miette::Report::new(error)),
        }
    }
}

pub(super) fn study(args: &StudyArgs) -> Result<(), Failure> {
    args.paths.iter().try_for_each(|path| exists(path))?;
    let recordings = NamedRecordings::find(&args.paths)?;
    let extent =
        AnalysisScope { concepts: !args.skip.contains(&Skip::Concepts), events: !args.skip.contains(&Skip::Events) };
    let out = args.out.clone().unwrap_or_else(|| args.paths[0].join("study"));
    let raters = args.raters.as_ref().map(|raters| two_raters(raters, "--raters")).transpose()?;
    let bar = progress(recordings.number() as u64, "recordings");
    let (paths, frozen) = (args.paths.clone(), args.frozen.clone());
    let request = AnalysisRequest { paths, out, extent, raters, frozen };
    let (figures, report) = study::study(&request, &recordings, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &figures, || format!("{}report: {}\n", study::describe(&figures), report.display()))
}
