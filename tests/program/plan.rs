//! Plans, as the program carries them out: simulated participants, what is refused, and a participant at the console.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::Value;
use tomcom::run::files::read_session;
use tomcom_session::LogHeader;
use tomcom_session::log::LOG_NAME;
use tomcom_session::plan::{PlanPosition, Study, WantedRecording};
use tomcom_session::settings::Condition;

use crate::program::{done, folder, json, refused, tiny_plan, tomcom, verified};
use crate::pseudo_terminal::Terminal;

fn study() -> Study {
    read_session(Path::new("sessions/study.toml")).expect("the study of the project").study().expect("a plan")
}

/// The step of a recording, from its header.
fn step(recording: &Path) -> (String, Condition, PlanPosition) {
    let text = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let header: LogHeader = serde_json::from_str(text.lines().next().expect("a header")).expect("a header");
    let step = header.session.step.expect("a step of the plan");
    (header.session.participant.code, header.session.trial.condition, step)
}

#[test]
fn simulated_participants_have_both_trials_of_the_plan() {
    let out = folder("plan-simulated");
    let out_name = out.to_str().expect("UTF-8");
    let simulate = |trials: &str, out: &str| {
        json(&["simulate", "sessions/study.toml", "--trials", trials, "--arm", "timed", "--out", out])
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
    verified(Path::new(recordings[1]));
    let alone = folder("plan-simulated-alone");
    simulate("1", alone.to_str().expect("UTF-8"));
    let same = Path::new("seed1-P01-1").join(LOG_NAME);
    assert!(fs::read(alone.join(&same)).expect("a log") == fs::read(out.join(&same)).expect("a log"));
    let plan = json(&["plan", "sessions/study.toml", "--out", out_name]);
    assert_eq!(
        (&plan["finished"], &plan["simulated"]),
        (&Value::from(0), &Value::from(3)),
        "simulated trials fill no plan"
    );
    let told = done(&["plan", "sessions/study.toml", "--out", out_name]);
    let words =
        "\nnot counted: 3 recordings of simulated participants, since tomcom simulate fills no plan; tomcom study ";
    assert!(told.contains(&format!("{words}{out_name} analyses them")), "{told}");
    let nowhere = format!("{out_name}/none-yet");
    let told = done(&["plan", "sessions/study.toml", "--out", &nowhere]);
    assert!(told.contains(&format!("no recording of the plan is in {nowhere}, which does not exist; --out")), "{told}");
    refused(&["simulate", "sessions/study.toml", "--trials", "29", "--out", out_name], "--trials 29");
}

#[test]
fn wrong_plans_and_arguments_say_what_would_be_right() {
    let study = "sessions/study.toml";
    refused(&["plan", "sessions/default.toml"], "a session without a plan");
    refused(&["operate", study], "and no code of a participant");
    refused(&["operate", study, "--code", "P15"], "--code P15, a participant who is not in the plan \"study\"\n");
    refused(&["operate", study, "--code", "P15"], "--code with a code of the plan: P01 to P14 (14)");
    refused(&["operate", study, "--code", "p07"], "not in the plan \"study\"; did you mean P07?");
    refused(
        &["operate", study, "--code", "P01", "--condition", "none"],
        "--condition, with a session file that has a plan",
    );
    refused(&["operate", study, "--code", "P01", "--seed", "2"], "--seed, with a session file that has a plan");
    refused(&["operate", study, "--code", "P01", "--seed", "2"], "no --seed: the plan of the study decides");
    let root = env!("CARGO_MANIFEST_DIR");
    let wrong = folder("plan-wrong").join("study.toml");
    // The settings of a recording are no session file: its place in the plan is not for people to write.
    let (spec, _) = self::study().settings(WantedRecording { participant: 0, slot: 1, attempt: 1, instructed: true });
    let spec = toml::to_string(&spec).expect("settings").replace("\"../", &format!("\"{root}/"));
    let spec = spec.replace("\"questionnaires/", &format!("\"{root}/sessions/questionnaires/"));
    fs::write(&wrong, spec).expect("written");
    refused(&["plan", wrong.to_str().expect("UTF-8")], "the place of a recording in the plan \"study\"");
}

/// The plan's figures for the first participant.
fn first(session: &str, out: &str) -> Value {
    json(&["plan", session, "--out", out])["participants"][0].clone()
}

/// Answers every item with the same key, and confirms.
fn answer(terminal: &Terminal, key: &str) {
    terminal.see("How was it?");
    let confirms = || terminal.screen().contains("confirm the answers");
    let mut pressed = None;
    terminal.wait("all answers", || {
        // The key that goes on does nothing so soon after the last one.
        if !confirms() && pressed.is_none_or(|at: Instant| at.elapsed() > Duration::from_secs(1)) {
            [key, "Enter"].into_iter().for_each(|key| terminal.key(key));
            pressed = Some(Instant::now());
        }
        confirms()
    });
    terminal.turn_until("Enter", "the answers confirmed", || !confirms());
}

fn operate(terminal: &Terminal, session: &str) {
    terminal.run(&["operate", session, "--code", "A1", "--out", &terminal.recordings()]);
}

/// Answers a question before a recording: a digit chooses, and enter goes on.
fn choose(terminal: &Terminal, digit: &str) {
    terminal.key(digit);
    terminal.see(&format!("[{digit}]"));
    terminal.key("Enter");
}

/// A second console for a participant ends with these words, here without a terminal.
fn check_second_console(session: &str, out: &str, code: &str, says: &str) {
    let output = tomcom(&["operate", session, "--code", code, "--out", out]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains(says), "{says} is not in\n{told}");
}

/// The series goes on with the trial that a kill has cut, and comes to its end.
fn check_goes_on_after_a_kill(terminal: &Terminal, session: &str) {
    operate(terminal, session);
    terminal.see("A1: SIMULATED PARTICIPANT");
    choose(terminal, "1");
    terminal.see("A1: trial 1 is ");
    choose(terminal, "1");
    terminal.see("A1 trial 1/2");
    // The few presses may have been over before the kill, or not.
    terminal.wait("the trial's end", || {
        if terminal.screen().contains("PAUSED") {
            terminal.key(".");
        }
        terminal.screen().contains(". next phase: questionnaire")
    });
    terminal.key(".");
    answer(terminal, "4");
    terminal.key(".");
    terminal.see("A1 trial 2/2");
    terminal.begin();
    terminal.see(". next phase: questionnaire");
    terminal.key(".");
    answer(terminal, "7");
    terminal.turn_until("Enter", "the end", || terminal.has_ended());
}

#[test]
fn a_participant_goes_through_a_plan_at_the_console_and_over_a_kill() {
    let terminal = Terminal::open("plan");
    let (session, out) = (tiny_plan(&terminal.folder), terminal.recordings());
    // A person is asked for consent.
    terminal.run(&["operate", &session, "--code", "A1", "--out", &out, "--participant", "keyboard", "--gaze", "none"]);
    terminal.see("and agrees to");
    terminal.key("Enter");
    terminal.see("choose an answer by its digit");
    choose(&terminal, "2");
    terminal.is_whole(0);
    terminal.see("A1 does not agree to be recorded: nothing was recorded");
    assert!(!Path::new(&out).exists(), "nothing is recorded without consent");
    // A simulated participant has to be meant, and is asked nothing.
    operate(&terminal, &session);
    terminal.see("A1: SIMULATED PARTICIPANT");
    // In a narrow terminal the name of the folder may be broken.
    terminal.see("Its recordings go to the folder");
    choose(&terminal, "2");
    terminal.is_whole(0);
    assert!(!Path::new(&out).exists(), "nothing is recorded of a simulated participant that is not meant");
    operate(&terminal, &session);
    terminal.see("A1: SIMULATED PARTICIPANT");
    // From here on, no other console records this participant; the other one is free.
    check_second_console(&session, &out, "A1", "records A1 of the plan tiny");
    check_second_console(&session, &out, "B2", "the console cannot be opened");
    choose(&terminal, "1");
    terminal.see("Instruction of the participant");
    let plan = first(&session, &out);
    assert_eq!(plan["next"]["is"], "running", "{plan}");
    check_second_console(&session, &out, "A1", "records A1 of the plan tiny");
    terminal.turn_until("Enter", "the practice", || terminal.screen().contains("READY"));
    terminal.see("S I M U L A T E D   P A R T I C I P A N T");
    terminal.see("0 of 2 participants done");
    terminal.begin();
    terminal.see("The practice criterion is not met");
    terminal.key("2");
    terminal.see("waive for this reason");
    terminal.key("Enter");
    terminal.see("in words");
    terminal.key("Enter");
    terminal.see(". next recording");
    // What is typed while the next recording is prepared is no note in it.
    terminal.send(".1");
    terminal.see("A1 trial 1/2");
    terminal.key(".");
    terminal.see("questionnaire");
    terminal.kill();
    let listed = done(&["list", &out]);
    assert_eq!(listed.matches(" cut ").count(), 1, "the recording that was killed:\n{listed}");
    assert_eq!(first(&session, &out)["next"]["is"], "choose");
    check_goes_on_after_a_kill(&terminal, &session);
    terminal.is_whole(0);
    terminal.see("A1: everything is done");
    let plan = first(&session, &out);
    assert_eq!((&plan["consent"], &plan["next"]["is"]), (&Value::Bool(false), &Value::from("finished")), "{plan}");
    let recordings: Vec<PathBuf> =
        fs::read_dir(&out).expect("recordings").flatten().map(|entry| entry.path()).collect();
    recordings.iter().for_each(|recording| drop(verified(recording)));
    let says =
        |recording: &PathBuf, text: &str| fs::read_to_string(recording.join(LOG_NAME)).expect("a log").contains(text);
    let debriefs = |recording: &PathBuf| says(recording, "\"phase\":\"debriefing\"");
    assert!(recordings.iter().any(debriefs), "the last recording has the debriefing");
    assert!(!recordings.iter().any(|recording| says(recording, "\"kind\":\"marker\"")), "no note was written");
    operate(&terminal, &session);
    terminal.is_whole(0);
    assert_eq!(fs::read_dir(&out).expect("recordings").count(), 4, "nothing is recorded when everything is done");
    check_excluded_trial_is_repeated(&terminal, &session, &out);
}

/// A trial that is excluded after its session is done, and is repeated if the wizard asks for it.
fn check_excluded_trial_is_repeated(terminal: &Terminal, session: &str, out: &str) {
    let steps = first(session, out)["steps"].clone();
    let trial = steps.as_array().expect("steps").last().expect("a trial")["recordings"][0]["recording"].clone();
    let recording = format!("{out}/{}", trial.as_str().expect("a name"));
    assert!(tomcom(&["exclude", &recording, "--reason", "lights went out"]).status.success());
    let told = String::from_utf8_lossy(&tomcom(&["plan", session, "--out", out]).stdout).into_owned();
    let again = format!("everything is done, 1 excluded: repeat with tomcom operate {session} --code A1 --out {out}");
    // The terminal's width breaks the line.
    let words = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(&again), "{told}");
    assert!(words.contains("of a simulated participant at the console, and count here as those of"), "{told}");
    assert!(words.contains("), with a simulated participant"), "{told}");
    assert!(told.contains("1 of 2 participants have done everything (1 of them with an excluded trial)"), "{told}");
    // Its recordings are of a simulated participant.
    terminal.run(&["operate", session, "--code", "A1", "--out", out, "--participant", "keyboard", "--gaze", "none"]);
    terminal.see("A1: ANOTHER KIND OF PARTICIPANT");
    terminal.see("Now: person at the keyboard");
    terminal.see("To go on as before, leave");
    choose(terminal, "2");
    terminal.is_whole(0);
    // It is asked for, and left alone.
    operate(terminal, session);
    terminal.see("A1: SIMULATED PARTICIPANT");
    choose(terminal, "1");
    terminal.see("A1: excluded trials");
    terminal.see("is excluded: lights went out");
    choose(terminal, "1");
    terminal.is_whole(0);
    assert_eq!(first(session, out)["next"]["is"], "finished");
    // It is repeated.
    operate(terminal, session);
    terminal.see("A1: SIMULATED PARTICIPANT");
    choose(terminal, "1");
    terminal.see("2  repeat trial 2");
    choose(terminal, "2");
    terminal.see("A1, trial 2/2, attempt 2");
    terminal.begin();
    terminal.quit();
}
