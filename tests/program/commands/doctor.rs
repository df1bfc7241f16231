//! `doctor`, completions and man pages.

use std::collections::HashSet;
use std::fs;
use std::net::TcpListener;
use std::path::Path;

use serde_json::Value;

use super::{check, complaint, failed};
use crate::program::{folder, session_file};

#[test]
fn doctor_looks_at_the_machine_and_says_how_to_mend_it() {
    let out = folder("doctor");
    let found = failed(&["doctor", "--out", &out.join("new").display().to_string()]);
    let checks = found["checks"].as_array().expect("checks");
    let verdict = |name: &str| {
        checks.iter().find(|check| check["name"] == name).map(|check| check["verdict"].as_str().unwrap_or_default())
    };
    // Through a pipe there is no terminal, which the console needs.
    assert_eq!((&found["healthy"], verdict("terminal")), (&Value::Bool(false), Some("failed")));
    assert_eq!((verdict("recordings"), verdict("wall clock")), (Some("ok"), Some("ok")));
    assert!(fs::read_dir(&out).expect("the folder").next().is_none(), "it leaves nothing behind");
    for check in checks {
        assert!(check["purpose"].as_str().is_some_and(|purpose| !purpose.is_empty()), "{check}");
        assert_eq!(check["remedy"].is_string(), check["verdict"] != "ok", "{check}");
    }
    let told = check(&["doctor", "--out", "/proc/nowhere"], 1);
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("FAILED  recordings        the folder /proc/nowhere is not there yet, and /proc"), "{told}");
    let last = told.lines().last().unwrap_or_default();
    assert!(last.starts_with("NOT READY: terminal (for the console), recordings (to record)"), "{last}");
    assert!(!told.contains("free space"), "where there is no disk, none of it is free:\n{told}");
}

#[test]
fn doctor_looks_at_what_a_session_names() {
    let place = folder("doctor-session");
    let taken = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = taken.local_addr().expect("an address").port();
    let verdict = |settings: &str, name: &str| {
        let found = failed(&["doctor", &session_file(&place, settings)]);
        let check = found["checks"].as_array().and_then(|checks| checks.iter().find(|check| check["name"] == name));
        let told = |key: &str| check.and_then(|check| check[key].as_str()).unwrap_or_default().to_string();
        (told("verdict"), told("found"))
    };
    for (kind, gaze, expected) in [("simulated", "simulated", ""), ("display", "mouse", "failed")] {
        let page = format!("[participant]\nkind = \"{kind}\"\ngaze = \"{gaze}\"\n[display]\nport = {port}\n");
        let (found, words) = verdict(&page, "wall display");
        let is_named = words.contains(&port.to_string());
        assert_eq!((found.as_str(), is_named), (expected, !expected.is_empty()), "{kind}: {words}");
    }
    let (found, words) = verdict(&format!("[participant]\ngaze = \"json\"\ngaze_port = {port}\n"), "gaze");
    assert_eq!((found.as_str(), words.contains(&port.to_string())), ("failed", true), "{words}");
    let nobody = "[participant]\ngaze = \"pupil\"\n[tracker]\nport = 1\n";
    let (found, words) = verdict(nobody, "eye tracker");
    assert_eq!((found.as_str(), words.contains("127.0.0.1:1")), ("failed", true), "{words}");
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pupil/gaze_positions_on_surface_wall.csv");
    // Two lines of it are malformed.
    for (file, expected) in [(surface.as_path(), "warning"), (Path::new("nowhere.csv"), "failed")] {
        let settings = format!("[participant]\ngaze = \"file\"\n[tracker]\nfile = \"{}\"\n", file.display());
        let (found, words) = verdict(&settings, "gaze");
        assert_eq!(found, expected, "{words}");
    }
    let table = place.join("gaze.csv");
    let settings = format!("[participant]\ngaze = \"file\"\n[tracker]\nfile = \"{}\"\n", table.display());
    let row = |time: f64| format!("{time:.3},0.5,0.5,0.9\n");
    let rows: String = (0..80).map(|nth| row(f64::from(nth % 40) / 200.0 - 3.0)).collect();
    for (rows, name, expected, told) in [
        (rows.clone(), "gaze", "ok", "80 samples in 0.4 s; no gap of more than 1 s"),
        (
            rows,
            "gaze file",
            "warning",
            "line 42: the clock was set from -2.805 s to -3 s; joined in the order of lines",
        ),
        (
            "soon,0.5,0.5,0.9\n".to_string(),
            "gaze",
            "failed",
            "gaze.csv:2: found no line with gaze: gaze_timestamp = \"soon\"",
        ),
    ] {
        fs::write(&table, format!("gaze_timestamp,x_norm,y_norm,confidence\n{rows}")).expect("a table");
        let (found, words) = verdict(&settings, name);
        assert!(found == expected && words.contains(told), "{found}: {words}");
    }
    assert!(complaint(&["doctor", "sessions/nowhere.toml"]).contains("sessions/nowhere.toml"));
}

