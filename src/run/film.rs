//! Films beside recordings: the command `tomcom video attach`. Films are decoded by the program ffmpeg.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};

use sha2::{Digest, Sha256};

use tomcom_core::base::text::{PathText, count};
use tomcom_core::base::time::SessionTime;
use tomcom_session::Event;
use tomcom_session::files::file_error::{FileError, FileResult, open_regular};
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::log::video_file::{self, AttachedFilm, FilmAlignmentSource};
use tomcom_session::log::{LogEnding, LogReader, RecordingWriteError};
use tomcom_session::wall_display::DisplayEvent;
use tomcom_study::analysis::film_flashes::{AlignmentRefusal, FlashSearch, align};

/// Size to which frames are reduced, in pixels, whatever the film's shape: the square of the page is still a pixel wide if
/// the page fills a fifth of the film.
const SIZE: (usize, usize) = (320, 180);
/// Largest number of times that a message names.
const MOST_NAMED: usize = 8;
const BY_HAND: &str = "or say where it begins: --at 12.4 (the trial starts at 12.4 s of the film) or --offset";

/// Error of attaching a film.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum FilmError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    #[error("ffmpeg cannot be started: {0}")]
    #[diagnostic(help("install ffmpeg (Debian and Ubuntu: apt install ffmpeg), {BY_HAND}, which need no ffmpeg"))]
    NoDecoder(io::Error),
    #[error("{}: ffmpeg cannot decode it: {reason}", film.display())]
    #[diagnostic(help("a film that ffmpeg plays"))]
    Undecodable { film: PathBuf, reason: String },
    /// The flashes do not say how the film's time follows from session time.
    #[error("{}: found {found}", film.display())]
    #[diagnostic(help("{remedy}"))]
    NotAligned { film: PathBuf, found: String, remedy: String },
}

impl From<FileError> for FilmError {
    fn from(error: FileError) -> FilmError {
        FilmError::File(Box::new(error))
    }
}

/// How a film is to be aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmAlignmentRequest {
    /// By the flashes of the participant's page.
    Flashes,
    /// The session begins at this time in the film, in seconds.
    Offset(f64),
    /// The trial starts at this time in the film, in seconds.
    TrialStart(f64),
}

/// What of a log films are aligned with.
struct RecordedFlashes {
    folder: PathBuf,
    /// When the page drew its flashes, in seconds of session time.
    drawn_s: Vec<f64>,
    trial_start: Option<SessionTime>,
    is_shown: bool,
}

impl RecordedFlashes {
    fn read(recording: &Path) -> FileResult<RecordedFlashes> {
        let mut log = LogReader::open(recording)?;
        if log.ending() == LogEnding::Running {
            let found = "a recording that another program writes".to_string();
            return Err(FileError::from_finding(recording, found, "a recording whose session is over".to_string()));
        }
        let (mut drawn_s, mut trial_start) = (Vec::new(), None);
        while let Some(line) = log.next_line()? {
            match line.stamped.event {
                Event::TrialStarted => trial_start = Some(line.stamped.time),
                Event::Display(DisplayEvent::Drawn { at_ns, .. }) => drawn_s.push(at_ns.as_secs_f64()),
                _ => {}
            }
        }
        drawn_s.sort_by(f64::total_cmp);
        let is_shown = log.session().spec.display.flash;
        Ok(RecordedFlashes { folder: log.folder().to_path_buf(), drawn_s, trial_start, is_shown })
    }
}

/// Attaches films to a recording, and says so in `video.json` beside its log. `told` hears of each second of film that
/// was looked at.
///
/// # Errors
/// The recording or a film cannot be read, or a film does not fit; then no film is attached.
pub fn attach(
    recording: &Path,
    films: &[PathBuf],
    request: FilmAlignmentRequest,
    copies: bool,
    mut told: impl FnMut(),
) -> Result<Vec<AttachedFilm>, FilmError> {
    let recorded = RecordedFlashes::read(recording)?;
    let mut attached = video_file::read(&recorded.folder)?;
    let mut new = Vec::new();
    for film in films {
        new.push(aligned(&recorded, film, request, &mut told)?);
    }
    for (film, aligned) in films.iter().zip(&mut new) {
        if copies {
            aligned.file = PathText(copy(film, &recorded.folder)?);
        }
        attached.attach(aligned.clone());
    }
    video_file::write(&recorded.folder, &attached)?;
    Ok(new)
}

