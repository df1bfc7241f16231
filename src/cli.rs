//! The command line. A command is listed when it works.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use miette::MietteHandlerOpts;
use serde::Serialize;

use crate::edge::doctor;
use crate::edge::files::{self, FileError};
use crate::edge::log::WriteError;
use crate::run::live::LiveError;
use crate::run::options::{self, Beginning, Overrides};
use crate::run::replay::Replay;
use crate::run::review::{self, ReviewError};
use crate::run::{kitchen, series, simulate, tell, verify};
use crate::session::settings::{Condition, GazeSource, ParticipantKind};

/// Exit code: something failed.
const FAILED: u8 = 1;
/// Exit code: wrong arguments or files.
const WRONG: u8 = 2;

/// How often a running session is looked at for new events.
const FOLLOW_INTERVAL: Duration = Duration::from_millis(50);

/// A console for Wizard-of-Oz experiments in human-robot cooperation.
#[derive(Debug, Parser)]
#[command(name = "tomcom", version, args_conflicts_with_subcommands = true)]
#[command(
    after_help = "Without a command: operate the default session.\nExample: tomcom --participant keyboard --gaze mouse"
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    operate: OperateFlags,
}

#[derive(Debug, Subcommand)]
enum Command {
    Operate(OperateArgs),
    Replay(ReplayArgs),
    Simulate(SimulateArgs),
    Kitchen(KitchenArgs),
    Doctor(DoctorArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// How figures are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// One JSON object.
    Json,
}

/// Opens the wizard's console and runs a session; everything that happens is recorded.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom operate sessions/default.toml --participant keyboard --gaze mouse")]
struct OperateArgs {
    /// The session file; by default sessions/default.toml, or the one that the program carries.
    session: Option<PathBuf>,
    /// Take up this recording, which was cut, in a new part beside it; its session is the same, a running trial is paused.
    #[arg(long = "continue", value_name = "RECORDING", conflicts_with_all = ["session", "participant", "gaze", "condition", "seed", "out"])]
    recording: Option<PathBuf>,
    #[command(flatten)]
    flags: OperateFlags,
}

#[derive(Debug, Args)]
struct OperateFlags {
    /// Who plays the human's part, instead of the session file's.
    #[arg(long, value_enum)]
    participant: Option<Participant>,
    /// Where gaze samples come from, instead of the session file's.
    #[arg(long, value_enum)]
    gaze: Option<Gaze>,
    /// Who sends signals, instead of the session file's.
    #[arg(long, value_enum)]
    condition: Option<ConditionArg>,
    /// Everything random follows from it; by default the session file's.
    #[arg(long)]
    seed: Option<u64>,
    /// Where the recording's folder is made.
    #[arg(long, default_value = "sessions")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Participant {
    /// A simulated person.
    Simulated,
    /// Somebody at this keyboard: tab switches between the wizard's and the participant's keys.
    Keyboard,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Gaze {
    /// The simulated person's.
    Simulated,
    /// The mouse pointer over the kitchen.
    Mouse,
    /// Lines of JSON over TCP on localhost.
    Json,
    /// No gaze at all.
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ConditionArg {
    /// Nobody.
    None,
    /// The wizard.
    Wizard,
}

/// Opens the console over a recording. Through a pipe: what happened, line by line. Or checks that it comes out the same.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom replay sessions/2026-03-14-P07-1 --verify")]
struct ReplayArgs {
    /// The folder of a recording, or its events.jsonl.
    recording: PathBuf,
    /// Run the session again from the recording's header and its inputs; every line must come out the same.
    #[arg(long, conflicts_with = "follow")]
    verify: bool,
    /// Watch a session that is still running, until it ends.
    #[arg(long)]
    follow: bool,
    /// How to print the result.
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

/// Simulates whole trials, faster than real time. Participants are simulated and unassisted: nobody is there to signal.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom simulate sessions/default.toml --trials 20 --seed 7 --out recordings")]
struct SimulateArgs {
    /// The session file.
    session: PathBuf,
    /// How many trials; each has orders and a participant of its own and does not depend on how many there are.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    trials: u64,
    /// Everything random follows from it; by default the session file's.
    #[arg(long)]
    seed: Option<u64>,
    /// Where the recordings go, one folder a trial.
    #[arg(long, default_value = "sessions/simulated")]
    out: PathBuf,
    /// How to print the figures.
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

/// Checks a kitchen and prints it: locations, buttons, recipes, optimal plans, size of the state space.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom kitchen layouts/sushi.toml --format json")]
struct KitchenArgs {
    /// The layout file.
    layout: PathBuf,
    /// How to print it.
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

/// Checks terminal, place for recordings, and clocks; says how to mend what is not as it should be.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 0: the program works here. 1: something is broken.\nExample: tomcom doctor --out recordings"
)]
struct DoctorArgs {
    /// Where the recordings would go.
    #[arg(long, default_value = "sessions")]
    out: PathBuf,
    /// How to print what was found.
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

/// Prints the completions of a shell.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom completions bash > ~/.local/share/bash-completion/completions/tomcom")]
struct CompletionsArgs {
    shell: clap_complete::Shell,
}

/// Prints the man page of the program or of one of its commands.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom man operate | man -l -")]
struct ManArgs {
    /// The command.
    command: Option<String>,
}

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

impl From<LiveError> for Failure {
    fn from(error: LiveError) -> Failure {
        match error {
            LiveError::Resume(error) => Failure::Wrong(miette::Report::new(error)),
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
        cli.command.unwrap_or(Command::Operate(OperateArgs { session: None, recording: None, flags: cli.operate }));
    let done = match command {
        Command::Operate(args) => operate(&args),
        Command::Replay(args) => replay(&args),
        Command::Simulate(args) => simulate(&args),
        Command::Kitchen(args) => kitchen(&args),
        Command::Doctor(args) => examine(&args),
        Command::Completions(args) => completions(&args),
        Command::Man(args) => man(&args),
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
fn print(format: Format, figures: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match format {
        Format::Json => writeln!(out, "{}", serde_json::to_string_pretty(figures).map_err(std::io::Error::other)?)?,
        Format::Text => write!(out, "{}", text())?,
    }
    Ok(out.flush()?)
}

fn operate(args: &OperateArgs) -> Result<(), Failure> {
    let beginning = match &args.recording {
        Some(recording) => Beginning::Continued(recording.clone()),
        None => new_session(args)?,
    };
    let done = series::operate(beginning)?;
    Ok(write!(std::io::stdout(), "{}", series::describe(&done))?)
}

fn new_session(args: &OperateArgs) -> Result<Beginning, Failure> {
    let flags = &args.flags;
    let mut files = options::session_or_default(args.session.as_deref())?;
    let overrides = Overrides {
        participant: flags.participant.map(|participant| match participant {
            Participant::Simulated => ParticipantKind::Simulated,
            Participant::Keyboard => ParticipantKind::Keyboard,
        }),
        gaze: flags.gaze.map(|gaze| match gaze {
            Gaze::Simulated => GazeSource::Simulated,
            Gaze::Mouse => GazeSource::Mouse,
            Gaze::Json => GazeSource::Json,
            Gaze::None => GazeSource::None,
        }),
        condition: flags.condition.map(|condition| match condition {
            ConditionArg::None => Condition::None,
            ConditionArg::Wizard => Condition::Wizard,
        }),
        seed: flags.seed,
    };
    overrides
        .apply(&mut files)
        .map_err(|error| Failure::Wrong(miette::miette!(help = error.remedy, "found {}", error.found)))?;
    Ok(Beginning::New { files: Box::new(files), out: flags.out.clone() })
}

fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    if args.verify {
        let found = verify::verify(&args.recording)?;
        print(args.format, &found, || verify::describe(&found))?;
        return if found.verified { Ok(()) } else { Err(Failure::No) };
    }
    if args.format == Format::Text && std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        return Ok(review::review(&args.recording, args.follow)?);
    }
    let mut replay = Replay::open(&args.recording)?;
    let mut events = 0;
    if args.format == Format::Text {
        writeln!(std::io::stdout(), "{}", tell::HEADING)?;
    }
    loop {
        while let Some(event) = replay.step()? {
            events += 1;
            if let (Format::Text, Some(line)) = (args.format, tell::line(&event.stamped, &replay.follower)) {
                writeln!(std::io::stdout(), "{line}")?;
            }
        }
        if !args.follow || !replay.log().is_cut() {
            break;
        }
        std::thread::sleep(FOLLOW_INTERVAL);
    }
    let figures = tell::RecordingFigures::of(&replay.follower, events, replay.log().is_cut());
    print(args.format, &figures, || figures.describe())
}

fn simulate(args: &SimulateArgs) -> Result<(), Failure> {
    let mut files = files::read_session(&args.session)?;
    if files.spec.participant.kind != ParticipantKind::Simulated || files.spec.participant.gaze != GazeSource::Simulated
    {
        let found = "a session whose participant or gaze is not simulated".to_string();
        return Err(wrong_argument(&args.session, found, "kind = \"simulated\" and gaze = \"simulated\""));
    }
    files.spec.seed = args.seed.unwrap_or(files.spec.seed);
    let simulation = simulate::Simulation { files, trials: args.trials, out: args.out.clone() };
    let bar = ProgressBar::new(args.trials);
    if std::io::stderr().is_terminal()
        && let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} trials, {eta} left")
    {
        bar.set_style(style);
    }
    let figures = simulate::simulate(&simulation, || bar.inc(1))?;
    bar.finish_and_clear();
    print(args.format, &figures, || simulate::describe(&figures))
}

fn kitchen(args: &KitchenArgs) -> Result<(), Failure> {
    let kitchen = Arc::new(files::read_kitchen(&args.layout)?.kitchen);
    let figures = kitchen::KitchenFigures::of(&kitchen);
    print(args.format, &figures, || kitchen::describe(&kitchen, &figures))
}

fn examine(args: &DoctorArgs) -> Result<(), Failure> {
    let found = doctor::examine(&args.out);
    print(args.format, &found, || doctor::describe(&found))?;
    if found.healthy { Ok(()) } else { Err(Failure::No) }
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
