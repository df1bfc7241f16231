//! Command `tomcom tournament`, and `tomcom protocol`, which prints what external concepts and participants are told.

use std::path::PathBuf;

use clap::Args;

use super::choices::{arm_parser, concept, whole};
use super::failure::{Failure, every_trial_failed, wrong_argument};
use super::output::{OutputFormat, print, progress, put};
use crate::run::files::read_session;
use crate::run::picture_file::{check_picture, write_picture};
use crate::run::tournament::{self, TournamentRequest};
use tomcom_core::communication::settings::ConceptSpec;
use tomcom_session::external::SCHEMA;
use tomcom_session::headless::{self, SimulationShard};
use tomcom_session::settings::{ArmKind, GazeSource, ParticipantKind};
use tomcom_study::charts;
use tomcom_study::files::tournament_files::{check_table, write_table};
use tomcom_study::tournament::describe;

/// Compares communication concepts, also programs of yours, in simulated trials of the same seeds.
///
/// Each concept acts by itself with the same participants and orders. Prints a league by net saving: presses that errors
/// cost less than without signals, minus 1.5 for each signal.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples: tomcom tournament sessions/default.toml \\\n            --concepts tom-com,tom,\"python my_agent.py\" --trials 100\n          \
                  tomcom tournament sessions/default.toml --concepts tom-com,tom \\\n            --trials 1000 --shard 2/8\nMore: docs/your-own-mind.md"
)]
pub(super) struct TournamentArgs {
    /// The session file with the settings.
    session: PathBuf,
    /// The concepts, separated by commas: tom-com, tom, dev, none, and command lines of programs, or tcp://127.0.0.1:PORT.
    #[arg(long, value_delimiter = ',', required = true, value_parser = concept)]
    concepts: Vec<ConceptSpec>,
    /// Number of trials of each concept.
    #[arg(long, default_value_t = 20, value_parser = whole(1_u64..=100_000))]
    trials: u64,
    /// Only this shard of the trials, such as "2/8", the second of eight, for job arrays with a common --out; afterwards
    /// the command without --shard reads all of them.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1", hide_default_value = true)]
    shard: SimulationShard,
    /// Seed of all random numbers; by default that of the session file.
    #[arg(long)]
    seed: Option<u64>,
    /// Kind of the robot's arm, instead of the session file's; "timed" is faster to simulate.
    #[arg(long, value_parser = arm_parser())]
    arm: Option<ArmKind>,
    /// Folder for the recordings, with a folder for each concept. Trials that are there already are read.
    #[arg(long, default_value = "sessions/tournament")]
    out: PathBuf,
    /// Write the table to this file (CSV).
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a picture of the league to this file (SVG).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// Prints the protocol of external concepts and participants as a JSON Schema.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example: tomcom protocol > protocol.schema.json\nMore: docs/your-own-mind.md")]
pub(super) struct ProtocolArgs {}

pub(super) fn protocol() -> Result<(), Failure> {
    Ok(put(SCHEMA)?)
}

pub(super) fn tournament(args: &TournamentArgs) -> Result<(), Failure> {
    args.csv.as_deref().map_or(Ok(()), check_table)?;
    args.picture.as_deref().map_or(Ok(()), |file| check_picture(file, "a picture of a tournament"))?;
    let mut files = read_session(&args.session)?;
    let participant = &files.spec.participant;
    let is_simulated = participant.kind == ParticipantKind::Simulated
        && matches!(participant.gaze, GazeSource::Simulated | GazeSource::None);
    if files.spec.plan.is_some() || !is_simulated {
        let found = "a session with a plan, or whose participant or gaze is not simulated".to_string();
        return Err(wrong_argument(&args.session, found, "a session without [plan], and kind = \"simulated\""));
    }
    if args.shard.of > args.trials {
        let found = format!("--shard of {} parts, with {} trials", args.shard.of, args.trials);
        return Err(wrong_argument(&args.session, found, "at most as many parts as trials, so that no part is empty"));
    }
    files.spec.seed = args.seed.unwrap_or(files.spec.seed);
    files.spec.robot.arm = args.arm.unwrap_or(files.spec.robot.arm);
    headless::require(&files.spec, &args.session)?;
    let (concepts, trials, shard, out) = (args.concepts.clone(), args.trials, args.shard, args.out.clone());
    let request = TournamentRequest { files, concepts, trials, shard, out };
    if let Some(concept) = request.twice() {
        let found =
            format!("--concepts with {} twice, or with another whose folder has the same name", concept.label());
        return Err(wrong_argument(&args.session, found, "each concept once"));
    }
    let bar = progress(request.steps(), "steps");
    let found = tournament::run(&request, || bar.inc(1))?;
    bar.finish_and_clear();
    if let Some(file) = &args.csv {
        write_table(file, &found)?;
    }
    if let Some(file) = &args.picture {
        write_picture(file, &charts::league(&found.concepts))?;
    }
    print(args.format, &found, || describe(&found))?;
    match found.concepts.iter().find(|row| row.trials == 0 && row.failed > 0) {
        Some(row) => Err(every_trial_failed(&row.concept)),
        None => Ok(()),
    }
}
