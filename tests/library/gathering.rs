//! Recordings that are read together: each trial counts once, whatever leads to it, however often it was copied and corrected.

use miette::Diagnostic;
use tomcom::run::forget;
use tomcom::run::recording_list::{RecordingListDetail, list};
use tomcom::run::series::recordings_of;
use tomcom_session::log::{CORRECTION_NAME, RecordingLock, correct, rule};
use tomcom_session::plan::{ParticipantProgress, RecordingOutcome, Study};
use tomcom_study::bids_export;
use tomcom_study::files::{corrected, recordings};
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope};
use tomcom_study::pass::{self, AnalysisRequest, NamedRecordings, describe};
use tomcom_study::planned_trial::copies_in_words;
use tomcom_study::standing::left_out;

use crate::support::*;

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("gathering/{name}"))
}

/// The log of a short trial in a plan.
fn log(root: &Path) -> String {
    let mut files = session_file("paper");
    files.spec.trial.presses = 6;
    let made = simulate_into(files, 1, &root.join("simulated"));
    let log = fs::read_to_string(made[0].join(LOG_NAME)).expect("a log");
    fs::remove_dir_all(root.join("simulated")).expect("removed");
    log
}

/// Records this log in a folder, as a trial of a person, with changes of its header.
fn record(folder: &Path, log: &str, change: impl FnOnce(&mut Value)) -> PathBuf {
    let (head, events) = log.split_once('\n').expect("a header");
    let mut header: Value = serde_json::from_str(head).expect("a header");
    header["started"] = json!("2026-03-14T10:00:00Z");
    change(&mut header);
    fs::create_dir_all(folder).expect("a folder");
    fs::write(folder.join(LOG_NAME), format!("{header}\n{events}")).expect("written");
    folder.to_path_buf()
}

/// Copies the files of a recording into another folder.
fn copy(recording: &Path, to: &Path) -> PathBuf {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(recording).expect("a recording") {
        let path = entry.expect("an entry").path();
        fs::copy(&path, to.join(path.file_name().expect("a name"))).expect("copied");
    }
    to.to_path_buf()
}

/// Records this log in two parts, the second of which continues the first.
fn record_parts(root: &Path, name: &str, log: &str) -> (PathBuf, PathBuf) {
    let lines: Vec<&str> = log.lines().collect();
    let half = lines.len() / 2;
    let first = record(&root.join(name), &(lines[..half].join("\n") + "\n"), |_| ());
    let event: Value = serde_json::from_str(lines[half]).expect("an event");
    let rest = format!("{}\n{}\n", lines[0], lines[half..].join("\n"));
    let second = record(&root.join(format!("{name}-part2")), &rest, |header| {
        header["continues"] = json!({ "recording": name, "events": event["seq"], "t_ns": event["t_ns"] });
    });
    (first, second)
}

fn number(paths: &[PathBuf]) -> usize {
    NamedRecordings::find(paths, &[]).expect("recordings").number()
}

fn refusal(paths: &[PathBuf]) -> String {
    GatheredRecordings::find(paths).expect_err("refused").to_string()
}

#[test]
fn a_recording_that_several_paths_lead_to_counts_once() {
    let root = folder("paths");
    let (log, all, other) = (log(&root), root.join("recordings"), root.join("other"));
    let code = |code: &str| {
        let code = code.to_string();
        move |header: &mut Value| header["session"]["participant"]["code"] = json!(code)
    };
    record(&all.join("P01-1"), &log, code("P01"));
    record(&all.join("P02-1"), &log, code("P02"));
    record(&other.join("P01-1"), &log, code("P03"));
    assert_eq!(number(std::slice::from_ref(&all)), 2);
    assert_eq!(
        number(&[all.clone(), other.join("../recordings"), all.join("P02-1"), all.join("P02-1/events.jsonl")]),
        2
    );
    assert_eq!(number(&[all.clone(), other]), 3, "recordings of one name in two folders are two");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&all, root.join("link")).expect("a link");
        std::os::unix::fs::symlink(all.join("P01-1"), all.join("again")).expect("a link");
        assert_eq!(number(&[all, root.join("link")]), 2);
    }
}

