//! The command `tomcom review`.

use std::path::PathBuf;

use clap::Args;

use super::failure::Failure;
use super::list::each_chosen;
use super::output::OutputFormat;
use super::rerun_messages::{list_landmarks, open};
use tomcom_core::base::time::SessionTime;
use tomcom_session::features::Feature;

/// Opens recordings in the Rerun viewer.
///
/// Shows kitchen, arm, beliefs, signals and events over time.
#[derive(Debug, Args)]
#[command(
    after_help = "Without a viewer of Rerun in PATH it is served for a browser. Several recordings stand side by side, by the \
                  clocks of their trials.\nExamples: tomcom review sessions/2026-03-14-P07-1\n          \
                  tomcom review sessions/2026-03-14-P07-1 --at 1:34\n          \
                  tomcom review sessions/2026-03-14-P07-1 --errors\nMore: docs/rerun.md"
)]
pub(super) struct ReviewArgs {
    /// The folders of recordings, or their events.jsonl. Of a folder of recordings, one is chosen from a list.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Only write the stream file: recording.rrd beside the log, or FILE. Several recordings need a FILE.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    save: Option<Option<PathBuf>>,
    /// Open the viewer in a browser, even if a native viewer is installed.
    #[arg(long, conflicts_with = "save")]
    web: bool,
    /// Open at this time on the trial's clock, as the console shows it: 1:34, or seconds.
    #[arg(long, value_name = "TIME", value_parser = moment, conflicts_with = "save")]
    at: Option<SessionTime>,
    #[command(flatten)]
    asked: AskedLandmarks,
}

// What is printed instead of opening the viewer. Not a doc comment, which would stand in the command's help.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct AskedLandmarks {
    /// Only print a line for each error: the command that opens the viewer there, with its end and its reason.
    #[arg(long, conflicts_with_all = ["save", "web", "at"])]
    pub(super) errors: bool,
    /// The same for each signal, and for each note; also together with --errors.
    #[arg(long, conflicts_with_all = ["save", "web", "at"])]
    pub(super) signals: bool,
    /// The same for each estimated false belief, with the truth; also together with the others.
    #[arg(long, conflicts_with_all = ["save", "web", "at"])]
    pub(super) beliefs: bool,
    /// With them, only what lasts at least this long.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, hide_default_value = true, value_parser = at_least_zero)]
    pub(super) least: f64,
    /// With them, the output format.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: OutputFormat,
}

impl AskedLandmarks {
    fn is_any(self) -> bool {
        self.errors || self.signals || self.beliefs
    }
}

/// Parses a duration in seconds.
fn at_least_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "a duration in seconds, such as 1 or 0.5".to_string())
}

/// Parses a time on the trial's clock, written as the console shows it, or in seconds.
fn moment(text: &str) -> Result<SessionTime, String> {
    let wrong = || "a time in minutes and seconds, such as 1:34, or in seconds, such as 94.6".to_string();
    SessionTime::from_clock(text).ok_or_else(wrong)
}

/// Runs the command `tomcom review RECORDING`.
pub(super) fn review(args: &ReviewArgs) -> Result<(), Failure> {
    Feature::Rerun.require()?;
    let (mut recordings, mut save) = (args.recordings.clone(), args.save.clone());
    // A path that ends with `.rrd` is no recording, but the file of a stream: `--save FILE` without `=` ends up here.
    let is_stream = |path: &mut PathBuf| path.extension().is_some_and(|extension| extension == "rrd");
    if save == Some(None)
        && recordings.len() > 1
        && let Some(file) = recordings.pop_if(is_stream)
    {
        save = Some(Some(file));
    }
    if let (Some(None), 2..) = (&save, recordings.len()) {
        let help = "--save=out.rrd: the stream of several recordings needs the name of a file";
        return Err(Failure::Wrong(miette::miette!(
            help = help,
            "found --save without a file, with {} recordings",
            recordings.len()
        )));
    }
    let without_list = match args.asked {
        asked if asked.is_any() => None,
        AskedLandmarks { format: OutputFormat::Json, .. } => Some("--format json"),
        asked => (asked.least > 0.0).then_some("--least"),
    };
    if let Some(option) = without_list {
        let help = format!("{option} with --errors, --signals or --beliefs");
        return Err(Failure::Wrong(miette::miette!(help = help, "found {option}, with nothing to list")));
    }
    let recordings = each_chosen(&recordings, "open")?;
    match args.asked.is_any() {
        true => list_landmarks(&recordings, args.asked),
        false => open(recordings, save, args.web, args.at),
    }
}
