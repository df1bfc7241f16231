//! `tomcom codes` and `tomcom forget`.

use std::io::{BufRead, IsTerminal};
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::output::{OutputFormat, print, progress, put_aside};
use crate::base::words::count;
use crate::edge::forget::{self, ParticipantData};
use crate::run::codes::{self, CodedRecording, CodesSummary};
use crate::run::review;
use crate::session::settings::is_code;

/// Prints raters' codes of errors, and their agreement.
///
/// Can import codes from a table, or export them.
#[derive(Debug, Args)]
#[command(after_help = "tomcom replay RECORDING --rater R1 is where errors are coded.\n\
                  Examples: tomcom codes sessions/2026-03-14-P07-1\n          \
                  tomcom codes sessions/*-P*-* --export codes.csv\nMore: docs/recordings.md")]
pub(super) struct CodesArgs {
    /// The folders of recordings, or their events.jsonl.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Import codes from this table, with the columns recording, rater, press, cause, aspect.
    #[arg(long, value_name = "FILE")]
    import: Option<PathBuf>,
    /// Export all codes to such a table.
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

pub(super) fn codes(args: &CodesArgs) -> Result<(), Failure> {
    let bar = progress(args.recordings.len() as u64, "recordings");
    let read = crate::run::parallel::each(&args.recordings, |recording| CodedRecording::open(recording), || bar.inc(1));
    bar.finish_and_clear();
    let mut recordings = read.into_iter().collect::<Result<Vec<CodedRecording>, _>>()?;
    if let Some(file) = &args.import {
        codes::import(&mut recordings, file)?;
    }
    if let Some(file) = &args.export {
        codes::export(&recordings, file)?;
    }
    let figures = CodesSummary::from_recordings(&recordings);
    print(args.format, &figures, || codes::describe(&figures))
}

/// Codes the errors of a recording at the console.
pub(super) fn rate(recording: &Path, rater: &str) -> Result<(), Failure> {
    if !is_code(rater) {
        let help = "a code of 1 to 32 letters, digits, - and _, such as R1; never a name";
        return Err(Failure::Wrong(miette::miette!(help = help, "found the rater \"{rater}\"")));
    }
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        let help = "a terminal; tomcom codes takes codes from a table";
        return Err(Failure::Wrong(miette::miette!(help = help, "found no terminal to code errors at")));
    }
    Ok(review::rate(recording, rater)?)
}

/// Deletes everything about a participant below a folder.
///
/// Recordings with their parts, streams and codes, rows of tables, reports, and what a wizard has trained on them. With a
/// wizard's code: the records of training.
#[derive(Debug, Args)]
#[command(after_help = "Session files stay, and so does what an eye tracker has recorded by itself.\n\
                  Exit code 0: deleted. 1: there was nothing, or not all of it could be deleted.\n\
                  Example: tomcom forget P07 --in sessions\nMore: docs/recordings.md, docs/security.md")]
pub(super) struct ForgetArgs {
    /// The code of the participant.
    code: String,
    /// Where to look.
    #[arg(long = "in", value_name = "FOLDER", default_value = "sessions")]
    folder: PathBuf,
    /// Do not ask.
    #[arg(long)]
    yes: bool,
    /// How to print what was deleted.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// What was deleted, as JSON.
#[derive(Debug, Serialize)]
struct Forgotten<'a> {
    code: &'a str,
    deleted: bool,
    #[serde(flatten)]
    found: &'a ParticipantData,
}

pub(super) fn forget(args: &ForgetArgs) -> Result<(), Failure> {
    let code = &args.code;
    if !is_code(code) {
        let help = "a code of 1 to 32 letters, digits, - and _, such as P07";
        return Err(Failure::Wrong(miette::miette!(help = help, "found the code \"{code}\"")));
    }
    let found = forget::find(&args.folder, code)?;
    let deletes = !found.is_empty() && (args.yes || is_meant(args, &found)?);
    if deletes {
        forget::delete(&found, code)?;
    }
    let figures = Forgotten { code, deleted: deletes, found: &found };
    print(args.format, &figures, || match (found.is_empty(), deletes) {
        (true, _) => format!("nothing of {code} is in {}\n", args.folder.display()),
        (false, true) => format!("deleted:\n{}", listed(&found)),
        (false, false) => "nothing was deleted\n".to_string(),
    })?;
    if deletes { Ok(()) } else { Err(Failure::No) }
}

/// Shows what would be deleted, and asks for the code.
fn is_meant(args: &ForgetArgs, found: &ParticipantData) -> Result<bool, Failure> {
    let input = std::io::stdin();
    put_aside(&format!("{}\n", listed(found)));
    if !input.is_terminal() {
        let help = "--yes, or a terminal to answer at";
        return Err(Failure::Wrong(miette::miette!(help = help, "found nobody to ask whether this is to be deleted")));
    }
    put_aside(&format!("It cannot be brought back. To delete it, type the code {} again: ", args.code));
    let mut answer = String::new();
    input.lock().read_line(&mut answer)?;
    Ok(answer.trim() == args.code)
}

fn listed(found: &ParticipantData) -> String {
    let line = |path: &Path, what: &str| format!("  {}{what}\n", path.display());
    let recordings = found.recordings.iter().map(|path| line(path, " (recording)"));
    let files = found.files.iter().map(|path| line(path, ""));
    let tables = found.tables.iter().map(|(path, rows)| line(path, &format!(" ({})", count(*rows, "row", "rows"))));
    let trainings = found.trainings.iter().map(|path| line(path, " (what was trained on these recordings)"));
    recordings.chain(files).chain(tables).chain(trainings).collect()
}