#[test]
fn of_two_equal_recordings_the_one_in_its_own_folder_counts() {
    let root = folder("copy-called");
    let log = log(&root);
    for copied in ["copy", "Copy of P01-1", "P01-1 (2)"] {
        let all = root.join("recordings");
        let own = record(&all.join("P01-1"), &log, |header| header["session"]["participant"]["code"] = json!("P01"));
        let copy = copy(&own, &all.join(copied));
        let found = GatheredRecordings::find(std::slice::from_ref(&all)).expect("recordings");
        assert_eq!(found.paths, [own]);
        assert_eq!(found.copies[0].recording, copy.display().to_string());
        fs::remove_dir_all(all).expect("removed");
    }
}

#[test]
fn one_plan_is_analysed_and_several_only_if_each_is_named() {
    let root = folder("plans");
    let log = log(&root);
    record(&root.join("a/P01-1"), &log, |_| ());
    record(&root.join("a/P02-1"), &log, |header| {
        header["session"]["step"]["plan"] = json!("another");
        header["session"]["participant"]["code"] = json!("P02");
    });
    let paths = [root.join("a")];
    let find = |plans: &[&str]| {
        let plans: Vec<String> = plans.iter().map(|plan| plan.to_string()).collect();
        NamedRecordings::find(&paths, &plans).map(|found| found.number()).map_err(|error| error.to_string())
    };
    let told = find(&[]).expect_err("two plans");
    assert!(told.contains("recordings of several plans: \"another\" (1 recording), \"paper\" (1 recording)"), "{told}");
    assert_eq!((find(&["paper"]), find(&["another"]), find(&["paper", "another"])), (Ok(1), Ok(1), Ok(2)));
    assert!(find(&["no-plan"]).expect_err("no such plan").contains("no recording of the plan \"no-plan\""));
    // One code in two plans would be one participant.
    record(&root.join("a/P01-2"), &log, |header| header["session"]["step"]["plan"] = json!("another"));
    let told = find(&["paper", "another"]).expect_err("one code");
    assert!(told.contains("recordings of P01 in the plan"), "{told}");
    assert_eq!(find(&["another"]), Ok(2));
}

/// What was tried in the study's folder is none of the study: it is left out, and named in the terminal and in the report.
#[test]
fn what_is_none_of_the_study_is_left_out_and_named() {
    let root = folder("foreign");
    let (log, out) = (log(&root), root.join("sessions"));
    let person = |code: &'static str| {
        move |header: &mut Value| {
            header["session"]["participant"]["code"] = json!(code);
            header["session"]["participant"]["kind"] = json!("display");
            header["session"]["participant"]["gaze"] = json!("none");
        }
    };
    record(&out.join("P01-1"), &log, person("P01"));
    record(&out.join("P02-1"), &log, |header| header["session"]["participant"]["code"] = json!("P02"));
    // "tomcom" without a plan records the code of the default session.
    record(&out.join("tried"), &log, |header| {
        person("P01")(header);
        header["session"].as_object_mut().expect("settings").remove("step");
    });
    let scope = AnalysisScope { concepts: false, events: false, raters: None };
    let (paths, results) = (vec![out.clone()], folder("foreign-results"));
    let request = AnalysisRequest { paths, out: results, scope, frozen: None };
    for plans in [vec![], vec!["paper".to_string()]] {
        let found = NamedRecordings::find(&request.paths, &plans).expect("recordings");
        let (figures, report) = pass::study(&request, &found, || ()).expect("analysed");
        assert_eq!((figures.trials, figures.participants, figures.simulated_participants), (1, 1, false));
        let words = "1 recording is of no plan, beside those of a plan, and left out: tried; 1 recording is of a simulated \
                     participant, beside those of people, and left out: P02-1";
        assert!(describe(&figures).contains(words), "{}", describe(&figures));
        assert!(fs::read_to_string(report).expect("a report").contains(words));
        let told = bids_export::export(&request.paths, &root.join("bids"), false, || ()).expect("exported");
        assert_eq!(told.recordings.len(), 1);
        assert!(bids_export::describe(&told).contains(words));
        fs::remove_dir_all(root.join("bids")).expect("removed");
    }
    // Without the one trial that counts there is no study, and a report would be empty.
    record(&out.join("P01-practice"), &log, |header| {
        person("P01")(header);
        header["session"]["step"].as_object_mut().expect("a step").remove("period");
    });
    rule(&out.join("P01-1"), true, "lights went out").expect("excluded");
    let found = NamedRecordings::find(&request.paths, &[]).expect("recordings");
    let request = AnalysisRequest { out: root.join("nothing"), ..request };
    let told = pass::study(&request, &found, || ()).expect_err("nothing counts").to_string();
    let words = "no trial that counts: 1 recording of practice; left out: P01-1 (excluded: lights went out); 1 recording is of \
                 no plan, beside those of a plan, and left out: tried; 1 recording is of a simulated participant, beside";
    assert!(told.contains(words), "{told}");
    assert!(!request.out.exists(), "no report");
}

