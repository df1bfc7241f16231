//! Damage in place: logs that another program changes under the running session, logs that a power failure left without
//! their header, pipes in place of logs, and several programs that fill one folder.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tomcom_session::log::{LOG_NAME, RecordingLock};

use crate::program::{PATIENCE, TOMCOM, done, end, folder, json, refused, session_file, start, tomcom};
use crate::pseudo_terminal::Terminal;
use crate::survival::is_over;

/// Length of a log that has a middle, in bytes: its end is compared more often than the rest.
const LENGTH: usize = 150_000;
/// The name of a log that was moved aside.
const ASIDE: &str = "events.jsonl.damaged";

/// Does something bad to the log of a running session: it is told, and everything that was acknowledged is in the log that
/// stands in its place; what the other program made of it stands beside that.
fn check_damage(name: &str, bad: impl FnOnce(&Path), says: &str) {
    let terminal = Terminal::open(name);
    terminal.operate("default.toml", &[]);
    terminal.begin();
    terminal.gaze(50);
    let recording = terminal.recording();
    terminal.wait("a log of some length", || terminal.log().len() > LENGTH);
    let before = terminal.log();
    bad(&recording.join(LOG_NAME));
    terminal.see("RECORDING LOST");
    is_over(&terminal, &before, &recording);
    assert!(recording.join(ASIDE).exists(), "{name}: the damaged log is kept");
    terminal.see_words(says);
    terminal.see_words("everything recorded until then is in");
}

fn opened(log: &Path) -> File {
    File::options().write(true).open(log).expect("a log")
}

#[test]
fn a_log_that_another_program_cuts_is_told_at_once_and_saved() {
    check_damage("cut-to-nothing", |log| opened(log).set_len(0).expect("cut"), "by another program");
    let halve = |log: &Path| {
        let log = opened(log);
        let length = log.metadata().expect("a length").len();
        log.set_len(length / 2).expect("cut");
    };
    check_damage("cut-in-half", halve, "by another program");
}

#[test]
fn a_log_that_another_program_overwrites_is_told_at_once_and_saved() {
    let write = |log: &Path, at: SeekFrom| {
        let mut log = opened(log);
        log.seek(at).and_then(|_| log.write_all(b"x")).expect("written");
    };
    check_damage("overwritten-header", |log| write(log, SeekFrom::Start(30)), "overwritten by another program");
    check_damage("overwritten-middle", |log| write(log, SeekFrom::Start(50_000)), "overwritten by another program");
    check_damage("overwritten-end", |log| write(log, SeekFrom::End(-300)), "overwritten by another program");
    check_damage("appended", |log| write(log, SeekFrom::End(40_000)), "by another program");
}

#[test]
fn a_log_that_an_editor_saves_again_is_told_at_once_and_saved() {
    let save = |log: &Path| {
        let edited = log.with_extension("edited");
        fs::copy(log, &edited).and_then(|_| fs::rename(edited, log)).expect("saved");
    };
    check_damage("saved-again", save, "another file took its place");
}

/// A session file of a few presses, and where its recordings go.
fn short_session(home: &Path) -> [String; 2] {
    let session = session_file(home, "seed = 3\n[trial]\npresses = 30\n[robot]\narm = \"timed\"\n");
    [session, home.join("recordings").display().to_string()]
}

/// The logs of a folder, by the names of their recordings.
fn logs(folder: &str) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder).expect("a folder").flatten().filter(|entry| entry.path().is_dir());
    let read = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        (name, fs::read_to_string(path.join(LOG_NAME)).expect("a log"))
    };
    let mut logs: Vec<_> = entries.map(|entry| read(entry.path())).collect();
    logs.sort();
    logs
}

/// The figures that do not say when and by whom it was simulated.
fn lasting(mut figures: Value) -> Value {
    for key in ["wall_s", "found", "moved"] {
        figures.as_object_mut().expect("figures").remove(key).unwrap_or_else(|| panic!("no {key}"));
    }
    figures
}

#[test]
fn two_programs_simulate_into_one_folder_and_print_the_same_figures() {
    let home = folder("damage-two-simulations");
    let [session, out] = short_session(&home);
    let arguments = ["simulate", &session, "--trials", "12", "--out", &out];
    let [first, second] = std::thread::scope(|scope| {
        [(); 2].map(|()| scope.spawn(|| json(&arguments))).map(|program| program.join().expect("a simulation"))
    });
    let (found, trials) = (first["found"].as_u64().zip(second["found"].as_u64()), first["trials"].as_u64());
    assert!(found.is_some_and(|(first, second)| first + second <= 12), "{first} {second}");
    assert_eq!(trials, Some(12));
    assert_eq!(lasting(first), lasting(second.clone()));
    let together = logs(&out);
    fs::remove_dir_all(&out).expect("recordings");
    let alone = json(&arguments);
    assert_eq!(alone["found"], 0);
    assert_eq!(lasting(alone), lasting(second));
    assert!(together == logs(&out), "the recordings are those of one program");
}