#[test]
fn a_fault_report_has_machine_and_warnings_and_no_codes() {
    let place = folder("fault-report");
    let [out, file, plan] = ["recordings", "fault.md", "plan.toml"].map(|name| place.join(name).display().to_string());
    let text = fs::read_to_string("sessions/study.toml").expect("a session");
    let text = text.replace("\"../", &format!("\"{}/", env!("CARGO_MANIFEST_DIR")));
    let text = text.replace("participants = 14 ", "participants = [\"Anna7\", \"Bert8\"] ");
    let text = text.replace("\"questionnaires/", &format!("\"{}/sessions/questionnaires/", env!("CARGO_MANIFEST_DIR")));
    let text = text.replace("\"tutorials/", &format!("\"{}/sessions/tutorials/", env!("CARGO_MANIFEST_DIR")));
    fs::write(&plan, text).expect("written");
    check(&["simulate", &plan, "--trials", "1", "--arm", "timed", "--out", &out], 0);
    // What a live session would have recorded.
    let recording = fs::read_dir(&out).expect("a folder").next().expect("a recording").expect("an entry").path();
    let log = recording.join("events.jsonl");
    let lines = fs::read_to_string(&log).expect("a log");
    let (kept, end) = lines.trim_end().rsplit_once('\n').expect("lines");
    let mut end: Value = serde_json::from_str(end).expect("an event");
    let at = end["seq"].as_u64().expect("a number");
    end["seq"] = (at + 3).into();
    let t_ns = &end["t_ns"];
    let added = format!(
        "{kept}\n{{\"seq\":{at},\"t_ns\":{t_ns},\"kind\":\"clock_jumped\",\"by_ms\":4321}}\n\
         {{\"seq\":{},\"t_ns\":{t_ns},\"kind\":\"marker\",\"note\":\"Anna7 said a secret\"}}\n\
         {{\"seq\":{},\"t_ns\":{t_ns},\"kind\":\"tracker\",\"what\":\"lost\",\"reason\":\"the cable of Anna7\"}}\n{end}\n",
        at + 1,
        at + 2
    );
    fs::write(&log, added).expect("written");
    let doctor = ["doctor", &plan, "--out", &out, "--report", &file];
    check(&doctor, 1);
    let report = fs::read_to_string(&file).expect("a report");
    for has in [
        concat!("tomcom ", env!("CARGO_PKG_VERSION")),
        "## Machine",
        "NOT READY: terminal (for the console)",
        "participants = 2",
        "4321",
        "the cable of <code>",
    ] {
        assert!(report.contains(has), "{has:?} is not in\n{report}");
    }
    for lacks in ["Anna7", "Bert8", "secret"] {
        assert!(!report.contains(lacks), "{lacks} is in\n{report}");
    }
    check(&doctor, 1);
    fs::write(&file, "# Mine\n").expect("written");
    let told = complaint(&doctor);
    assert!(
        told.contains("fault.md: cannot be written") && fs::read_to_string(&file).is_ok_and(|text| text == "# Mine\n")
    );
}

#[test]
fn completions_and_man_pages_know_every_command() {
    let text = |arguments: &[&str]| String::from_utf8_lossy(&check(arguments, 0).stdout).into_owned();
    let help = text(&["--help"]);
    let listed = help.split_once("Commands:\n").and_then(|(_, rest)| rest.split_once("\n\n")).expect("commands").0;
    let commands =
        listed.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).filter(|name| !name.is_empty());
    let commands: Vec<&str> = commands.collect();
    assert!(commands.contains(&"operate"), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let words = text(&["completions", shell]);
        let words: HashSet<&str> = words.split(|letter: char| !letter.is_alphanumeric() && letter != '-').collect();
        let missing: Vec<&&str> = commands.iter().filter(|command| !words.contains(*command)).collect();
        assert!(missing.is_empty(), "{shell} completes no {missing:?}");
    }
    let overview = text(&["man"]).replace("\\-", "-");
    for command in commands.into_iter().filter(|&command| command != "help") {
        assert!(overview.contains(&format!("tomcom-{command}(1)")), "{command} is not in the overview");
        assert!(text(&["man", command]).contains(&format!(".TH tomcom-{command}")), "{command} has no page");
    }
    complaint(&["man", "dance"]);
}
