//! Opening recordings in the Rerun viewer, with the messages about it.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use super::failure::Failure;
use super::output::{OutputFormat, print, progress, put};
use super::review::AskedLandmarks;
use crate::run::open_viewer::{
    OngoingRecording, RecordedLandmark, RerunReviewOutcome, RerunReviewRequest, RerunStreamFile, RerunViewerError,
    landmarks, length, review, running, save, unshown_films, until_asked_to_end,
};
use tomcom_core::base::text::PathText;
use tomcom_core::base::time::SessionTime;
use tomcom_session::replay::ReplayLandmark;

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

/// Landmarks of recordings as JSON.
#[derive(Serialize)]
struct LandmarkList {
    landmarks: Vec<LandmarkSummary>,
}

#[derive(Serialize)]
struct LandmarkSummary {
    recording: String,
    /// "error", "signal", "note" or "estimated false belief".
    kind: &'static str,
    /// On the trial's clock.
    from_s: f64,
    /// Null if it lasts to the end of the recording.
    until_s: Option<f64>,
    words: String,
    /// The same in fields, by kind.
    #[serde(flatten)]
    fields: Value,
}

/// Prints the landmarks that are asked for in these recordings, each as the command that opens the viewer there, with its end
/// and what happened as its comment, or all as JSON.
pub(super) fn list_landmarks(recordings: &[PathBuf], asked: AskedLandmarks) -> Result<(), Failure> {
    let kinds = [
        (asked.errors, ReplayLandmark::Error),
        (asked.signals, ReplayLandmark::Signal),
        (asked.signals, ReplayLandmark::Marker),
        (asked.beliefs, ReplayLandmark::FalseBelief),
    ];
    let kinds: Vec<ReplayLandmark> =
        kinds.into_iter().filter_map(|(is_asked, kind)| is_asked.then_some(kind)).collect();
    let mut all = Vec::new();
    for recording in recordings {
        let mut text = String::new();
        for RecordedLandmark { kind, from, until, words, fields } in landmarks(recording, &kinds)? {
            // A false belief can last as short as the estimate tells.
            if until.is_some_and(|until| until.secs_since(from) < asked.least) {
                continue;
            }
            if asked.format == OutputFormat::Json {
                let (recording, kind) = (recording.display().to_string(), kind.name());
                let (from_s, until_s) = (from.as_secs_f64(), until.map(SessionTime::as_secs_f64));
                all.push(LandmarkSummary { recording, kind, from_s, until_s, words, fields });
                continue;
            }
            // To the millisecond, as the viewer and exported annotations have it.
            let until = until.map_or_else(|| "the end".to_string(), SessionTime::with_ms);
            let command = format!("tomcom review {} --at {}", shell_word(recording), from.with_ms());
            text += &format!("{command}  # to {until}, {words}\n");
        }
        if asked.format == OutputFormat::Json {
            continue;
        }
        if text.is_empty() {
            let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
            text = format!("{}: no {}\n", recording.display(), names.join(", no "));
        }
        put(&text)?;
    }
    match asked.format {
        OutputFormat::Json => print(OutputFormat::Json, &LandmarkList { landmarks: all }, String::new),
        OutputFormat::Text => Ok(()),
    }
}

/// Opens recordings in the Rerun viewer at a time on the trial's clock, or writes their stream to a file. `web`: use a
/// browser even if a native viewer is installed.
pub(super) fn open(
    recordings: Vec<PathBuf>,
    save: Option<Option<PathBuf>>,
    web: bool,
    at: Option<SessionTime>,
) -> Result<(), Failure> {
    let at = match at {
        Some(at) => {
            let end = length(&recordings)?;
            if at.is_shown_after(end) {
                let help = format!("a time on the trial's clock, up to {end}");
                return Err(Failure::Wrong(miette::miette!(
                    help = help,
                    "found --at {at}, after the end: the recording is {end} long"
                )));
            }
            Some(at.min(end))
        }
        None => None,
    };
    for one in running(&recordings)? {
        put(&still_running(&one))?;
    }
    let is_beside_log = save == Some(None);
    for unshown in if is_beside_log { Vec::new() } else { unshown_films(&recordings)? } {
        put(&format!("not shown: {unshown}\n"))?;
    }
    if save.is_none() {
        put("preparing the recording for the viewer …\n")?;
    }
    let asked = RerunReviewRequest { recordings, save, web, at };
    let bar = progress(0, "events prepared");
    let outcome = review(&asked, &|done, all| {
        bar.set_length(all);
        bar.set_position(done);
    });
    bar.finish_and_clear();
    match outcome? {
        RerunReviewOutcome::Saved(file) => {
            let how = if file.made { "was made from the log" } else { "is there already" };
            put(&format!("{} {how}{}\n", file.path.display(), because(&file)))?;
        }
        RerunReviewOutcome::Opened(file) => {
            put(&format!("the viewer opens {}{}\n", file.path.display(), because(&file)))?;
        }
        RerunReviewOutcome::Served { file, because: why, viewer } => {
            let path = file.path.display();
            put(&format!(
                "the viewer shows {path}{}\n{why}: the Rerun viewer is served here, for a browser on this machine, \
                 until ctrl+c\n{}\n",
                because(&file),
                viewer.url
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
