//! Commands that use pools of simulated participants: `tomcom power` and `tomcom arms`.

use std::path::PathBuf;

use clap::Args;

use super::choices::{arm_parser, whole};
use super::failure::{Failure, wrong_argument};
use super::lab::tell_carried;
use super::output::{OutputFormat, print, progress, put_aside};
use crate::run::files::read_session;
use crate::run::picture_file::{check_picture, write_picture};
use tomcom_core::base::text::count;
use tomcom_session::files::SessionSetup;
use tomcom_session::headless::{self, SimulationShard};
use tomcom_session::settings::ArmKind;
use tomcom_study::drawn_study::DrawnEffect;
use tomcom_study::files::pool_file;
use tomcom_study::pass::describe_arms;
use tomcom_study::pool::SimulationPool;
use tomcom_study::pool::{self, PoolRequest};
use tomcom_study::power::{self, PowerRequest};
use tomcom_study::{arm_table, charts};

/// Default numbers of participants for `tomcom power`.
const SIZES: &str = "8,10,12,14,16,20,24,28,32,36,40";

/// Says how many participants a study needs.
///
/// Simulates a pool of participants with the plan's conditions, and each trial once more without signals; draws studies
/// of whole persons from it; analyses each as the plan will be, and prints power, the least effect that is found, and
/// how many participants are needed.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom power sessions/paper.toml --pool 200 --seed 9741 \\\n            --out pool.jsonl --picture power.svg\n          \
                  tomcom power sessions/paper.toml --pool 1000 --shard 2/8 \\\n            --out part-2.jsonl\n          \
                  tomcom power sessions/paper.toml --from part-*.jsonl --out pool.jsonl\nMore: docs/planning.md"
)]
pub(super) struct PowerArgs {
    #[command(flatten)]
    pool: PoolArgs,
    /// Numbers of participants for which the power is computed, separated by commas.
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', default_value = SIZES, value_parser = whole(4_u16..=1000))]
    sizes: Vec<u16>,
    /// Number of studies that are drawn for each number of participants.
    #[arg(long, default_value_t = 1000, value_parser = whole(20_u64..=100_000))]
    studies: u64,
    /// Simulate this effect by thinning the events of unassisted trials, instead of using the trials of each condition:
    /// the ratio of each condition's rate to that of the first, above 0; 1 gives the type I error.
    #[arg(long, value_name = "RATIO", value_parser = ratio)]
    effect: Option<f64>,
    /// Simulate unassisted trials alone, and measure the type I error: short for --effect 1, but faster.
    #[arg(long, conflicts_with = "effect")]
    null: bool,
    /// Write the table to this file (CSV).
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a picture to this file (SVG).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// Compares all conditions of a plan with simulated participants.
///
/// Each participant has a trial in every condition. Prints a table with errors, belief related errors, lengths of error
/// sequences, orders, signals and the time with a signal on the display, with intervals, and the contrasts between
/// conditions. Nothing is recorded.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tomcom arms sessions/all-arms.toml --participants 60 --seed 1\nMore: docs/planning.md"
)]
pub(super) struct ArmsArgs {
    #[command(flatten)]
    pool: PoolArgs,
}

/// Options for the pool of simulated participants.
#[derive(Debug, Args)]
struct PoolArgs {
    /// The session file with the plan.
    plan: PathBuf,
    /// Number of simulated participants in the pool, whatever the plan says.
    #[arg(long = "pool", visible_alias = "participants", value_name = "PARTICIPANTS", default_value_t = 200, value_parser = whole(2_u32..=100_000))]
    participants: u32,
    /// Seed of all random numbers; by default that of the session file.
    #[arg(long, conflicts_with = "from")]
    seed: Option<u64>,
    /// Kind of the robot's arm, instead of the session file's; "timed" is faster to simulate.
    #[arg(long, value_parser = arm_parser())]
    arm: Option<ArmKind>,
    /// Simulate one shard of the pool, such as "2/8", the second of eight, for job arrays, and only write it to --out.
    #[arg(
        long,
        value_name = "PART/PARTS",
        default_value = "1/1",
        hide_default_value = true,
        requires = "out",
        conflicts_with = "from"
    )]
    shard: SimulationShard,
    /// Read the participants from these files instead of simulating them; shards are joined.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "participants")]
    from: Vec<PathBuf>,
    /// Write the simulated or joined pool, or the shard, to this file (JSON Lines).
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

fn ratio(text: &str) -> Result<f64, String> {
    let right = || "wanted a ratio of rates above 0, at most 1, such as 0.7".to_string();
    text.parse().ok().filter(|&ratio| ratio > 0.0 && ratio <= 1.0).ok_or_else(right)
}

