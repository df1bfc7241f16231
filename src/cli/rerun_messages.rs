//! Opening recordings in the Rerun viewer, with the messages about it.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::output::put;
use crate::run::open_viewer::{
    OngoingRecording, RerunReviewOutcome, RerunReviewRequest, RerunStreamFile, RerunViewerError, landmarks, review,
    running, save, unshown_films, until_asked_to_end,
};
use tomcom_core::base::text::PathText;
use tomcom_core::base::time::SessionTime;
use tomcom_devices::scene::moment_on_clock;

impl From<RerunViewerError> for Failure {
    fn from(error: RerunViewerError) -> Failure {
        match error {
            RerunViewerError::File(error) => Failure::from(error),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

/// Writes Rerun streams of these recordings beside their logs.
pub(super) fn save_all(recordings: &[PathText]) -> Result<(), Failure> {
    for recording in recordings {
        save(recording)?;
    }
    Ok(())
}

/// Prints the errors, signals and false beliefs of these recordings, each as the command that opens the viewer there, with
/// what happened as its comment.
pub(super) fn list_landmarks(recordings: &[PathBuf]) -> Result<(), Failure> {
    for recording in recordings {
        let mut text = String::new();
        for (at, words) in landmarks(recording)? {
            text += &format!("tomcom review {} --at {}  # {words}\n", shell_word(recording), moment_on_clock(at));
        }
        if text.is_empty() {
            text = format!("{}: no error, signal or false belief\n", recording.display());
        }
        put(&text)?;
    }
    Ok(())
}

/// Opens recordings in the Rerun viewer at a time on the trial's clock, or writes their stream to a file. `web`: use a
/// browser even if a native viewer is installed.
pub(super) fn open(
    recordings: Vec<PathBuf>,
    save: Option<Option<PathBuf>>,
    web: bool,
    at: Option<SessionTime>,
) -> Result<(), Failure> {
    for one in running(&recordings)? {
        put(&still_running(&one))?;
    }
    let is_beside_log = save == Some(None);
    for unshown in if is_beside_log { Vec::new() } else { unshown_films(&recordings)? } {
        put(&format!("not shown: {unshown}\n"))?;
    }
    let asked = RerunReviewRequest { recordings, save, web, at };
    match review(&asked)? {
        RerunReviewOutcome::Saved(file) => {
            let how = if file.made { "was made from the log" } else { "is there already" };
            put(&format!("{} {how}{}\n", file.path.display(), because(&file)))?;
        }
        RerunReviewOutcome::Opened(file) => {
            put(&format!("the viewer opens {}{}\n", file.path.display(), because(&file)))?;
        }
        RerunReviewOutcome::Served { url, because, _serving } => {
            put(&format!(
                "{because}: the Rerun viewer is served here, for a browser on this machine, until ctrl+c\n{url}\n"
            ))?;
            until_asked_to_end()?;
        }
    }
    Ok(())
}

/// A path as one word of a shell's command.
fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |sign: char| sign.is_alphanumeric() || "/._-".contains(sign);
    if path.chars().all(is_plain) { path } else { format!("'{}'", path.replace('\'', r"'\''")) }
}

/// Why an existing stream file was rebuilt, in words.
fn because(file: &RerunStreamFile) -> String {
    file.because.map_or(String::new(), |because| format!(", and was made anew, since {because}"))
}

fn still_running(one: &OngoingRecording) -> String {
    let live = one.viewers.as_ref().map_or(String::new(), |viewers| format!("; to watch it live: rerun {viewers}"));
    format!("{}: this session is still running, and its recording is shown up to now{live}\n", one.recording.display())
}
