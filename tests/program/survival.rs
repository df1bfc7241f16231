//! Recordings survive: the real program is killed, its disk fills up, its folder vanishes, its clock stands still, and what
//! was acknowledged is there and goes on. Without tmux the tests say that they were skipped.
//!
//! `TOMCOM_KILLS=200 cargo test --release --test program survival` kills that often, and demands times that only an idle machine
//! keeps: nothing older than 100 ms is lost, and the wizard is told within a second.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use rand::RngExt;
use serde_json::Value;
use serial_test::serial;
use tomcom::base::rng::stream;
use tomcom::edge::log::{LOG_NAME, RRD_NAME};

use crate::tmux::{TOMCOM, Terminal, tiny_plan, tomcom};

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

fn signal(pid: &str, signal: &str) {
    let done = Command::new("kill").args([&format!("-{signal}"), pid.trim()]).status().expect("kill runs");
    assert!(done.success(), "kill -{signal} {pid}");
}

/// What `tomcom replay RECORDING --verify` finds.
fn verified(recording: &Path) -> Value {
    let output = tomcom(&["replay", &recording.display().to_string(), "--verify", "--format", "json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"));
    assert_eq!(found["verified"], true, "{}: {found}", recording.display());
    found
}

/// A session file with gaze over TCP on a port of its own; the port.
fn json_session(folder: &Path) -> (PathBuf, u16) {
    let free = TcpListener::bind(("127.0.0.1", 0)).and_then(|listener| listener.local_addr());
    let port = free.expect("a free port").port();
    let root = env!("CARGO_MANIFEST_DIR");
    let text = fs::read_to_string("sessions/default.toml").expect("the default session");
    let text = text.replace("../layouts", &format!("{root}/layouts")).replace("50021", &port.to_string());
    let session = folder.join("session.toml");
    fs::write(&session, text).expect("written");
    (session, port)
}

/// Takes a cut recording up, lets its trial run on, and ends it; the new part.
fn goes_on(terminal: &Terminal, recording: &Path) -> PathBuf {
    terminal.run(&format!("{TOMCOM} operate --continue {}", recording.display()));
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
    let Some(terminal) = Terminal::open(&format!("kill-{number}")) else { return };
    let mut random = stream(number, "kills", 0);
    let (session, port) = json_session(&terminal.folder);
    let out = terminal.folder.join("recordings");
    terminal.run(&format!("{TOMCOM} operate {} --out {} --gaze json", session.display(), out.display()));
    // Every fourth is killed on its way to the first frame.
    if number % 4 == 3 {
        terminal.wait("a process", || terminal.read("pid").ends_with('\n'));
        std::thread::sleep(Duration::from_millis(random.random_range(0..60)));
        signal(&terminal.read("pid"), "KILL");
        let recordings = fs::read_dir(&out).into_iter().flatten().flatten().map(|entry| entry.path());
        recordings.filter(|folder| folder.join(LOG_NAME).exists()).for_each(|folder| {
            assert_eq!(verified(&folder)["cut"], true);
        });
        return;
    }
    terminal.see("READY");
    terminal.start();
    let mut tracker = TcpStream::connect(("127.0.0.1", port)).expect("it listens");
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
    let pid = terminal.read("pid");
    let killed = Instant::now();
    signal(&pid, "KILL");
    let recording = terminal.recording();
    assert_eq!(verified(&recording)["cut"], true);
    let log = terminal.log();
    let is_there = |taken_ms: u64| taken_ms == 0 || log.contains(&format!("\"device_ns\":{taken_ms}000000,"));
    let (there, lost) = sent.split_at(sent.iter().take_while(|(_, taken_ms)| is_there(*taken_ms)).count());
    let is_gap = lost.iter().any(|(_, taken_ms)| is_there(*taken_ms));
    assert!(!is_gap, "kill {number}: a sample after {} others is lost, and a later one is not", there.len());
    let age = lost.first().map_or(Duration::ZERO, |(at, _)| killed - *at);
    took(&format!("kill {number}: {} samples, the oldest lost one has an age of", sent.len()), age, LOST);
    let Some(other) = Terminal::open(&format!("kill-{number}-goes-on")) else { return };
    let part = goes_on(&other, &recording);
    let found = verified(&part);
    assert_eq!(found["cut"], false, "{found}");
    assert!(found["events"].as_u64() > verified(&recording)["events"].as_u64(), "{found}");
}

#[test]
#[serial]
fn a_kill_at_any_moment_loses_nothing_and_the_session_goes_on_in_a_new_part() {
    (0..kills().unwrap_or(6)).for_each(check_kill);
}