#[test]
fn two_recordings_that_count_for_one_trial_are_refused_with_both_names() {
    let root = folder("twice");
    let log = log(&root);
    let at = |time: &str| {
        let time = time.to_string();
        move |header: &mut Value| header["started"] = json!(time)
    };
    let first = record(&root.join("a/P01-1"), &log, at("2026-03-14T10:00:00Z"));
    let second = record(&root.join("b/P01-1"), &log, at("2026-03-14T12:00:00Z"));
    let both = [root.join("b"), root.join("a")];
    let told = refusal(&both);
    assert!(told.contains(&second.display().to_string()), "{told}");
    assert!(told.contains("a second recording of trial 1 of participant P01 in the plan \"paper\""), "{told}");
    assert!(told.contains(&format!("which {} is a recording of", first.display())), "{told}");
    assert!(NamedRecordings::find(&both, &[]).is_err());
    // What does not count is no second recording: excluded, cut, another trial, practice, another plan, no plan.
    let told = rule(&second, false, "").expect_err("it was never excluded").to_string();
    assert!(told.contains("no exclusion of"), "{told}");
    assert!(!second.join("exclusion.toml").exists());
    rule(&second, true, "the first one is right").expect("excluded");
    assert_eq!(number(&both), 2);
    fs::remove_dir_all(&second).expect("removed");
    let lines: Vec<&str> = log.lines().collect();
    record(&second, &(lines[..lines.len() / 2].join("\n") + "\n"), at("2026-03-14T12:00:00Z"));
    assert_eq!(number(&both), 2);
    type Change = fn(&mut Value);
    let others: [Change; 5] = [
        |header| header["session"]["step"]["period"] = json!(2),
        |header| header["session"]["step"]["period"] = Value::Null,
        |header| header["session"]["step"]["plan"] = json!("another"),
        |header| header["session"]["participant"]["code"] = json!("P02"),
        |header| header["session"]["step"] = Value::Null,
    ];
    for change in others {
        record(&second, &log, |header| {
            change(header);
            let header = header.as_object_mut().expect("a header");
            let session = header["session"].as_object_mut().expect("settings");
            session.retain(|_, value| !value.is_null());
            if let Some(step) = session.get_mut("step").and_then(Value::as_object_mut) {
                step.retain(|_, value| !value.is_null());
            }
        });
        assert_eq!(GatheredRecordings::find(&both).expect("recordings").paths.len(), 2);
    }
    record(&second, &log, |header| header["session"]["participant"]["code"] = json!("p01"));
    let told = refusal(&both);
    assert!(told.contains("a recording of P01, beside") && told.contains("which is one of p01"), "{told}");
    // Another version of the plan is the same plan; simulated people of another seed are others.
    record(&second, &log, |header| header["session"]["step"]["digest"] = json!("another"));
    assert!(refusal(&both).contains("a second recording"));
    let simulated = |folder: &Path, seed: u64| {
        record(folder, &log, |header| {
            header.as_object_mut().expect("a header").remove("started");
            header["program"] = json!(format!("0.9.{seed}"));
            header["session"]["seed"] = json!(seed / 2);
        })
    };
    simulated(&first, 2);
    simulated(&second, 4);
    assert_eq!(number(&both), 2);
    simulated(&second, 3);
    assert!(refusal(&both).contains("a second recording of trial 1 of participant P01 (simulated, seed 1)"));
    // Tables would make one participant of a person and a simulation with the same code, whichever trials they are.
    for period in [1, 2] {
        record(&second, &log, |header| header["session"]["step"]["period"] = json!(period));
        let told = refusal(&both);
        assert!(told.contains("a simulated recording of P01 in the plan \"paper\""), "{told}");
        assert!(told.contains(&format!("beside {}, which was recorded live", second.display())), "{told}");
    }
    rule(&second, true, "a rehearsal").expect("excluded");
    assert_eq!(number(&both), 2);
}

