//! The commands of the program `tomcom` and their arguments.

use std::path::PathBuf;

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};

#[cfg(feature = "ur")]
use super::arm_server::ArmArgs;
use super::choices::{arm_parser, concept, simulated_condition_parser, whole};
use super::data::{CodesArgs, ForgetArgs};
use super::exports::ExportArgs;
use super::lab::NewArgs;
use super::list::ListArgs;
use super::operate::{OperateArgs, OperateFlags};
use super::output::OutputFormat;
use super::pools::{ArmsArgs, PowerArgs};
use super::review::ReviewArgs;
use super::study::StudyArgs;
use super::tournaments::{ProtocolArgs, TournamentArgs};
use super::tutorial_alone::TutorialArgs;
use super::video::VideoArgs;
use super::wizard::{CompareArgs, TrainArgs};
use crate::run::options::{DEFAULT_OUT, DEFAULT_SESSION};
use tomcom_core::communication::settings::ConceptSpec;
use tomcom_core::mind::fitting::HumanModelParameter;
use tomcom_session::headless::SimulationShard;
use tomcom_session::settings::{ArmKind, Condition};

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
    New(NewArgs),
    Operate(OperateArgs),
    Compare(CompareArgs),
    Tutorial(TutorialArgs),
    Train(TrainArgs),
    Replay(ReplayArgs),
    Review(ReviewArgs),
    List(ListArgs),
    Simulate(SimulateArgs),
    Power(PowerArgs),
    Arms(ArmsArgs),
    Tournament(TournamentArgs),
    Protocol(ProtocolArgs),
    Study(StudyArgs),
    Plan(PlanArgs),
    Fit(FitArgs),
    Kitchen(KitchenArgs),
    Keys(KeysArgs),
    Exclude(ExcludeArgs),
    Correct(CorrectArgs),
    Codes(CodesArgs),
    Video(VideoArgs),
    Export(ExportArgs),
    Forget(ForgetArgs),
    Doctor(DoctorArgs),
    #[cfg(feature = "ur")]
    Arm(ArmArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Shows, prints or verifies a recording.
///
/// In a terminal it opens the console over the recording; through a pipe it prints what happened, line by line.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example: tomcom replay sessions/2026-03-14-P07-1 --verify\nMore: docs/recordings.md")]
pub(super) struct ReplayArgs {
    /// The folder of a recording, or its events.jsonl; of a folder of recordings, one is chosen from a list.
    pub(super) recording: PathBuf,
    /// Run the session again from the recording's header and inputs; every line must be identical.
    #[arg(long, conflicts_with = "follow")]
    pub(super) verify: bool,
    /// Watch a session that is still running, until it ends.
    #[arg(long)]
    pub(super) follow: bool,
    /// Code the errors of the recording as this rater (a code, never a name), without estimate, signals or condition in
    /// view: letters code false beliefs, 1 a slip, 2 a race, 3 another cause, 4 mixed up buttons. Begins at the first
    /// error without a code. Codes are saved beside the log at once.
    #[arg(long, value_name = "CODE", conflicts_with_all = ["verify", "follow", "format"])]
    pub(super) rater: Option<String>,
    /// Settle as two raters together what they coded differently: goes through these errors with both codes in view,
    /// and saves the consensus beside the log.
    #[arg(long, value_names = ["A", "B"], num_args = 2, conflicts_with_all = ["rater", "verify", "follow", "format"])]
    pub(super) settle: Option<Vec<String>>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints the progress of a study.
///
/// Participants, groups, finished and next recordings, from the recordings on the disk.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom plan sessions/study.toml --out sessions\nMore: docs/study.md")]
pub(super) struct PlanArgs {
    /// The session file with the plan.
    #[arg(default_value = "sessions/study.toml")]
    pub(super) session: PathBuf,
    /// Folder of the recordings.
    #[arg(long, default_value = DEFAULT_OUT)]
    pub(super) out: PathBuf,
    /// Freeze the plan before the study (preregistration): write plan, definitions and analysis with a digest to this
    /// new file, which tomcom study --frozen checks.
    #[arg(long, value_name = "FILE")]
    pub(super) freeze: Option<PathBuf>,
    /// Say whether the plan is still the one that was frozen in this file, and what differs.
    #[arg(long, value_name = "FILE", conflicts_with = "freeze")]
    pub(super) frozen: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Simulates whole trials, faster than real time.
///
/// Participants are simulated. Signals come from nobody, the assistant, or a scripted wizard.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom simulate sessions/default.toml --trials 20 --seed 7 \\\n            --arm timed --out recordings\nMore: docs/study.md"
)]
pub(super) struct SimulateArgs {
    /// The session file to simulate.
    #[arg(default_value = DEFAULT_SESSION)]
    pub(super) session: PathBuf,
    /// Number of trials; each has its own orders and participant and does not depend on their number. With a plan: the
    /// first trials of the plan, participant by participant. Default: 1, or the whole plan.
    #[arg(long, value_parser = whole(1_u64..=100_000))]
    pub(super) trials: Option<u64>,
    /// Simulate one shard of the trials, such as "2/8", the second of eight disjoint shards, for job arrays.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1", hide_default_value = true)]
    pub(super) shard: SimulationShard,
    /// Seed of all random numbers; by default that of the session file.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Who sends signals: by default nobody, with a plan as the plan says.
    #[arg(long, value_parser = simulated_condition_parser())]
    pub(super) condition: Option<Condition>,
    /// Communication concept of the assistant, instead of the session file's: tom-com, tom, dev, none, or the command
    /// line of a program of yours.
    #[arg(long, value_parser = concept)]
    pub(super) concept: Option<ConceptSpec>,
    /// Kind of the robot's arm, instead of the session file's; "timed" is faster to simulate.
    #[arg(long, value_parser = arm_parser())]
    pub(super) arm: Option<ArmKind>,
    /// Compute the assistant's recommendations also in trials in which the assistant does not act, and record them. A
    /// scripted wizard reads them where the session shows recommendations; nobody else sees them.
    #[arg(long)]
    pub(super) shadow: bool,
    /// Also write a stream for the Rerun viewer beside every log, as recording.rrd.
    #[arg(long)]
    pub(super) rerun: bool,
    /// Folder for the recordings, one folder per trial.
    #[arg(long, default_value = "sessions/simulated")]
    pub(super) out: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Fits the human model to recordings.
///
/// Maximum likelihood estimates of parameters from recorded presses, with standard errors.
#[derive(Debug, Args)]
#[command(
    after_help = "A session uses the file with human_model = \"FILE\".\nExample: tomcom fit recordings/* --out sessions/human.toml\nMore: docs/human-model.md"
)]
pub(super) struct FitArgs {
    /// The folders of recordings of one kitchen, or their events.jsonl.
    #[arg(required = true, value_name = "RECORDING")]
    pub(super) recordings: Vec<PathBuf>,
    /// Parameters to fit, separated by commas. By default tau, lapse, radius, reading and half-life, without those that
    /// the model of the recordings does not use or that it sets outside of what is searched.
    #[arg(long, value_enum, value_delimiter = ',')]
    pub(super) parameters: Vec<FitParameter>,
    /// Parameter file to start from; parameters that are not fitted keep its values. By default the parameters in the
    /// recordings.
    #[arg(long, value_name = "FILE")]
    pub(super) start: Option<PathBuf>,
    /// Use answers to freeze probes beside presses, and tell by how much they narrow the intervals; needs a second
    /// search, without the answers.
    #[arg(long)]
    pub(super) probes: bool,
    /// Largest number of likelihood evaluations.
    #[arg(long, default_value_t = 600, value_parser = whole(10_u64..=100_000))]
    pub(super) tries: u64,
    /// Write the fitted parameters to this file.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// A parameter of the human model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FitParameter {
    /// Rationality of choices (softmax over the expected cost to go).
    Tau,
    /// Share of presses that are slips.
    Lapse,
    /// Radius of the area around the fixation.
    Radius,
    /// Rate at which gaze at a location becomes knowledge of its content, per second.
    Reading,
    /// Half-life of recipe memory.
    HalfLife,
    /// Share of the robot's unseen presses whose consequences the human infers.
    Foresight,
    /// Looks at what the next press needs, per second, where gaze is unknown.
    Looks,
    /// Looks at other locations, per second, where gaze is unknown.
    OtherLooks,
    /// Share of changes by others that attract a look, where gaze is unknown.
    Capture,
    /// Expected probability of a true recipe at the start of a trial.
    RecipeKnowledge,
}