#[test]
#[serial]
fn a_recording_is_written_by_one_program_and_continued_once() {
    let Some(terminal) = Terminal::open("one-writer") else { return };
    terminal.operate("default.toml", "");
    terminal.start();
    let recording = terminal.recording();
    let refused = |recording: &Path, says: &str| {
        let output = tomcom(&["operate", "--continue", &recording.display().to_string()]);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(says), "{says:?} is not in\n{told}");
    };
    let pid = terminal.read("pid");
    refused(&recording, &format!("another program (process {}) writes this recording", pid.trim()));
    // Read it may be, by everybody.
    assert_eq!(verified(&recording)["cut"], true);
    signal(&pid, "KILL");
    terminal.wait("the end", || terminal.folder.join("exit").exists());
    assert!(recording.join("lock").exists(), "a killed program leaves its lock behind");
    let Some(second) = Terminal::open("one-writer-goes-on") else { return };
    let root = recording.parent().expect("a folder");
    second.run(&format!("{TOMCOM} operate --continue {}", recording.display()));
    second.see("PAUSED");
    let part = recording.with_file_name(format!("{}-part2", recording.file_name().expect("a name").to_string_lossy()));
    second.wait("a part", || part.join(LOG_NAME).exists());
    signal(&second.read("pid"), "KILL");
    second.wait("the end", || second.folder.join("exit").exists());
    refused(&recording, "was continued already");
    let Some(third) = Terminal::open("one-writer-third") else { return };
    let last = goes_on(&third, &part);
    assert!(last.ends_with(format!("{}-part3", recording.file_name().expect("a name").to_string_lossy())));
    assert_eq!(verified(&last)["cut"], false);
    refused(&last, "brought to its end");
    assert!(!last.join("lock").exists() && !part.join("lock").exists());
    // A part tells the whole session, and says which part is missing.
    let told = tomcom(&["replay", &last.display().to_string()]);
    assert!(String::from_utf8_lossy(&told.stdout).contains("trial started"), "{told:?}");
    fs::rename(&recording, root.join("elsewhere")).expect("moved");
    let output = tomcom(&["replay", &last.display().to_string(), "--verify"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && told.contains("a recording that is not there"), "{told}");
}

/// After the alarm: the robot is stopped, the session over, everything that the log had before is there, and verifies.
fn is_over(terminal: &Terminal, before: &str, recording: &Path) {
    terminal.see("EMERGENCY STOP");
    terminal.see("CLOSED");
    let after = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let complete = before.rfind('\n').map_or("", |end| &before[..=end]);
    assert!(after.starts_with(complete), "what was acknowledged is lost");
    assert_eq!(verified(recording)["cut"], true);
    terminal.key("C-c");
    terminal.is_whole("1");
    terminal.see("a folder that can be written to");
}

/// Does something bad to the recording of a running session, and demands the alarm.
fn check_loss(name: &str, bad: impl FnOnce(&Path)) {
    let Some(terminal) = Terminal::open(name) else { return };
    terminal.operate("default.toml", "");
    terminal.start();
    terminal.wait("gaze", || terminal.count("\"kind\":\"gaze\"") > 50);
    let (recording, before) = (terminal.recording(), terminal.log());
    let began = Instant::now();
    bad(&recording);
    terminal.see("RECORDING LOST");
    took(&format!("{name}: alarm after"), began.elapsed(), ALARM);
    is_over(&terminal, &before, &recording);
}

#[test]
#[serial]
fn a_folder_that_is_deleted_is_told_at_once_and_saved() {
    check_loss("deleted", |recording| fs::remove_dir_all(recording).expect("deleted"));
}

#[test]
#[serial]
fn a_folder_that_is_moved_away_is_told_at_once_and_saved() {
    check_loss("moved", |recording| {
        let away = recording.parent().and_then(Path::parent).expect("a folder").join("away");
        fs::rename(recording, away).expect("moved");
    });
}

#[test]
#[serial]
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
    fn mount(folder: PathBuf) -> Option<Disk> {
        fs::create_dir_all(&folder).expect("a folder");
        let arguments = ["-t", "tmpfs", "-o", "size=1500k", "tomcom-test"];
        let mounted = Command::new("mount").args(arguments).arg(&folder).output();
        if !mounted.is_ok_and(|output| output.status.success()) {
            eprintln!("skipped: mounting a small disk needs root");
            return None;
        }
        Some(Disk(folder))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).output();
    }
}

#[test]
#[serial]
fn on_a_full_disk_the_stream_goes_first_then_the_session_which_goes_on_when_there_is_room() {
    let Some(terminal) = Terminal::open("full") else { return };
    let Some(disk) = Disk::mount(terminal.folder.join("recordings")) else { return };
    terminal.operate("default.toml", "");
    terminal.start();
    terminal.wait("gaze", || terminal.count("\"kind\":\"gaze\"") > 50);
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
    terminal.wait("more gaze in the log", || terminal.count("\"kind\":\"gaze\"") > before + 5);
    assert!(!terminal.screen().contains("RECORDING LOST"), "{}", terminal.screen());
    let before = terminal.log();
    let _ = fill("filler2");
    terminal.see("RECORDING LOST");
    is_over(&terminal, &before, &recording);
    fs::remove_file(disk.0.join("filler")).expect("room");
    let Some(other) = Terminal::open("full-goes-on") else { return };
    assert_eq!(verified(&goes_on(&other, &recording))["cut"], false);
}

