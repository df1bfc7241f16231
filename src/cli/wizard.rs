//! Commands about the wizard: comparison with assistants, and training.

use std::path::{Path, PathBuf};

use clap::Args;

use super::choices::{own_concept_parser, whole};
use super::failure::Failure;
use super::lab::tell_carried;
use super::list::{chosen, each_chosen, gathered_for_analysis};
use super::operate::{OperateFlags, new_session};
use super::output::{OutputFormat, print, progress, put};
use crate::console::console_model::SPEEDS;
use crate::run::options::{DEFAULT_OUT, DEFAULT_SESSION};
use crate::run::train::{self, WizardTrainingRequest};
use crate::run::{review_console, series, simulate};
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::measures::matching::WINDOW;
use tomcom_core::measures::wizard_performance::TrainingCriterion;
use tomcom_session::person_code;
use tomcom_session::watcher::SenderComparisonSettings;
use tomcom_study::analysis::comparison_summary::{self, ComparisonSummary};
use tomcom_study::analysis::lesson_report::{self, WizardTrainingSummary};
use tomcom_study::files::training;
use tomcom_study::similarity;

/// Compares a wizard's signals with those that assistants would have sent.
///
/// Signals of both, matches, and the context of differences; over recordings or live.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom compare sessions/2026-03-14-P07-1 --with tom,dev\n          tomcom compare sessions/2026-03-14-P07-* --only tom\n          tomcom compare sessions/2026-03-14-P07-1 --follow\n          tomcom compare sessions/default.toml\nMore: docs/analysis.md"
)]
pub(super) struct CompareArgs {
    /// Folders of recordings, or their events.jsonl; or a session file, to operate it with the comparison in front (by
    /// default sessions/default.toml). That unblinds the wizard, and the recording says so.
    #[arg(value_name = "RECORDING|SESSION")]
    paths: Vec<PathBuf>,
    /// Open the console over a session that is still running, read-only from this terminal.
    #[arg(long, conflicts_with_all = ["sweep", "open", "wizard", "format"])]
    follow: bool,
    /// Further concepts besides the session's own, separated by commas.
    #[arg(long, value_parser = own_concept_parser(), value_delimiter = ',')]
    with: Vec<ConceptName>,
    /// Show only these concepts; they are asked for advice, as with --with.
    #[arg(long, value_parser = own_concept_parser(), value_delimiter = ',', conflicts_with = "follow")]
    only: Vec<ConceptName>,
    /// Window of a match, in presses of the human: communications further apart do not match.
    #[arg(long, default_value_t = WINDOW, value_parser = whole(0_u32..=100))]
    window: u32,
    /// Print the statistics for every window from 0 to 10.
    #[arg(long, conflicts_with_all = ["open", "window"])]
    sweep: bool,
    /// Print the context of the difference with this number.
    #[arg(long, value_name = "NUMBER", conflicts_with = "format")]
    open: Option<usize>,
    /// The wizard's code, to add the results of training.
    #[arg(long)]
    wizard: Option<String>,
    /// Folder of the training records.
    #[arg(long, default_value = "sessions/training")]
    training: PathBuf,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
    #[command(flatten, next_help_heading = "To operate a session")]
    flags: OperateFlags,
}

/// Trains a wizard on simulated recordings.
///
/// The wizard watches recordings with known beliefs, sends signals with the usual keys, and gets immediate feedback and
/// a score.
#[derive(Debug, Args)]
#[command(after_help = "Example: tomcom train --wizard W1 --hits 0.6 --wrong 0.4\nMore: docs/training.md")]
pub(super) struct TrainArgs {
    /// Recordings of simulated participants without signals; by default one is simulated.
    #[arg(value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// The wizard's code, never a name. A repeated recording is compared with the wizard's earlier signals.
    #[arg(long, default_value = "W1")]
    wizard: String,
    /// Criterion: least share of hits among the false beliefs that lead to errors.
    #[arg(long, default_value_t = 0.6)]
    hits: f64,
    /// Criterion: largest share of wrong signals.
    #[arg(long, default_value_t = 0.4)]
    wrong: f64,
    /// Speed of the replay.
    #[arg(long, value_parser = ["0.25", "0.5", "1", "2", "4", "16", "64"], default_value = "1")]
    speed: String,
    /// Seed of the recording that is simulated for the training; --seconds sets its length.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[arg(long, default_value_t = 300.0)]
    seconds: f64,
    /// Folder for the training record.
    #[arg(long, default_value = "sessions/training")]
    out: PathBuf,
}

