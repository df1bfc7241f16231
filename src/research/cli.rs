//! The command line of the program `tomcom-research`.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use miette::{MietteHandlerOpts, Report};
use serde::Serialize;
use tomcom_core::base::text::count;
use tomcom_core::base::text::printable_lines;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::settings::ConceptSpec;
use tomcom_session::files::file_error::FileError;
use tomcom_session::files::{overwrite, read_session};
use tomcom_session::headless::{self, SimulationShard};
use tomcom_session::log::RecordingError;
use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};
use tomcom_study::files::simulated_trials::SimulationRequest;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::planned_trial::copies_in_words;

use crate::planner_accuracy::AccuracyStepCounts;
use crate::robustness::battery::read_battery;
use crate::robustness::report::{chart, describe_end, describe_row, heading, name_width};
use crate::robustness::table::CohortRow;
use crate::robustness::{self, RobustnessRequest};
use crate::sweep::ParameterSweepAxis;
use crate::{beliefs, calibrate, offers, planner_accuracy, speed, sweep};

/// Measurements for the development of tomcom: simulations, checks of the belief estimate, accuracy and speed.
#[derive(Debug, Parser)]
#[command(
    name = "tomcom-research",
    version,
    after_help = "Run it from a clone: cargo run -p tomcom-research -- COMMAND\nMore: docs/evidence.md"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Robustness(RobustnessArgs),
    Sweep(SweepArgs),
    Beliefs(BeliefsArgs),
    Planner(PlannerArgs),
    Speed(SpeedArgs),
    Offers(OffersArgs),
    Calibrate(CalibrateArgs),
}

/// Measures estimate and assistant with cohorts of simulated people.
///
/// Each cohort differs from the default population. Its trials are simulated without signals and with the assistant
/// acting by itself. Nothing is recorded. The row of a cohort is printed when it is finished; with --format json on
/// standard error.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom-research robustness sessions/people/robustness.toml --seed 9101 --choose-seed 9001 --arm timed\nMore: docs/study.md"
)]
struct RobustnessArgs {
    /// Battery file, which names a session file and describes the cohorts.
    battery: PathBuf,
    /// Number of judged trials of each cohort, and of trials on which the thresholds of its flags are chosen; at least
    /// 2, since intervals draw trials anew.
    #[arg(long, default_value_t = 160, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    trials: u64,
    /// Seed of the judged trials; by default that of the session file.
    #[arg(long)]
    seed: Option<u64>,
    /// Seed of the trials on which the thresholds for flagging false beliefs are chosen; by default the seed of the
    /// judged trials plus 1.
    #[arg(long)]
    choose_seed: Option<u64>,
    /// Simulate only this cohort (several: repeat the option).
    #[arg(long, value_name = "NAME")]
    cohort: Vec<String>,
    /// Kind of the robot's arm, instead of the session file's; "timed" is faster to simulate.
    #[arg(long, value_enum)]
    arm: Option<ArmArg>,
    /// Write a picture to this file (SVG).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ArmArg {
    /// A simulated UR5 that presses the buttons, slows near the hand, and stops when it touches the hand.
    Physics,
    /// A timed arm: every press takes a random duration.
    Timed,
}

impl From<ArmArg> for ArmKind {
    fn from(arm: ArmArg) -> ArmKind {
        match arm {
            ArmArg::Physics => ArmKind::Physics,
            ArmArg::Timed => ArmKind::Timed,
        }
    }
}