#[test]
fn a_trial_that_another_program_simulates_is_waited_for_and_the_others_are_made_meanwhile() {
    let home = folder("damage-waits");
    let [session, out] = short_session(&home);
    let recording = |trial: u32| Path::new(&out).join(format!("seed3-S{trial:03}"));
    fs::create_dir_all(recording(1)).expect("a folder");
    let lock = RecordingLock::take(&recording(1)).expect("nobody has it");
    let mut child = start(&["simulate", &session, "--trials", "3", "--out", &out]);
    let is_made = |trial: u32| {
        fs::read_to_string(recording(trial).join(LOG_NAME)).is_ok_and(|log| log.contains("\"session_ended\""))
    };
    let began = Instant::now();
    while !(is_made(2) && is_made(3)) {
        assert!(began.elapsed() < PATIENCE, "the others are not made");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().expect("a child").is_none(), "it does not wait");
    assert!(!recording(1).join(LOG_NAME).exists(), "it writes what another program writes");
    drop(lock);
    let output = end("a simulation", child);
    assert!(output.status.success() && is_made(1), "{output:?}");
}

#[test]
fn a_log_without_its_header_is_moved_aside_and_made_again() {
    let home = folder("power-failure");
    let [session, out] = short_session(&home);
    let arguments = ["simulate", &session, "--trials", "5", "--out", &out];
    done(&arguments);
    let whole = logs(&out);
    let recording = |trial: u32| Path::new(&out).join(format!("seed3-S{trial:03}"));
    let header = &whole[1].1.as_bytes()[..200];
    let damaged: [&[u8]; 3] = [b"", header, &[0; 4096]];
    for (trial, bytes) in (1..).zip(damaged) {
        fs::write(recording(trial).join(LOG_NAME), bytes).expect("written");
    }
    let told = done(&arguments);
    assert!(told.contains(", 2 of them in an earlier run"), "{told}");
    assert!(logs(&out) == whole, "the same recordings again");
    for (trial, bytes) in (1..).zip(damaged) {
        let aside = recording(trial).join(ASIDE);
        let line =
            format!("before the end of its header was moved to {}; its trial was simulated again", aside.display());
        assert!(told.contains(&line), "{line}\n{told}");
        assert_eq!(fs::read(&aside).expect("moved"), bytes, "trial {trial}");
    }
    // What is no log of a session is nobody's to move, and an earlier one that was moved stays.
    fs::write(recording(4).join(LOG_NAME), "notes of mine").expect("written");
    let refused = tomcom(&arguments);
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    let says = ["a recording that cannot be read (", "a file that is no log of a session", "is there already"];
    assert!(refused.status.code() == Some(1) && says.iter().all(|words| told.contains(words)), "{told}");
    assert_eq!(fs::read_to_string(recording(4).join(LOG_NAME)).expect("left alone"), "notes of mine");
    fs::remove_file(recording(4).join(LOG_NAME)).expect("removed");
    fs::write(recording(1).join(LOG_NAME), "{").expect("written");
    done(&arguments);
    assert_eq!(fs::read(recording(1).join(ASIDE)).expect("kept"), b"");
    assert_eq!(fs::read_to_string(recording(1).join(format!("{ASIDE}2"))).expect("moved"), "{");
    assert!(logs(&out) == whole, "the same recordings again");
    // They are the participant's, too.
    done(&["forget", "S001", "--in", &out, "--yes"]);
    assert!(!recording(1).exists());
}

fn pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().expect("mkfifo");
    assert!(made.success(), "{made}");
}

#[test]
fn a_pipe_in_place_of_a_log_is_refused_by_every_reader() {
    let home = folder("damage-pipe");
    let recording = home.join("recordings").join("2026-03-14-P01-1");
    fs::create_dir_all(&recording).expect("a folder");
    [LOG_NAME, "lock", "exclusion.toml", "recording.rrd"].iter().for_each(|name| pipe(&recording.join(name)));
    let [folder, all, log] =
        [&recording, &home.join("recordings"), &recording.join(LOG_NAME)].map(|path| path.display().to_string());
    let readers: [&[&str]; 10] = [
        &["replay", &folder],
        &["replay", &log],
        &["replay", &folder, "--verify"],
        &["replay", &folder, "--follow"],
        &["compare", &folder],
        &["codes", &folder],
        &["review", &folder, "--save"],
        &["exclude", &folder, "--reason", "a pipe"],
        &["operate", "--continue", &folder],
        &["fit", &folder],
    ];
    for arguments in readers {
        refused(arguments, "it is no regular file");
    }
    // Who looks through a folder finds no recording in it.
    let looked: [&[&str]; 3] =
        [&["study", &all], &["plan", "sessions/study.toml", "--out", &all], &["forget", "P01", "--in", &all, "--yes"]];
    for arguments in looked {
        let output = end(&arguments.join(" "), start(arguments));
        assert!(!String::from_utf8_lossy(&output.stdout).contains("2026-03-14-P01-1"), "{arguments:?}: {output:?}");
    }
}

