//! A participant's code that was typed wrong when the session began is corrected for every reader.

use std::fs;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde_json::{Value, json};
use tomcom::edge::files::read_session;
use tomcom::edge::forget;
use tomcom::run::recording_list::{RecordingListDetail, list};
use tomcom::run::series::recordings_of;
use tomcom::run::simulate::{SimulationRequest, simulate};
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::{CORRECTION_NAME, LOG_NAME, LogReader, correct, rule};
use tomcom_session::plan::{ParticipantProgress, Study};
use tomcom_study::bids_export;
use tomcom_study::files::recordings;
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope};
use tomcom_study::pass::{self, AnalysisRequest, NamedRecordings, describe};

/// An empty folder for the test of this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("corrections").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// A plan of two participants with short trials, and a recording of each trial, as if people had taken part.
fn recorded(out: &Path) -> Study {
    let mut files = read_session(Path::new("sessions/paper.toml")).expect("the paper's session");
    files.spec.trial.presses = 6;
    let study = files.study().expect("a plan");
    let simulated = out.join("simulated");
    let request = SimulationRequest { files, trials: 4, shard: SimulationShard::WHOLE, out: simulated.clone() };
    for recording in simulate(&request, || ()).expect("a folder").recordings {
        let log = fs::read_to_string(Path::new(&recording).join(LOG_NAME)).expect("a log");
        let (head, events) = log.split_once('\n').expect("a header");
        let mut header: Value = serde_json::from_str(head).expect("a header");
        header["started"] = json!("2026-03-14T10:00:00Z");
        let name = Path::new(&recording).file_name().expect("a name").to_string_lossy().replace("seed1-", "");
        fs::create_dir_all(out.join(&name)).expect("a folder");
        fs::write(out.join(name).join(LOG_NAME), format!("{header}\n{events}")).expect("written");
    }
    fs::remove_dir_all(simulated).expect("removed");
    study
}

fn code(recording: &Path) -> String {
    LogReader::open(recording).expect("a recording").header.session.participant.code
}

/// The codes that the list of a folder shows, by recording.
fn listed(folder: &Path) -> Vec<(String, String)> {
    let (list, _) = list(folder, RecordingListDetail::WithErrors, |_| (), || ()).expect("a folder");
    let mut rows: Vec<(String, String)> =
        list.recordings.into_iter().map(|row| (row.recording, row.code.unwrap_or_default())).collect();
    rows.sort();
    rows
}

