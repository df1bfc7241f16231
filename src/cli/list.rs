//! The command `tomcom list`, and the choice of a recording from a folder of recordings.

use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::output::{OutputFormat, print, progress, put_aside};
use crate::run::doctor::columns;
use crate::run::options::DEFAULT_OUT;
use crate::run::recording_list::{self, RecordingListDetail};
use tomcom_core::base::text::count;
use tomcom_session::log::{LOG_NAME, LogReader};
use tomcom_session::person_code;
use tomcom_study::analysis::recording_summary::ListedRecording;
use tomcom_study::files::recordings;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::planned_trial::left_out_in_words;

/// Largest number of recordings that a message names.
const MOST_NAMED: usize = 12;

/// Lists the recordings of a folder.
///
/// Code, kind (trial or practice; simulated), condition, date, length of the trial, errors, and state: whole, ended by
/// wizard (who ended the trial), ended early (left before all was done), cut (without its end), empty, excluded (or
/// aborted), running, unreadable. Sorted by code and date.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples: tomcom list sessions P07\n          tomcom list recordings --format json\nMore: docs/recordings.md"
)]
pub(super) struct ListArgs {
    /// A folder with recordings in it.
    #[arg(value_name = "DIR", default_value = DEFAULT_OUT)]
    folder: PathBuf,
    /// Only the recordings whose line has all of these words, such as P07 (that participant alone) or excluded.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

/// Runs the command `tomcom list DIR`.
pub(super) fn list(args: &ListArgs) -> Result<(), Failure> {
    let bar = progress(0, "recordings");
    let begun = |number: usize| bar.set_length(number as u64);
    let (mut list, _) = recording_list::list(&args.folder, RecordingListDetail::WithErrors, begun, || bar.inc(1))?;
    bar.finish_and_clear();
    let is_of =
        |one: &ListedRecording, word: &str| one.code.as_ref().is_some_and(|code| code.eq_ignore_ascii_case(word));
    // The folder of a recording whose code was corrected still names another participant.
    let codes: BTreeSet<&String> =
        args.words.iter().filter(|word| list.recordings.iter().any(|one| is_of(one, word))).collect();
    let has = |one: &ListedRecording, word: &String| match codes.contains(word) {
        true => is_of(one, word),
        false => one.words().to_lowercase().contains(&word.to_lowercase()),
    };
    for word in args.words.iter().filter(|word| !list.recordings.iter().any(|one| has(one, word))) {
        put_aside(&format!("no recording in {} has \"{word}\" in its line\n", args.folder.display()));
    }
    list.recordings.retain(|one| args.words.iter().all(|word| has(one, word)));
    print(args.format, &list, || list.describe(columns()))
}

/// Chooses one recording per path: if a path is a folder of recordings, the user chooses a recording at the terminal.
/// `does`: what is done with it, as the name of a key.
pub(super) fn each_chosen(paths: &[PathBuf], does: &'static str) -> Result<Vec<PathBuf>, Failure> {
    paths.iter().map(|path| chosen(path, does)).collect()
}

/// Gathers the recordings at these paths, each trial once, and tells which are copies.
pub(super) fn gathered(paths: &[PathBuf]) -> Result<GatheredRecordings, Failure> {
    Ok(told(GatheredRecordings::find(paths)?))
}

/// Gathers the recordings of one analysis, and tells which are left out.
pub(super) fn gathered_for_analysis(paths: &[PathBuf]) -> Result<GatheredRecordings, Failure> {
    Ok(told(GatheredRecordings::find(paths)?.without_foreign(&[])))
}

fn told(found: GatheredRecordings) -> GatheredRecordings {
    put_aside(&left_out_in_words(&found.foreign, &found.copies));
    found
}

/// Finds the recording at a path: of a folder of recordings the only one, or the one that the user chooses at the terminal.
/// `does`: what is done with it, as the name of a key.
pub(super) fn chosen(path: &Path, does: &'static str) -> Result<PathBuf, Failure> {
    if !path.is_dir() || path.join(LOG_NAME).exists() {
        return Ok(path.to_path_buf());
    }
    let mut found = recordings::of_folder(path)?;
    if found.len() == 1 {
        return Ok(found.remove(0));
    }
    if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        return recording_list::pick(path, does)?.ok_or(Failure::Unread);
    }
    let named: Vec<String> = found.iter().take(MOST_NAMED).map(|path| path.display().to_string()).collect();
    let more = match found.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!(", and {more} more, which tomcom list {} shows", path.display()),
    };
    let number = count(found.len() as u64, "recording", "recordings");
    Err(Failure::Wrong(miette::miette!(
        help = format!("one of the recordings {}{more}", named.join(", ")),
        "{}: found a folder with {number}, where one recording is meant",
        path.display()
    )))
}

/// The recordings of a participant in a folder of recordings, sorted by name.
pub(super) fn of_participant(folder: &Path, code: &str) -> Result<Vec<PathBuf>, Failure> {
    let mut codes = BTreeSet::new();
    let mut found = Vec::new();
    for recording in recordings::of_folder(folder)? {
        let own = LogReader::open(&recording)?.header.session.participant.code;
        if own == code {
            found.push(recording);
        }
        codes.insert(own);
    }
    if found.is_empty() {
        let near = person_code::did_you_mean(code, &codes);
        let codes: Vec<String> = codes.into_iter().take(MOST_NAMED).collect();
        return Err(Failure::Wrong(miette::miette!(
            help = format!("the code of a participant who is recorded there, such as {}", codes.join(", ")),
            "{}: found no recording of {code}{near}",
            folder.display()
        )));
    }
    Ok(found)
}