#[test]
fn copies_count_once_and_are_told() {
    let root = folder("copies");
    let log = log(&root);
    let first = record(&root.join("P01-1"), &log, |_| ());
    let copied = copy(&first, &root.join("P01-1 - Copy"));
    let elsewhere = copy(&first, &root.join("backup/0"));
    let found = GatheredRecordings::find(&[elsewhere.clone(), root.clone()]).expect("recordings");
    assert_eq!(found.paths, std::slice::from_ref(&first), "the one whose folder names the participant");
    let copies: Vec<(&str, &str)> =
        found.copies.iter().map(|one| (one.recording.as_str(), one.copy_of.as_str())).collect();
    let [first_name, copied_name, elsewhere_name] =
        [&first, &copied, &elsewhere].map(|path| path.display().to_string());
    assert_eq!(copies, [(elsewhere_name.as_str(), first_name.as_str()), (&copied_name, &first_name)]);
    assert_eq!(number(&[root.clone(), root.join("backup")]), 1);
    // A plan goes on where it was, and does not offer the copy of a recording.
    let made = recordings::of_plan(&root, "paper").expect("recordings").0;
    let made: Vec<(&str, &RecordingOutcome)> = made.iter().map(|one| (one.recording.as_str(), &one.outcome)).collect();
    assert_eq!(made.len(), 1, "{made:?}");
    assert_eq!(made[0].0, "P01-1");
    // An excluded copy is a copy that does not count; the other one counts, and the reason is told.
    for (excluded, counted) in [(&copied, &first), (&first, &copied)] {
        rule(excluded, true, "a copy").expect("excluded");
        let found = GatheredRecordings::find(std::slice::from_ref(&root)).expect("recordings");
        assert_eq!(found.paths, std::slice::from_ref(counted));
        assert_eq!(found.copies[0].left_out.as_deref(), Some("excluded: a copy"));
        let told = copies_in_words(&found.copies).expect("a copy");
        assert!(
            told.ends_with(&format!("{} (excluded: a copy) of {}", excluded.display(), counted.display())),
            "{told}"
        );
        rule(excluded, false, "").expect("taken back");
        assert_eq!(number(std::slice::from_ref(&root)), 1);
    }
    rule(&first, true, "interrupted").expect("excluded");
    rule(&copied, true, "interrupted").expect("excluded");
    assert_eq!(number(std::slice::from_ref(&root)), 1);
}

