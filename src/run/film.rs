//! Films beside recordings: the command `tomcom video attach`. Films are decoded and converted by the program ffmpeg.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::mpsc;

use sha2::{Digest, Sha256};

use tomcom_core::base::text::{PathText, count};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_devices::child_process::ChildProcess;
use tomcom_devices::ffmpeg::{self, FfmpegMessage};
use tomcom_session::Event;
use tomcom_session::files::file_error::{FileError, FileResult, open_regular};
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::film::{FilmEvent, is_recorded_film};
use tomcom_session::log::video_file::{self, AttachedFilm, FilmAlignmentSource};
use tomcom_session::log::{LogEnding, LogReader, RecordingWriteError};
use tomcom_session::settings::GazeSource;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_study::analysis::film_clock::{self, ClockPair};
use tomcom_study::analysis::film_flashes::{AlignmentRefusal, FilmAlignment, FlashSearch, align};
use tomcom_study::files::pupil_timestamps;

/// Size to which frames are reduced, in pixels, whatever the film's shape: the square of the page is still a pixel wide if
/// the page fills a fifth of the film.
const SIZE: (usize, usize) = (320, 180);
/// Largest number of times that a message names.
const MOST_NAMED: usize = 8;
/// How far the flashes of a film that this program recorded may be from its own times, in seconds: others are not the page's.
const NEAR_S: f64 = 0.5;
/// Largest height of a converted film, in pixels.
const CONVERTED_HEIGHT: u32 = 720;
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
    #[diagnostic(help("{}, {BY_HAND}, which need no ffmpeg", ffmpeg::REMEDY))]
    NoDecoder(io::Error),
    #[error("{}: ffmpeg cannot decode it: {reason}", film.display())]
    #[diagnostic(help("a film that ffmpeg plays"))]
    Undecodable { film: PathBuf, reason: String },
    #[error("{}: ffmpeg cannot make a copy in H.264: {reason}", film.display())]
    #[diagnostic(help("an ffmpeg with libx264, as that of Debian, and space for the copy beside the log"))]
    NotConverted { film: PathBuf, reason: String },
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

/// Where an attached film is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmPlace {
    Stays,
    /// In the recording's folder.
    Copied,
    /// As a copy in H.264 there, which all viewers play.
    Converted,
}

/// How a film is to be aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilmAlignmentRequest {
    /// By what film and log have: Pupil's clock, the flashes of the participant's page, or the times of the recorder.
    Flashes,
    /// The session begins at this time in the film, in seconds.
    Offset(f64),
    /// The trial starts at this time in the film, in seconds.
    TrialStart(f64),
}

/// What of a log films are aligned with.
struct RecordedTimes {
    folder: PathBuf,
    /// Films that the program recorded, by their names in the folder, with when they began.
    began: Vec<(String, SessionTime)>,
    /// Samples of gaze with times on the clocks of Pupil Capture and of the session.
    gaze: Vec<ClockPair>,
    /// When the page drew its flashes, in seconds of session time.
    drawn_s: Vec<f64>,
    trial_start: Option<SessionTime>,
    /// Where the trial ends; without an end of it, the recording does.
    end: SessionTime,
    is_shown: bool,
}

impl RecordedTimes {
    fn read(recording: &Path) -> FileResult<RecordedTimes> {
        let mut log = LogReader::open(recording)?;
        if log.ending() == LogEnding::Running {
            let found = "a recording that another program writes".to_string();
            return Err(FileError::from_finding(recording, found, "a recording whose session is over".to_string()));
        }
        let (mut drawn_s, mut trial_start) = (Vec::new(), None);
        let (mut trial_end, mut last) = (None, SessionTime::ZERO);
        let (mut began, mut gaze) = (Vec::new(), Vec::new());
        let is_pupil = log.session().spec.participant.gaze == GazeSource::Pupil;
        while let Some(line) = log.next_line()? {
            last = line.stamped.time;
            match line.stamped.event {
                Event::TrialStarted => trial_start = Some(last),
                Event::TrialEnded { .. } | Event::TrialAborted { .. } => trial_end = Some(last),
                Event::Display(DisplayEvent::Drawn { at_ns, .. }) => drawn_s.push(at_ns.as_secs_f64()),
                Event::Film(FilmEvent::Began { file, began_ns, .. }) => began.push((file, began_ns)),
                Event::Gaze(GazeSample { device_ns: Some(device_ns), taken_ns: Some(taken), .. }) if is_pupil => {
                    gaze.push(ClockPair { device_s: device_ns as f64 / 1e9, session_s: taken.as_secs_f64() });
                }
                _ => {}
            }
        }
        drawn_s.sort_by(f64::total_cmp);
        let is_shown = log.session().spec.display.flash;
        let (folder, end) = (log.folder().to_path_buf(), trial_end.unwrap_or(last));
        Ok(RecordedTimes { folder, began, gaze, drawn_s, trial_start, end, is_shown })
    }