pub(super) fn compare(args: &CompareArgs) -> Result<(), Failure> {
    let with: Vec<ConceptName> = args.with.iter().chain(&args.only).copied().collect();
    let request = |window: u32| SenderComparisonSettings { with: with.clone(), window };
    let session = match &args.paths[..] {
        [] => Some(None),
        [path] => Some(Some(path.as_path())).filter(|_| path.extension().is_some_and(|extension| extension == "toml")),
        _ => None,
    };
    check_flags(args, session.is_some() && !args.follow)?;
    if let Some(session) = session.filter(|_| !args.follow) {
        let done = new_session(session, &args.flags, Some(request(args.window)))?;
        return Ok(put(&series::describe(&done))?);
    }
    if args.follow {
        let [recording] = &args.paths[..] else {
            let help = "one recording to follow: its folder";
            return Err(Failure::Wrong(miette::miette!(help = help, "found --follow and {} paths", args.paths.len())));
        };
        return Ok(review_console::review(&chosen(recording, "follow")?, true, Some(&request(args.window)))?);
    }
    let recordings = gathered_for_analysis(&each_chosen(&args.paths, "compare")?)?;
    let windows: Vec<u32> = if args.sweep { similarity::SWEEP.collect() } else { vec![args.window] };
    let bar = progress((recordings.paths.len() * windows.len()) as u64, "recordings");
    let watch = |window: u32| similarity::watch(&recordings, &request(window), || bar.inc(1));
    let first = watch(windows[0])?;
    let mut figures = ComparisonSummary::from_recordings(&first);
    for &window in &windows[1..] {
        figures.pairs.extend(ComparisonSummary::from_recordings(&watch(window)?).pairs);
    }
    if !args.only.is_empty() {
        let only = args.only.clone();
        figures = figures.only(&only);
    }
    if let Some(wizard) = &args.wizard {
        let records = training::read(&args.training, &code_of(wizard)?)?;
        figures.training = Some(WizardTrainingSummary::from_records(&args.training, wizard, &records));
    }
    bar.finish_and_clear();
    match args.open {
        Some(number) => Ok(put(&similarity::open(&first, number)?)?),
        None => print(args.format, &figures, || comparison_summary::describe(&figures, &request(windows[0]))),
    }
}

/// Refuses options that have no effect in the requested comparison.
fn check_flags(args: &CompareArgs, is_session: bool) -> Result<(), Failure> {
    let flags = &args.flags;
    let of_session = [
        ("--code", flags.code.is_some()),
        ("--participant", flags.participant.is_some()),
        ("--gaze", flags.gaze.is_some()),
        ("--gaze-file", flags.gaze_file.is_some()),
        ("--gaze-start", flags.gaze_start.is_some()),
        ("--listen", flags.listen.is_some()),
        ("--rerun-listen", flags.rerun_listen.is_some()),
        ("--observe", flags.observe.is_some()),
        ("--out", flags.out != Path::new(DEFAULT_OUT)),
        ("--arm", flags.arm.is_some()),
        ("--condition", flags.condition.is_some()),
        ("--concept", flags.concept.is_some()),
        ("--seed", flags.seed.is_some()),
        ("--frozen", flags.frozen.is_some()),
    ];
    let of_recordings = [
        ("--sweep", args.sweep),
        ("--only", !args.only.is_empty()),
        ("--open", args.open.is_some()),
        ("--wizard", args.wizard.is_some()),
    ];
    let (strange, help) = match is_session {
        true => (&of_recordings[..], "this option with recordings, or a session file without this option"),
        false => (
            &of_session[..],
            "this option with a session file, or recordings without this option: their headers say it",
        ),
    };
    if let Some((flag, _)) = strange.iter().find(|(_, is_given)| *is_given) {
        let what = if is_session { "a session file" } else { "recordings" };
        return Err(Failure::Wrong(miette::miette!(help = help, "found {flag}, with {what}")));
    }
    Ok(())
}

pub(super) fn train(args: &TrainArgs) -> Result<(), Failure> {
    let is_share = |value: f64| (0.0..=1.0).contains(&value);
    if let Some((key, value)) =
        [("hits", args.hits), ("wrong", args.wrong)].into_iter().find(|(_, value)| !is_share(*value))
    {
        return Err(Failure::Wrong(miette::miette!(help = "a share of signals from 0 to 1", "found --{key} {value}")));
    }
    let recordings = match &args.recordings[..] {
        [] => {
            tell_carried(Path::new(DEFAULT_SESSION), Some(&args.out));
            simulate::for_training(args.seed, args.seconds, &args.out.join("recordings"))?
        }
        given => each_chosen(given, "train with it")?,
    };
    let lesson = WizardTrainingRequest {
        recordings,
        wizard: code_of(&args.wizard)?,
        out: args.out.clone(),
        criterion: TrainingCriterion { hits: args.hits, wrong: args.wrong },
        speed: SPEEDS.iter().position(|speed| speed.to_string() == args.speed).unwrap_or(2),
    };
    let (record, path) = train::train(&lesson)?;
    Ok(put(&lesson_report::describe(&record, &path))?)
}

/// Parses a wizard's code.
fn code_of(text: &str) -> Result<String, Failure> {
    match person_code::fault(text) {
        None => Ok(text.to_string()),
        Some(fault) => {
            Err(Failure::Wrong(miette::miette!(help = person_code::REMEDY, "found --wizard \"{text}\": {fault}")))
        }
    }
}