#[test]
fn every_reader_has_the_corrected_code_until_it_is_taken_back() {
    let out = folder("readers");
    let plan = recorded(&out);
    let recording = out.join("P02-1");
    let log = fs::read(recording.join(LOG_NAME)).expect("a log");
    let before = listed(&out);
    let correction = correct(&recording, Some("P03"), "the code of the day before").expect("corrected");
    assert_eq!((correction.before.as_str(), correction.after.as_str()), ("P02", "P03"));
    assert!(fs::read(recording.join(LOG_NAME)).expect("a log") == log, "the log stays as it is");
    let kept = fs::read_to_string(recording.join(CORRECTION_NAME)).expect("a file");
    assert!(kept.contains("before = \"P02\"") && kept.contains("why = \"the code of the day before\""), "{kept}");

    assert_eq!(code(&recording), "P03");
    let rows = listed(&out);
    assert_eq!(rows[2], ("P02-1".to_string(), "P03".to_string()), "{rows:?}");
    // The second list comes from the numbers that the first one kept.
    assert_eq!(listed(&out), rows);
    let extent = AnalysisScope { concepts: false, events: false };
    let read = reading::read(&recording, "one", extent, None, &mut KeptCost::default()).expect("readable");
    assert_eq!(read.expect("a trial").1.trial.participant, "P03");
    let all = GatheredRecordings::find(std::slice::from_ref(&out)).expect("recordings");
    let bids = folder("bids");
    let summary = bids_export::export(&all.paths, &bids.join("data"), false, || ()).expect("exported");
    let place = summary.recordings.iter().find(|one| one.recording == recording.clone().into()).expect("exported");
    assert!(place.place.starts_with("sub-P03/"), "{}", place.place);
    // The plan: P03 has the trial, and P02 does it again.
    let made = recordings::of_plan(&out, "paper").expect("recordings");
    let done = |participant: usize| {
        let progress = ParticipantProgress::from_recordings(&plan, participant, &made).expect("recordings of the plan");
        progress.steps.iter().map(|step| step.is_done).collect::<Vec<bool>>()
    };
    assert_eq!([done(0), done(1), done(2)], [vec![true, true], vec![false, true], vec![true, false]]);
    // What belongs to P02 goes without the recording.
    let found = |code: &str| forget::find(&out, &out.join("nothing"), code).expect("a folder").recordings;
    assert_eq!([found("P02"), found("P03")], [vec![out.join("P02-2")], vec![recording.clone()]]);

    let request =
        AnalysisRequest { paths: vec![out.clone()], out: folder("results"), extent, raters: None, frozen: None };
    let (figures, report) =
        pass::study(&request, &NamedRecordings::find(&request.paths).expect("recordings"), || ()).expect("analysed");
    let words = "code of the participant corrected: P02-1: P02 is P03 (the code of the day before; ";
    assert!(describe(&figures).contains(words), "{}", describe(&figures));
    assert!(describe(&figures).contains("2 trials of the plan have no recording: P02 trial 1; P03 trial 2"));
    assert!(fs::read_to_string(report).expect("a report").contains(words));

    assert!(correct(&recording, Some("P03"), "again").expect_err("refused").to_string().contains("has already"));
    assert!(correct(&recording, Some("NA"), "why").expect_err("refused").to_string().contains("the code \"NA\""));
    assert!(correct(&recording, Some("P04"), " ").expect_err("refused").to_string().contains("found an empty reason"));
    assert!(correct(&recording, Some(""), "why").expect_err("refused").to_string().contains("at least one letter"));
    assert!(correct(&recording, Some("P04"), "a\nb").expect_err("refused").to_string().contains("a line break"));
    let told = correct(&recording, Some("p01"), "why").expect_err("refused").to_string();
    assert!(told.contains("the code p01, beside P01-") && told.contains("which is a recording of P01"), "{told}");
    assert_eq!(code(&recording), "P03");
    // A code that is not in the plan: neither a plan nor its series counts on without the recording.
    correct(&recording, Some("P99"), "why").expect("the plan is not in the log");
    let told = recordings_of(&plan, &out).expect_err("refused");
    let help = told.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(told.to_string().contains("the recording P02-1 of P99, a participant who is not in the plan"), "{told}");
    assert!(help.contains("tomcom correct") && help.contains("--undo"), "{help}");
    correct(&recording, None, "").expect("taken back");
    assert_eq!(code(&recording), "P02");
    assert_eq!(listed(&out), before);
    let told = correct(&recording, None, "").expect_err("refused").to_string();
    assert!(told.contains("no correction of the code P02"), "{told}");
    fs::write(recording.join(CORRECTION_NAME), "[[correction]]\nbefore = 1\n").expect("written");
    let told = LogReader::open(&recording).expect_err("refused").to_string();
    assert!(told.contains("correction.toml:2"), "{told}");
}

#[test]
fn all_parts_of_a_recording_are_corrected() {
    let out = folder("parts");
    recorded(&out);
    let whole = out.join("P02-1");
    let log = fs::read_to_string(whole.join(LOG_NAME)).expect("a log");
    let lines: Vec<&str> = log.lines().collect();
    let half = lines.len() / 2;
    let part = out.join("P02-1-part2");
    fs::create_dir_all(&part).expect("a folder");
    let event: Value = serde_json::from_str(lines[half]).expect("an event");
    let mut header: Value = serde_json::from_str(lines[0]).expect("a header");
    header["continues"] = json!({ "recording": "P02-1", "events": event["seq"], "t_ns": event["t_ns"] });
    fs::write(part.join(LOG_NAME), format!("{header}\n{}\n", lines[half..].join("\n"))).expect("written");
    fs::write(whole.join(LOG_NAME), lines[..half].join("\n") + "\n").expect("written");
    let told = correct(&whole, Some("P03"), "why").expect_err("a later part continues it").to_string();
    assert!(told.contains("was continued already"), "{told}");
    let told = rule(&whole, true, "why").expect_err("a later part continues it");
    let help = told.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(help.contains("the last part of the recording") && help.contains("P02-1-part2"), "{help}");
    correct(&part, Some("P03"), "why").expect("corrected");
    assert_eq!([code(&whole), code(&part)], ["P03", "P03"]);
    let found = |code: &str| forget::find(&out, &out.join("nothing"), code).expect("a folder").recordings;
    assert_eq!(found("P03"), [whole.clone(), part.clone()], "nothing of the participant is left");
    let mut reader = LogReader::open(&part).expect("a recording");
    while reader.next_line().expect("all parts can be read").is_some() {}
    // A part that continues a corrected recording has the right code in its log; the first code comes back all the same.
    let text = fs::read_to_string(part.join(LOG_NAME)).expect("a log");
    fs::write(part.join(LOG_NAME), text.replacen("\"code\":\"P02\"", "\"code\":\"P03\"", 1)).expect("written");
    fs::remove_file(part.join(CORRECTION_NAME)).expect("removed");
    assert_eq!(code(&part), "P03");
    correct(&part, None, "").expect("taken back");
    assert_eq!([code(&whole), code(&part)], ["P02", "P02"]);
}