/// Simulates the same trials for every value of a setting and without signals, and prints the effects.
///
/// Plans are left out: every trial has another participant.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom-research sweep sessions/default.toml --trials 100 --sweep cost=0.5,1.5,2.4 --sweep gaze=on,off --out grid\nMore: docs/study.md"
)]
struct SweepArgs {
    /// The session file to simulate.
    session: PathBuf,
    /// A setting with its values: cost=0.5,1.5, threshold (of tom), horizon, rollouts, tau, radius, gaze=on,off. Several
    /// settings make a grid.
    #[arg(long, value_name = "SETTING=VALUES", required = true)]
    sweep: Vec<ParameterSweepAxis>,
    /// Number of trials; each has its own orders and participant and does not depend on their number.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    trials: u64,
    /// Simulate one shard of the trials, such as "2/8", the second of eight disjoint shards, for job arrays.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1", hide_default_value = true)]
    shard: SimulationShard,
    /// Seed of all random numbers; by default that of the session file.
    #[arg(long)]
    seed: Option<u64>,
    /// Who sends signals.
    #[arg(long, value_enum, default_value = "assistant")]
    condition: SenderArg,
    /// Communication concept of the assistant, instead of the session file's.
    #[arg(long, value_parser = concept_parser())]
    concept: Option<ConceptName>,
    /// Kind of the robot's arm, instead of the session file's; "timed" is faster to simulate.
    #[arg(long, value_enum)]
    arm: Option<ArmArg>,
    /// Folder for the recordings, one folder per combination of values, and for the table.
    #[arg(long, default_value = "sessions/simulated")]
    out: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SenderArg {
    /// The scripted wizard of the session sends signals.
    Wizard,
    /// The assistant sends signals by itself.
    Assistant,
}

/// Reads the name of a communication concept.
fn concept_parser() -> impl TypedValueParser<Value = ConceptName> {
    let choices = ConceptName::OWN.map(|concept| PossibleValue::new(concept.name()).help(concept.entry().sends));
    PossibleValuesParser::new(choices).try_map(|name| ConceptName::named(&name).ok_or("no concept"))
}

/// Compares the estimates before each press with recorded beliefs, and with the presses.
///
/// Beliefs are recorded of simulated participants; of people, answers to freeze probes take their place.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom-research beliefs recordings/*\nMore: docs/human-model.md")]
struct BeliefsArgs {
    /// Recordings of one kitchen, or folders of recordings.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Choose the thresholds for flagging false beliefs on this recording, of another participant (several: repeat the
    /// option). Without it, each half of the participants is judged with the thresholds of the other half.
    #[arg(long, value_name = "RECORDING")]
    choose_on: Vec<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
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

/// Calibrates simulated participants to the rates of the paper.
///
/// Measures populations over whole studies, on all processors (RAYON_NUM_THREADS limits them).
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom-research calibrate figures sessions/paper.toml 3001,3002\nMore: docs/simulated-participants.md"
)]
struct CalibrateArgs {
    #[command(subcommand)]
    what: Calibration,
}

#[derive(Debug, Subcommand)]
enum Calibration {
    /// Rates of the session's population.
    Figures {
        #[command(flatten)]
        studies: StudiesArgs,
        /// Parameters of the population to change, such as "slip = 0.01".
        changes: Vec<String>,
    },
    /// Rates of the same people, who know everything and do not slip.
    Planning {
        #[command(flatten)]
        studies: StudiesArgs,
        /// Parameters of the population to change, such as "slip = 0.01".
        changes: Vec<String>,
    },
    /// Draws vectors of belief parameters, and tells which agree with the paper.
    Search {
        #[command(flatten)]
        studies: StudiesArgs,
        /// Number of vectors.
        count: u64,
    },
    /// Rates of each vector of a file.
    Each {
        #[command(flatten)]
        studies: StudiesArgs,
        /// File of vectors, such as sessions/people/accepted.toml.
        file: PathBuf,
    },
}

#[derive(Debug, Args)]
struct StudiesArgs {
    /// A session file with a plan.
    session: PathBuf,
    /// Seeds of the studies, separated by commas.
    seeds: Seeds,
}

/// One argument, since others may follow.
#[derive(Clone, Debug)]
struct Seeds(Vec<u64>);

impl FromStr for Seeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Seeds, String> {
        let seeds: Result<Vec<u64>, _> = text.split(',').map(str::parse).collect();
        seeds.map(Seeds).map_err(|error| format!("{error}: right would be whole numbers such as 1,2"))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    /// Text for people.
    Text,
    /// One JSON object for programs.
    Json,
}

/// Failure of a command, which decides the exit code: 2 for wrong arguments or files, 1 for all else.
pub(crate) enum Failure {
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

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Failure {
        match error {
            RecordingError::File(error) => Failure::from(error),
            RecordingError::Recording(error) => Failure::Failed(Report::new(error)),
        }
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
        Command::Robustness(args) => robustness(&args),
        Command::Sweep(args) => sweep(args),
        Command::Beliefs(args) => beliefs(&args),
        Command::Planner(args) => planner(&args),
        Command::Speed(args) => speed(&args),
        Command::Offers(args) => offers(&args),
        Command::Calibrate(args) => calibrate(&args),
    };
    let (code, report) = match done {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::Failed(report)) => (1, report),
        Err(Failure::Wrong(report)) => (2, report),
    };
    eprintln!("{report:?}");
    ExitCode::from(code)
}

