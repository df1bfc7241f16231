//! What can be typed: commands and their arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::choices::{ArmArg, ConceptArg, SimulatedCondition};
use super::data::{CodesArgs, ForgetArgs};
use super::operate::{OperateArgs, OperateFlags};
use super::output::OutputFormat;
use super::review::ReviewArgs;
use super::study::StudyArgs;
use super::wizard::{CompareArgs, TrainArgs};
use crate::mind::fitting::Parameter;
use crate::run::simulate::Shard;
use crate::run::sweep::SweepAxis;

/// A console for Wizard-of-Oz experiments in human-robot cooperation.
#[derive(Debug, Parser)]
#[command(name = "tomcom", version, args_conflicts_with_subcommands = true)]
#[command(
    after_help = "Without a command: operates the default session. -h is shorter than --help.\nExample: tomcom --participant keyboard --gaze mouse\nMore: docs/index.md"
)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<CliCommand>,
    #[command(flatten)]
    pub(super) operate: OperateFlags,
}

#[derive(Debug, Subcommand)]
pub(super) enum CliCommand {
    Operate(OperateArgs),
    Compare(CompareArgs),
    Train(TrainArgs),
    Replay(ReplayArgs),
    Review(ReviewArgs),
    Simulate(SimulateArgs),
    Study(StudyArgs),
    Plan(PlanArgs),
    Fit(FitArgs),
    Kitchen(KitchenArgs),
    Keys(KeysArgs),
    Exclude(ExcludeArgs),
    Codes(CodesArgs),
    Forget(ForgetArgs),
    Doctor(DoctorArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Shows a recording at the console, prints it, or verifies it.
///
/// In a terminal it opens the console over the recording; through a pipe it prints what happened, line by line.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom replay sessions/2026-03-14-P07-1 --verify\nMore: docs/recordings.md")]
pub(super) struct ReplayArgs {
    /// The folder of a recording, or its events.jsonl; several only with --check-beliefs and --accuracy.
    #[arg(required = true, value_name = "RECORDING")]
    pub(super) recordings: Vec<PathBuf>,
    /// Run the session again from the recording's header and its inputs; every line must come out the same.
    #[arg(long, conflicts_with = "follow")]
    pub(super) verify: bool,
    /// Hold what was estimated before each press against what simulated participants believed, and what they pressed.
    #[arg(long, conflicts_with_all = ["verify", "follow"])]
    pub(super) check_beliefs: bool,
    /// Take the time of the inference, event by event.
    #[arg(long, conflicts_with_all = ["verify", "follow", "check_beliefs"])]
    pub(super) timing: bool,
    /// Hold the planner's answers against those with 64 times the rollouts, and against its plain reference. Takes long.
    #[arg(long, conflicts_with_all = ["verify", "follow", "check_beliefs", "timing"])]
    pub(super) accuracy: bool,
    /// With --accuracy: at most so many steps, spread evenly over the recordings.
    #[arg(long, default_value_t = 500, requires = "accuracy", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(super) steps: u64,
    /// With --accuracy: at most so many of them for the plain reference; 0: none.
    #[arg(long, default_value_t = 30, requires = "accuracy", value_parser = clap::value_parser!(u64).range(0..=100_000))]
    pub(super) reference_steps: u64,
    /// Watch a session that is still running, until it ends.
    #[arg(long)]
    pub(super) follow: bool,
    /// Code the errors of the recording as this rater (a code, never a name), without any estimate in view: letters say
    /// what was believed wrong, 1 a slip, 2 a race, 3 another cause. It is kept beside the log.
    #[arg(long, value_name = "CODE", conflicts_with_all = ["verify", "follow", "check_beliefs", "timing", "accuracy", "format"])]
    pub(super) rater: Option<String>,
    /// How to print the result.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints how far a study is.
///
/// Participants, their groups, what is done and what comes next, from the recordings on the disk.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom plan sessions/study.toml --out sessions\nMore: docs/study.md")]
pub(super) struct PlanArgs {
    /// The session file with the plan.
    pub(super) session: PathBuf,
    /// Where the recordings are.
    #[arg(long, default_value = "sessions")]
    pub(super) out: PathBuf,
    /// How to print it.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Simulates whole trials, faster than real time.
///
/// Participants are simulated. Signals come from nobody, the assistant, or a scripted wizard.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom simulate sessions/default.toml --trials 20 --seed 7 --arm timed --out recordings\n          \
                  tomcom simulate sessions/default.toml --trials 100 --sweep cost=0.5,1.5,2.4 --sweep gaze=on,off --out grid\nMore: docs/study.md"
)]
pub(super) struct SimulateArgs {
    /// The session file.
    pub(super) session: PathBuf,
    /// How many trials; each has orders and a participant of its own and does not depend on how many there are. Of a
    /// session with a plan, the first so many of its trials, participant by participant. By default 1, or the whole plan.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(super) trials: Option<u64>,
    /// Only a part of the trials, "2/8" the second of eight, so that a job array makes them all: the parts have no trial in
    /// common, and together they are the whole.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1", hide_default_value = true)]
    pub(super) shard: Shard,
    /// Everything random follows from it; by default the session file's.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Who sends signals: by default nobody, and with --sweep the assistant; of a session with a plan, the plan says it.
    #[arg(long, value_enum)]
    pub(super) condition: Option<SimulatedCondition>,
    /// By what the assistant decides, instead of the session file's concept.
    #[arg(long, value_enum)]
    pub(super) concept: Option<ConceptArg>,
    /// How the robot's presses come about, instead of the session file's arm; "timed" is quicker to simulate.
    #[arg(long, value_enum)]
    pub(super) arm: Option<ArmArg>,
    /// Simulate the trials for every value of a setting, and without signals, and print what matters how much: cost=0.5,1.5,
    /// threshold (of tom), horizon, rollouts, tau, radius, gaze=on,off. Several make a grid. The assistant sends the
    /// signals, unless --condition says otherwise; of a session with a plan its settings count, and each trial is of
    /// another participant.
    #[arg(long, value_name = "SETTING=VALUES", conflicts_with_all = ["shadow", "rerun"])]
    pub(super) sweep: Vec<SweepAxis>,
    /// Let the assistant advise in unassisted trials too; its advice is recorded and shown to nobody.
    #[arg(long)]
    pub(super) shadow: bool,
    /// Write the stream for Rerun's viewer beside every log, too, as recording.rrd.
    #[arg(long)]
    pub(super) rerun: bool,
    /// Where the recordings go, one folder a trial.
    #[arg(long, default_value = "sessions/simulated")]
    pub(super) out: PathBuf,
    /// How to print the figures.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Fits the human model to recordings.
///
/// Finds the parameters under which the recorded presses are likeliest, with standard errors.
#[derive(Debug, Args)]
#[command(
    after_help = "A session uses the file with human_model = \"FILE\".\nExample: tomcom fit recordings/* --out sessions/human.toml\nMore: docs/human-model.md"
)]
pub(super) struct FitArgs {
    /// The folders of recordings of one kitchen, or their events.jsonl.
    #[arg(required = true, value_name = "RECORDING")]
    pub(super) recordings: Vec<PathBuf>,
    /// Which parameters, with commas between them.
    #[arg(long, value_enum, value_delimiter = ',', default_value = FitParameter::USUAL)]
    pub(super) parameters: Vec<FitParameter>,
    /// Where to begin, a parameter file; what is not fitted stays as it is there. By default the parameters that stand in
    /// the recordings.
    #[arg(long, value_name = "FILE")]
    pub(super) start: Option<PathBuf>,
    /// The search for the best parameters ends after so many tries.
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u64).range(10..=100_000))]
    pub(super) tries: u64,
    /// Where to write the parameter file.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// How to print the figures.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// A parameter of the human model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FitParameter {
    /// How strictly fewer expected presses are preferred.
    Tau,
    /// The share of presses that slip.
    Lapse,
    /// Radius of the area around the fixation.
    Radius,
    /// Readings a second.
    Reading,
    /// Half-life of what is remembered of recipes.
    HalfLife,
    /// The share of the robot's unseen presses that the human thinks through.
    Foresight,
}

