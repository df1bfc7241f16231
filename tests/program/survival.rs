//! Recordings survive: the real program is killed, its disk fills up, its folder vanishes, its clock stands still, and what
//! was acknowledged is there and goes on.
//!
//! `TOMCOM_KILLS=200 cargo test --release --test program survival` kills that often, and demands times that only an idle machine
//! keeps: nothing older than 100 ms is lost, and the wizard is told within a second.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use rand::RngExt;
use rustix::process::Signal;
use tomcom_core::base::rng::stream;
use tomcom_session::log::{LOG_NAME, RRD_NAME};

use crate::program::{TOMCOM, done, json, refused, session_with_tracker, tiny_plan, verified};
use crate::pseudo_terminal::Terminal;

/// How old the newest lost sample may be after a kill, and how soon the wizard is told that something is wrong, on an idle machine.
const LOST: Duration = Duration::from_millis(100);
const ALARM: Duration = Duration::from_secs(1);

/// How often to kill, if the machine is idle.
fn kills() -> Option<u64> {
    std::env::var("TOMCOM_KILLS").ok().and_then(|count| count.parse().ok())
}

/// Says how long something took, and demands this limit if the machine is idle.
fn took(what: &str, time: Duration, limit: Duration) {
    println!("{what} {:.1} ms", time.as_secs_f64() * 1e3);
    assert!(kills().is_none() || time <= limit, "{what} {time:?}");
}

/// Takes a cut recording up, lets its trial run on, and ends it; the new part.
fn goes_on(terminal: &Terminal, recording: &Path) -> PathBuf {
    terminal.run(&["operate", "--continue", &recording.display().to_string()]);
    terminal.see("PAUSED");
    terminal.key(".");
    terminal.see("RUNNING");
    terminal.quit();
    let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
    let numbered = name.rsplit_once("-part").map(|(first, n)| (first.to_string(), n.parse::<u32>().expect("a number")));
    let (first, n) = numbered.unwrap_or((name, 1));
    recording.with_file_name(format!("{first}-part{}", n + 1))
}

/// One session with gaze from outside, killed at a random moment. What is recorded is the beginning of what was sent.
fn check_kill(number: u64) {
    let terminal = Terminal::open(&format!("kill-{number}"));
    let mut random = stream(number, "kills", 0);
    let (session, connect) = session_with_tracker(&terminal.folder);
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out, "--gaze", "json"]);
    // Every fourth is killed on its way to the first frame.
    if number % 4 == 3 {
        std::thread::sleep(Duration::from_millis(random.random_range(0..60)));
        terminal.kill();
        let recordings = fs::read_dir(&out).into_iter().flatten().flatten().map(|entry| entry.path());
        recordings.filter(|folder| folder.join(LOG_NAME).exists()).for_each(|folder| {
            assert_eq!(verified(&folder)["cut"], true);
        });
        return;
    }
    terminal.see("READY");
    terminal.begin();
    let mut tracker = connect();
    tracker.set_nodelay(true).expect("a socket");
    let length = Duration::from_millis(random.random_range(200..3000));
    let began = Instant::now();
    let mut sent = Vec::new();
    while began.elapsed() < length {
        let taken_s = began.elapsed().as_millis() as f64 / 1e3;
        let line = format!("{{\"t\": {taken_s:.3}, \"x\": 0.4, \"y\": 0.3, \"confidence\": 0.9}}\n");
        tracker.write_all(line.as_bytes()).expect("sent");
        sent.push((Instant::now(), (taken_s * 1e3).round() as u64));
        std::thread::sleep(Duration::from_micros(random.random_range(7_000..9_700)));
    }
    let killed = Instant::now();
    terminal.kill();
    let recording = terminal.recording();
    assert_eq!(verified(&recording)["cut"], true);
    let log = terminal.log();
    let is_there = |taken_ms: u64| taken_ms == 0 || log.contains(&format!("\"device_ns\":{taken_ms}000000,"));
    let (there, lost) = sent.split_at(sent.iter().take_while(|(_, taken_ms)| is_there(*taken_ms)).count());
    let is_gap = lost.iter().any(|(_, taken_ms)| is_there(*taken_ms));
    assert!(!is_gap, "kill {number}: a sample after {} others is lost, and a later one is not", there.len());
    let age = lost.first().map_or(Duration::ZERO, |(at, _)| killed - *at);
    took(&format!("kill {number}: {} samples, the oldest lost one has an age of", sent.len()), age, LOST);
    let found = verified(&goes_on(&terminal, &recording));
    assert_eq!(found["cut"], false, "{found}");
    assert!(found["events"].as_u64() > verified(&recording)["events"].as_u64(), "{found}");
}

