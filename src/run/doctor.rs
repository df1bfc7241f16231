//! The command `tomcom doctor`: checks what the program, and a session, need of the computer: terminal, a folder for
//! recordings, clocks, ports, trackers. Every finding names a remedy.

mod devices;
pub mod fault_report;
mod films;

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crossterm::style::available_color_count;
use crossterm::terminal::{disable_raw_mode, enable_raw_mode, size, supports_keyboard_enhancement};
use serde::Serialize;

use super::ask::ask;
use super::terminal::theme;
use crate::console::text_columns::beside;
use crate::console::view::theme::TerminalBackground;
use tomcom_session::SessionSpec;
use tomcom_session::features::Feature;
use tomcom_session::files::{SessionSetup, WallTime};
use tomcom_session::log::RecordingLock;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, space};
use tomcom_session::settings::ConsoleSpec;

/// Terminal size at which the console shows all panels, in columns and rows.
const ROOMY: (u16, u16) = (120, 40);
/// Smallest terminal in which the console is usable, in columns and rows; `tomcom doctor` warns below [`ROOMY`].
const WORKABLE: (u16, u16) = (80, 24);
/// Column at which the findings stand.
const INDENT: u16 = 26;
/// Date before which this program did not exist; a clock that shows an earlier date was never set.
const WRITTEN: &str = "2025-01-01";

/// Findings of the command `tomcom doctor`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoctorReport {
    /// Whether no check of `tomcom doctor` failed.
    pub healthy: bool,
    pub checks: Vec<DoctorCheck>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoctorCheck {
    /// What is missing where the check is not ok: "for the console".
    pub purpose: &'static str,
    #[serde(flatten)]
    pub check: PreflightCheck,
}

/// Checks everything that a session with these settings needs; `out` is the folder for its recordings.
pub fn examine(files: &SessionSetup, out: &Path) -> DoctorReport {
    let (spec, kitchen) = (&files.spec, &files.kitchen.kitchen);
    let place = folder(out);
    // The free disk space matters only if the folder for recordings can be written to.
    let room = (place.verdict == PreflightVerdict::Ok).then(|| space(free_bytes(&existing(out)).ok()));
    let mut checks = Vec::new();
    let mut add = |purpose, found: Vec<PreflightCheck>| {
        checks.extend(found.into_iter().map(|check| DoctorCheck { purpose, check }));
    };
    add("for the console", terminal(spec));
    add("to record", [place].into_iter().chain(room).collect());
    add("for times in recordings", vec![wall_clock(), timer()]);
    add("for the participant's page", devices::display(spec).into_iter().collect());
    add("for the participant's buttons", devices::button_box(spec).into_iter().collect());
    #[cfg(feature = "rerun")]
    add("for Rerun", vec![viewer()]);
    let remarks = files.study().map_or_else(Vec::new, |study| study.remarks());
    let told = |remark| PreflightCheck::warning("plan", remark, "change the session file, unless it is meant so");
    add("for the plan", remarks.into_iter().map(told).collect());
    add("for films beside recordings", films::checks(spec.video.as_ref()));
    add("for parts that this program was built without", left_out().collect());
    add("for the Lab Streaming Layer", devices::lsl(spec).into_iter().collect());
    add("for gaze", devices::gaze(spec, kitchen));
    #[cfg(feature = "ur")]
    add("for the arm", devices::arm(spec, kitchen));
    let healthy = checks.iter().all(|one| one.check.verdict != PreflightVerdict::Failed);
    DoctorReport { healthy, checks }
}

/// The findings as text, wrapped to this width in columns.
pub fn describe(findings: &DoctorReport, columns: u16) -> String {
    let indented = |first: &str, text: &str| beside(first, text, INDENT, columns);
    let told = |check: &PreflightCheck| {
        let mark = match check.verdict {
            PreflightVerdict::Ok => "ok    ",
            PreflightVerdict::Warning => "warn  ",
            PreflightVerdict::Failed => "FAILED",
        };
        let remedy = check.remedy.as_ref().map_or(String::new(), |remedy| indented("", &format!("fix: {remedy}")));
        indented(&format!("{mark}  {:<16}  ", check.name), &check.found) + &remedy
    };
    let lines: String = findings.checks.iter().map(|one| told(&one.check)).collect();
    lines + &beside("", &findings.conclusion(), 0, columns)
}

