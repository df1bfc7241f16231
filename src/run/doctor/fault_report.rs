//! A file to send with the report of a fault: versions, machine, checks, session, last warnings. It has no participant's code,
//! no answer and no note, and the user's home folder is `~`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use tomcom_core::base::text::printable_lines;
use tomcom_session::button_box::ButtonBoxEvent;
use tomcom_session::event::{Event, TimestampedEvent};
use tomcom_session::features::Feature;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::files::{WallTime, overwrite};
use tomcom_session::film::FilmEvent;
use tomcom_session::history::event_words;
use tomcom_session::log::{LOG_NAME, LogReader};
use tomcom_session::preflight_checks::PreflightVerdict;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{LogHeader, SessionSpec};

use super::{DoctorReport, describe};

const TITLE: &str = "# Fault report of tomcom ";
/// Number of the last warnings that are reported.
const WARNINGS: usize = 20;

/// Writes the report of these findings; `out` is the folder of recordings, of whose newest the warnings are.
///
/// # Errors
/// The file cannot be written, or is there and is no such report.
pub fn write(path: &Path, spec: &SessionSpec, findings: &DoctorReport, out: &Path) -> io::Result<()> {
    overwrite::check(path, "a fault report", |head| head.starts_with(TITLE.as_bytes()))?;
    overwrite::write(path, text(spec, findings, out).as_bytes())
}

fn text(spec: &SessionSpec, findings: &DoctorReport, out: &Path) -> String {
    let built = Feature::ALL.into_iter().filter(|feature| feature.require().is_ok()).map(|feature| feature.to_string());
    let built: Vec<String> = built.collect();
    let newest = newest(out);
    let (mut codes, warnings) = match newest.as_deref().map(warnings) {
        None => (Vec::new(), "no recording\n".to_string()),
        Some(Ok((header, lines))) => (codes(&header.session), lines),
        Some(Err(error)) => (Vec::new(), format!("{error}\n")),
    };
    codes.extend(self::codes(spec));
    // A recording's folder is named by the participant's code.
    codes.extend(newest.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned()));
    let told = format!(
        "{TITLE}{}\n\nWritten at {}. What happened, and what you expected:\n\n\n## Machine\n\n{}\nbuilt with {}\n\n\
         ## Checks\n\n{}\n## Session\n\n{}\n## Last warnings of the newest recording\n\n{warnings}",
        env!("CARGO_PKG_VERSION"),
        WallTime::now().rfc3339(),
        machine(),
        built.join(", "),
        describe(findings, u16::MAX),
        settings(spec),
    );
    without(told, codes)
}

/// Operating system, processor, memory, and what the terminal says about itself.
fn machine() -> String {
    let line = |path: &str, key: &str| {
        let text = fs::read_to_string(path).ok()?;
        let value = text.lines().find_map(|line| line.strip_prefix(key))?;
        Some(value.trim_start_matches([' ', '\t', ':', '=']).trim_matches('"').to_string())
    };
    let mut lines = vec![
        [std::env::consts::OS, std::env::consts::ARCH].join(" "),
        line("/etc/os-release", "PRETTY_NAME").unwrap_or_default(),
        line("/proc/sys/kernel/osrelease", "").unwrap_or_default(),
        line("/proc/cpuinfo", "model name").unwrap_or_default(),
        std::thread::available_parallelism().map_or(String::new(), |number| format!("{number} processors")),
        line("/proc/meminfo", "MemTotal").map_or(String::new(), |total| format!("{total} of memory")),
    ];
    let named = ["TERM", "COLORTERM", "TERM_PROGRAM", "LANG", "LC_ALL", "NO_COLOR"];
    lines.extend(named.into_iter().filter_map(|name| Some(format!("{name}={}", std::env::var(name).ok()?))));
    lines.extend(std::env::var("TMUX").is_ok().then(|| "in tmux".to_string()));
    lines.retain(|line| !line.is_empty());
    lines.join("\n")
}

