//! The command `tomcom study`, which analyses a study.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::data::two_raters;
use super::failure::Failure;
use super::output::{OutputFormat, print, progress, put_aside};
use tomcom_core::base::text::count;
use tomcom_session::headless::SimulationShard;
use tomcom_study::figures::StudySummary;
use tomcom_study::pass::reading::AnalysisScope;
use tomcom_study::pass::{self, AnalysisRequest, NamedRecordings, StudyError, shards};

/// Analyses the recordings of a study: report and tables.
///
/// Errors and their causes, effect of assistance, similarity of wizard and assistant, comparison of concepts. Writes a
/// report (HTML) and tables (CSV).
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom study recordings\n          tomcom study sessions --plan main-study\n          tomcom study shards/* --out results --format json\n          \
                  tomcom study shards/3 --shard 3/8 --out part-3.jsonl\n          \
                  tomcom study --from part-*.jsonl --out results\nMore: docs/study.md, docs/cluster.md, docs/analysis.md"
)]
pub(super) struct StudyArgs {
    /// Folders with recordings in them, or recordings, of one kitchen.
    #[arg(required_unless_present = "from", value_name = "DIR")]
    paths: Vec<PathBuf>,
    /// Folder for report.html and the tables; by default the folder "study" in the first DIR. With --shard, the file of
    /// the part.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Only the recordings of this plan, where there are several; of each, if it is given several times.
    #[arg(long, value_name = "NAME", conflicts_with = "from")]
    plan: Vec<String>,
    /// The two raters whose codes of errors are taken; by default the two with the most complete codes of a recording.
    #[arg(long, value_names = ["A", "B"], num_args = 2)]
    raters: Option<Vec<String>>,
    /// Compare the recordings with a plan that was frozen with tomcom plan PLAN --freeze FILE, and say what differs.
    #[arg(long, value_name = "FILE")]
    frozen: Option<PathBuf>,
    /// Analyse one shard of the recordings, such as "3/8", the third of eight, for job arrays, and only write what the
    /// analysis of all needs of it to the file --out. Shards are those of tomcom simulate.
    #[arg(long, value_name = "PART/PARTS", requires = "out", conflicts_with_all = ["frozen", "format"])]
    shard: Option<SimulationShard>,
    /// Join these parts, written with --shard, instead of reading recordings; the results are those of one analysis of
    /// all recordings.
    #[arg(long, value_name = "FILE", num_args = 1.., requires = "out", conflicts_with_all = ["paths", "shard", "raters", "skip"])]
    from: Vec<PathBuf>,
    /// Steps of the analysis to skip, separated by commas.
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
            StudyError::File(error) => Failure::from(error),
            StudyError::Export(error) => Failure::Failed(miette::Report::new(error)),
        }
    }
}

/// Runs the command `tomcom study`.
pub(super) fn study(args: &StudyArgs) -> Result<(), Failure> {
    let scope = AnalysisScope {
        concepts: !args.skip.contains(&Skip::Concepts),
        events: !args.skip.contains(&Skip::Events),
        raters: args.raters.as_ref().map(|raters| two_raters(raters, "--raters")).transpose()?,
    };
    let paths = if args.from.is_empty() { args.paths.clone() } else { args.from.clone() };
    // The parts of an analysis are joined into a folder that the option `--out` names.
    let out = args.out.clone().unwrap_or_else(|| paths[0].join("study"));
    let request = AnalysisRequest { paths, out, scope, frozen: args.frozen.clone() };
    if !args.from.is_empty() {
        let (figures, report) = shards::join(&request)?;
        return told(args.format, &figures, &report);
    }
    let recordings = NamedRecordings::find(&request.paths, &args.plan)?;
    let bar = progress(recordings.number() as u64, "recordings");
    if let Some(shard) = args.shard {
        let begun = |number: usize| bar.set_length(number as u64);
        let found = recordings.number() as u64;
        let number = shards::analyse_shard(&request, recordings, shard, begun, || bar.inc(1))?;
        bar.finish_and_clear();
        let SimulationShard { number: part, of } = shard;
        let others = match found - number {
            0 => String::new(),
            others => format!("; {others} of other parts {} left out", if others == 1 { "was" } else { "were" }),
        };
        let number = count(number, "recording", "recordings");
        put_aside(&format!("part {part} of {of} of the study was analysed: {number}{others}\n"));
        return Ok(());
    }
    let (figures, report) = pass::study(&request, &recordings, || bar.inc(1))?;
    bar.finish_and_clear();
    told(args.format, &figures, &report)
}

/// Prints the summary of the study's analysis.
fn told(format: OutputFormat, figures: &StudySummary, report: &Path) -> Result<(), Failure> {
    print(format, figures, || format!("{}report: {}\n", pass::describe(figures), report.display()))
}