impl DoctorReport {
    /// Whether a session can begin, and what is wrong for what.
    fn conclusion(&self) -> String {
        let wrong = |verdict: PreflightVerdict| {
            let of_it = self.checks.iter().filter(|one| one.check.verdict == verdict);
            let mut told: Vec<String> = of_it.map(|one| format!("{} ({})", one.check.name, one.purpose)).collect();
            told.dedup();
            told.join(", ")
        };
        let (failed, limited) = (wrong(PreflightVerdict::Failed), wrong(PreflightVerdict::Warning));
        match (failed.is_empty(), limited.is_empty()) {
            (true, true) => "ready: this session has everything that it needs".to_string(),
            (true, false) => format!("ready; not perfect: {limited}"),
            (false, _) => format!("NOT READY: {failed}"),
        }
    }
}

fn terminal(spec: &SessionSpec) -> Vec<PreflightCheck> {
    if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
        let remedy = "run tomcom in a terminal; without one: tomcom simulate";
        return vec![PreflightCheck::failed("terminal", "input or output of tomcom is no terminal", remedy)];
    }
    let mut checks = vec![screen_size(), colours(&spec.console)];
    let keys = match supports_keyboard_enhancement() {
        Ok(true) => (PreflightVerdict::Ok, "the terminal reports key releases: a held key is told from a second press"),
        _ => (
            PreflightVerdict::Warning,
            "the terminal reports no key releases: a held key is told from a second press by time",
        ),
    };
    let remedy = "use a terminal with the kitty keyboard protocol (kitty, foot, WezTerm, Ghostty), without a \
                  multiplexer";
    checks.push(PreflightCheck::new("key releases", keys.0, keys.1, remedy));
    if !spec.is_gaze_of_console_mouse() {
        return checks;
    }
    let mouse = match mouse_mode() {
        Some(true) => (PreflightVerdict::Ok, "the terminal knows mouse reports (SGR)"),
        Some(false) => (PreflightVerdict::Warning, "the terminal does not know mouse reports (SGR)"),
        None => (PreflightVerdict::Warning, "the terminal does not say whether it knows mouse reports"),
    };
    checks.push(PreflightCheck::new("mouse", mouse.0, mouse.1, "try the mouse, or use another terminal"));
    checks
}

/// Columns in which the findings are written: those of the terminal, if they go to one.
pub fn columns() -> u16 {
    match io::stdout().is_terminal() {
        true => size().map_or(WORKABLE.0, |(columns, _)| columns),
        false => u16::MAX,
    }
}

fn screen_size() -> PreflightCheck {
    let (columns, rows) = size().unwrap_or_default();
    let fits = |least: (u16, u16)| columns >= least.0 && rows >= least.1;
    let verdict = match (fits(ROOMY), fits(WORKABLE)) {
        (true, _) => PreflightVerdict::Ok,
        (_, true) => PreflightVerdict::Warning,
        _ => PreflightVerdict::Failed,
    };
    let remedy = "use a larger window or a smaller font: 120x40 characters, at least 80x24";
    PreflightCheck::new("terminal size", verdict, format!("{columns}x{rows}"), remedy)
}

fn colours(spec: &ConsoleSpec) -> PreflightCheck {
    let (theme, count) = (theme(spec, TerminalBackground::Dark), available_color_count());
    let signs = if theme.unicode { "Unicode signs" } else { "ASCII signs" };
    let remedy = "set TERM=xterm-256color and a UTF-8 locale such as LC_ALL=C.UTF-8, and unset NO_COLOR, if the terminal has \
         colours and Unicode";
    let found = match theme.colour {
        true => format!("{} colours, {signs}", if count > 256 { "16 million".to_string() } else { count.to_string() }),
        false => format!("no colours (NO_COLOR is set), {signs}"),
    };
    let verdict =
        if theme.colour && theme.unicode && count >= 8 { PreflightVerdict::Ok } else { PreflightVerdict::Warning };
    PreflightCheck::new("colours", verdict, found, remedy)
}

/// Whether the terminal knows mouse reports (query DECRQM); `None` if the terminal does not answer.
fn mouse_mode() -> Option<bool> {
    enable_raw_mode().ok()?;
    let answer = ask("\x1b[?1006$p");
    let _ = disable_raw_mode();
    let answer = answer?;
    let state = answer.split("\x1b[?1006;").nth(1)?.chars().next()?;
    Some(state != '0')
}

fn existing(out: &Path) -> PathBuf {
    let there = out.ancestors().find(|folder| folder.is_dir());
    there.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf()
}

