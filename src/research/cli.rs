//! The command line of the program `tomcom-research`.

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use miette::{MietteHandlerOpts, Report};
use serde::Serialize;
use tomcom_core::base::printable::printable_lines;
use tomcom_session::files::file_error::FileError;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::planned_trial::copies_in_words;

use crate::planner_accuracy::AccuracyStepCounts;
use crate::{offers, planner_accuracy, speed};

/// Measurements for the development of tomcom: simulations, checks of the belief estimate, accuracy and speed.
#[derive(Debug, Parser)]
#[command(
    name = "tomcom-research",
    version,
    after_help = "Run it from a clone: cargo run --release -p tomcom-research -- COMMAND\nMore: docs/evidence.md"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Planner(PlannerArgs),
    Speed(SpeedArgs),
    Offers(OffersArgs),
}

/// Compares the planner's answers with those from 64 times as many rollouts, and with the plain reference planner.
///
/// Takes long.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom-research planner recordings/* --steps 500\nMore: docs/human-model.md")]
struct PlannerArgs {
    /// Recordings of one kitchen, or folders of recordings.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Largest number of steps, spread evenly over the recordings.
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    steps: u64,
    /// Largest number of steps for the plain reference planner; 0 for none.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(0..=100_000))]
    reference_steps: u64,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// Measures computing times of inference and planning on a recording.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom-research speed recordings/seed7-S001\nMore: docs/human-model.md")]
struct SpeedArgs {
    /// The folder of a recording, or its events.jsonl.
    recording: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// Measures how steady offers are.
///
/// How long they stand, and whether a simulated hand that reads an offer sends what it has read.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom-research offers recordings/*\nMore: docs/human-model.md")]
struct OffersArgs {
    /// Recordings, or folders of recordings.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    /// Text for people.
    Text,
    /// One JSON object for programs.
    Json,
}

/// Failure of a command, which decides the exit code: 2 for wrong arguments or files, 1 for all else.
enum Failure {
    Wrong(Report),
    Failed(Report),
    /// The program that reads the output has closed the pipe, as `head` does.
    Unread,
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Failure {
        Failure::Wrong(Report::new(error))
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::Unread,
            _ => Failure::Failed(miette::miette!("the result cannot be printed: {error}")),
        }
    }
}

/// Runs the command that the program's arguments name. Exit codes: 0 done, 1 failed, 2 wrong arguments or files.
pub fn main() -> ExitCode {
    // Lines of messages are not wrapped, so that file and line can be searched for; an existing hook is kept.
    let _ = miette::set_hook(Box::new(|_| Box::new(MietteHandlerOpts::new().wrap_lines(false).build())));
    let done = match Cli::parse().command {
        Command::Planner(args) => planner(&args),
        Command::Speed(args) => speed(&args),
        Command::Offers(args) => offers(&args),
    };
    let (code, report) = match done {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::Failed(report)) => (1, report),
        Err(Failure::Wrong(report)) => (2, report),
    };
    eprintln!("{report:?}");
    ExitCode::from(code)
}

fn planner(args: &PlannerArgs) -> Result<(), Failure> {
    let extent = AccuracyStepCounts {
        steps: args.steps as usize,
        reference_steps: args.reference_steps.min(args.steps) as usize,
    };
    let recordings = gathered(&args.recordings)?;
    // Each step is planned twice: with the budget of a session, and with the larger one.
    let bar = progress(2 * args.steps + args.reference_steps, "answers of the planner at most");
    let found = planner_accuracy::measure(&recordings, extent, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &found, || planner_accuracy::describe(&found))
}

fn speed(args: &SpeedArgs) -> Result<(), Failure> {
    let found = speed::measure(&args.recording)?;
    print(args.format, &found, || speed::describe(&found))
}

fn offers(args: &OffersArgs) -> Result<(), Failure> {
    let recordings = gathered(&args.recordings)?;
    let bar = progress(recordings.paths.len() as u64, "recordings");
    let found = offers::measure(&recordings, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &found, || offers::describe(&found))
}

/// Gathers the recordings at these paths, each trial once, and tells which are copies.
fn gathered(paths: &[PathBuf]) -> Result<GatheredRecordings, Failure> {
    let found = GatheredRecordings::find(paths)?;
    if let Some(copies) = copies_in_words(&found.copies) {
        eprintln!("{}", printable_lines(&copies));
    }
    Ok(found)
}

/// Prints what was found as one JSON object or as text.
fn print(format: OutputFormat, found: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    let text = match format {
        OutputFormat::Json => serde_json::to_string_pretty(found).map_err(io::Error::other)? + "\n",
        OutputFormat::Text => text(),
    };
    Ok(put(&text)?)
}

fn put(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(printable_lines(text).as_bytes())?;
    out.flush()
}

/// A progress bar on standard error; hidden if standard error is not a terminal.
fn progress(of: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(of);
    if io::stderr().is_terminal()
        && let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {what}, {{eta}} left"))
    {
        bar.set_style(style);
    }
    bar
}
