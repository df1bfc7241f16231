//! The command `tomcom video`: films beside recordings.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::failure::Failure;
use super::list::chosen;
use super::output::{OutputFormat, print, progress};
use crate::run::film::{self, FilmAlignmentRequest, FilmError, FilmPlace};
use tomcom_core::base::text::count;
use tomcom_session::log::video_file::AttachedFilm;

/// Attaches films of the room to a recording.
#[derive(Debug, Args)]
#[command(flatten_help = true, after_help = "More: docs/video.md")]
pub(super) struct VideoArgs {
    #[command(subcommand)]
    command: VideoCommand,
}

#[derive(Debug, Subcommand)]
enum VideoCommand {
    Attach(AttachArgs),
}

/// Aligns films with a recording, and writes video.json beside its log.
///
/// The flashes of the participant's page are looked for in each film (decoded by the program ffmpeg), and give offset and
/// drift of the film's clock. A film that does not fit is refused. The film stays where it is. A film of Pupil Capture
/// (world.mp4 with world_timestamps.npy beside it) needs no flash, nor does one that the session recorded itself.
#[derive(Debug, Args)]
#[command(after_help = "Examples: tomcom video attach sessions/2026-03-14-P07-1 room.mp4 hands.mp4\n          \
                  tomcom video attach sessions/2026-03-14-P07-1 room.mp4 --at 12.4\nMore: docs/video.md")]
struct AttachArgs {
    /// The folder of a recording.
    recording: PathBuf,
    /// Films of its trial, one for each camera; by default those that the session recorded itself.
    #[arg(value_name = "FILM")]
    films: Vec<PathBuf>,
    /// Time in the film at which the trial starts, in seconds, where no flash is seen.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds, conflicts_with = "offset")]
    at: Option<f64>,
    /// Time in the film at which the session begins (time 0 of the log), in seconds; negative if the film begins later.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    offset: Option<f64>,
    /// Copy the films into the recording's folder.
    #[arg(long)]
    copy: bool,
    /// Attach copies in H.264 (MP4, at most 720 lines) in the recording's folder, for viewers that do not play the films. A
    /// film that is attached already keeps its alignment.
    #[arg(long, conflicts_with = "copy")]
    convert: bool,
    /// Output format.
    #[arg(long, value_enum, default_value = "text")]
    format: OutputFormat,
}

impl From<FilmError> for Failure {
    fn from(error: FilmError) -> Failure {
        match error {
            FilmError::File(error) => Failure::from(*error),
            FilmError::Recording(error) => Failure::from(error),
            error @ (FilmError::NoDecoder(_) | FilmError::NotConverted { .. }) => {
                Failure::Failed(miette::Report::new(error))
            }
            error @ (FilmError::Undecodable { .. } | FilmError::NotAligned { .. }) => {
                Failure::Wrong(miette::Report::new(error))
            }
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds: &f64| seconds.abs() < 1e6);
    number.ok_or_else(|| "seconds, such as 12.4".to_string())
}

/// JSON output of the command.
#[derive(Debug, Serialize)]
struct AttachSummary {
    films: Vec<AttachedFilm>,
}

pub(super) fn video(args: &VideoArgs) -> Result<(), Failure> {
    let VideoCommand::Attach(args) = &args.command;
    let request = match (args.offset, args.at) {
        (Some(offset_s), _) => FilmAlignmentRequest::Offset(offset_s),
        (None, Some(film_s)) => FilmAlignmentRequest::TrialStart(film_s),
        (None, None) => FilmAlignmentRequest::Flashes,
    };
    if request != FilmAlignmentRequest::Flashes && args.films.len() != 1 {
        let found = format!("one time by hand for {}", count(args.films.len() as u64, "film", "films"));
        let help = "a command for each film, since each camera began at a time of its own";
        return Err(Failure::Wrong(miette::miette!(help = help, "found {found}")));
    }
    let recording = chosen(&args.recording, "attach to it")?;
    let bar = progress(0, "seconds of film");
    let place = match (args.copy, args.convert) {
        (true, _) => FilmPlace::Copied,
        (false, true) => FilmPlace::Converted,
        (false, false) => FilmPlace::Stays,
    };
    let films = film::attach(&recording, &args.films, request, place, || {
        bar.inc_length(1);
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    let text: String = films.iter().map(|film| film::describe(film) + "\n").collect();
    print(args.format, &AttachSummary { films }, || text)
}