/// Checks the folder for recordings by writing a file and deleting it again.
fn folder(out: &Path) -> PreflightCheck {
    let there = existing(out);
    let place = match out.is_dir() {
        true => out.display().to_string(),
        false => {
            format!("the folder {} is not there yet, and {}, in which it will be made,", out.display(), there.display())
        }
    };
    let probe = there.join(format!(".tomcom-doctor-{}", std::process::id()));
    let made = fs::create_dir(&probe).map_err(|reason| reason.to_string());
    let is_own = made.is_ok();
    let tried = made.and_then(|()| {
        let _lock = RecordingLock::take(&probe).map_err(|error| error.to_string())?;
        let began = Instant::now();
        let mut file = fs::File::create(probe.join("probe")).map_err(|reason| reason.to_string())?;
        let written = file.write_all(&[b'x'; 1 << 16]).and_then(|()| file.sync_all());
        written.map(|()| began.elapsed()).map_err(|reason| reason.to_string())
    });
    if is_own {
        let _ = fs::remove_dir_all(&probe);
    }
    match tried {
        Ok(took) => {
            let found = format!("{place} can be written to (64 KiB were on the disk after {} ms)", took.as_millis());
            PreflightCheck::ok("recordings", found)
        }
        Err(reason) => {
            let found = format!("{place} cannot be written to: {reason}");
            PreflightCheck::failed("recordings", found, "give a folder that can be written to with --out")
        }
    }
}

/// Free bytes on the disk of a folder.
///
/// # Errors
/// The operating system does not tell the free space.
#[cfg(unix)]
pub fn free_bytes(folder: &Path) -> io::Result<u64> {
    let found = rustix::fs::statvfs(folder)?;
    Ok(found.f_bavail.saturating_mul(found.f_frsize))
}

/// Free disk space cannot be determined on this operating system.
#[cfg(not(unix))]
pub fn free_bytes(_: &Path) -> io::Result<u64> {
    Err(io::ErrorKind::Unsupported.into())
}

fn wall_clock() -> PreflightCheck {
    let now = WallTime::now();
    let verdict = if now.date().as_str() >= WRITTEN { PreflightVerdict::Ok } else { PreflightVerdict::Failed };
    let remedy = "set the computer's clock: recordings are named by date (session time does not depend on this clock)";
    PreflightCheck::new("wall clock", verdict, now.rfc3339(), remedy)
}

/// Warnings about optional parts of the program that this build leaves out.
fn left_out() -> impl Iterator<Item = PreflightCheck> {
    Feature::ALL.into_iter().filter_map(|feature| {
        let missing = feature.require().err()?;
        Some(PreflightCheck::warning("build", missing.to_string(), missing.remedy()))
    })
}

/// Checks whether Rerun's viewer is installed, which shows recordings in a window; without it, a browser shows the
/// recordings.
#[cfg(feature = "rerun")]
fn viewer() -> PreflightCheck {
    use tomcom_devices::viewer::{REMEDY, ViewerAvailability};
    match ViewerAvailability::find() {
        ViewerAvailability::Ready(path) => {
            PreflightCheck::ok("viewer", format!("{} {}", path.display(), tomcom_devices::rerun::VERSION))
        }
        ViewerAvailability::NoScreen => {
            let found =
                "a Rerun viewer is installed, but there is no screen: tomcom review serves the viewer for a browser";
            PreflightCheck::ok("viewer", found)
        }
        ViewerAvailability::Other(version) => {
            let found = format!("the Rerun viewer {version} is installed: another version");
            PreflightCheck::warning("viewer", found, REMEDY)
        }
        ViewerAvailability::None => {
            let found = "no Rerun viewer in PATH: tomcom review serves one for a browser";
            PreflightCheck::warning("viewer", found, REMEDY)
        }
    }
}

/// Checks whether the computer wakes sleeping programs in time: a late wake-up delays the time stamps of presses and
/// gaze.
fn timer() -> PreflightCheck {
    let late = (0..20).map(|_| {
        let began = Instant::now();
        std::thread::sleep(Duration::from_millis(5));
        began.elapsed().saturating_sub(Duration::from_millis(5))
    });
    let late_ms = late.max().unwrap_or_default().as_secs_f64() * 1000.0;
    let verdict = if late_ms < 20.0 { PreflightVerdict::Ok } else { PreflightVerdict::Warning };
    let found = format!("a timer wakes the program at most {late_ms:.1} ms late");
    PreflightCheck::new("timer", verdict, found, "close other programs that use the processor")
}