#[test]
#[serial]
fn a_limit_for_files_is_told_as_a_full_disk_is() {
    let Some(terminal) = Terminal::open("limit") else { return };
    // In blocks of 512 bytes.
    terminal.shell("ulimit -f 120");
    terminal.operate("default.toml", "");
    terminal.start();
    let before = terminal.log();
    terminal.see("RECORDING LOST");
    is_over(&terminal, &before, &terminal.recording());
}

#[test]
#[serial]
fn a_program_that_stood_still_goes_on_where_it_was_and_the_log_says_so() {
    let Some(terminal) = Terminal::open("standstill") else { return };
    // A shell with job control would take the terminal back from a stopped program.
    terminal.shell("set +m");
    terminal.operate("default.toml", "");
    terminal.start();
    let pid = terminal.read("pid");
    let stood_at = Instant::now();
    signal(&pid, "STOP");
    std::thread::sleep(Duration::from_millis(2500));
    signal(&pid, "CONT");
    let events = || -> Vec<Value> {
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
#[serial]
fn a_terminal_that_is_fine_is_found_fine() {
    let Some(terminal) = Terminal::open("doctor") else { return };
    terminal.run(&format!("{TOMCOM} doctor --out {}/recordings", terminal.folder.display()));
    terminal.is_whole("0");
    terminal.see("120x40");
    terminal.see("can be written to");
}

/// The key that goes on in a plan from what is on this screen, if any does; `turn` keeps two presses in a row apart.
fn onward(screen: &str, turn: u64) -> Option<&'static str> {
    let shows = |text: &str| screen.contains(text);
    let on = if turn.is_multiple_of(2) { "Enter" } else { "." };
    match () {
        () if shows("enter waive for this reason") => Some("Enter"),
        () if shows("and agrees to") || shows("is not done") || shows("is not met") => Some("1"),
        () if shows("0 no answer") => Some(if turn.is_multiple_of(2) { "3" } else { "5" }),
        () if shows("RUNNING") => None,
        () if shows("READY")
            || shows("PAUSED")
            || shows(". next recording")
            || shows(". next phase: questionnaire") =>
        {
            Some(".")
        }
        () if shows("enter ") => Some(on),
        () => None,
    }
}

/// The logs of all recordings, by path.
fn logs(out: &Path) -> Vec<(PathBuf, String)> {
    let folders = fs::read_dir(out).into_iter().flatten().flatten().map(|entry| entry.path().join(LOG_NAME));
    folders.filter_map(|path| Some((path.clone(), fs::read_to_string(&path).ok()?))).collect()
}

#[test]
#[serial]
fn a_plan_goes_on_where_it_was_however_often_it_is_killed() {
    let kills: u64 = std::env::var("TOMCOM_KILLS").ok().and_then(|count| count.parse().ok()).unwrap_or(5);
    let Some(home) = Terminal::open("plan-kills") else { return };
    let (session, out) = (tiny_plan(&home.folder), home.folder.join("recordings"));
    let [session, out_name] = [session.display().to_string(), out.display().to_string()];
    let mut done = 0;
    for number in 0..=kills {
        let Some(terminal) = Terminal::open(&format!("plan-kill-{number}")) else { return };
        if done == 3 && number < kills {
            fs::remove_dir_all(&out).expect("recordings");
            done = 0;
        }
        let before = logs(&out);
        terminal.run(&format!("{TOMCOM} operate {session} --code A1 --out {out_name}"));
        terminal.wait("a process", || terminal.read("pid").ends_with('\n'));
        let mut random = stream(number, "kills of a plan", 0);
        let until = Instant::now() + Duration::from_millis(random.random_range(100..5000));
        let mut turn = 0;
        let mut last = ("", Instant::now());
        terminal.wait("the kill, or at last the end", || {
            // A key that comes again too soon counts as held down.
            let next = onward(&terminal.screen(), turn);
            if let Some(key) = next.filter(|&key| key != last.0 || last.1.elapsed() > Duration::from_millis(900)) {
                terminal.key(key);
                last = (key, Instant::now());
                turn += 1;
            }
            std::thread::sleep(Duration::from_millis(200));
            terminal.folder.join("after").exists() || (number < kills && Instant::now() > until)
        });
        if !terminal.folder.join("after").exists() {
            signal(&terminal.read("pid"), "KILL");
            terminal.wait("the end", || terminal.folder.join("exit").exists());
        }
        // What was written before stays as it was, and everything verifies, cut or not.
        let after = logs(&out);
        assert!(before.iter().all(|log| after.contains(log)), "kill {number} changed another recording");
        after.iter().for_each(|(log, _)| drop(verified(log.parent().expect("a folder"))));
        let plan = tomcom(&["plan", &session, "--out", &out_name, "--format", "json"]);
        let plan: Value = serde_json::from_slice(&plan.stdout).unwrap_or_else(|_| panic!("{plan:?}"));
        let first = &plan["participants"][0];
        let steps = first["steps"].as_array().expect("steps").iter().filter(|step| step["is_done"] == true).count();
        assert!(steps >= done, "kill {number}: {steps} steps are done, {done} were before: {first}");
        println!("kill {number}: {steps} of 3 steps are done, {} recordings", after.len());
        done = steps;
    }
    assert_eq!(done, 3, "after the last kill it is brought to its end");
}