#[test]
fn a_kill_at_any_moment_loses_nothing_and_the_session_goes_on_in_a_new_part() {
    match kills() {
        Some(kills) => (0..kills).for_each(check_kill),
        None => std::thread::scope(|scope| (0..6).for_each(|number| drop(scope.spawn(move || check_kill(number))))),
    }
}

#[test]
fn a_recording_is_written_by_one_program_and_continued_once() {
    let terminal = Terminal::open("one-writer");
    terminal.operate("default.toml", &[]);
    terminal.begin();
    let recording = terminal.recording();
    let name = recording.file_name().expect("a name").to_string_lossy().into_owned();
    let part = |number: u32| recording.with_file_name(format!("{name}-part{number}"));
    let no_further = |recording: &Path, says: &str| {
        refused(&["operate", "--continue", &recording.display().to_string()], says);
    };
    no_further(&recording, &format!("another program (process {}) writes this recording", terminal.pid()));
    // Read it may be, by everybody.
    assert_eq!(verified(&recording)["cut"], true);
    terminal.kill();
    assert!(recording.join("lock").exists(), "a killed program leaves its lock behind");
    terminal.run(&["operate", "--continue", &recording.display().to_string()]);
    terminal.see("PAUSED");
    terminal.wait("a part", || part(2).join(LOG_NAME).exists());
    terminal.kill();
    no_further(&recording, "was continued already");
    let last = goes_on(&terminal, &part(2));
    assert_eq!(last, part(3));
    assert_eq!(verified(&last)["cut"], false);
    assert!(!last.join("lock").exists() && !part(2).join("lock").exists());
    // A part tells the whole session, and says which part is missing.
    let last = last.display().to_string();
    assert!(done(&["replay", &last]).contains("trial started"));
    fs::rename(&recording, recording.with_file_name("elsewhere")).expect("moved");
    refused(&["replay", &last, "--verify"], "a recording that is not there");
}

/// After the alarm: the robot is stopped, the session over, everything that the log had before is there, and verifies.
pub fn is_over(terminal: &Terminal, before: &str, recording: &Path) {
    terminal.see("EMERGENCY STOP");
    terminal.see("ENDED EARLY");
    let after = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let complete = before.rfind('\n').map_or("", |end| &before[..=end]);
    assert!(after.starts_with(complete), "what was acknowledged is lost");
    assert_eq!(verified(recording)["cut"], true);
    terminal.key("C-c");
    terminal.is_whole(1);
}

/// The same, where nothing can be written, which is told.
fn is_over_unwritten(terminal: &Terminal, before: &str, recording: &Path) {
    is_over(terminal, before, recording);
    terminal.see("a folder that can be written to");
}

/// Does something bad to the recording of a running session, and demands the alarm.
fn check_loss(name: &str, bad: impl FnOnce(&Path)) {
    let terminal = Terminal::open(&format!("folder-{name}"));
    terminal.operate("default.toml", &[]);
    terminal.begin();
    terminal.gaze(50);
    let (recording, before) = (terminal.recording(), terminal.log());
    let began = Instant::now();
    bad(&recording);
    terminal.see("RECORDING LOST");
    took(&format!("{name}: alarm after"), began.elapsed(), ALARM);
    is_over_unwritten(&terminal, &before, &recording);
}

#[test]
fn a_folder_that_is_deleted_is_told_at_once_and_saved() {
    check_loss("deleted", |recording| fs::remove_dir_all(recording).expect("deleted"));
}

