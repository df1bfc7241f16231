//! The command line. A command is listed when it works.

mod args;
mod choices;
mod data;
mod estimates;
#[cfg(feature = "rerun")]
mod rerun;
#[cfg(not(feature = "rerun"))]
#[path = "cli/without_rerun.rs"]
mod rerun;
mod review;
mod simulation;
mod study;
mod wizard;

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::{CommandFactory, Parser};
use indicatif::{ProgressBar, ProgressStyle};
use miette::MietteHandlerOpts;
use serde::Serialize;

use self::args::*;
use crate::analysis::watcher::CompareRequest;
use crate::base::features::{Feature, NotBuilt};
use crate::base::number_range::OutOfRange;
use crate::communication::concept::ConceptName;
use crate::console;
use crate::edge::doctor;
use crate::edge::file_error::FileError;
use crate::edge::files;
use crate::edge::key_file;
use crate::edge::log::{self, ExclusionError, LogReader, WriteError};
use crate::run::error::RunError;
use crate::run::live::LiveError;
use crate::run::options::{self, SessionStart, SettingOverrides, TrialSeries};
use crate::run::plan::{self, StudyPlanSummary};
use crate::run::replay::Replay;
use crate::run::review::{self as console_over, ReviewError};
use crate::run::series::{self, SeriesOutcome};
use crate::run::standing::{self, ExclusionStatus};
use crate::run::{kitchen, tell, timing, verify};
use crate::session::settings::{ArmKind, Condition, GazeSource, ParticipantKind, SettingError};

/// Exit code: something failed.
const FAILED: u8 = 1;
/// Exit code: wrong arguments or files.
const WRONG: u8 = 2;

/// How often a running session is looked at for new events.
const FOLLOW_INTERVAL: Duration = Duration::from_millis(50);

/// Why a command did not do what was asked.
#[derive(Debug)]
enum Failure {
    /// Wrong arguments or files.
    Wrong(miette::Report),
    /// Something failed on the way.
    Failed(miette::Report),
    /// It was done, and the answer is no; it was printed already.
    No,
    /// Whoever read the output has read enough, as `head` does.
    Unread,
}