    /// The films in the folder that the program recorded; of a recording in parts, those of the last part.
    fn own(&self) -> Vec<PathBuf> {
        let names = self.began.iter().map(|(name, _)| name.as_str());
        let mut names: Vec<&str> = names.filter(|name| is_recorded_film(name)).collect();
        names.sort_unstable();
        names.dedup();
        names.iter().map(|name| self.folder.join(name)).filter(|film| film.is_file()).collect()
    }

    /// When a film began that the program recorded, at this path.
    fn began(&self, path: &Path) -> Option<SessionTime> {
        let name = within(&self.folder, path);
        let is_it = |(file, _): &&(String, SessionTime)| is_recorded_film(file) && name == Path::new(file);
        self.began.iter().rfind(is_it).map(|(_, began)| *began)
    }
}

/// Attaches films to a recording, and says so in `video.json` beside its log; without films, those that the program
/// recorded. `told` hears of each second of film that was looked at.
///
/// # Errors
/// The recording or a film cannot be read, or a film does not fit; then no film is attached. Or a film cannot be copied;
/// then those before it are attached.
pub fn attach(
    recording: &Path,
    films: &[PathBuf],
    request: FilmAlignmentRequest,
    place: FilmPlace,
    mut told: impl FnMut(),
) -> Result<Vec<AttachedFilm>, FilmError> {
    let recorded = RecordedTimes::read(recording)?;
    let own = recorded.own();
    let films = if films.is_empty() { &own[..] } else { films };
    if films.is_empty() {
        let found = "a recording without films of its own".to_string();
        return Err(FileError::from_finding(recording, found, "the films, as further arguments".to_string()).into());
    }
    let mut attached = video_file::read(&recorded.folder)?;
    let mut new = Vec::new();
    for film in films {
        let known = attached.films.iter().find(|old| is_same(&old.path(&recorded.folder), film));
        new.push(match known.filter(|_| place == FilmPlace::Converted && request == FilmAlignmentRequest::Flashes) {
            // To convert a film is no reason to align it in another way.
            Some(known) => known.clone(),
            None => aligned(&recorded, film, request, &mut told)?,
        });
    }
    for (film, aligned) in films.iter().zip(&mut new) {
        let original = aligned.file.clone();
        match place {
            FilmPlace::Stays => {}
            FilmPlace::Copied => {
                aligned.file = PathText(copy(film, &recorded.folder)?);
                aligned.copies_of.extend(Some(original).filter(|original| *original != aligned.file));
            }
            FilmPlace::Converted => {
                let (name, later_s) = convert(film, &recorded.folder)?;
                aligned.copies_of.push(original);
                let path = recorded.folder.join(&name);
                aligned.sha256 =
                    digest(&path).map_err(|reason| FileError::unreadable(&path, reason, "the new film"))?;
                aligned.offset_s = rounded(aligned.offset_s + later_s, 1e4);
                aligned.file = PathText(name);
                attached.films.retain(|old| !is_same(&old.path(&recorded.folder), film));
            }
        }
        attached.attach(aligned.clone());
        video_file::write(&recorded.folder, &attached)?;
    }
    Ok(new)
}

