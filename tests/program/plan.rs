//! Plans, as the program carries them out: simulated participants, what is refused, and a participant at the console.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use serial_test::serial;
use tomcom::edge::files::read_session;
use tomcom::edge::log::LOG_NAME;
use tomcom::run::verify::verify;
use tomcom::session::LogHeader;
use tomcom::session::plan::{PlanPosition, Study, WantedRecording};
use tomcom::session::settings::Condition;

use crate::tmux::{TOMCOM, Terminal, tiny_plan, tomcom};

fn study() -> Study {
    read_session(Path::new("sessions/study.toml")).expect("the study of the project").study().expect("a plan")
}

/// An empty folder for the test of this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plan-program").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn json(arguments: &[&str]) -> Value {
    let output = tomcom(arguments);
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// The step of a recording, from its header.
fn step(recording: &Path) -> (String, Condition, PlanPosition) {
    let text = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let header: LogHeader = serde_json::from_str(text.lines().next().expect("a header")).expect("a header");
    let step = header.session.step.expect("a step of the plan");
    (header.session.participant.code, header.session.trial.condition, step)
}

#[test]
#[serial]
fn simulated_participants_have_both_trials_of_the_plan() {
    let out = folder("simulated");
    let out_name = out.to_str().expect("UTF-8");
    let simulate = |trials: &str, out: &str| {
        json(&[
            "simulate",
            "sessions/study.toml",
            "--trials",
            trials,
            "--arm",
            "timed",
            "--out",
            out,
            "--format",
            "json",
        ])
    };
    let figures = simulate("3", out_name);
    let recordings: Vec<&str> =
        figures["recordings"].as_array().expect("paths").iter().flat_map(Value::as_str).collect();
    assert_eq!(recordings.len(), 3);
    let study = study();
    for (index, recording) in recordings.iter().enumerate() {
        let (code, condition, step) = step(Path::new(recording));
        assert_eq!(code, study.plan.codes()[index / 2]);
        assert_eq!((step.period, step.periods), (Some(index as u32 % 2 + 1), 2));
        assert_eq!(step.group, study.group(index / 2).name);
        assert_eq!(condition, Condition::None, "nobody is there to signal");
    }
    assert!(verify(Path::new(recordings[1])).expect("readable").verified);
    let alone = folder("simulated-alone");
    simulate("1", alone.to_str().expect("UTF-8"));
    let same = Path::new("seed1-P01-1").join(LOG_NAME);
    assert!(fs::read(alone.join(&same)).expect("a log") == fs::read(out.join(&same)).expect("a log"));
    let plan = json(&["plan", "sessions/study.toml", "--out", out_name, "--format", "json"]);
    assert_eq!(plan["finished"], 0, "simulated trials fill no plan");
    let too_many = tomcom(&["simulate", "sessions/study.toml", "--trials", "29", "--out", out_name]);
    assert_eq!(too_many.status.code(), Some(2), "{too_many:?}");
}

#[test]
#[serial]
fn wrong_plans_and_arguments_say_what_would_be_right() {
    let refused = |arguments: &[&str], says: &str| {
        let output = tomcom(arguments);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(says), "{says:?} is not in\n{told}");
    };
    let study = "sessions/study.toml";
    refused(&["plan", "sessions/default.toml"], "a session without a plan");
    refused(&["operate", study], "and no code of a participant");
    refused(&["operate", study, "--code", "P15"], "--code P15, a participant who is not in the plan");
    refused(
        &["operate", study, "--code", "P01", "--condition", "none"],
        "--condition, with a session file that has a plan",
    );
    refused(&["operate", study, "--code", "P01", "--seed", "2"], "--seed, with a session file that has a plan");
    refused(&["operate", study, "--code", "P01", "--seed", "2"], "no --seed: the plan of the study decides");
    let root = env!("CARGO_MANIFEST_DIR");
    let wrong = folder("wrong").join("study.toml");
    // The settings of a recording are no session file: its place in the plan is not for people to write.
    let (spec, _) = self::study().settings(WantedRecording { participant: 0, slot: 1, attempt: 1, instructed: true });
    let spec = toml::to_string(&spec).expect("settings").replace("\"../", &format!("\"{root}/"));
    let spec = spec.replace("\"questionnaires/", &format!("\"{root}/sessions/questionnaires/"));
    fs::write(&wrong, spec).expect("written");
    refused(&["plan", wrong.to_str().expect("UTF-8")], "the place of a recording in the plan \"study\"");
}

/// The plan's figures for the first participant.
fn first(session: &Path, out: &Path) -> Value {
    let [session, out] = [session, out].map(|path| path.display().to_string());
    json(&["plan", &session, "--out", &out, "--format", "json"])["participants"][0].clone()
}

/// Presses the key that goes on until the screen shows the text.
fn on_until(terminal: &Terminal, text: &str) {
    terminal.wait(&format!("\"{text}\" on the screen"), || {
        if terminal.screen().contains(text) {
            return true;
        }
        terminal.key("Enter");
        // Longer than a key that is still down from the last step.
        std::thread::sleep(std::time::Duration::from_millis(800));
        false
    });
}