#[test]
fn a_folder_that_is_moved_away_is_told_at_once_and_saved() {
    check_loss("moved", |recording| {
        let away = recording.parent().and_then(Path::parent).expect("a folder").join("away");
        fs::rename(recording, away).expect("moved");
    });
}

#[test]
fn a_folder_that_becomes_read_only_is_told_at_once() {
    check_loss("read-only", |recording| {
        let mut permissions = fs::metadata(recording).expect("a folder").permissions();
        permissions.set_readonly(true);
        fs::set_permissions(recording, permissions).expect("changed");
    });
}

/// A small disk, unmounted when dropped.
struct Disk(PathBuf);

impl Disk {
    fn mount(folder: PathBuf) -> Disk {
        fs::create_dir_all(&folder).expect("a folder");
        let arguments = ["-t", "tmpfs", "-o", "size=1500k", "tomcom-test"];
        let mounted = Command::new("mount").args(arguments).arg(&folder).output().expect("mount");
        assert!(mounted.status.success(), "{mounted:?}");
        Disk(folder)
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).output();
    }
}

#[test]
#[ignore = "needs root, who mounts a small disk"]
fn on_a_full_disk_the_stream_goes_first_then_the_session_which_goes_on_when_there_is_room() {
    let terminal = Terminal::open("full");
    let disk = Disk::mount(terminal.folder.join("recordings"));
    terminal.operate("default.toml", &[]);
    terminal.begin();
    terminal.gaze(50);
    let recording = terminal.recording();
    let stream = recording.join(RRD_NAME);
    assert!(stream.exists());
    // Copied until nothing fits any more.
    let fill = |name: &str| fs::write(disk.0.join(name), vec![0; 2 << 20]);
    let began = Instant::now();
    let _ = fill("filler");
    terminal.see("the disk is full");
    took("full disk: told after", began.elapsed(), ALARM);
    assert!(!stream.exists(), "the stream made room for the log");
    let before = terminal.count("\"kind\":\"gaze\"");
    terminal.gaze(before + 5);
    assert!(!terminal.screen().contains("RECORDING LOST"), "{}", terminal.screen());
    let before = terminal.log();
    let _ = fill("filler2");
    terminal.see("RECORDING LOST");
    is_over_unwritten(&terminal, &before, &recording);
    fs::remove_file(disk.0.join("filler")).expect("room");
    assert_eq!(verified(&goes_on(&terminal, &recording))["cut"], false);
}

#[test]
fn a_limit_for_files_is_told_as_a_full_disk_is() {
    let terminal = Terminal::open("limit");
    // In blocks of 512 bytes.
    let limited = ["-c", "ulimit -f 120; exec \"$@\"", "sh", TOMCOM, "operate", "sessions/default.toml", "--out"];
    terminal.start(Command::new("sh").args(limited).arg(terminal.recordings()));
    terminal.see("READY");
    terminal.begin();
    let before = terminal.log();
    terminal.see("RECORDING LOST");
    is_over_unwritten(&terminal, &before, &terminal.recording());
}

#[test]
fn a_program_that_stood_still_goes_on_where_it_was_and_the_log_says_so() {
    let terminal = Terminal::open("standstill");
    terminal.operate("default.toml", &[]);
    terminal.begin();
    // It still runs after this.
    let stood_at = Instant::now();
    terminal.gaze(terminal.count("\"kind\":\"gaze\"") + 50);
    terminal.signal(Signal::STOP);
    std::thread::sleep(Duration::from_millis(2500));
    terminal.signal(Signal::CONT);
    let events = || -> Vec<serde_json::Value> {
        terminal.log().lines().skip(1).filter_map(|line| serde_json::from_str(line).ok()).collect()
    };
    // On a busy machine the program stands still at other times, too, but not for so long.
    let jumped = || events().iter().filter_map(|event| event["by_ms"].as_i64()).max().unwrap_or(0);
    terminal.wait("the jump", || jumped() > 2300);
    let (jump, at_most) = (jumped(), stood_at.elapsed().as_millis() as i64);
    assert!(jump <= at_most, "jumped by {jump} ms within {at_most} ms");
    let events = events();
    let times: Vec<u64> = events.iter().filter_map(|event| event["t_ns"].as_u64()).collect();
    let widest = times.windows(2).map(|pair| pair[1] - pair[0]).max().expect("events");
    assert!(widest < 1_500_000_000, "session time went on for {widest} ns");
    terminal.quit();
    terminal.verifies();
}