/// The session's settings, without codes.
fn settings(spec: &SessionSpec) -> String {
    let mut spec = spec.clone();
    spec.participant.code = String::new();
    let mut table = match toml::Table::try_from(&spec) {
        Ok(table) => table,
        Err(error) => return format!("{error}\n"),
    };
    if let Some(plan) = table.get_mut("plan").and_then(|plan| plan.as_table_mut()) {
        let number = spec.plan.as_ref().map_or(0, |plan| plan.codes().len());
        plan.insert("participants".to_string(), toml::Value::Integer(number as i64));
    }
    table.to_string()
}

fn codes(spec: &SessionSpec) -> Vec<String> {
    let planned = spec.plan.as_ref().map(|plan| plan.codes().iter().map(ToString::to_string).collect::<Vec<_>>());
    planned.into_iter().flatten().chain([spec.participant.code.clone()]).collect()
}

/// The recording of a folder that was written last.
fn newest(out: &Path) -> Option<PathBuf> {
    let written =
        |folder: &PathBuf| -> Option<SystemTime> { fs::metadata(folder.join(LOG_NAME)).ok()?.modified().ok() };
    let folders = fs::read_dir(out).ok()?.flatten().map(|entry| entry.path());
    folders.filter_map(|folder| Some((written(&folder)?, folder))).max().map(|(_, folder)| folder)
}

/// The last warnings of a recording, a line each.
fn warnings(recording: &Path) -> FileResult<(LogHeader, String)> {
    let mut log = LogReader::open(recording)?;
    let header = log.header.clone();
    let mut told = Vec::new();
    while let Some(line) = log.next_line()? {
        told.extend(warning(&line.stamped));
    }
    let mut lines = vec![format!("written by tomcom {}, {:?}", header.program, log.ending())];
    let left_out = told.len().saturating_sub(WARNINGS);
    if left_out > 0 {
        lines.push(format!("{left_out} earlier warnings are left out"));
    }
    lines.extend(told.drain(left_out..));
    Ok((header, lines.join("\n") + "\n"))
}

/// What an event warns of. Texts that people typed are left out.
fn warning(stamped: &TimestampedEvent) -> Option<String> {
    let at = format!("{} s", stamped.time.in_seconds());
    match &stamped.event {
        Event::Preflight { checks, overridden } => {
            let wrong = checks.iter().filter(|check| check.verdict != PreflightVerdict::Ok);
            let wrong: Vec<String> = wrong.map(|check| format!("{}: {}", check.name, check.found)).collect();
            (!wrong.is_empty()).then(|| format!("{at} preflight, overridden: {overridden}; {}", wrong.join("; ")))
        }
        Event::Tracker(
            TrackerEvent::Fixation { .. }
            | TrackerEvent::Blink { .. }
            | TrackerEvent::Connected { .. }
            | TrackerEvent::DisplayFound,
        )
        | Event::Display(DisplayEvent::Connected { .. } | DisplayEvent::Drawn { .. })
        | Event::Film(FilmEvent::Began { .. })
        | Event::ButtonBox(ButtonBoxEvent::Connected { .. }) => None,
        Event::TrialAborted { .. } => Some(format!("{at} trial_aborted")),
        Event::RobotStage { stage, .. } => Some(format!("{at} robot_stage {}", event_words::arm_stage(*stage, ""))),
        event @ (Event::Tracker(_)
        | Event::Display(_)
        | Event::Film(_)
        | Event::ButtonBox(_)
        | Event::ClockJumped { .. }
        | Event::FocusLost
        | Event::RobotSafety { .. }
        | Event::RobotTouched { .. }) => Some(format!("{at} {}", serde_json::to_string(event).ok()?)),
        _ => None,
    }
}

/// The text without participants' codes and the user's home folder.
fn without(mut text: String, mut codes: Vec<String>) -> String {
    // A code can be a part of another.
    codes.sort_by_key(|code| std::cmp::Reverse(code.len()));
    for code in codes.iter().filter(|code| code.len() > 1) {
        text = text.replace(code.as_str(), "<code>");
    }
    if let Some(home) =
        std::env::home_dir().and_then(|home| home.to_str().map(str::to_string)).filter(|home| home.len() > 1)
    {
        text = text.replace(&home, "~");
    }
    printable_lines(&text).into_owned()
}