/// Starts and lets run a trial; `then` is what the footer says when it is over.
fn trial(terminal: &Terminal, then: &str) {
    terminal.see("READY");
    std::thread::sleep(std::time::Duration::from_millis(800));
    terminal.key(".");
    terminal.see(then);
    std::thread::sleep(std::time::Duration::from_millis(800));
}

/// Answers every item with the same key, and confirms.
fn answer(terminal: &Terminal, key: &str) {
    terminal.see("How was it?");
    terminal.wait("all answers", || {
        if terminal.screen().contains("confirm the answers") {
            return true;
        }
        terminal.key(key);
        std::thread::sleep(std::time::Duration::from_millis(400));
        false
    });
    std::thread::sleep(std::time::Duration::from_millis(800));
    terminal.key("Enter");
    terminal.wait("the answers confirmed", || !terminal.screen().contains("confirm the answers"));
    std::thread::sleep(std::time::Duration::from_millis(800));
}

fn operate(terminal: &Terminal, session: &Path, out: &Path) {
    terminal.run(&format!("{TOMCOM} operate {} --code A1 --out {}", session.display(), out.display()));
}

/// A second console for a participant ends with these words, here without a terminal.
fn check_second_console(session: &Path, out: &Path, code: &str, says: &str) {
    let [session, out] = [session, out].map(|path| path.display().to_string());
    let output = tomcom(&["operate", &session, "--code", code, "--out", &out]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains(says), "{says} is not in\n{told}");
}

/// The series goes on with the trial that a kill has cut, and comes to its end.
fn check_goes_on_after_a_kill(other: &Terminal, session: &Path, out: &Path) {
    operate(other, session, out);
    other.see("A1: trial 1 is not done");
    other.key("1");
    other.see("A1 trial 1/2");
    // The few presses may have been over before the kill, or not.
    other.wait("the trial's end", || {
        if other.screen().contains("PAUSED") {
            other.key(".");
            std::thread::sleep(std::time::Duration::from_millis(800));
        }
        other.screen().contains(". next phase: questionnaire")
    });
    other.key(".");
    answer(other, "4");
    other.key(".");
    other.see("A1 trial 2/2");
    trial(other, ". next phase: questionnaire");
    other.key(".");
    answer(other, "7");
    on_until(other, "Debriefing of the wizard");
    other.wait("the end of the series", || {
        if other.folder.join("after").exists() {
            return true;
        }
        other.key("Enter");
        std::thread::sleep(std::time::Duration::from_millis(800));
        false
    });
}

#[test]
#[serial]
fn a_participant_goes_through_a_plan_at_the_console_and_over_a_kill() {
    let Some(terminal) = Terminal::open("plan") else { return };
    let (session, out) = (tiny_plan(&terminal.folder), terminal.folder.join("recordings"));
    operate(&terminal, &session, &out);
    terminal.see("and agrees to");
    terminal.key("2");
    terminal.is_whole("0");
    terminal.see("A1 does not agree to be recorded: nothing was recorded");
    assert!(!out.exists(), "nothing is recorded without consent");
    operate(&terminal, &session, &out);
    terminal.see("and agrees to");
    // From here on, no other console records this participant; the other one is free.
    check_second_console(&session, &out, "A1", "records A1 of the plan tiny");
    check_second_console(&session, &out, "B2", "the console cannot be opened");
    terminal.key("1");
    terminal.see("Instruction of the participant");
    let plan = first(&session, &out);
    assert_eq!(plan["next"]["is"], "running", "{plan}");
    check_second_console(&session, &out, "A1", "records A1 of the plan tiny");
    on_until(&terminal, "READY");
    trial(&terminal, "The practice criterion is not met");
    terminal.key("2");
    terminal.see("waive for this reason");
    terminal.key("Enter");
    terminal.see(". next recording");
    std::thread::sleep(std::time::Duration::from_millis(800));
    terminal.key(".");
    terminal.see("A1 trial 1/2");
    terminal.key(".");
    terminal.see("questionnaire");
    let pid = terminal.read("pid");
    let killed = std::process::Command::new("kill").args(["-KILL", pid.trim()]).status().expect("kill runs");
    assert!(killed.success());
    assert_eq!(first(&session, &out)["next"]["is"], "choose");
    let Some(other) = Terminal::open("plan-goes-on") else { return };
    check_goes_on_after_a_kill(&other, &session, &out);
    other.is_whole("0");
    other.see("A1: everything is done");
    let plan = first(&session, &out);
    assert_eq!((&plan["consent"], &plan["next"]["is"]), (&Value::Bool(true), &Value::from("finished")), "{plan}");
    for entry in fs::read_dir(&out).expect("recordings") {
        let recording = entry.expect("an entry").path();
        let found = verify(&recording).unwrap_or_else(|error| panic!("{error}"));
        assert!(found.verified, "{}: {found:?}", recording.display());
    }
    operate(&other, &session, &out);
    other.is_whole("0");
    assert_eq!(fs::read_dir(&out).expect("recordings").count(), 4, "nothing is recorded when everything is done");
}