#[test]
fn what_is_no_regular_file_of_usual_size_is_refused_by_every_reader_of_settings() {
    let home = folder("no-file");
    pipe(&home.join("pipe.toml"));
    let [pipe, large] = ["pipe.toml", "large.toml"].map(|name| home.join(name).display().to_string());
    File::create(&large).and_then(|file| file.set_len((16 << 20) + 1)).expect("a sparse file");
    let root = env!("CARGO_MANIFEST_DIR");
    let whole = format!("layout = \"{root}/layouts/sushi.toml\"\n");
    let study = "[plan]\nname = \"study\"\nparticipants = 2\nconditions = [\"none\"]\n";
    let recording = home.join("recording").display().to_string();
    done(&["simulate", &short_session(&home)[0], "--out", &recording]);
    let recording = format!("{recording}/seed3-S001");
    let layout = fs::read_to_string(format!("{root}/layouts/sushi.toml")).expect("a layout");
    for (place, says) in [
        (pipe.as_str(), "it is no regular file"),
        ("/dev/zero", "it is no regular file"),
        (large.as_str(), "it has more than 16 MB"),
    ] {
        let file = |name: &str, text: String| {
            let path = home.join(name);
            fs::write(&path, text).expect("written");
            path.display().to_string()
        };
        let session = |name: &str, text: String| file(&format!("session-{name}.toml"), text);
        let with_recipes = layout.replacen("recipes = \"../recipes/sushi.toml\"", &format!("recipes = \"{place}\""), 1);
        assert_ne!(with_recipes, layout);
        let planned = format!("{whole}{study}");
        let cases: Vec<Vec<String>> = [
            vec!["keys", place],
            vec!["kitchen", place],
            vec!["kitchen", &file("layout.toml", with_recipes)],
            vec!["keys", &session("layout", format!("layout = \"{place}\"\n"))],
            vec!["keys", &session("keys", format!("{whole}[console]\nkeys = \"{place}\"\n"))],
            vec!["keys", &session("language", format!("{whole}[display]\nlanguage = \"{place}\"\n"))],
            vec!["keys", &session("model", format!("human_model = \"{place}\"\n{whole}"))],
            vec![
                "plan",
                &session("asks", format!("{planned}[[plan.questionnaire]]\nfile = \"{place}\"\nafter = [1]\n")),
            ],
            vec!["plan", &session("tutorial", format!("{planned}tutorial = \"{place}\"\n"))],
            vec!["codes", &recording, "--import", place],
            vec!["study", &recording, "--frozen", place],
        ]
        .into_iter()
        .map(|case| case.into_iter().map(str::to_string).collect())
        .collect();
        for arguments in cases {
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            refused(&arguments, says);
        }
    }
    for arguments in [
        &["arms", "sessions/study.toml", "--from", "/dev/zero"][..],
        &["study", "--from", &pipe, "--out", &home.join("study").display().to_string()],
    ] {
        refused(arguments, "it is no regular file");
    }
}