#[test]
fn nearly_equal_copies_count_once_and_the_longest_counts() {
    let root = folder("near-copies");
    let log = log(&root);
    // Without a plan, nothing else tells that the copies are recordings of one trial.
    let without_plan = |header: &mut Value| {
        header["session"].as_object_mut().expect("settings").remove("step");
    };
    let first = record(&root.join("P01-1"), &log, without_plan);
    let text = fs::read_to_string(first.join(LOG_NAME)).expect("a log");
    let last = text.trim_end().rfind('\n').expect("lines");
    let copies = [
        ("empty line", format!("{text}\n")),
        ("other system", text.replace('\n', "\r\n")),
        ("no last line end", text.trim_end().to_string()),
        ("before the end", text[..=last].to_string()),
        ("within a line", text[..last - 20].to_string()),
        ("header alone", text[..=text.find('\n').expect("a header")].to_string()),
    ];
    // Folders before the recording by name, and after it.
    for (name, copy) in
        copies.iter().flat_map(|(name, copy)| [(format!("A {name}"), copy), (format!("Z {name}"), copy)])
    {
        let folder = root.join(&name);
        fs::create_dir_all(&folder).expect("a folder");
        fs::write(folder.join(LOG_NAME), copy).expect("written");
        let found = GatheredRecordings::find(std::slice::from_ref(&root)).expect("recordings");
        assert_eq!((found.paths.len(), found.copies.len()), (1, 1), "{name}");
        assert_eq!(found.paths[0], first, "{name}");
        fs::remove_dir_all(folder).expect("removed");
    }
    // Another session, and another event, are no copies.
    let other = root.join("other");
    record(&other, &log, |header| {
        without_plan(header);
        header["started"] = json!("2026-03-14T11:00:00Z");
    });
    assert_eq!(number(std::slice::from_ref(&root)), 2);
    fs::write(other.join(LOG_NAME), text.replacen("\"kind\":\"press\"", "\"kind\":\"prext\"", 1)).expect("written");
    assert_eq!(number(std::slice::from_ref(&root)), 2);
}

#[test]
fn a_plan_does_not_offer_a_copy_that_was_made_before_the_end() {
    let root = folder("plan-copies");
    let log = log(&root);
    let first = record(&root.join("P01-1"), &log, |_| ());
    let text = fs::read_to_string(first.join(LOG_NAME)).expect("a log");
    fs::create_dir_all(root.join("A copy")).expect("a folder");
    fs::write(root.join("A copy").join(LOG_NAME), &text[..text.len() / 2]).expect("written");
    let made = recordings::of_plan(&root, "paper").expect("recordings").0;
    assert_eq!(made.iter().map(|one| one.recording.as_str()).collect::<Vec<_>>(), ["P01-1"]);
}

#[test]
fn codes_beside_a_copy_alone_are_named_and_are_not_lost() {
    let root = folder("codes-of-copies");
    let log = log(&root);
    let first = record(&root.join("K1/P01-1"), &log, |_| ());
    let copied = copy(&first, &root.join("K2/P01-1"));
    let both = [root.join("K1"), root.join("K2")];
    let codes = |folder: &Path, rater: &str, cause: &str| {
        let text = format!("rater,press,cause,aspect\n{rater},1,{cause},\n");
        fs::write(folder.join(format!("codes-{rater}.csv")), text).expect("written");
    };
    // The copy with all codes counts.
    codes(&copied, "R2", "slip");
    let found = GatheredRecordings::find(&both).expect("recordings");
    assert_eq!(found.paths, std::slice::from_ref(&copied));
    codes(&first, "R1", "slip");
    let told = GatheredRecordings::find(&both).expect_err("refused");
    let help = told.help().map(|help| help.to_string()).unwrap_or_default();
    let (first_name, copied_name) = (first.display().to_string(), copied.display().to_string());
    assert!(told.to_string().contains(&format!("a copy of {first_name} with codes-R2.csv, which is not in")), "{told}");
    assert!(help.contains(&format!("tomcom codes {copied_name} --export codes.csv")), "{help}");
    // The way out that the message names.
    fs::copy(copied.join("codes-R2.csv"), first.join("codes-R2.csv")).expect("copied");
    assert_eq!(GatheredRecordings::find(&both).expect("recordings").paths, std::slice::from_ref(&first));
    codes(&copied, "R2", "race");
    assert!(refusal(&both).contains(&format!("a copy of {first_name} with another codes-R2.csv")));
    rule(&copied, true, "a copy").expect("excluded");
    assert_eq!(number(&both), 1);
    rule(&copied, false, "").expect("taken back");
    fs::remove_file(copied.join("codes-R2.csv")).expect("removed");
    correct(&copied, Some("P03"), "typed wrong").expect("corrected");
    assert!(refusal(&both).contains("that is a recording of P03, not of P01"));
}

