//! Films beside recordings, without ffmpeg: what is attached by hand, and what is refused before a film is decoded.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::complaint;
use crate::program::{TOMCOM, folder, json};

/// A recording that is a copy of a golden one, and a film; both as arguments.
fn recorded(name: &str, change: impl FnOnce(String) -> String) -> (PathBuf, [String; 2]) {
    let made = folder(name);
    let recording = made.join("2026-03-14-P07-1");
    fs::create_dir_all(&recording).expect("a folder");
    let log = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden recording");
    fs::write(recording.join("events.jsonl"), change(log)).expect("written");
    let film = made.join("room.mp4");
    fs::write(&film, "a film").expect("written");
    let arguments = [&recording, &film].map(|path| path.display().to_string());
    (recording, arguments)
}

#[test]
fn films_are_attached_by_hand_and_copied() {
    let (recording, [log, film]) = recorded("video-by-hand", |log| log);
    let found = json(&["video", "attach", &log, &film, "--at", "12.5", "--copy"]);
    let text = fs::read_to_string(recording.join("events.jsonl")).expect("a log");
    let started = text.lines().find(|line| line.contains("\"trial_started\"")).expect("a trial");
    let started: Value = serde_json::from_str(started).expect("an event");
    let start_s = started["t_ns"].as_f64().expect("a time") / 1e9;
    let one = &found["films"][0];
    assert!((one["offset_s"].as_f64().expect("a number") - (12.5 - start_s)).abs() < 1e-3, "{one}");
    assert_eq!((one["file"].as_str(), one["by"].as_str()), (Some("room.mp4"), Some("trial_start")));
    assert_eq!(fs::read_to_string(recording.join("room.mp4")).expect("a copy"), "a film");
    // Another file of this name beside the log is kept.
    fs::write(&film, "another film").expect("written");
    let told = complaint(&["video", "attach", &log, &film, "--offset", "-3", "--copy"]);
    assert!(told.contains("another file of this name beside the log"), "{told}");
    assert_eq!(fs::read_to_string(recording.join("room.mp4")).expect("a copy"), "a film");
}

#[test]
fn what_cannot_be_aligned_is_refused() {
    let (recording, [log, film]) = recorded("video-refused", |log| log);
    let told = complaint(&["video", "attach", &log, &film, &film, "--at", "3"]);
    assert!(told.contains("one time by hand for 2 films"), "{told}");
    assert!(complaint(&["video", "attach", &log, &film, "--at", "soon"]).contains("seconds, such as 12.4"));
    let told = complaint(&["video", "attach", &log, "nowhere.mp4", "--at", "3"]);
    assert!(told.contains("nowhere.mp4"), "{told}");
    // This recording was made at the keyboard, without the participant's page.
    let told = complaint(&["video", "attach", &log, &film]);
    assert!(told.contains("a recording without a flash of the participant's page"), "{told}");
    assert!(!recording.join("video.json").exists(), "nothing was attached");
}

#[test]
fn without_ffmpeg_the_message_says_what_goes_without_it() {
    let drawn = |log: String| {
        let (start, rest) = log.split_once('\n').expect("a header");
        let mut seen = 0;
        let lines = rest.lines().map(|line| {
            // Two events about which nothing else depends become flashes.
            let is_place = seen < 2 && line.contains("\"kind\":\"gaze\"");
            seen += usize::from(is_place);
            let event: Value = serde_json::from_str(line).expect("an event");
            match is_place {
                true => format!(
                    "{{\"seq\":{},\"t_ns\":{1},\"kind\":\"display\",\"what\":\"drawn\",\"cue\":0,\"at_ns\":{1}}}",
                    event["seq"], event["t_ns"]
                ),
                false => line.to_string(),
            }
        });
        format!("{start}\n{}\n", lines.collect::<Vec<String>>().join("\n"))
    };
    let (_, [log, film]) = recorded("video-without-ffmpeg", drawn);
    let done = Command::new(TOMCOM).args(["video", "attach", &log, &film]).env("PATH", "").output().expect("it starts");
    let told = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{told}");
    assert!(told.contains("ffmpeg cannot be started") && told.contains("--at 12.4"), "{told}");
    assert!(!Path::new(&log).join("video.json").exists());
}
