//! `tomcom review`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::Failure;
use crate::run::rerun::{RerunError, Review, Reviewed, review as open, until_asked_to_end};

/// Opens recordings in Rerun's viewer: kitchen, arm, beliefs, signals and what happened, over time.
#[derive(Debug, Args)]
#[command(
    after_help = "Without a viewer of Rerun in PATH it is served for a browser. Several recordings stand side by side, with \
                  their trials' starts at the same time.\nExample: tomcom review sessions/2026-03-14-P07-1"
)]
pub(super) struct ReviewArgs {
    /// The folders of recordings, or their events.jsonl.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Only write the file: recording.rrd beside the log, or FILE. Several recordings need a FILE.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    save: Option<Option<PathBuf>>,
    /// Serve the viewer for a browser, even if there is another one.
    #[arg(long, conflicts_with = "save")]
    web: bool,
    /// Open at this moment, as the console shows it: seconds since the session began, of several since their trials' starts.
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["save", "web"])]
    at: Option<f64>,
}

impl From<RerunError> for Failure {
    fn from(error: RerunError) -> Failure {
        match error {
            RerunError::File(error) => Failure::from(*error),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

pub(super) fn review(args: &ReviewArgs) -> Result<(), Failure> {
    if let (Some(None), 2..) = (&args.save, args.recordings.len()) {
        let help = "--save=FILE: several recordings have no folder of their own";
        return Err(Failure::Wrong(miette::miette!(
            help = help,
            "found --save, with {} recordings",
            args.recordings.len()
        )));
    }
    let asked = Review { recordings: args.recordings.clone(), save: args.save.clone(), web: args.web, at_s: args.at };
    let mut out = std::io::stdout();
    match open(&asked)? {
        Reviewed::Saved { path, made } => {
            let how = if made { "made from the log" } else { "is there already" };
            writeln!(out, "{} {how}", path.display())?;
        }
        Reviewed::Opened { path } => writeln!(out, "the viewer opens {}", path.display())?,
        Reviewed::Served { url, because, _serving } => {
            writeln!(out, "{because}: it is served here, for a browser on this machine, until ctrl+c\n{url}")?;
            if let Some(at) = args.at {
                writeln!(out, "in the time panel, go to +{at} s")?;
            }
            out.flush()?;
            until_asked_to_end()?;
        }
    }
    Ok(())
}