impl FitParameter {
    pub(super) fn parameter(self) -> HumanModelParameter {
        match self {
            FitParameter::Tau => HumanModelParameter::Tau,
            FitParameter::Lapse => HumanModelParameter::Lapse,
            FitParameter::Radius => HumanModelParameter::RadiusDeg,
            FitParameter::Reading => HumanModelParameter::ReadingRateHz,
            FitParameter::HalfLife => HumanModelParameter::RecipeHalfLifeS,
            FitParameter::Foresight => HumanModelParameter::Foresight,
            FitParameter::Looks => HumanModelParameter::LooksHz,
            FitParameter::OtherLooks => HumanModelParameter::OtherLooksHz,
            FitParameter::Capture => HumanModelParameter::Capture,
            FitParameter::RecipeKnowledge => HumanModelParameter::RecipeTruth,
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
    #[arg(default_value = "layouts/sushi.toml")]
    pub(super) layout: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints the keys of the console as a key file that can be changed.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom keys sessions/default.toml > sessions/keys.toml\nMore: docs/running-a-session.md"
)]
pub(super) struct KeysArgs {
    /// Session file with the kitchen and the key file; by default that of tomcom operate.
    pub(super) session: Option<PathBuf>,
}

/// Excludes a recording from the analysis, or all of a participant; or includes them again.
///
/// The recordings must be closed. Their logs stay as they are.
#[derive(Debug, Args)]
#[command(
    after_help = "While the session is open, its console does it.\nExamples: tomcom exclude sessions/2026-03-14-P07-1 --reason \"tracker slipped\"\n          \
                  tomcom exclude sessions --code P07 --reason \"asked for it\"\nMore: docs/recordings.md",
    group = ArgGroup::new("ruling").args(["reason", "back"]).required(true).multiple(true)
)]
pub(super) struct ExcludeArgs {
    /// The folder of a recording; with --code, of recordings.
    pub(super) recording: PathBuf,
    /// Exclude all recordings of this participant in the folder.
    #[arg(long)]
    pub(super) code: Option<String>,
    /// Reason for the exclusion.
    #[arg(long)]
    pub(super) reason: Option<String>,
    /// Include again.
    #[arg(long)]
    pub(super) back: bool,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Corrects the participant's code of a recording that was begun with a wrong one.
///
/// The recording must be closed. Its log stays as it is: a file beside it says whose the recording is, and every command
/// goes by that. Exports and reports that were made before still have the old code.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom correct sessions/2026-03-14-P02-1 --code P03 \\\n            --reason \"the code of the day before\"\n          \
                  tomcom correct sessions/2026-03-14-P02-1 --undo\nMore: docs/recordings.md",
    group = ArgGroup::new("correction").args(["code", "undo"]).required(true)
)]
pub(super) struct CorrectArgs {
    /// The folder of a recording.
    pub(super) recording: PathBuf,
    /// The code of the participant who took part.
    #[arg(long, requires = "reason")]
    pub(super) code: Option<String>,
    /// Reason for the correction.
    #[arg(long)]
    pub(super) reason: Option<String>,
    /// Take all corrections back: the code in the log holds again.
    #[arg(long)]
    pub(super) undo: bool,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Checks whether this machine is ready for a session.
///
/// Checks terminal, disk space, clocks, the port of the wall display, the Rerun viewer and the gaze source, and gives a
/// remedy for each problem.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 0: the session works here. 1: something is broken.\nExamples: tomcom doctor --out recordings\n          \
                  tomcom doctor sessions/study.toml\nMore: docs/troubleshooting.md"
)]
pub(super) struct DoctorArgs {
    /// Session file with the settings; by default sessions/default.toml.
    pub(super) session: Option<PathBuf>,
    /// Folder for recordings.
    #[arg(long, default_value = DEFAULT_OUT)]
    pub(super) out: PathBuf,
    /// Also write a file to send with the report of a fault: versions, machine, checks, the session without codes, and the
    /// last warnings of the newest recording in the folder for recordings. Read it before you send it.
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

/// Prints the completion script for a shell.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom completions bash \\\n            > ~/.local/share/bash-completion/completions/tomcom"
)]
pub(super) struct CompletionsArgs {
    pub(super) shell: clap_complete::Shell,
}

/// Prints the man page of the program or of one of its commands.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom man operate | man -l -")]
pub(super) struct ManArgs {
    /// Command whose man page to print; by default that of the program.
    pub(super) command: Option<String>,
}
