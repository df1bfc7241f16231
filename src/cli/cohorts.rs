//! Options of the command `tomcom robustness`, and their checks.

use std::path::PathBuf;

use clap::Args;

use super::choices::ArmArg;
use super::failure::{Failure, wrong_argument};
use super::output::{OutputFormat, print, progress, put, put_aside};
use crate::edge::battery_file::read_battery;
use crate::edge::picture_file::{check_picture, write_picture};
use crate::run::robustness::{self, RobustnessRequest};
use tomcom_session::files::file_error::FileError;
use tomcom_session::settings::ArmKind;
use tomcom_study::analysis::cohort_lines::{describe_end, describe_row, heading, name_width};
use tomcom_study::analysis::cohort_table::CohortRow;
use tomcom_study::cohort_chart;

/// Measures estimate and assistant with cohorts of simulated people.
///
/// Each cohort differs from the default population. Its trials are simulated without signals and with the assistant
/// acting by itself. Nothing is recorded. The row of a cohort is printed when it is finished; with --format json on
/// standard error.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom robustness sessions/people/robustness.toml --seed 9101 --choose-seed 9001 --arm timed\nMore: docs/study.md"
)]
pub(super) struct RobustnessArgs {
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

/// Runs the command `tomcom robustness BATTERY`.
pub(super) fn robustness(args: &RobustnessArgs) -> Result<(), Failure> {
    args.picture.as_deref().map_or(Ok(()), |file| check_picture(file, "a picture of robustness"))?;
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
    spec.require_built().map_err(|missing| FileError::not_built(&args.battery, missing))?;
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
            put_aside(text);
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
        write_picture(file, &cohort_chart::robustness(&table))?;
    }
    print(args.format, &table, || describe_end(&table))
}
