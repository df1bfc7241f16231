//! Check of the program that decodes films, for `tomcom doctor`.

use std::process::Command;

use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};

/// Whether ffmpeg is installed, which `tomcom video attach` runs.
pub(super) fn decoder() -> PreflightCheck {
    let told = Command::new("ffmpeg").arg("-version").output();
    let version = told.ok().filter(|told| told.status.success()).and_then(|told| {
        let text = String::from_utf8_lossy(&told.stdout).into_owned();
        text.split_whitespace().nth(2).map(|version| format!("ffmpeg {version}"))
    });
    match version {
        Some(version) => PreflightCheck::ok("ffmpeg", version),
        None => PreflightCheck::new(
            "ffmpeg",
            PreflightVerdict::Warning,
            "no ffmpeg in PATH: tomcom video attach takes --at and --offset only",
            "install ffmpeg (Debian and Ubuntu: apt install ffmpeg)",
        ),
    }
}
