//! Trials that are filmed, by ffmpeg's own test picture in place of a camera.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::program::{TOMCOM, json, tomcom};
use crate::pseudo_terminal::Terminal;

/// A camera that needs none.
const PICTURES: &str = "-f lavfi -i testsrc=size=320x240:rate=20,realtime,settb=1/1000000";

fn has_ffmpeg() -> bool {
    let is_there = Command::new("ffprobe").arg("-version").output().is_ok();
    if !is_there {
        eprintln!("skipped: this test needs ffmpeg");
    }
    is_there
}

/// The default session with these cameras.
fn session_with(terminal: &Terminal, cameras: &[&str]) -> String {
    let layouts = format!("{}/layouts", env!("CARGO_MANIFEST_DIR"));
    let text =
        fs::read_to_string("sessions/default.toml").expect("the default session").replace("../layouts", &layouts);
    let session = terminal.folder.join("session.toml");
    fs::write(&session, format!("{text}\n[video]\ndevices = {cameras:?}\n")).expect("written");
    session.display().to_string()
}

/// Numbers of the pictures in a film that can be played, with their times.
fn times_s(film: &Path) -> Vec<f64> {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v", "-show_entries", "packet=pts_time", "-of", "csv=p=0"]);
    let told = command.arg(film).output().expect("ffprobe");
    let text = String::from_utf8(told.stdout).expect("UTF-8");
    text.lines().filter_map(|line| line.trim_matches(',').parse().ok()).collect()
}

/// Whether a program runs in whose arguments this is.
fn runs(argument: &str) -> bool {
    let processes = fs::read_dir("/proc").expect("processes").flatten();
    let lines = processes.filter_map(|process| fs::read(process.path().join("cmdline")).ok());
    lines.into_iter().any(|line| {
        let line = String::from_utf8_lossy(&line).into_owned();
        line.starts_with("ffmpeg") && line.contains(argument)
    })
}

fn began_s(log: &str) -> f64 {
    let line = log.lines().find(|line| line.contains("\"what\":\"began\"")).expect("a film began");
    let event: Value = serde_json::from_str(line).expect("JSON");
    assert_eq!((event["kind"].as_str(), event["file"].as_str()), (Some("film"), Some("film-1.mp4")));
    event["began_ns"].as_f64().expect("a time") / 1e9
}

#[test]
fn a_trial_is_filmed_a_lost_camera_is_told_and_the_film_is_attached() {
    if !has_ffmpeg() {
        return;
    }
    let terminal = Terminal::open("filmed");
    let session = session_with(&terminal, &[PICTURES, "/dev/no-camera"]);
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out, "--participant", "keyboard", "--gaze", "mouse"]);
    terminal.see("film idle");
    terminal.key("C-f");
    terminal.see("there is no camera /dev/no-camera");
    terminal.key("Escape");
    terminal.begin();
    let lost = "\"what\":\"lost\",\"camera\":2,";
    terminal.wait("the lost camera in the log", || terminal.count(lost) == 1);
    terminal.see("NO FILM 1 OF 2");
    terminal.wait("a film", || terminal.count("\"what\":\"began\"") == 1);
    let film = terminal.recording().join("film-1.mp4");
    // A second of pictures is in the file before the film ends.
    terminal.wait("pictures", || times_s(&film).len() >= 40);
    terminal.quit();
    terminal.see("film-1.mp4: the session begins at -");
    assert!(!runs(&film.display().to_string()), "ffmpeg ends with the session");
    terminal.verifies();
    let log = terminal.log();
    assert_eq!(terminal.count(lost), 1, "{log}");
    let films: Value =
        serde_json::from_str(&fs::read_to_string(terminal.recording().join("video.json")).expect("attached"))
            .expect("JSON");
    let one = &films["films"][0];
    assert_eq!((one["file"].as_str(), one["by"].as_str()), (Some("film-1.mp4"), Some("recorded")), "{films}");
    assert!((one["offset_s"].as_f64().expect("a number") + began_s(&log)).abs() < 1e-3, "{films}");
    assert_eq!(films["films"].as_array().map(Vec::len), Some(1), "{films}");
    let times = times_s(&film);
    assert_eq!(times[0], 0.0);
    // No picture was doubled for a steady rate.
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
}

