//! Commands about raters' codes (`tomcom codes`) and the deletion of a participant's data (`tomcom forget`).

use std::io::{BufRead, IsTerminal, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::list::gathered;
use super::output::{OutputFormat, print, progress, put, put_aside};
use crate::run::forget::{self, ParticipantData};
use crate::run::options::DEFAULT_OUT;
use crate::run::review_console;
use tomcom_core::base::text::count;
use tomcom_session::person_code;
use tomcom_session::settings::is_code;
use tomcom_study::codes::{self, CodedRecording, ImportableCodes, InterRaterSummary};

/// Longest answer to a question, in bytes; no code of a participant is as long.
const MAX_ANSWER: u64 = 1 << 12;

/// Prints raters' codes of errors, their agreement, and where they disagree.
///
/// Also the codes on which two raters agreed afterwards. The codes of R1 stand in codes-R1.csv in the folder of each recording.
/// --export gathers the codes of all raters and recordings in one table; --import takes such a table back, for example
/// beside another copy of the recordings.
#[derive(Debug, Args)]
#[command(after_help = "tomcom replay RECORDING --rater R1 is where errors are coded;\n\
                  tomcom replay RECORDING --settle R1 R2 is where two raters settle what they coded differently.\n\
                  Examples: tomcom codes sessions/2026-03-14-P07-1\n          \
                  tomcom codes sessions/*-P*-* --export codes.csv\n          \
                  tomcom codes copy/*-P*-* --import codes.csv\nMore: docs/raters.md")]
pub(super) struct CodesArgs {
    /// The folders of recordings, or their events.jsonl; or folders with recordings in them.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Import codes from this file: a table that --export wrote, or another one with the columns recording, rater (R1+R2: a
    /// consensus), press, cause, aspect; or a file of ELAN (.eaf) or BORIS (.boris) that tomcom export wrote and raters
    /// annotated.
    #[arg(long, value_name = "FILE")]
    import: Option<PathBuf>,
    /// Import codes of raters who have no codes yet, and codes that change others, without asking.
    #[arg(long, requires = "import")]
    yes: bool,
    /// Export the codes of all raters and recordings to this table, which is made anew, with these columns.
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

pub(super) fn codes(args: &CodesArgs) -> Result<(), Failure> {
    let is_codes = |path: &&PathBuf| {
        path.is_file() && path.extension().is_some_and(|end| ["csv", "eaf", "boris"].iter().any(|codes| end == *codes))
    };
    if let Some(file) = args.recordings.iter().find(is_codes) {
        let help = format!("tomcom codes RECORDING --import {}", file.display());
        return Err(Failure::Wrong(miette::miette!(
            help = help,
            "{}: found a file with codes, wanted a recording",
            file.display()
        )));
    }
    let chosen = gathered(&args.recordings)?.paths;
    let bar = progress(chosen.len() as u64, "recordings");
    let read = tomcom_study::parallel::each(&chosen, |recording| CodedRecording::open(recording), || bar.inc(1));
    bar.finish_and_clear();
    let mut recordings = read.into_iter().collect::<Result<Vec<CodedRecording>, _>>()?;
    if let Some(file) = &args.import {
        let codes = codes::read(&recordings, file)?;
        if !are_meant(&codes, args.yes)? {
            put_aside("nothing was imported\n");
            return Err(Failure::No);
        }
        codes.import(&mut recordings)?;
    }
    if let Some(file) = &args.export {
        // The recordings are as they should be: what fails is writing.
        codes::export(&recordings, file).map_err(|error| Failure::Failed(miette::Report::new(error)))?;
    }
    let figures = InterRaterSummary::from_recordings(&recordings);
    print(args.format, &figures, || codes::describe(&figures))
}

/// Tells which raters in a table are new, and which codes it changes, and asks whether that is meant: a code that was
/// typed wrong, or changed by a spreadsheet, would make a rater of its own, and an old table would undo later codes.
fn are_meant(codes: &ImportableCodes, is_agreed: bool) -> Result<bool, Failure> {
    let mut told = Vec::new();
    if !codes.new_raters.is_empty() {
        let (new, known) = (codes.new_raters.join(", "), codes.known_raters.join(", "));
        let known = if known.is_empty() { "no rater".to_string() } else { known };
        told.push(format!("new raters in the table: {new}; so far these recordings have codes of: {known}"));
    }
    let changes = codes.changed.iter().map(|(rater, number)| format!("{} of {rater}", count(*number, "code", "codes")));
    let changes: Vec<String> = changes.collect();
    if !changes.is_empty() {
        told.push(format!("the table changes {}", changes.join(", ")));
    }
    told.iter().for_each(|line| put_aside(&format!("{line}\n")));
    let input = std::io::stdin();
    if is_agreed || told.is_empty() {
        return Ok(true);
    }
    if !input.is_terminal() {
        let help = "use --yes if that is meant; otherwise correct the table";
        return Err(Failure::Wrong(miette::miette!(
            help = help,
            "nothing was imported: there is no terminal to confirm in: {}",
            told.join("; ")
        )));
    }
    put_aside("Import the table? To do so, type yes: ");
    let mut answer = String::new();
    input.lock().read_line(&mut answer)?;
    Ok(answer.trim() == "yes")
}

/// Runs `tomcom replay --rater`: lets a rater code the errors of a recording at the console.
pub(super) fn rate(recording: &Path, rater: &str) -> Result<(), Failure> {
    check_rater(rater)?;
    check_terminal()?;
    Ok(put(&format!("{}\n", review_console::rate(recording, rater)?))?)
}

/// Lets two raters settle, at the console, the errors that they coded differently.
pub(super) fn settle(recording: &Path, raters: &[String]) -> Result<(), Failure> {
    let [one, other] = two_raters(raters, "--settle")?;
    check_terminal()?;
    Ok(put(&format!("{}\n", review_console::code_as_pair(recording, [&one, &other])?))?)
}

/// Parses the names of two different raters from the values of an option.
pub(super) fn two_raters(raters: &[String], option: &str) -> Result<[String; 2], Failure> {
    raters.iter().try_for_each(|rater| check_rater(rater))?;
    let wrong = |found: String| {
        let help = format!("two raters, each of whom coded the errors alone: {option} R1 R2");
        Failure::Wrong(miette::miette!(help = help, "{found}"))
    };
    match raters {
        [one, other] if one == other => Err(wrong(format!("found the rater \"{one}\" twice"))),
        [one, other] => Ok([one.clone(), other.clone()]),
        _ => Err(wrong(format!("found {} raters after {option}", raters.len()))),
    }
}

/// Refuses a rater without a valid code.
fn check_rater(rater: &str) -> Result<(), Failure> {
    match person_code::fault(rater) {
        None => Ok(()),
        Some(fault) => {
            Err(Failure::Wrong(miette::miette!(help = person_code::REMEDY, "found the rater \"{rater}\": {fault}")))
        }
    }
}

/// Refuses to code errors without a terminal.
fn check_terminal() -> Result<(), Failure> {
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        let help = "run it in a terminal, or import a table of codes with tomcom codes";
        return Err(Failure::Wrong(miette::miette!(help = help, "found no terminal in which errors can be coded")));
    }
    Ok(())
}

/// Deletes everything about a participant below a folder.
///
/// Recordings with their parts, streams and codes; rows of tables, by the columns that name the participant or the
/// recording; reports about the participant; what a wizard has trained on the recordings. With a wizard's code: the
/// records of training. Only what tomcom wrote is deleted. It is listed first, and what is left, with the reason.
#[derive(Debug, Args)]
#[command(after_help = "Session files stay, and so does what other programs have written, such as an eye tracker.\n\
                  Exit code 0: all of it below the folder is deleted. 1: there was nothing, or\nsomething is left. 2: wrong arguments.\n\
                  Example: tomcom forget P07 --in sessions\nMore: docs/recordings.md, docs/security.md")]
pub(super) struct ForgetArgs {
    /// The code of the participant.
    code: String,
    /// Folder in which to look for the participant's data.
    #[arg(long = "in", value_name = "FOLDER", default_value = DEFAULT_OUT)]
    folder: PathBuf,
    /// Delete without asking for confirmation.
    #[arg(long)]
    yes: bool,
    /// How to print what is deleted and what is left.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// JSON output of the deletion: what is deleted or would be deleted, and what stays.
#[derive(Debug, Serialize)]
struct ForgetSummary<'a> {
    code: &'a str,
    deleted: bool,
    recordings: Vec<String>,
    recording_files: Vec<String>,
    files: Vec<String>,
    tables: Vec<(String, usize)>,
    trainings: Vec<String>,
    left: Vec<LeftSummary<'a>>,
    naming: Vec<String>,
}

#[derive(Debug, Serialize)]
struct LeftSummary<'a> {
    path: String,
    reason: &'a str,
}

impl ForgetSummary<'_> {
    fn new(found: &ParticipantData, deleted: bool) -> ForgetSummary<'_> {
        let told = |path: &PathBuf| path.display().to_string();
        let all = |paths: &[PathBuf]| paths.iter().map(told).collect();
        ForgetSummary {
            code: &found.code,
            deleted,
            recordings: all(&found.recordings),
            recording_files: all(&found.recording_files),
            files: all(&found.files),
            tables: found.tables.iter().map(|(path, rows)| (told(path), rows.len())).collect(),
            trainings: found.trainings.iter().map(|(path, _)| told(path)).collect(),
            left: found.left.iter().map(|left| LeftSummary { path: told(&left.path), reason: &left.reason }).collect(),
            naming: all(&found.naming),
        }
    }
}

pub(super) fn forget(args: &ForgetArgs) -> Result<(), Failure> {
    let code = &args.code;
    if !is_code(code) {
        let help = "the code of a participant, such as P07";
        return Err(Failure::Wrong(miette::miette!(help = help, "found the participant's code \"{code}\"")));
    }
    let found = forget::find(&args.folder, &std::env::temp_dir(), code)?;
    if !found.is_empty() && !args.yes && !is_meant(args, &found)? {
        return print(args.format, &ForgetSummary::new(&found, false), || "nothing was deleted\n".to_string())
            .and(Err(Failure::No));
    }
    let deletes = !found.is_empty();
    let done = if deletes { forget::delete(found)? } else { found };
    print(args.format, &ForgetSummary::new(&done, deletes), || match deletes {
        true => format!("deleted:\n{}{}", listed(&done), left(&done)),
        false => {
            let deletable = if done.left.is_empty() { "" } else { " that can be deleted" };
            let (folder, near) = (args.folder.display(), &done.near);
            format!("there are no files of participant {code}{deletable} in {folder}{near}\n{}", left(&done))
        }
    })?;
    if deletes && done.left.is_empty() { Ok(()) } else { Err(Failure::No) }
}

/// What the command cannot know of.
const UNKNOWN: &str = "not looked for: copies, tables and exports in other folders, files of other programs (videos, eye trackers), \
                       backups\n";

/// Shows what the deletion would remove, and asks for the participant's code as confirmation.
fn is_meant(args: &ForgetArgs, found: &ParticipantData) -> Result<bool, Failure> {
    let input = std::io::stdin();
    put_aside(&format!("to be deleted:\n{}{}\n", listed(found), left(found)));
    if !input.is_terminal() {
        if args.format == OutputFormat::Json {
            print(args.format, &ForgetSummary::new(found, false), String::new)?;
        }
        let help = "use --yes";
        return Err(Failure::Wrong(miette::miette!(
            help = help,
            "nothing was deleted: there is no terminal to confirm in"
        )));
    }
    put_aside(&format!(
        "Deleted files cannot be brought back. To delete them, type the participant's code {} again: ",
        args.code
    ));
    let mut answer = String::new();
    input.lock().take(MAX_ANSWER).read_line(&mut answer)?;
    Ok(answer.trim() == args.code)
}

/// What is deleted, as text with one line each; the files of a recording are listed below the recording's folder.
fn listed(found: &ParticipantData) -> String {
    let line = |path: &Path, what: &str| format!("  {}{what}\n", path.display());
    let recording = |folder: &PathBuf| {
        let own = found.recording_files.iter().filter(|file| file.parent() == Some(folder));
        let names: Vec<String> =
            own.map(|file| file.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect();
        let names = if names.is_empty() { String::new() } else { format!("    {}\n", names.join(", ")) };
        line(folder, " (recording)") + &names
    };
    let recordings = found.recordings.iter().map(recording);
    let files = found.files.iter().map(|path| line(path, ""));
    let rows = |rows: usize| format!(" ({})", count(rows as u64, "row", "rows"));
    let tables = found.tables.iter().map(|(path, cut)| line(path, &rows(cut.len())));
    let trainings = found.trainings.iter().map(|(path, _)| line(path, " (a wizard's training on these recordings)"));
    recordings.chain(files).chain(tables).chain(trainings).collect()
}

/// What is not deleted although it is or may be about the participant, as text with a line and a reason each, what still
/// names the code, which plans ask for the participant, and what cannot be known.
fn left(found: &ParticipantData) -> String {
    let lines: String = found.left.iter().map(|left| format!("  {}: {}\n", left.path.display(), left.reason)).collect();
    let lines = if lines.is_empty() { lines } else { format!("not deleted:\n{lines}") };
    let naming: String = found.naming.iter().map(|path| format!("  {}\n", path.display())).collect();
    let naming = match naming.is_empty() {
        true => naming,
        false => format!(
            "these stay, and name {} (session files, frozen plans, corrected recordings of others):\n{naming}",
            found.code
        ),
    };
    let still_asks = |plan: &String| {
        format!(
            "the plan {plan} still asks for {}: leave the code in the plan, since without it those after it would get other orders \
             of conditions\n",
            found.code
        )
    };
    lines + &naming + &found.plans.iter().map(still_asks).collect::<String>() + UNKNOWN
}
