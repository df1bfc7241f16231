//! Checks of the program that decodes and records films, and of the cameras, for `tomcom doctor`.

use std::process::Command;
use std::thread;
use std::time::Duration;

use tomcom_devices::ffmpeg;
use tomcom_devices::film_recorder::{FilmRecorder, FilmState};
use tomcom_session::film::{VideoSpec, ffmpeg_input, film_name};
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};

const STEP: Duration = Duration::from_millis(50);
/// Time in which ffmpeg ends the film of a check.
const ENDS_WITHIN: Duration = Duration::from_secs(2);

/// Whether ffmpeg is installed, which `tomcom video attach` runs, and films what these cameras see.
pub(super) fn checks(spec: Option<&VideoSpec>) -> Vec<PreflightCheck> {
    let told = Command::new("ffmpeg").arg("-version").output();
    let version = told.ok().filter(|told| told.status.success()).and_then(|told| {
        let text = String::from_utf8_lossy(&told.stdout).into_owned();
        text.split_whitespace().nth(2).map(|version| format!("ffmpeg {version}"))
    });
    let (verdict, limits) = match spec {
        Some(_) => (PreflightVerdict::Failed, "the trials cannot be filmed"),
        None => (PreflightVerdict::Warning, "tomcom video attach takes --at and --offset only"),
    };
    let Some(version) = version else {
        return vec![PreflightCheck::new("ffmpeg", verdict, format!("no ffmpeg in PATH: {limits}"), ffmpeg::REMEDY)];
    };
    let devices = spec.iter().flat_map(|spec| &spec.devices);
    let cameras = (1..).zip(devices).map(|(number, device)| camera(number, device));
    [PreflightCheck::ok("ffmpeg", version)].into_iter().chain(cameras).collect()
}

/// Films with a camera until a picture arrives.
fn camera(number: u32, device: &str) -> PreflightCheck {
    let name = format!("camera {number}");
    let failed = |found: String| {
        let remedy =
            "connect the camera, end other programs that use it, and see that ffmpeg is 5.1 or newer, with libx264";
        PreflightCheck::failed(&name, found, remedy)
    };
    let input = ffmpeg_input(device).unwrap_or_default();
    let started = tempfile::tempdir().and_then(|folder| {
        let recorder = FilmRecorder::start(&input, &folder.path().join(film_name(number)))?;
        Ok((folder, recorder))
    });
    let (_folder, recorder) = match started {
        Ok(started) => started,
        Err(error) => return failed(error.to_string()),
    };
    loop {
        match recorder.state() {
            FilmState::Opening => thread::sleep(STEP),
            FilmState::Filming(_) => break,
            FilmState::Silent(reason) | FilmState::Ended(reason) => return failed(reason),
        }
    }
    recorder.finish(ENDS_WITHIN);
    PreflightCheck::ok(&name, "pictures arrive")
}