#[test]
fn a_killed_session_leaves_a_film_that_plays_and_no_ffmpeg() {
    if !has_ffmpeg() {
        return;
    }
    let terminal = Terminal::open("filmed-killed");
    let session = session_with(&terminal, &[PICTURES]);
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out, "--participant", "keyboard", "--gaze", "mouse"]);
    terminal.see("READY");
    terminal.begin();
    terminal.see("film ok");
    let recording = terminal.recording();
    let film = recording.join("film-1.mp4");
    let name = film.display().to_string();
    terminal.wait("pictures", || times_s(&film).len() >= 40);
    assert!(runs(&name));
    terminal.kill();
    terminal.wait("ffmpeg's end", || !runs(&name));
    assert!(times_s(&film).len() >= 40);
    // What the program would have done at the end.
    assert!(!recording.join("video.json").exists());
    let recording = recording.display().to_string();
    let found = json(&["video", "attach", &recording]);
    assert_eq!(
        (found["films"][0]["by"].as_str(), found["films"][0]["file"].as_str()),
        (Some("recorded"), Some("film-1.mp4"))
    );
    // It goes with the participant, also where nothing names it.
    fs::remove_file(film.with_file_name("video.json")).expect("removed");
    let told = tomcom(&["forget", "P01", "--in", &out, "--yes"]);
    assert!(!film.exists(), "{told:?}");
}

fn video(arguments: &[&str]) -> Output {
    tomcom(&[&["video", "attach"], arguments].concat())
}

#[test]
fn a_film_that_viewers_do_not_play_is_converted_and_the_copy_keeps_its_times() {
    if !has_ffmpeg() {
        return;
    }
    let folder = crate::program::folder("film-converted");
    let recording = folder.join("2026-03-14-P07-1");
    fs::create_dir_all(&recording).expect("a folder");
    fs::copy("tests/golden/format-3-hand.jsonl", recording.join("events.jsonl")).expect("a recording");
    let film = folder.join("room.avi");
    let mut make = Command::new("ffmpeg");
    make.args(["-v", "error", "-f", "lavfi", "-i", "testsrc=size=160x90:rate=10:duration=2", "-c:v", "mjpeg"])
        .arg(&film);
    assert!(make.status().expect("ffmpeg").success());
    let [log, film] = [&recording, &film].map(|path| path.display().to_string());
    // The trial is from 0.5 s to 228.7 s of the session.
    for by_hand in [["--offset", "500"], ["--offset", "-300"], ["--at", "2.5"]] {
        let told = video(&[&[&*log, &*film], &by_hand[..]].concat());
        let words = String::from_utf8_lossy(&told.stderr).replace("\n  │ ", " ");
        assert_eq!(told.status.code(), Some(2), "{by_hand:?}: {words}");
        assert!(words.contains("found a film of 2.0 s, and a trial from"), "{words}");
    }
    let done = video(&[&log, &film, "--offset", "-1.5"]);
    assert!(done.status.success(), "{done:?}");
    let told =
        Command::new(TOMCOM).args(["review", &log, "--save"]).arg(folder.join("a.rrd")).output().expect("it runs");
    let told = String::from_utf8_lossy(&told.stderr).into_owned() + &String::from_utf8_lossy(&told.stdout);
    let words = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(&format!("tomcom video attach {log} {film} --convert")), "{told}");
    // A film that is attached keeps its alignment.
    let found = json(&["video", "attach", &log, &film, "--convert"]);
    let one = &found["films"][0];
    assert_eq!((one["file"].as_str(), one["by"].as_str()), (Some("room-h264.mp4"), Some("offset")), "{found}");
    assert!((one["offset_s"].as_f64().expect("a number") + 1.5).abs() < 1e-3, "{found}");
    assert_eq!(one["copies_of"][0].as_str(), Some(film.as_str()), "{found}");
    assert_eq!(times_s(&recording.join("room-h264.mp4")).len(), 20);
    let films: Value =
        serde_json::from_str(&fs::read_to_string(recording.join("video.json")).expect("attached")).expect("JSON");
    assert_eq!(films["films"].as_array().map(Vec::len), Some(1), "the copy stands for the film: {films}");
    let again = video(&[&log, &film, "--convert", "--offset", "-1.5"]);
    assert_eq!(again.status.code(), Some(2), "{again:?}");
    assert!(String::from_utf8_lossy(&again.stderr).contains("a file of this name beside the log"), "{again:?}");
}

