//! A camera's film, recorded by the program ffmpeg in a process of its own.
//!
//! The film is MP4 in H.264, in fragments of a second, so that what was filmed can be played however the recording ends.
//! It has no sound. Each picture has the time at which the camera took it (by the driver's stamps, where the camera is one of
//! Video4Linux) or at which it arrived, on this computer's clock; the film begins with its first picture.

use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use super::child_process::ChildProcess;
use super::ffmpeg::{self, FfmpegMessage};
use crate::lock;

/// Time after which a camera without a new picture counts as lost; cameras take some seconds to open.
const SILENT: Duration = Duration::from_secs(5);
const OPENS_WITHIN: Duration = Duration::from_secs(15);
/// How old the first picture can be when ffmpeg tells its time; a time before that is of another clock.
const OLDEST_FIRST: Duration = Duration::from_secs(30);

/// State of a camera's recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FilmState {
    Opening,
    /// Pictures arrive; the first one was taken at this time.
    Filming(SystemTime),
    /// No picture arrives, in words.
    Silent(String),
    /// ffmpeg has ended, with its last words.
    Ended(String),
}

/// A film while it is recorded; its end ends ffmpeg.
#[derive(Debug)]
pub struct FilmRecorder {
    process: ChildProcess,
    started: Instant,
    heard: Arc<Mutex<Heard>>,
    /// ffmpeg leaves films as they are if it is asked again and again.
    is_asked: bool,
}

/// What ffmpeg has said.
#[derive(Debug, Default)]
struct Heard {
    first: Option<SystemTime>,
    last: Option<Instant>,
    fault: Option<String>,
    is_over: bool,
}

impl FilmRecorder {
    /// Starts to film what ffmpeg reads with these arguments.
    ///
    /// # Errors
    /// ffmpeg is not installed, or cannot be started.
    pub fn start(input: &[String], film: &Path) -> io::Result<FilmRecorder> {
        let mut command = ffmpeg::command();
        // Times are kept as they are until they are told, and then count from the first picture.
        let filter = format!("{},setpts=PTS-STARTPTS", ffmpeg::TELLS_TIMES);
        command.arg("-copyts").args(input).args(["-map", "0:v:0", "-an", "-vf", &filter]);
        // No picture is doubled or left out for a steady rate, and its time is not rounded to one.
        command.args(["-fps_mode", "passthrough", "-enc_time_base", "1:90000"]);
        command.args(["-c:v", "libx264", "-preset", "veryfast", "-tune", "zerolatency", "-crf", "23"]);
        command.args(["-pix_fmt", "yuv420p", "-force_key_frames", "expr:gte(t,n_forced)", "-flush_packets", "1"]);
        command.args(["-movflags", "+frag_keyframe+empty_moov+default_base_moof", "-f", "mp4", "-n"]);
        let mut out = std::ffi::OsString::from("file:");
        out.push(film);
        let mut process = ChildProcess::start(command.arg(out))?;
        process.yield_to_others(5);
        let heard = Arc::new(Mutex::new(Heard::default()));
        if let Some(log) = process.child().stderr.take() {
            let heard = heard.clone();
            thread::spawn(move || {
                ffmpeg::read_messages(log, |message| {
                    lock(&heard).take(message);
                    true
                });
                lock(&heard).is_over = true;
            });
        }
        Ok(FilmRecorder { process, started: Instant::now(), heard, is_asked: false })
    }

    pub fn state(&self) -> FilmState {
        let heard = lock(&self.heard);
        let silent = |limit: Duration| FilmState::Silent(format!("no picture for {} s", limit.as_secs()));
        match (heard.first, heard.last) {
            _ if heard.is_over => {
                FilmState::Ended(heard.fault.clone().unwrap_or_else(|| "ffmpeg ended without a word".to_string()))
            }
            (Some(_), Some(last)) if last.elapsed() > SILENT => silent(SILENT),
            (Some(first), _) => FilmState::Filming(first),
            (None, _) if self.started.elapsed() > OPENS_WITHIN => silent(OPENS_WITHIN),
            (None, _) => FilmState::Opening,
        }
    }

    /// Asks ffmpeg to end the film.
    pub fn ask_to_end(&mut self) {
        if !std::mem::replace(&mut self.is_asked, true) {
            self.process.ask_to_end();
        }
    }

    /// Waits until ffmpeg has closed the film, but no longer than this.
    pub fn finish(mut self, longest: Duration) {
        self.ask_to_end();
        self.process.ends_within(longest);
    }
}

impl Heard {
    fn take(&mut self, message: FfmpegMessage) {
        match message {
            FfmpegMessage::Frame(time_s) => {
                self.last = Some(Instant::now());
                if self.first.is_none() {
                    let now = SystemTime::now();
                    let since_1970 = Duration::try_from_secs_f64(time_s).ok();
                    let told = since_1970.and_then(|since| SystemTime::UNIX_EPOCH.checked_add(since));
                    let is_recent = |told: &SystemTime| now.duration_since(*told).is_ok_and(|age| age <= OLDEST_FIRST);
                    // Some drivers stamp by a clock of their own: then the first picture counts as taken when it arrives.
                    self.first = Some(told.filter(is_recent).unwrap_or(now));
                }
            }
            FfmpegMessage::Fault(words) => self.fault = Some(words),
        }
    }
}