fn robustness(args: &RobustnessArgs) -> Result<(), Failure> {
    if let Some(file) = &args.picture {
        overwrite::check(file, "a picture of robustness", |head| head.starts_with(b"<svg "))
            .map_err(|reason| FileError::unwritable(file, reason))?;
    }
    let mut battery = read_battery(&args.battery)?;
    let names: Vec<String> = battery.cohorts.iter().map(|cohort| cohort.name.get_ref().clone()).collect();
    if let Some(unknown) = args.cohort.iter().find(|name| !names.contains(name)) {
        let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
        let remedy = format!("one of the cohorts in the file: {}", quoted.join(", "));
        return Err(wrong_argument(&args.battery, format!("--cohort \"{unknown}\""), &remedy));
    }
    battery.cohorts.retain(|cohort| args.cohort.is_empty() || args.cohort.contains(cohort.name.get_ref()));
    let spec = &mut battery.session.spec;
    spec.robot.arm = args.arm.map_or(spec.robot.arm, ArmKind::from);
    headless::require(spec, &args.battery)?;
    let seed = args.seed.unwrap_or(spec.seed);
    let choose_seed = args.choose_seed.unwrap_or(seed.wrapping_add(1));
    if seed == choose_seed {
        let found = format!("--choose-seed {choose_seed}, which is also the seed of the trials that are judged");
        return Err(wrong_argument(&args.battery, found, "another seed than --seed"));
    }
    let width = name_width(battery.cohorts.iter().map(|cohort| cohort.name.get_ref().as_str()));
    let request = RobustnessRequest { battery, trials: args.trials, seed, choose_seed };
    let bar = progress(request.all_trials(), "trials");
    let tell = |text: &str| match args.format {
        OutputFormat::Text => put(text),
        OutputFormat::Json => {
            eprint!("{}", printable_lines(text));
            Ok(())
        }
    };
    let mut told = tell(&heading(width));
    let finished = |row: &CohortRow| {
        if told.is_ok() {
            told = bar.suspend(|| tell(&describe_row(row, width)));
        }
    };
    let table = robustness::measure(&request, || bar.inc(1), finished);
    bar.finish_and_clear();
    told?;
    if let Some(file) = &args.picture {
        overwrite::write(file, chart(&table).as_bytes()).map_err(|reason| FileError::unwritable(file, reason))?;
    }
    print(args.format, &table, || describe_end(&table))
}

fn sweep(args: SweepArgs) -> Result<(), Failure> {
    let mut files = read_session(&args.session, None)?;
    let spec = &mut files.spec;
    let is_simulated = spec.participant.kind == ParticipantKind::Simulated;
    if !is_simulated || !matches!(spec.participant.gaze, GazeSource::Simulated | GazeSource::None) {
        let found = "a session whose participant or gaze is not simulated".to_string();
        let remedy = "kind = \"simulated\", and gaze = \"simulated\" or \"none\"";
        return Err(wrong_argument(&args.session, found, remedy));
    }
    if args.shard.of > args.trials {
        let found = format!("--shard of {} parts, with {}", args.shard.of, count(args.trials, "trial", "trials"));
        return Err(wrong_argument(&args.session, found, "at most as many parts as trials, so that no part is empty"));
    }
    (spec.plan, spec.seed) = (None, args.seed.unwrap_or(spec.seed));
    spec.trial.condition = match args.condition {
        SenderArg::Wizard => Condition::Wizard,
        SenderArg::Assistant => Condition::Assistant,
    };
    if spec.unattended(spec.trial.condition) != spec.trial.condition {
        let found = "--condition wizard, with a session file whose wizard is a person".to_string();
        return Err(wrong_argument(&args.session, found, "[wizard] with kind = \"scripted\" in the session file"));
    }
    spec.assistant.concept = args.concept.map_or(spec.assistant.concept.clone(), ConceptSpec::from);
    spec.robot.arm = args.arm.map_or(spec.robot.arm, ArmKind::from);
    headless::require(spec, &args.session)?;
    let simulation = SimulationRequest { files, trials: args.trials, shard: args.shard, out: args.out };
    let bar = progress(sweep::trials(&simulation, &args.sweep), "trials");
    let found = sweep::sweep(&simulation, &args.sweep, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &found, || sweep::describe(&found, &args.sweep))
}

fn beliefs(args: &BeliefsArgs) -> Result<(), Failure> {
    let (recordings, choose_on) = (gathered(&args.recordings)?, gathered(&args.choose_on)?);
    let bar = progress((recordings.paths.len() + choose_on.paths.len()) as u64, "recordings");
    let found = beliefs::check(&recordings, &choose_on, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &found, || beliefs::describe(&found))
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

fn calibrate(args: &CalibrateArgs) -> Result<(), Failure> {
    let (Calibration::Figures { studies, .. }
    | Calibration::Planning { studies, .. }
    | Calibration::Search { studies, .. }
    | Calibration::Each { studies, .. }) = &args.what;
    let setting = calibrate::Setting::read(&studies.session)?;
    match &args.what {
        Calibration::Figures { changes, .. } => setting.figures(changes, false, &studies.seeds.0),
        Calibration::Planning { changes, .. } => setting.figures(changes, true, &studies.seeds.0),
        Calibration::Search { count, .. } => setting.search(*count, &studies.seeds.0),
        Calibration::Each { file, .. } => setting.each(file, &studies.seeds.0),
    }
}

/// The failure of a command because an argument is invalid for this file.
pub(crate) fn wrong_argument(path: &Path, found: String, remedy: &str) -> Failure {
    Failure::Wrong(miette::miette!(help = remedy.to_string(), "{}: found {found}", path.display()))
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

pub(crate) fn put(text: &str) -> io::Result<()> {
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