#[test]
fn a_film_of_pupil_capture_is_attached_without_a_flash() {
    if !has_ffmpeg() {
        return;
    }
    let folder = crate::program::folder("film-pupil");
    let recording = folder.join("2026-03-14-P07-1");
    fs::create_dir_all(&recording).expect("a folder");
    // Capture's clock is 5000 s ahead of the session's.
    let log = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden recording");
    let stamped =
        log.replacen("\"gaze\":\"mouse\"", "\"gaze\":\"pupil\"", 1).lines().fold(String::new(), |text, line| {
            let event: Value = serde_json::from_str(line).expect("JSON");
            let line = match (event["kind"].as_str(), event["t_ns"].as_i64()) {
                (Some("gaze"), Some(t_ns)) => {
                    let stamps = format!(",\"device_ns\":{},\"taken_ns\":{t_ns}}}", t_ns + 5_000_000_000_000);
                    format!("{}{stamps}", line.strip_suffix('}').expect("an object"))
                }
                _ => line.to_string(),
            };
            text + &line + "\n"
        });
    fs::write(recording.join("events.jsonl"), stamped).expect("written");
    let film = folder.join("world.mp4");
    let mut make = Command::new("ffmpeg");
    make.args(["-v", "error", "-f", "lavfi", "-i", "testsrc=size=160x90:rate=5:duration=20"]).arg(&film);
    assert!(make.status().expect("ffmpeg").success());
    // It begins 100 s after the session.
    let stamps = |number: usize| {
        let head = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({number},), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((head.len() as u16).to_le_bytes());
        bytes.extend(head.as_bytes());
        bytes.extend((0..number).flat_map(|frame| (5100.0 + frame as f64 / 5.0).to_le_bytes()));
        fs::write(folder.join("world_timestamps.npy"), bytes).expect("written");
    };
    let [log, film] = [&recording, &film].map(|path| path.display().to_string());
    stamps(99);
    let told = video(&[&log, &film]);
    assert_eq!(told.status.code(), Some(2), "{told:?}");
    assert!(String::from_utf8_lossy(&told.stderr).contains("100 pictures and 99 time stamps"), "{told:?}");
    stamps(100);
    let found = json(&["video", "attach", &log, &film]);
    let one = &found["films"][0];
    assert_eq!(one["by"].as_str(), Some("pupil_clock"), "{found}");
    assert!((one["offset_s"].as_f64().expect("a number") + 100.0).abs() < 1e-3, "{found}");
}

/// A recording whose page flashes three times, and a film of its own of them that began `late_s` later than the log says.
fn filmed_with_flashes(name: &str, late_s: f64) -> PathBuf {
    let recording = crate::program::folder(name).join("2026-03-14-P07-1");
    fs::create_dir_all(&recording).expect("a folder");
    let log = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden recording");
    let (mut flashes, mut began_s) = (Vec::new(), None);
    let changed = log.lines().fold(String::new(), |text, line| {
        let event: Value = serde_json::from_str(line).expect("JSON");
        let time_s = event["t_ns"].as_f64().unwrap_or_default() / 1e9;
        let start = format!("{{\"seq\":{},\"t_ns\":{},", event["seq"], event["t_ns"]);
        // Events about which nothing else depends become what the film is aligned with.
        let line = match event["kind"].as_str() {
            Some("gaze") if began_s.is_none() && time_s > 10.0 => {
                began_s = Some(time_s);
                format!("{start}\"kind\":\"film\",\"what\":\"began\",\"camera\":1,\"file\":\"film-1.mp4\",\"began_ns\":{}}}", event["t_ns"])
            }
            Some("gaze") if [14.0, 20.0, 31.0].get(flashes.len()).is_some_and(|wanted| time_s > *wanted) => {
                flashes.push(time_s);
                format!("{start}\"kind\":\"display\",\"what\":\"drawn\",\"cue\":0,\"at_ns\":{}}}", event["t_ns"])
            }
            _ => line.to_string(),
        };
        text + &line + "\n"
    });
    fs::write(recording.join("events.jsonl"), changed).expect("written");
    let began_s = began_s.expect("gaze") + late_s;
    let lit: Vec<String> = flashes.iter().map(|at| format!("between(t,{0},{0}+0.2)", at - began_s)).collect();
    let square = format!("drawbox=x=200:y=100:w=30:h=30:c=white:t=fill:enable='{}'", lit.join("+"));
    let mut make = Command::new("ffmpeg");
    make.args(["-v", "error", "-f", "lavfi", "-i", "color=black:size=320x180:rate=30:duration=30", "-vf", &square]);
    assert!(make.arg(recording.join("film-1.mp4")).status().expect("ffmpeg").success());
    recording
}

#[test]
fn an_own_film_is_aligned_by_flashes_that_are_near_and_else_by_its_times() {
    if !has_ffmpeg() {
        return;
    }
    for (name, late_s, by) in [("film-near", 0.12, "flashes"), ("film-far", 2.0, "recorded")] {
        let recording = filmed_with_flashes(name, late_s);
        let began_s = began_s(&fs::read_to_string(recording.join("events.jsonl")).expect("a log"));
        let found = json(&["video", "attach", &recording.display().to_string()]);
        let one = &found["films"][0];
        assert_eq!((one["by"].as_str(), one["file"].as_str()), (Some(by), Some("film-1.mp4")), "{found}");
        let truth = -began_s - if by == "flashes" { late_s } else { 0.0 };
        assert!((one["offset_s"].as_f64().expect("a number") - truth).abs() < 1.0 / 30.0, "{truth}: {found}");
    }
}