impl FitParameter {
    const USUAL: &str = "tau,lapse,radius,reading,half-life";

    pub(super) fn parameter(self) -> Parameter {
        match self {
            FitParameter::Tau => Parameter::Tau,
            FitParameter::Lapse => Parameter::Lapse,
            FitParameter::Radius => Parameter::RadiusDeg,
            FitParameter::Reading => Parameter::ReadingRateHz,
            FitParameter::HalfLife => Parameter::RecipeHalfLifeS,
            FitParameter::Foresight => Parameter::Foresight,
        }
    }
}

/// Checks a kitchen and prints it.
///
/// Locations, buttons, recipes, shortest plans, size of the state space, tags for eye trackers.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom kitchen layouts/sushi.toml --format json\nMore: docs/writing-a-kitchen.md")]
pub(super) struct KitchenArgs {
    /// The layout file.
    pub(super) layout: PathBuf,
    /// How to print it.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints the keys of the console as a key file that can be changed.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom keys sessions/default.toml > sessions/keys.toml\nMore: docs/running-a-session.md"
)]
pub(super) struct KeysArgs {
    /// The session file whose kitchen and key file it is about; by default the one of tomcom operate.
    pub(super) session: Option<PathBuf>,
}

/// Leaves a recording out of the analysis, or takes that back.
///
/// The recording must be closed. Its log stays as it is.
#[derive(Debug, Args)]
#[command(
    after_help = "While the session is open, its console does it.\nExample: tomcom exclude sessions/2026-03-14-P07-1 --reason \"the tracker slipped\"\nMore: docs/recordings.md"
)]
pub(super) struct ExcludeArgs {
    /// The folder of a recording.
    pub(super) recording: PathBuf,
    /// Why.
    #[arg(long, required_unless_present = "back")]
    pub(super) reason: Option<String>,
    /// It counts again.
    #[arg(long)]
    pub(super) back: bool,
    /// How to print what holds now.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Checks whether this machine is fit for a session.
///
/// Terminal, place for recordings, clocks, the port of the wall display, Rerun's viewer, and where gaze comes from; says how
/// to mend what is not as it should be.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 0: the session works here. 1: something is broken.\nExamples: tomcom doctor --out recordings\n          \
                  tomcom doctor sessions/study.toml\nMore: docs/troubleshooting.md"
)]
pub(super) struct DoctorArgs {
    /// The session file whose settings hold; by default sessions/default.toml, or the one that the program carries.
    pub(super) session: Option<PathBuf>,
    /// Where the recordings would go.
    #[arg(long, default_value = "sessions")]
    pub(super) out: PathBuf,
    /// How to print what was found.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints the completions of a shell.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom completions bash > ~/.local/share/bash-completion/completions/tomcom")]
pub(super) struct CompletionsArgs {
    pub(super) shell: clap_complete::Shell,
}

/// Prints the man page of the program or of one of its commands.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom man operate | man -l -")]
pub(super) struct ManArgs {
    /// The command.
    pub(super) command: Option<String>,
}