#[test]
fn a_copy_of_an_earlier_part_is_no_recording_of_its_own() {
    let root = folder("parts");
    let (first, _) = record_parts(&root, "P01-1", &log(&root));
    assert_eq!(number(std::slice::from_ref(&root)), 1);
    assert_eq!(number(&[root.join("P01-1"), root.join("P01-1-part2")]), 1, "a part is read with the last one");
    copy(&first, &root.join("P01-1 - Copy"));
    let found = GatheredRecordings::find(std::slice::from_ref(&root)).expect("recordings");
    assert_eq!(found.paths, [root.join("P01-1-part2")]);
    assert_eq!(found.copies[0].recording, root.join("P01-1 - Copy").display().to_string());
    assert_eq!(found.copies[0].copy_of, root.join("P01-1-part2").display().to_string());
    // No recording is judged by thresholds that were chosen on itself.
    let both = found.beside(&GatheredRecordings::find(&[root.join("P01-1 - Copy")]).expect("a recording"));
    assert!(both.expect_err("refused").to_string().contains("named for two purposes"));
}

#[test]
fn a_recording_that_is_still_made_is_running_and_not_cut() {
    let root = folder("running");
    let log = log(&root);
    let recording = record(&root.join("P01-1"), &log, |_| ());
    let text = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let half: Vec<&str> = text.lines().take(text.lines().count() / 2).collect();
    fs::write(recording.join(LOG_NAME), half.join("\n") + "\n").expect("cut");
    let lock = RecordingLock::take(&recording).expect("a lock");
    assert_eq!(left_out(&recording).expect("readable").as_deref(), Some("running: its trial is not over"));
    // An export has what is over, and names what is not.
    let over = record(&root.join("P02-1"), &log, |header| header["session"]["participant"]["code"] = json!("P02"));
    let export = |paths: &[PathBuf]| bids_export::export(paths, &root.join("bids"), false, || ());
    let told = export(std::slice::from_ref(&recording)).expect_err("nothing is over").to_string();
    assert!(told.contains("P01-1: found a recording that is still being written"), "{told}");
    let summary = export(&[recording.clone(), over]).expect("exported");
    assert_eq!(summary.recordings.len(), 1);
    let told = bids_export::describe(&summary);
    assert!(told.contains("1 recording is still being written, and left out: P01-1\n"), "{told}");
    drop(lock);
    assert_eq!(left_out(&recording).expect("readable").as_deref(), Some("cut before the trial's end"));
    // What counts is the trial: only the session's end is missing.
    fs::write(recording.join(LOG_NAME), &text[..=text.trim_end().rfind('\n').expect("lines")]).expect("written");
    assert_eq!(left_out(&recording).expect("readable"), None);
}