/// Waits until a process has a handler for the signal that ends it.
fn until_it_listens_to_signals(process: u32) {
    let has_handler = || {
        let status = fs::read_to_string(format!("/proc/{process}/status")).expect("it runs");
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).expect("a mask of signals");
        let mask = u64::from_str_radix(caught.trim(), 16).expect("a number");
        mask & 1 << (Signal::TERM.as_raw() - 1) != 0
    };
    while !has_handler() {
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn the_stream_of_a_running_session_goes_where_it_is_told_and_nowhere_else() {
    let home = folder("damage-stream");
    let [session, out] = short_session(&home);
    done(&["simulate", &session, "--out", &out]);
    let recording = Path::new(&out).join("seed3-S001");
    let temporary = home.join("temporary");
    fs::create_dir_all(&temporary).expect("a folder");
    let files = |folder: &Path| {
        let mut names: Vec<_> =
            fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
        names.sort();
        names
    };
    let lock = RecordingLock::take(&recording).expect("nobody has it");
    let before = files(&recording);
    let review = |save: &str| {
        let mut command = Command::new(TOMCOM);
        command
            .args(["review", &recording.display().to_string(), save])
            .env("TMPDIR", &temporary)
            .output()
            .expect("runs")
    };
    let refused = review("--save");
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{told}");
    assert!(told.contains("another program writes this recording") && told.contains("--save=FILE"), "{told}");
    assert_eq!((files(&recording), files(&temporary).len()), (before.clone(), 0));
    let file = home.join("up-to-now.rrd");
    let saved = review(&format!("--save={}", file.display()));
    assert!(saved.status.success() && file.exists(), "{saved:?}");
    assert_eq!((files(&recording), files(&temporary).len()), (before.clone(), 0));
    // For a browser it is a temporary file until the viewer ends.
    let mut command = Command::new(TOMCOM);
    command.args(["review", &recording.display().to_string(), "--web"]).env("TMPDIR", &temporary);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").stdout(Stdio::piped());
    let mut served = command.spawn().expect("runs");
    let mut lines = BufReader::new(served.stdout.take().expect("its output")).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("http://")), "it is served");
    assert_eq!((files(&recording), files(&temporary).len()), (before, 1));
    until_it_listens_to_signals(served.id());
    kill_process(Pid::from_child(&served), Signal::TERM).expect("it runs");
    served.wait().expect("it ends");
    assert_eq!(files(&temporary).len(), 0);
    drop(lock);
    let saved = review("--save");
    assert!(saved.status.success() && recording.join("recording.rrd").exists(), "{saved:?}");
    assert_eq!(files(&temporary).len(), 0);
}

#[test]
fn an_error_about_codes_names_the_row_that_is_wrong() {
    let home = folder("damage-codes");
    let [session, out] = short_session(&home);
    done(&["simulate", &session, "--out", &out]);
    let recording = Path::new(&out).join("seed3-S001").display().to_string();
    let table = home.join("codes.csv");
    let head = "recording,rater,press,cause,aspect\n";
    let cases: [(&[u8], &str); 7] = [
        (b"seed3-S001,R1,x,slip,\n", "codes.csv:2: found the press \"x\""),
        (b"\n\nseed3-S001,R1,x,slip,\n", "codes.csv:4: found the press \"x\""),
        (b"\r\n\r\nseed3-S001,R1,7,slop,\r\n", "codes.csv:4: found the cause \"slop\""),
        (b"\nseed3-S001,R1,7,slip\n", "codes.csv:3: found record with 4 fields"),
        (b"\nother,R1,7,slip,\n", "codes.csv:3: found the recording \"other\""),
        (b"\nseed3-S001,M\xfcller,7,slip,\n", "codes.csv:3: found bytes that are no text in UTF-8"),
        (b"seed3-S001,\"R\n1\",7,slip,\n", "codes.csv:2: found the rater"),
    ];
    for (rows, says) in cases {
        fs::write(&table, [head.as_bytes(), rows].concat()).expect("written");
        refused(&["codes", &recording, "--import", &table.display().to_string()], says);
    }
    // Other files of a study in place of the table, and the table in place of the recording.
    let log = Path::new(&recording).join("events.jsonl").display().to_string();
    refused(&["codes", &recording, "--import", &log], "found a file that is no table of codes");
    fs::write(&table, "rater,press,cause,aspect\nR1,7,slip,\n").expect("written");
    let table = table.display().to_string();
    refused(&["codes", &recording, "--import", &table], "found one rater's codes of one recording");
    refused(&["codes", &table], &format!("tomcom codes RECORDING --import {table}"));
    assert!(!Path::new(&recording).join("codes-R1.csv").exists(), "nothing is taken of a table that is wrong");
}

#[test]
fn who_follows_a_log_that_vanishes_is_told_and_does_not_wait_for_ever() {
    let out = folder("vanished");
    let recording = out.join("running");
    fs::create_dir_all(&recording).expect("a folder");
    let text = fs::read_to_string("tests/golden/format-3-hand.jsonl").expect("a golden log");
    let lines: Vec<&str> = text.lines().collect();
    fs::write(recording.join(LOG_NAME), lines[..lines.len() - 1].join("\n") + "\n").expect("written");
    let mut child = start(&["replay", &recording.display().to_string(), "--follow"]);
    // The first lines are printed when the log is open.
    let mut printed = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut line = String::new();
    printed.read_line(&mut line).expect("a heading");
    printed.read_line(&mut line).expect("an event");
    fs::rename(&recording, out.join("moved")).expect("moved");
    let rest = std::thread::spawn(move || std::io::read_to_string(printed));
    let output = end("replay --follow", child);
    rest.join().expect("read").expect("text");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("it was removed or moved while it was followed"), "{told}");
}