fn aligned(
    recorded: &RecordedFlashes,
    film: &Path,
    request: FilmAlignmentRequest,
    told: &mut impl FnMut(),
) -> Result<AttachedFilm, FilmError> {
    let unreadable = |reason| FileError::unreadable(film, reason, "the path of a film");
    let path = film.canonicalize().map_err(unreadable)?;
    let mut attached = AttachedFilm {
        file: PathText(within(&recorded.folder, &path)),
        sha256: digest(&path).map_err(unreadable)?,
        by: FilmAlignmentSource::Flashes,
        offset_s: 0.0,
        drift_ppm: 0.0,
        residual_ms: None,
        flashes: None,
        frame_ms: None,
        length_s: None,
    };
    match request {
        FilmAlignmentRequest::Flashes => {
            check_flashes(recorded, film)?;
            let search = search(&path, told)?;
            let found =
                align(&search, &recorded.drawn_s).map_err(|refusal| refused(film, recorded, &search, refusal))?;
            attached.offset_s = rounded(found.offset_s, 1e4);
            attached.drift_ppm = rounded(found.drift * 1e6, 10.0);
            attached.residual_ms = Some(rounded(found.residual_s * 1e3, 10.0));
            attached.flashes = Some(found.flashes as u64);
            attached.frame_ms = Some(rounded(search.frame_s() * 1e3, 100.0));
            attached.length_s = Some(rounded(search.span_s()[1] + search.frame_s(), 1e3));
        }
        FilmAlignmentRequest::Offset(offset_s) => {
            (attached.by, attached.offset_s) = (FilmAlignmentSource::Offset, offset_s);
        }
        FilmAlignmentRequest::TrialStart(film_s) => {
            let Some(start) = recorded.trial_start else {
                let found = "a recording without a trial, with --at".to_string();
                let remedy = "--offset with the time in the film at which the session begins".to_string();
                return Err(FileError::from_finding(&recorded.folder, found, remedy).into());
            };
            let offset_s = rounded(film_s - start.as_secs_f64(), 1e4);
            (attached.by, attached.offset_s) = (FilmAlignmentSource::TrialStart, offset_s);
        }
    }
    Ok(attached)
}

fn rounded(value: f64, by: f64) -> f64 {
    (value * by).round() / by
}

/// The name of a file in the folder, or the whole path.
fn within(folder: &Path, path: &Path) -> PathBuf {
    let is_inside = folder.canonicalize().is_ok_and(|folder| path.parent() == Some(&folder));
    path.file_name().filter(|_| is_inside).map_or_else(|| path.to_path_buf(), PathBuf::from)
}

/// SHA-256 of a file, in hexadecimal.
fn digest(path: &Path) -> io::Result<String> {
    let (mut file, mut digest) = (open_regular(path)?, Sha256::new());
    let mut bytes = vec![0; 1 << 16];
    loop {
        match file.read(&mut bytes)? {
            0 => return Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()),
            read => digest.update(&bytes[..read]),
        }
    }
}

/// Copies a film into the recording's folder; returns its name there.
fn copy(film: &Path, folder: &Path) -> FileResult<PathBuf> {
    let name = PathBuf::from(film.file_name().unwrap_or_default());
    let to = folder.join(&name);
    let unwritable = |reason| FileError::unwritable(&to, reason);
    let is_there = fs::symlink_metadata(&to).is_ok();
    if is_there {
        let is_same =
            |path: &Path| film.canonicalize().is_ok_and(|film| path.canonicalize().is_ok_and(|to| to == film));
        if is_same(&to) || digest(&to).ok().is_some_and(|there| digest(film).is_ok_and(|new| new == there)) {
            return Ok(name);
        }
        let found = "another file of this name beside the log".to_string();
        return Err(FileError::from_finding(&to, found, "a film with a name of its own: rename it".to_string()));
    }
    let write = || {
        let mut new = Replacement::begin(&to)?;
        io::copy(&mut File::open(film)?, &mut new)?;
        new.finish()
    };
    write().map_err(unwritable)?;
    Ok(name)
}

fn check_flashes(recorded: &RecordedFlashes, film: &Path) -> Result<(), FilmError> {
    let number = recorded.drawn_s.len();
    let found = match (recorded.is_shown, number) {
        (false, _) => "a recording whose page does not flash (flash = false)".to_string(),
        (true, 0) => "a recording without a flash of the participant's page".to_string(),
        (true, 1) => "a recording with a single flash of the participant's page: two are needed".to_string(),
        (true, _) => return Ok(()),
    };
    let remedy = format!("a recording with the page as display, {BY_HAND}");
    Err(FilmError::NotAligned { film: film.to_path_buf(), found, remedy })
}

/// What was seen in a film that is not aligned.
fn refused(film: &Path, recorded: &RecordedFlashes, search: &FlashSearch, refusal: AlignmentRefusal) -> FilmError {
    let [from, to] = search.span_s();
    let whole = format!("{} frames ({:.1} s)", search.frames(), to - from);
    let listed = |times: &[f64]| {
        let named: Vec<String> = times.iter().take(MOST_NAMED).map(|time| format!("{time:.2}")).collect();
        format!("{}{}", named.join(", "), if times.len() > MOST_NAMED { ", …" } else { "" })
    };
    let start = recorded.trial_start.map_or(0.0, SessionTime::as_secs_f64);
    let recorded_s: Vec<f64> = recorded.drawn_s.iter().map(|drawn| drawn - start).collect();
    let log = format!("{} flashes, at {} s of the trial", recorded_s.len(), listed(&recorded_s));
    let (found, remedy) = match refusal {
        AlignmentRefusal::NoFlash => (
            format!("no flash in {whole}; the log has {log}"),
            format!("a film with the page's square beside the tag at its lower right in view, {BY_HAND}"),
        ),
        AlignmentRefusal::FewFit { seen_s, fit } => (
            format!(
                "{} at {} s of the film, of which {fit} fit the log, in {whole}; the log has {log}",
                count(seen_s.len() as u64, "flash", "flashes"),
                listed(&seen_s)
            ),
            format!("the film of this trial, from its start to the second flash at least, {BY_HAND}"),
        ),
        AlignmentRefusal::Residual { residual_s, flashes } => (
            format!(
                "{flashes} flashes that fit the log only up to {:.0} ms, where a frame lasts {:.0} ms",
                residual_s * 1e3,
                search.frame_s() * 1e3
            ),
            format!("a film with the times of its frames as the camera took them, {BY_HAND}"),
        ),
    };
    FilmError::NotAligned { film: film.to_path_buf(), found, remedy }
}