fn aligned(
    recorded: &RecordedTimes,
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
        copies_of: Vec::new(),
    };
    match request {
        FilmAlignmentRequest::Flashes => {
            if let Some(stamps) = pupil_timestamps::beside(&path) {
                align_by_pupil(&mut attached, recorded, film, &pupil_timestamps::read(&stamps)?, told)?;
            } else if let Some(began) = recorded.began(&path) {
                align_recorded(&mut attached, recorded, &path, began, told);
            } else {
                check_flashes(recorded, film)?;
                let search = search(&path, told)?;
                let found =
                    align(&search, &recorded.drawn_s).map_err(|refusal| refused(film, recorded, &search, refusal))?;
                set_by_flashes(&mut attached, &found);
                set_length(&mut attached, search.span_s()[1], search.frame_s());
            }
        }
        FilmAlignmentRequest::Offset(offset_s) => {
            (attached.by, attached.offset_s) = (FilmAlignmentSource::Offset, offset_s);
            check_by_hand(&mut attached, recorded, film, &path)?;
        }
        FilmAlignmentRequest::TrialStart(film_s) => {
            let Some(start) = recorded.trial_start else {
                let found = "a recording without a trial, with --at".to_string();
                let remedy = "--offset with the time in the film at which the session begins".to_string();
                return Err(FileError::from_finding(&recorded.folder, found, remedy).into());
            };
            let offset_s = rounded(film_s - start.as_secs_f64(), 1e4);
            (attached.by, attached.offset_s) = (FilmAlignmentSource::TrialStart, offset_s);
            check_by_hand(&mut attached, recorded, film, &path)?;
        }
    }
    Ok(attached)
}

/// Refuses a time by hand that puts nothing of the trial into the film, as far as the film tells its length.
fn check_by_hand(
    attached: &mut AttachedFilm,
    recorded: &RecordedTimes,
    film: &Path,
    path: &Path,
) -> Result<(), FilmError> {
    let Some(length_s) = ffmpeg::length_s(&address(path)) else { return Ok(()) };
    attached.length_s = Some(length_s);
    let [start_s, end_s] = [recorded.trial_start.unwrap_or_default(), recorded.end].map(|time| attached.film_s(time));
    if start_s < length_s && end_s > 0.0 {
        return Ok(());
    }
    let found = format!(
        "a film of {length_s:.1} s, and a trial from {start_s:.1} s to {end_s:.1} s of it: nothing of the trial is in the film"
    );
    let remedy =
        "--at with the time in the film at which the trial starts, or --offset with that at which the session begins";
    Err(FilmError::NotAligned { film: film.to_path_buf(), found, remedy: remedy.to_string() })
}

fn set_clock(attached: &mut AttachedFilm, by: FilmAlignmentSource, offset_s: f64, drift: f64, residual_s: f64) {
    (attached.by, attached.offset_s) = (by, rounded(offset_s, 1e4));
    attached.drift_ppm = rounded(drift * 1e6, 10.0);
    attached.residual_ms = Some(rounded(residual_s * 1e3, 10.0));
}

fn set_by_flashes(attached: &mut AttachedFilm, found: &FilmAlignment) {
    set_clock(attached, FilmAlignmentSource::Flashes, found.offset_s, found.drift, found.residual_s);
    attached.flashes = Some(found.flashes as u64);
}

fn set_length(attached: &mut AttachedFilm, last_s: f64, frame_s: f64) {
    attached.frame_ms = Some(rounded(frame_s * 1e3, 100.0));
    attached.length_s = Some(rounded(last_s + frame_s, 1e3));
}

/// Aligns a film that the program recorded: by flashes, where the page is in the picture, else by the time at which it began.
fn align_recorded(
    attached: &mut AttachedFilm,
    recorded: &RecordedTimes,
    path: &Path,
    began: SessionTime,
    told: &mut impl FnMut(),
) {
    (attached.by, attached.offset_s) = (FilmAlignmentSource::Recorded, rounded(-began.as_secs_f64(), 1e4));
    // A film that was cut off before its first second has no picture.
    let Ok(search) = search(path, told) else { return };
    set_length(attached, search.span_s()[1], search.frame_s());
    let found = if recorded.drawn_s.len() < 2 { None } else { align(&search, &recorded.drawn_s).ok() };
    if let Some(found) = found.filter(|found| (found.offset_s + began.as_secs_f64()).abs() < NEAR_S) {
        set_by_flashes(attached, &found);
    }
}

