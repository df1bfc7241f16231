//! Films of a live session: each camera of the settings is recorded by a process of its own, from the start of the trial
//! until a moment after its end.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use crate::console::console_model::FilmStatus;
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_devices::ffmpeg;
use tomcom_devices::film_recorder::{FilmRecorder, FilmState};
use tomcom_session::film::{FilmEvent, VideoSpec, device_path, ffmpeg_input, film_name};
use tomcom_session::preflight_checks::PreflightCheck;
use tomcom_session::{Event, Session, TrialPhase};

/// Time for which the cameras film on after the trial's end, so that the page's last flash is on the film.
const AFTER_TRIAL: Duration = Duration::from_secs(1);

/// The films of one recording.
#[derive(Debug, Default)]
pub(super) struct Filming {
    /// `None`: nothing is filmed in this session.
    spec: Option<VideoSpec>,
    /// Whether the trial can be filmed, as was found before it.
    check: Option<PreflightCheck>,
    folder: PathBuf,
    cameras: Vec<FilmingCamera>,
    /// When the films end, once the trial has.
    ends: Option<Instant>,
    is_over: bool,
}

#[derive(Debug)]
struct FilmingCamera {
    number: u32,
    /// `None` once its process has ended.
    recorder: Option<FilmRecorder>,
    has_begun: bool,
    is_lost: bool,
}

impl Filming {
    /// The films of a recording in this folder. A trial that goes on after a cut is filmed from now on.
    pub fn at(session: &Session, folder: &Path) -> (Filming, Vec<FilmEvent>) {
        let mut filming =
            Filming { spec: session.spec.video.clone(), folder: folder.to_path_buf(), ..Filming::default() };
        filming.examine();
        let goes_on = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
        let lost = if goes_on { filming.begin() } else { Vec::new() };
        (filming, lost)
    }

    /// Looks whether ffmpeg and the cameras are there.
    pub fn examine(&mut self) {
        self.check = self.spec.as_ref().map(check);
    }

    /// Follows the trial; returns the cameras that cannot film.
    pub fn tell(&mut self, event: &Event) -> Vec<FilmEvent> {
        match event {
            Event::TrialStarted => return self.begin(),
            Event::TrialEnded { .. } | Event::TrialAborted { .. } => self.ends = Some(Instant::now() + AFTER_TRIAL),
            _ => {}
        }
        Vec::new()
    }

    fn begin(&mut self) -> Vec<FilmEvent> {
        let devices = self.spec.iter().flat_map(|spec| &spec.devices);
        let mut lost = Vec::new();
        for (number, device) in (1..).zip(devices) {
            let input = ffmpeg_input(device).unwrap_or_default();
            let recorder = FilmRecorder::start(&input, &self.folder.join(film_name(number)));
            if let Err(error) = &recorder {
                lost.push(FilmEvent::Lost { camera: number, reason: format!("ffmpeg cannot be started: {error}") });
            }
            let is_lost = recorder.is_err();
            self.cameras.push(FilmingCamera { number, recorder: recorder.ok(), has_begun: false, is_lost });
        }
        lost
    }

    /// What has happened to the films since this was last asked.
    pub fn news(&mut self, now: SessionTime) -> Vec<FilmEvent> {
        if self.ends.is_some_and(|ends| ends <= Instant::now()) {
            self.is_over = true;
            self.cameras.iter_mut().filter_map(|camera| camera.recorder.as_mut()).for_each(FilmRecorder::ask_to_end);
        }
        // What ends after the trial is not lost.
        if self.is_over {
            return Vec::new();
        }
        self.cameras.iter_mut().flat_map(|camera| camera.news(now)).collect()
    }

    /// How the cameras do; `None` in a session without any.
    pub fn status(&self) -> Option<FilmStatus> {
        let spec = self.spec.as_ref()?;
        let films = |camera: &&FilmingCamera| camera.has_begun && !camera.is_lost;
        Some(FilmStatus {
            check: self.check.clone()?,
            cameras: spec.devices.len(),
            filming: self.cameras.iter().filter(films).count(),
            lost: self.cameras.iter().filter(|camera| camera.is_lost).count(),
            is_on: !self.cameras.is_empty() && !self.is_over,
        })
    }

    /// The films that are still recorded, when the recording is left; `None` if nothing was filmed.
    pub fn leave(&mut self) -> Option<Vec<FilmRecorder>> {
        let cameras = std::mem::take(&mut self.cameras);
        let has_films = cameras.iter().any(|camera| camera.has_begun || camera.recorder.is_some());
        has_films.then(|| cameras.into_iter().filter_map(|camera| camera.recorder).collect())
    }
}

impl FilmingCamera {
    fn news(&mut self, now: SessionTime) -> Vec<FilmEvent> {
        let Some(recorder) = &self.recorder else { return Vec::new() };
        let camera = self.number;
        let state = recorder.state();
        let mut events = Vec::new();
        let mut lose = |reason: String, is_lost: &mut bool| {
            if !std::mem::replace(is_lost, true) {
                events.push(FilmEvent::Lost { camera, reason });
            }
        };
        match state {
            FilmState::Opening => {}
            FilmState::Silent(reason) => lose(reason, &mut self.is_lost),
            FilmState::Ended(reason) => {
                lose(reason, &mut self.is_lost);
                self.recorder = None;
            }
            FilmState::Filming(first) => {
                let is_back = std::mem::take(&mut self.is_lost) && self.has_begun;
                if !std::mem::replace(&mut self.has_begun, true) {
                    let age = SystemTime::now().duration_since(first).unwrap_or_default();
                    let began_ns = now - SessionTime::from_secs_f64(age.as_secs_f64());
                    events.push(FilmEvent::Began { camera, file: film_name(camera), began_ns });
                } else if is_back {
                    events.push(FilmEvent::Back { camera });
                }
            }
        }
        events
    }
}

/// Whether the trial can be filmed, as far as that is known before.
fn check(spec: &VideoSpec) -> PreflightCheck {
    let failed = |found: String, remedy: &str| {
        PreflightCheck::failed("film", found, format!("{remedy}; or start without a film"))
    };
    let paths = spec.devices.iter().filter_map(|device| device_path(device));
    match paths.into_iter().find(|path| !Path::new(path).exists()) {
        _ if !ffmpeg::is_installed() => failed("no ffmpeg in PATH: nothing is filmed".to_string(), ffmpeg::REMEDY),
        Some(path) => failed(format!("there is no camera {path}"), "connect the camera"),
        None => PreflightCheck::ok("film", count(spec.devices.len() as u64, "camera", "cameras") + " film the trial"),
    }
}