/// Looks for flashes in a whole film.
fn search(film: &Path, told: &mut impl FnMut()) -> Result<FlashSearch, FilmError> {
    let mut search = FlashSearch::default();
    let mut second = f64::NEG_INFINITY;
    decode(film, |time_s, pixels| {
        search.take(time_s, pixels);
        if time_s >= second + 1.0 {
            second = time_s;
            told();
        }
    })?;
    Ok(search)
}

/// The program ffmpeg while it decodes; it ends with this value.
struct Decoder(Child);

impl Drop for Decoder {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Decodes the first picture track of a film into gray frames of [`SIZE`], with their times as players count them: from
/// the beginning of the film, in seconds.
fn decode(film: &Path, mut each: impl FnMut(f64, &[u8])) -> Result<(), FilmError> {
    let (width, height) = SIZE;
    // Frames get numbers as times after their own time was told, so that none is doubled or left out for a steady rate.
    let filter = format!("scale={width}:{height}:flags=area,format=gray,showinfo,settb=1/25,setpts=N");
    let mut input = std::ffi::OsString::from("file:");
    input.push(film);
    let mut command = Command::new("ffmpeg");
    command.args([
        "-nostdin",
        "-hide_banner",
        "-nostats",
        "-loglevel",
        "level+info",
        "-protocol_whitelist",
        "file,pipe",
    ]);
    command.arg("-i").arg(input).args(["-map", "0:v:0", "-vf", &filter, "-r", "25", "-f", "rawvideo", "pipe:1"]);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut decoder = Decoder(command.spawn().map_err(FilmError::NoDecoder)?);
    let undecodable = |reason: String| FilmError::Undecodable { film: film.to_path_buf(), reason };
    let (Some(mut frames), Some(log)) = (decoder.0.stdout.take(), decoder.0.stderr.take()) else {
        return Err(undecodable("its output cannot be read".to_string()));
    };
    let messages = messages(log);
    let mut pixels = vec![0; width * height];
    let mut faults = Vec::new();
    let mut number = 0;
    loop {
        match frames.read_exact(&mut pixels) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => break,
            Err(error) => return Err(undecodable(error.to_string())),
        }
        let time_s = loop {
            match messages.recv() {
                Ok(DecoderMessage::Frame(time_s)) => break time_s,
                Ok(DecoderMessage::Fault(fault)) => faults.push(fault),
                Err(_) => return Err(undecodable("a frame has no time".to_string())),
            }
        };
        if !time_s.is_finite() {
            return Err(undecodable("a frame has no time".to_string()));
        }
        each(time_s, &pixels);
        number += 1;
    }
    let status = decoder.0.wait().map_err(|error| undecodable(error.to_string()))?;
    faults.extend(messages.iter().filter_map(|message| match message {
        DecoderMessage::Fault(fault) => Some(fault),
        DecoderMessage::Frame(_) => None,
    }));
    if number == 0 || !status.success() {
        return Err(undecodable(faults.pop().unwrap_or_else(|| "there are no pictures in it".to_string())));
    }
    Ok(())
}

enum DecoderMessage {
    /// Time of the next frame, in seconds; NaN if it has none.
    Frame(f64),
    Fault(String),
}

/// Reads what ffmpeg says, on a thread of its own: both its outputs must be read for it to go on.
fn messages(log: impl Read + Send + 'static) -> Receiver<DecoderMessage> {
    let (send, receive) = mpsc::channel();
    std::thread::spawn(move || {
        for line in BufReader::new(log).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            let time = line.contains("showinfo").then(|| line.split("pts_time:").nth(1)).flatten();
            let fault = ["[error] ", "[fatal] "].iter().find_map(|mark| line.split(mark).nth(1));
            let message = match (time, fault) {
                (Some(time), _) => {
                    let time = time.split_whitespace().next().unwrap_or_default();
                    DecoderMessage::Frame(time.parse().unwrap_or(f64::NAN))
                }
                (None, Some(fault)) => DecoderMessage::Fault(fault.trim().to_string()),
                (None, None) => continue,
            };
            if send.send(message).is_err() {
                return;
            }
        }
    });
    receive
}