/// Aligns a film that Pupil Capture recorded, by the time of each of its pictures and of each gaze sample on Capture's clock.
fn align_by_pupil(
    attached: &mut AttachedFilm,
    recorded: &RecordedTimes,
    film: &Path,
    stamps_s: &[f64],
    told: &mut impl FnMut(),
) -> Result<(), FilmError> {
    let mut times_s = Vec::new();
    decode(&film.canonicalize().unwrap_or_else(|_| film.to_path_buf()), None, |time_s, _| {
        times_s.push(time_s);
        if times_s.len() % 30 == 0 {
            told();
        }
    })?;
    let found = film_clock::align(&times_s, stamps_s, &recorded.gaze).map_err(|refusal| FilmError::NotAligned {
        film: film.to_path_buf(),
        found: refusal.to_string(),
        remedy: format!("the film of this trial with its time stamps, as Capture recorded them, {BY_HAND}"),
    })?;
    set_clock(attached, FilmAlignmentSource::PupilClock, found.offset_s, found.drift, found.residual_s);
    set_length(attached, times_s.last().copied().unwrap_or(0.0), found.frame_s);
    Ok(())
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

/// Whether two paths lead to the same file.
fn is_same(one: &Path, other: &Path) -> bool {
    one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}

/// Makes a copy of a film in H.264 in the recording's folder; returns its name there, and by how much later its pictures
/// are than in the film, in seconds.
fn convert(film: &Path, folder: &Path) -> Result<(PathBuf, f64), FilmError> {
    let mut name = film.file_stem().unwrap_or_default().to_os_string();
    name.push("-h264.mp4");
    let name = PathBuf::from(name);
    let to = folder.join(&name);
    if fs::symlink_metadata(&to).is_ok() {
        let found = "a file of this name beside the log, where the copy in H.264 would be".to_string();
        let remedy = "attach that file, if it is the copy; or a film with a name of its own: rename it".to_string();
        return Err(FileError::from_finding(&to, found, remedy).into());
    }
    let not_converted = |reason: String| FilmError::NotConverted { film: film.to_path_buf(), reason };
    let new = tempfile::Builder::new().prefix(".film-").suffix(".tmp").tempfile_in(folder);
    let new = new.map_err(|reason| FileError::unwritable(&to, reason))?;
    let mut command = ffmpeg::command();
    let filter = format!("scale=-2:'trunc(min({CONVERTED_HEIGHT},ih)/2)*2'");
    command.args(["-protocol_whitelist", "file,pipe", "-i"]).arg(address(film));
    command.args(["-map", "0:v:0", "-map", "0:a:0?", "-vf", &filter, "-fps_mode", "passthrough"]);
    command.args(["-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p", "-c:a", "aac"]);
    command.args(["-movflags", "+faststart", "-f", "mp4", "-y"]).arg(address(new.path()));
    let mut process = ChildProcess::start(&mut command).map_err(FilmError::NoDecoder)?;
    process.yield_to_others(10);
    let mut fault = None;
    if let Some(log) = process.child().stderr.take() {
        ffmpeg::read_messages(log, |message| {
            if let FfmpegMessage::Fault(words) = message {
                fault = Some(words);
            }
            true
        });
    }
    let status = process.child().wait().map_err(|error| not_converted(error.to_string()))?;
    if !status.success() {
        return Err(not_converted(fault.unwrap_or_else(|| "it ended without a word".to_string())));
    }
    let later_s = first_picture_s(new.path())? - first_picture_s(film)?;
    new.persist_noclobber(&to).map_err(|error| FileError::unwritable(&to, error.error))?;
    Ok((name, later_s))
}

/// When a film has its first picture, in seconds.
fn first_picture_s(film: &Path) -> Result<f64, FilmError> {
    let mut first = None;
    decode(film, Some(1), |time_s, _| first = first.or(Some(time_s)))?;
    let reason = "there are no pictures in it".to_string();
    first.ok_or_else(|| FilmError::Undecodable { film: film.to_path_buf(), reason })
}

/// A film's path, as ffmpeg takes it for nothing else.
fn address(film: &Path) -> std::ffi::OsString {
    let mut address = std::ffi::OsString::from("file:");
    address.push(film);
    address
}

/// What an attached film was aligned by, in words.
pub fn describe(film: &AttachedFilm) -> String {
    let AttachedFilm { file, offset_s, drift_ppm, .. } = film;
    let begins = format!("{file}: the session begins at {offset_s:.3} s of the film");
    let residual_ms = film.residual_ms.unwrap_or_default();
    match film.by {
        FilmAlignmentSource::Flashes => {
            let flashes = film.flashes.unwrap_or_default();
            format!("{begins}, drift {drift_ppm:.0} ppm; {flashes} flashes fit to {residual_ms:.0} ms")
        }
        FilmAlignmentSource::PupilClock => {
            format!("{begins}, drift {drift_ppm:.0} ppm, by Pupil's clock, which fits to {residual_ms:.0} ms")
        }
        FilmAlignmentSource::Recorded => format!("{begins}, by when it was recorded"),
        FilmAlignmentSource::Offset | FilmAlignmentSource::TrialStart => format!("{begins}, as given"),
    }
}

/// Copies a film into the recording's folder; returns its name there.
fn copy(film: &Path, folder: &Path) -> FileResult<PathBuf> {
    let name = PathBuf::from(film.file_name().unwrap_or_default());
    let to = folder.join(&name);
    if fs::symlink_metadata(&to).is_ok() {
        if is_same(film, &to) || digest(&to).ok().is_some_and(|there| digest(film).is_ok_and(|new| new == there)) {
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
    write().map_err(|reason| FileError::unwritable(&to, reason))?;
    Ok(name)
}

fn check_flashes(recorded: &RecordedTimes, film: &Path) -> Result<(), FilmError> {
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
fn refused(film: &Path, recorded: &RecordedTimes, search: &FlashSearch, refusal: AlignmentRefusal) -> FilmError {
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
    decode(film, None, |time_s, pixels| {
        search.take(time_s, pixels);
        if time_s >= second + 1.0 {
            second = time_s;
            told();
        }
    })?;
    Ok(search)
}

/// Decodes the first picture track of a film into gray frames of [`SIZE`], with their times as players count them: from
/// the beginning of the film, in seconds. `most`: number of the first frames to decode; `None` for all.
fn decode(film: &Path, most: Option<u32>, mut each: impl FnMut(f64, &[u8])) -> Result<(), FilmError> {
    let (width, height) = SIZE;
    // Frames get numbers as times after their own time was told, so that none is doubled or left out for a steady rate.
    let times = ffmpeg::TELLS_TIMES;
    let filter = format!("scale={width}:{height}:flags=area,format=gray,{times},settb=1/25,setpts=N");
    let mut command = ffmpeg::command();
    command.args(["-protocol_whitelist", "file,pipe", "-i"]).arg(address(film)).args(["-map", "0:v:0", "-vf", &filter]);
    if let Some(most) = most {
        command.args(["-frames:v", &most.to_string()]);
    }
    command.args(["-r", "25", "-f", "rawvideo", "pipe:1"]).stdout(Stdio::piped());
    let mut process = ChildProcess::start(&mut command).map_err(FilmError::NoDecoder)?;
    process.yield_to_others(10);
    let undecodable = |reason: String| FilmError::Undecodable { film: film.to_path_buf(), reason };
    let (Some(mut frames), Some(log)) = (process.child().stdout.take(), process.child().stderr.take()) else {
        return Err(undecodable("its output cannot be read".to_string()));
    };
    // Both outputs must be read for ffmpeg to go on.
    let (send, messages) = mpsc::channel();
    std::thread::spawn(move || ffmpeg::read_messages(log, |message| send.send(message).is_ok()));
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
                Ok(FfmpegMessage::Frame(time_s)) => break time_s,
                Ok(FfmpegMessage::Fault(fault)) => faults.push(fault),
                Err(_) => return Err(undecodable("a frame has no time".to_string())),
            }
        };
        if !time_s.is_finite() {
            return Err(undecodable("a frame has no time".to_string()));
        }
        each(time_s, &pixels);
        number += 1;
    }
    let status = process.child().wait().map_err(|error| undecodable(error.to_string()))?;
    faults.extend(messages.iter().filter_map(|message| match message {
        FfmpegMessage::Fault(fault) => Some(fault),
        FfmpegMessage::Frame(_) => None,
    }));
    if number == 0 || !status.success() {
        return Err(undecodable(faults.pop().unwrap_or_else(|| "there are no pictures in it".to_string())));
    }
    Ok(())
}