/// A plan of two participants with short trials, and a recording of each trial, as if people had taken part.
fn recorded(out: &Path) -> Study {
    let mut files = session_file("paper");
    files.spec.trial.presses = 6;
    let study = files.study().expect("a plan");
    let simulated = out.join("simulated");
    for recording in simulate_into(files, 4, &simulated) {
        let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
        let name = recording.file_name().expect("a name").to_string_lossy().replace("seed1-", "");
        record(&out.join(name), &log, |_| ());
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
fn a_list_fits_a_narrow_terminal_and_keeps_the_names_of_recordings_whole() {
    let out = folder("narrow");
    recorded(&out);
    rule(&out.join("P02-1"), true, "lights went out").expect("excluded");
    let list = list(&out, RecordingListDetail::WithErrors, |_| (), || ()).expect("a folder").0;
    let shown = |columns: u16| {
        let told = list.describe(columns);
        let rows: Vec<&str> = told.lines().collect();
        assert!(rows[..rows.len() - 1].iter().all(|row| row.chars().count() <= usize::from(columns)), "{told}");
        list.recordings.iter().for_each(|one| assert!(told.contains(&format!("  {}\n", one.recording)), "{told}"));
        (rows[0].split_whitespace().collect::<Vec<_>>().join(" "), told.contains("of paper"))
    };
    let whole = list.describe(u16::MAX);
    assert!(whole.contains("P02-1  (excluded: lights went out)\n"), "{whole}");
    assert_eq!(shown(68), ("code kind condition length errors state recording".to_string(), false));
    assert_eq!(shown(52), ("code kind condition state recording".to_string(), false));
    assert_eq!(shown(42), ("code kind condition state".to_string(), false));
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
    let scope = AnalysisScope { concepts: false, events: false, raters: None };
    let read = reading::read(&recording, "one", &scope, &mut KeptCost::default()).expect("readable");
    assert_eq!(read.expect("a trial").1.trial.participant, "P03");
    let all = GatheredRecordings::find(std::slice::from_ref(&out)).expect("recordings");
    let bids = folder("bids");
    let summary = bids_export::export(&all.paths, &bids.join("data"), false, || ()).expect("exported");
    let place = summary.recordings.iter().find(|one| one.recording == recording.clone().into()).expect("exported");
    assert!(place.place.starts_with("sub-P03/"), "{}", place.place);
    // The plan: P03 has the trial, and P02 does it again.
    let made = recordings::of_plan(&out, "paper").expect("recordings").0;
    let done = |participant: usize| {
        let progress = ParticipantProgress::from_recordings(&plan, participant, &made).expect("recordings of the plan");
        progress.steps.iter().map(|step| step.is_done).collect::<Vec<bool>>()
    };
    assert_eq!([done(0), done(1), done(2)], [vec![true, true], vec![false, true], vec![true, false]]);
    // What belongs to P02 goes without the recording.
    let found = |code: &str| forget::find(&out, &out.join("nothing"), code).expect("a folder").recordings;
    assert_eq!([found("P02"), found("P03")], [vec![out.join("P02-2")], vec![recording.clone()]]);

    let request = AnalysisRequest { paths: vec![out.clone()], out: folder("results"), scope, frozen: None };
    let (figures, report) =
        pass::study(&request, &NamedRecordings::find(&request.paths, &[]).expect("recordings"), || ())
            .expect("analysed");
    let words = "code of the participant corrected: P02-1: P02 is P03 (the code of the day before; ";
    assert!(describe(&figures).contains(words), "{}", describe(&figures));
    // Of the corrected recording alone nobody knows whether its code is one of the plan.
    let missing = "2 trials of the plan \"paper\" have no recording: P02 trial 1; P03 (a corrected code, perhaps none of the plan) \
                   trial 2; codes were corrected of: P02-1 (";
    assert!(describe(&figures).contains(missing), "{}", describe(&figures));
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
    // A recording of the same trial that is left out is no second one.
    let correction = correct(&recording, Some("P01"), "why").expect("corrected");
    let is_second = || {
        let told = corrected::remarks(&recording, &correction).expect("readable");
        told.iter().any(|remark| remark.starts_with("P01 has a recording of trial 1 of the plan \"paper\" already"))
    };
    assert!(is_second());
    rule(&out.join("P01-1"), true, "the wrong person").expect("excluded");
    assert!(!is_second());
    fs::write(recording.join(CORRECTION_NAME), "[[correction]]\nbefore = 1\n").expect("written");
    let told = LogReader::open(&recording).expect_err("refused").to_string();
    assert!(told.contains("correction.toml:2"), "{told}");
}

#[test]
fn all_parts_of_a_recording_are_corrected() {
    let out = folder("corrected-parts");
    recorded(&out);
    let log = fs::read_to_string(out.join("P02-1").join(LOG_NAME)).expect("a log");
    let (whole, part) = record_parts(&out, "P02-1", &log);
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