impl PoolArgs {
    /// The pool that these options ask for; `None` if the options ask for a shard, which is written to a file. `arms`:
    /// simulate trials in the plan's arms; `unassisted`: simulate trials without signals.
    fn pool(&self, arms: bool, unassisted: bool) -> Result<Option<SimulationPool>, Failure> {
        let mut files = read_session(&self.plan)?;
        tell_carried(&self.plan, None);
        let spec = &mut files.spec;
        spec.robot.arm = self.arm.unwrap_or(spec.robot.arm);
        headless::require(spec, &self.plan)?;
        let pool = match self.from.is_empty() {
            false => self.read(files)?,
            true => {
                files.spec.seed = self.seed.unwrap_or(files.spec.seed);
                let request =
                    PoolRequest { files, participants: self.participants, shard: self.shard, arms, unassisted };
                if let Some(out) = &self.out {
                    pool_file::check_pool(out, &request.header(&self.plan)?)?;
                }
                let bar = progress(request.trials(&self.plan)?, "trials");
                let pool = pool::simulate(&request, &self.plan, || bar.inc(1))?;
                bar.finish_and_clear();
                pool
            }
        };
        if let Some(out) = &self.out {
            pool_file::write_pool(out, &pool)?;
        }
        if self.shard != SimulationShard::WHOLE {
            let (SimulationShard { number, of }, persons) = (self.shard, pool.persons.len() as u64);
            put_aside(&format!(
                "part {number} of {of} of the pool was simulated: {}\n",
                count(persons, "participant", "participants")
            ));
            return Ok(None);
        }
        Ok(Some(pool))
    }

    /// Reads the pool from the files of `--from`, which must have been simulated for this plan.
    fn read(&self, mut files: SessionSetup) -> Result<SimulationPool, Failure> {
        let pool = pool_file::read_pool(&self.from)?;
        files.spec.seed = pool.header.seed;
        let (participants, shard) = (pool.header.participants, SimulationShard::WHOLE);
        let request =
            PoolRequest { files, participants, shard, arms: pool.header.arms, unassisted: pool.header.unassisted };
        let wanted = request.header(&self.plan)?;
        if wanted.digest != pool.header.digest {
            let found = format!("a pool of another plan or other settings ({})", pool.header.digest);
            let remedy = format!(
                "a pool of {} as it is now ({}), simulated with the same --arm",
                self.plan.display(),
                wanted.digest
            );
            return Err(wrong_argument(&self.from[0], found, &remedy));
        }
        Ok(pool)
    }

    /// Path to which error messages about the pool refer.
    fn source(&self) -> &PathBuf {
        self.from.first().unwrap_or(&self.plan)
    }
}

pub(super) fn power(args: &PowerArgs) -> Result<(), Failure> {
    args.csv.as_deref().map_or(Ok(()), pool_file::check_table)?;
    args.picture.as_deref().map_or(Ok(()), |file| check_picture(file, "a picture of power"))?;
    let Some(pool) = args.pool.pool(!args.null, true)? else { return Ok(()) };
    let ratio = if args.null { Some(1.0) } else { args.effect };
    let effect = ratio.map_or(DrawnEffect::AsSimulated, DrawnEffect::Ratio);
    let mut sizes: Vec<usize> = args.sizes.iter().map(|&size| usize::from(size)).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let request = PowerRequest { sizes, studies: args.studies, effect };
    let bar = progress(power::blocks(&request, &pool), "blocks of drawn studies");
    let found = power::measure(&request, &pool, args.pool.source(), || bar.inc(1))?;
    bar.finish_and_clear();
    if let Some(file) = &args.csv {
        pool_file::write_table(file, &found)?;
    }
    if let Some(file) = &args.picture {
        write_picture(file, &charts::power(&found))?;
    }
    print(args.pool.format, &found, || power::describe(&found))
}

pub(super) fn arms(args: &ArmsArgs) -> Result<(), Failure> {
    let Some(pool) = args.pool.pool(true, false)? else { return Ok(()) };
    if !pool.header.arms {
        let found = "a pool that has only unassisted trials".to_string();
        return Err(wrong_argument(args.pool.source(), found, "a pool made without --null"));
    }
    let table = arm_table::StudyArmTable::from_pool(&pool);
    print(args.pool.format, &table, || {
        let comparisons: String = table.comparisons.iter().map(describe_arms).collect();
        arm_table::describe(&table) + "\n" + &comparisons
    })
}