impl From<NotBuilt> for Failure {
    fn from(missing: NotBuilt) -> Failure {
        Failure::Wrong(miette::miette!(help = missing.remedy(), "{missing}"))
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Failure {
        Failure::Wrong(miette::Report::new(error))
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Failure {
        Failure::Failed(miette::Report::new(error))
    }
}

impl From<ExclusionError> for Failure {
    fn from(error: ExclusionError) -> Failure {
        match error {
            ExclusionError::Recording(error) => Failure::from(error),
            error => Failure::Wrong(miette::Report::new(error)),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Failure {
        match error {
            RunError::File(error) => Failure::from(*error),
            RunError::Recording(error) => Failure::from(error),
        }
    }
}

impl From<LiveError> for Failure {
    fn from(error: LiveError) -> Failure {
        match error {
            LiveError::Resume(error) => Failure::Wrong(miette::Report::new(error)),
            LiveError::File(error) => Failure::from(*error),
            error @ LiveError::Plan(_) => Failure::Wrong(miette::Report::new(error)),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

impl From<ReviewError> for Failure {
    fn from(error: ReviewError) -> Failure {
        match error {
            ReviewError::File(error) => Failure::from(*error),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Failure {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure::Unread,
            _ => Failure::Failed(miette::miette!("the result cannot be printed: {error}")),
        }
    }
}

/// Runs the command of the arguments. Exit codes: 0 done, 1 failed, 2 wrong arguments or files.
pub fn main() -> ExitCode {
    // Lines are not wrapped, so that file and line can be searched for; a hook that is set already is as good.
    let _ = miette::set_hook(Box::new(|_| Box::new(MietteHandlerOpts::new().wrap_lines(false).build())));
    let cli = Cli::parse();
    let command =
        cli.command.unwrap_or(CliCommand::Operate(OperateArgs { session: None, recording: None, flags: cli.operate }));
    let done = match command {
        CliCommand::Operate(args) => operate(&args),
        CliCommand::Compare(args) => wizard::compare(&args),
        CliCommand::Train(args) => wizard::train(&args),
        CliCommand::Replay(args) => replay(&args),
        CliCommand::Review(args) => review::review(&args),
        CliCommand::Simulate(args) => simulation::simulate(&args),
        CliCommand::Study(args) => study::study(&args),
        CliCommand::Plan(args) => show_plan(&args),
        CliCommand::Fit(args) => estimates::fit(&args),
        CliCommand::Kitchen(args) => kitchen(&args),
        CliCommand::Keys(args) => keys(&args),
        CliCommand::Exclude(args) => exclude(&args),
        CliCommand::Codes(args) => data::codes(&args),
        CliCommand::Forget(args) => data::forget(&args),
        CliCommand::Doctor(args) => examine(&args),
        CliCommand::Completions(args) => completions(&args),
        CliCommand::Man(args) => man(&args),
    };
    let (code, report) = match done {
        Ok(()) | Err(Failure::Unread) => return ExitCode::SUCCESS,
        Err(Failure::No) => return ExitCode::from(FAILED),
        Err(Failure::Failed(report)) => (FAILED, report),
        Err(Failure::Wrong(report)) => (WRONG, report),
    };
    eprintln!("{report:?}");
    ExitCode::from(code)
}

/// Prints figures as one JSON object, or their text.
fn print(format: OutputFormat, figures: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match format {
        OutputFormat::Json => {
            writeln!(out, "{}", serde_json::to_string_pretty(figures).map_err(std::io::Error::other)?)?
        }
        OutputFormat::Text => write!(out, "{}", text())?,
    }
    Ok(out.flush()?)
}

fn operate(args: &OperateArgs) -> Result<(), Failure> {
    let done = match &args.recording {
        Some(recording) => series::operate(SessionStart::Continued(recording.clone()), None)?,
        None => new_session(args.session.as_deref(), &args.flags, None)?,
    };
    Ok(write!(std::io::stdout(), "{}", series::describe(&done))?)
}

/// Runs a session of this file; with wizard and assistants side by side, where that is asked for.
fn new_session(
    session: Option<&Path>,
    flags: &OperateFlags,
    compare: Option<CompareRequest>,
) -> Result<SeriesOutcome, Failure> {
    if flags.rerun_listen.is_some() {
        Feature::Rerun.require()?;
    }
    let mut files = options::session_or_default(session)?;
    let overrides = SettingOverrides {
        participant: flags.participant.map(ParticipantKind::from),
        arm: flags.arm.map(ArmKind::from),
        gaze: flags.gaze.map(GazeSource::from),
        gaze_file: flags.gaze_file.clone(),
        condition: flags.condition.map(Condition::from),
        concept: flags.concept.map(ConceptName::from),
        seed: flags.seed,
        listen: flags.listen,
        code: flags.code.clone(),
        rerun_listen: flags.rerun_listen.clone(),
    };
    overrides.apply(&mut files).map_err(wrong_setting)?;
    let name = session.unwrap_or(Path::new("sessions/default.toml"));
    files.spec.require_built_live().map_err(|missing| FileError::not_built(name, missing))?;
    let out = flags.out.clone();
    match &files.spec.plan {
        None => Ok(series::operate(SessionStart::New { files: Box::new(files), trial: 0, out }, compare)?),
        Some(plan) => {
            let participant = options::participant_of_plan(plan, flags.code.as_deref());
            let participant = participant.map_err(wrong_setting)?;
            Ok(series::operate_series(TrialSeries { files, participant, out, compare })?)
        }
    }
}

/// A setting that cannot be, of the command line.
fn wrong_setting(error: SettingError) -> Failure {
    Failure::Wrong(miette::miette!(help = error.remedy, "found {}", error.found))
}

fn show_plan(args: &PlanArgs) -> Result<(), Failure> {
    let files = files::read_session(&args.session)?;
    let Some(study) = files.study() else {
        let found = "a session without a plan".to_string();
        return Err(wrong_argument(&args.session, found, "a session file with a [plan], like sessions/study.toml"));
    };
    let figures = StudyPlanSummary::from_study(&study, &args.out)?;
    print(args.format, &figures, || plan::describe(&figures))
}

/// Warns of recordings with settings that no file may have today.
fn warn_of(recordings: &[PathBuf]) -> Result<(), Failure> {
    for recording in recordings {
        if let Some(OutOfRange { found, remedy, .. }) = LogReader::open(recording)?.unusual() {
            let name = recording.display();
            eprintln!(
                "{name}: recorded with {found}, where a settings file may have {remedy}; it counts as it was recorded"
            );
        }
    }
    Ok(())
}

fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    warn_of(&args.recordings)?;
    if args.check_beliefs {
        return estimates::check_beliefs(args);
    }
    if args.accuracy {
        return estimates::accuracy(args);
    }
    let [recording] = &args.recordings[..] else {
        let help = "one recording, or --check-beliefs or --accuracy";
        return Err(Failure::Wrong(miette::miette!(help = help, "found {} recordings", args.recordings.len())));
    };
    if args.verify {
        let found = verify::verify(recording)?;
        print(args.format, &found, || verify::describe(&found))?;
        return if found.verified { Ok(()) } else { Err(Failure::No) };
    }
    if args.timing {
        let figures = timing::measure(recording)?;
        return print(args.format, &figures, || timing::describe(&figures));
    }
    if let Some(rater) = &args.rater {
        return data::rate(recording, rater);
    }
    if args.format == OutputFormat::Text && std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        return Ok(console_over::review(recording, args.follow, None)?);
    }
    let mut replay = Replay::open(recording)?;
    let mut events = 0;
    if args.format == OutputFormat::Text {
        writeln!(std::io::stdout(), "{}", tell::HEADING)?;
    }
    loop {
        while let Some(event) = replay.step()? {
            events += 1;
            if let (OutputFormat::Text, Some(line)) = (args.format, tell::line(&event.stamped, &replay.follower)) {
                writeln!(std::io::stdout(), "{line}")?;
            }
        }
        if !args.follow || !replay.log().is_cut() {
            break;
        }
        std::thread::sleep(FOLLOW_INTERVAL);
    }
    let standing = ExclusionStatus::from_recording(replay.session(), replay.log())?;
    let figures = tell::RecordingSummary::from_follower(&replay.follower, events, replay.log().ending(), standing);
    print(args.format, &figures, || figures.describe())
}

/// A bar on stderr that counts so many of something; nothing to be seen where that is no terminal.
fn progress(of: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(of);
    if std::io::stderr().is_terminal()
        && let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {what}, {{eta}} left"))
    {
        bar.set_style(style);
    }
    bar
}

fn kitchen(args: &KitchenArgs) -> Result<(), Failure> {
    let kitchen = Arc::new(files::read_kitchen(&args.layout)?.kitchen);
    let figures = kitchen::KitchenSummary::from_kitchen(&kitchen);
    print(args.format, &figures, || kitchen::describe(&kitchen, &figures))
}

fn exclude(args: &ExcludeArgs) -> Result<(), Failure> {
    let ruling = log::rule(&args.recording, !args.back, args.reason.as_deref().unwrap_or_default())?;
    // Only who counts a recording again has to know what else is in its log.
    let aborted = if ruling.excluded { None } else { standing::aborted(&args.recording)? };
    let words = match (ruling.excluded, aborted) {
        (true, _) => "is left out of the analysis".to_string(),
        (false, None) => "counts again".to_string(),
        (false, Some(reason)) => format!("is not excluded; it is still left out of the analysis, as aborted: {reason}"),
    };
    print(args.format, &ruling, || format!("{} {words}\n", args.recording.display()))
}

fn examine(args: &DoctorArgs) -> Result<(), Failure> {
    let files = options::session_or_default(args.session.as_deref())?;
    let found = doctor::examine(&files.spec, &args.out);
    print(args.format, &found, || doctor::describe(&found))?;
    if found.healthy { Ok(()) } else { Err(Failure::No) }
}

fn keys(args: &KeysArgs) -> Result<(), Failure> {
    let files = options::session_or_default(args.session.as_deref())?;
    let map = key_file::key_map(files.keys.as_ref())?;
    let lines = console::keys::lines(&files.kitchen.kitchen, &map)
        .map_err(|error| Failure::Wrong(miette::miette!(help = error.remedy, "{}", error.found)))?;
    Ok(std::io::stdout().write_all(console::keymap::write(&lines).as_bytes())?)
}

fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "tomcom", &mut text);
    Ok(std::io::stdout().write_all(&text)?)
}

fn man(args: &ManArgs) -> Result<(), Failure> {
    let mut root = Cli::command();
    root.build();
    let page = match &args.command {
        None => root,
        Some(name) => match root.find_subcommand(name) {
            Some(command) => command.clone(),
            None => {
                let help = "one of those that tomcom --help lists";
                return Err(Failure::Wrong(miette::miette!(help = help, "found {name}, which is no command")));
            }
        },
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text)?;
    Ok(std::io::stdout().write_all(&text)?)
}

fn wrong_argument(path: &Path, found: String, remedy: &str) -> Failure {
    Failure::Wrong(miette::miette!(help = remedy.to_string(), "{}: found {found}", path.display()))
}