#[test]
fn a_terminal_that_is_fine_is_found_fine() {
    let terminal = Terminal::open("doctor");
    terminal.run(&["doctor", "--out", &terminal.recordings()]);
    terminal.is_whole(0);
    terminal.see("120x40");
    terminal.see("can be written to");
    terminal.see("ready");
    assert!(!terminal.screen().contains("lsl") && !terminal.screen().contains("mouse"), "the session has neither");
}

/// The key that goes on in a plan from what is on this screen, if any does.
fn onward(screen: &str) -> &'static [&'static str] {
    let shows = |text: &str| screen.contains(text);
    let advances = ["READY", "PAUSED", ". next recording", ". end the series", ". next phase: questionnaire"];
    match () {
        () if shows("enter save the text") || shows("enter waive for this reason") => &["Enter"],
        () if shows("SIMULATED PARTICIPANT") || shows("is not done") || shows("what follows the trial") => {
            &["1", "Enter"]
        }
        () if shows("is not met") => &["1"],
        () if shows("0 no answer") => &["3", "Enter"],
        () if shows("RUNNING") => &[],
        () if advances.into_iter().any(shows) => &["."],
        () if shows("enter ") => &["Enter"],
        () => &[],
    }
}

/// The logs of all recordings, by path.
fn logs(out: &Path) -> Vec<(PathBuf, String)> {
    let folders = fs::read_dir(out).into_iter().flatten().flatten().map(|entry| entry.path().join(LOG_NAME));
    folders.filter_map(|path| Some((path.clone(), fs::read_to_string(&path).ok()?))).collect()
}

#[test]
fn a_plan_goes_on_where_it_was_however_often_it_is_killed() {
    let kills = kills().unwrap_or(5);
    let terminal = Terminal::open("plan-kills");
    let (session, out_name) = (tiny_plan(&terminal.folder), terminal.recordings());
    let out = Path::new(&out_name);
    let mut done = 0;
    for number in 0..=kills {
        if done == 3 && number < kills {
            fs::remove_dir_all(out).expect("recordings");
            done = 0;
        }
        let before = logs(out);
        terminal.run(&["operate", &session, "--code", "A1", "--out", &out_name]);
        let mut random = stream(number, "kills of a plan", 0);
        let until = Instant::now() + Duration::from_millis(random.random_range(100..5000));
        let (mut shown, mut pressed) = (String::new(), Instant::now());
        terminal.wait("the kill, or at last the end", || {
            // A key that did nothing is pressed again.
            let now = terminal.words();
            if now != shown || pressed.elapsed() > Duration::from_secs(1) {
                onward(&terminal.screen()).iter().for_each(|key| terminal.key(key));
                (shown, pressed) = (now, Instant::now());
            }
            terminal.has_ended() || (number < kills && Instant::now() > until)
        });
        if !terminal.has_ended() {
            terminal.kill();
        }
        // What was written before stays as it was, and everything verifies, cut or not.
        let after = logs(out);
        assert!(before.iter().all(|log| after.contains(log)), "kill {number} changed another recording");
        after.iter().for_each(|(log, _)| drop(verified(log.parent().expect("a folder"))));
        let first = json(&["plan", &session, "--out", &out_name])["participants"][0].clone();
        let steps = first["steps"].as_array().expect("steps").iter().filter(|step| step["is_done"] == true).count();
        assert!(steps >= done, "kill {number}: {steps} steps are done, {done} were before: {first}");
        println!("kill {number}: {steps} of 3 steps are done, {} recordings", after.len());
        done = steps;
    }
    assert_eq!(done, 3, "after the last kill it is brought to its end");
}
