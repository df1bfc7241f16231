//! The study against its plan: plans that were frozen before it, and trials that have no recording.

use tomcom::run::plan::check_frozen;
use tomcom_session::header::CodeCorrection;
use tomcom_session::plan::listed;
use tomcom_study::figures::CorrectedRecording;
use tomcom_study::files::pool_file::{freeze, read_frozen};
use tomcom_study::frozen_plan::{
    FrozenDefinition, FrozenPlan, PlaceInPlan, PlanVersions, PreregistrationCheck, RecordedPlan,
};
use tomcom_study::planned_trial::{MissingTrials, in_words, missing_trials, other_orders};

use crate::support::*;

fn files() -> SessionSetup {
    session_file("arms")
}

fn frozen() -> FrozenPlan {
    let files = files();
    let study = files.study().expect("a plan");
    FrozenPlan::new(&study, [&files.kitchen.layout.text, &files.kitchen.recipes.text], 0)
}

/// A recording of every participant of the plan.
fn recordings(frozen: &FrozenPlan) -> Vec<RecordedPlan> {
    let plan = Some((frozen.plan.clone(), frozen.plan_digest.clone()));
    let recording = |code: &String| RecordedPlan { plan: plan.clone(), ..alone(code) };
    frozen.participants.iter().map(recording).collect()
}

/// A recording of no plan.
fn alone(code: &str) -> RecordedPlan {
    RecordedPlan { participant: code.to_string(), recorded_as: None, plan: None, place: None }
}

#[test]
fn a_recording_of_another_plan_is_none_of_a_participant_of_the_frozen_one() {
    let frozen = frozen();
    let mut all = recordings(&frozen);
    all[2].plan = Some(("another".to_string(), "0".to_string()));
    let told = differences(&frozen, &all);
    let code = &frozen.participants[2];
    assert_eq!(told, ["1 recording is of the plan \"another\""]);
    let check = PreregistrationCheck::new("0".to_string(), &frozen, &all, &PlanVersions::default(), 0);
    assert_eq!(check.to_come, std::slice::from_ref(code));
    assert!(check.words().ends_with(&format!("1 participant has no recording so far: {code}.")), "{}", check.words());
}

fn differences(frozen: &FrozenPlan, recordings: &[RecordedPlan]) -> Vec<String> {
    PreregistrationCheck::new("0".to_string(), frozen, recordings, &PlanVersions::default(), 0).differences
}

#[test]
fn a_frozen_plan_is_read_as_it_was_written_and_never_written_over() {
    let folder = empty_folder("frozen");
    let (file, plan) = (folder.join("arms.frozen"), frozen());
    let digest = freeze(&file, &plan).expect("frozen");
    assert_eq!(digest.len(), 64);
    assert_eq!(read_frozen(&file).expect("read"), (digest.clone(), plan.clone()));
    let text = fs::read_to_string(&file).expect("text");
    assert!(text.lines().next().is_some_and(|line| line.ends_with(&digest)), "{text}");
    let again = freeze(&file, &plan).expect_err("it is there").to_string();
    assert!(again.contains("a file that is there already"), "{again}");
    assert_eq!(fs::read_to_string(&file).expect("text"), text);
    for (edited, says) in [
        (text.replacen("\"margin\": 1.25", "\"margin\": 1.35", 1), "it was changed after"),
        (text.replacen(&digest[..8], "00000000", 1), "it was changed after"),
        (text.replacen("tomcom frozen", "my frozen", 1), "no frozen plan"),
        (String::new(), "no frozen plan"),
    ] {
        assert_ne!(edited, text);
        fs::write(&file, edited).expect("written");
        let told = read_frozen(&file).expect_err("changed").to_string();
        assert!(told.contains(says) && told.contains("arms.frozen:1"), "{told}");
    }
    let contrasts = plan.analysis.contrasts;
    assert!(
        contrasts.contains(&[StudyArm::TomCom, StudyArm::Wizard])
            && contrasts.contains(&[StudyArm::Wizard, StudyArm::None])
    );
    assert_eq!((plan.participants.len(), plan.groups.len()), (20, 20));
}

#[test]
fn each_difference_is_told() {
    let plan = frozen();
    let all = recordings(&plan);
    assert_eq!(differences(&plan, &all), Vec::<String>::new());
    let differs = |edit: fn(&mut FrozenPlan), says: &str| {
        let mut edited = plan.clone();
        edit(&mut edited);
        let found = differences(&edited, &all);
        assert!(matches!(&found[..], [one] if one.contains(says)), "{says}: {found:?}");
    };
    differs(|plan| plan.analysis.program = "0.0.1".to_string(), "was frozen for tomcom 0.0.1");
    differs(|plan| plan.analysis.methods[0].push('!'), "the methods of the analysis");
    differs(|plan| drop(plan.analysis.exclusions.pop()), "the exclusions of the analysis");
    differs(|plan| plan.analysis.level = 0.9, "frozen: 0.9");
    differs(|plan| plan.definitions[0].meaning.push('!'), "the definition of \"Regret, error\" is another one");
    differs(|plan| drop(plan.definitions.remove(1)), "the definition of \"Race\" is not in the frozen plan");
    differs(
        |plan| plan.definitions.push(FrozenDefinition { term: "Luck".to_string(), meaning: String::new() }),
        "the definition of \"Luck\" is gone",
    );
    let other = FrozenPlan { plan: "other".to_string(), ..plan.clone() };
    let found = differences(&other, &all);
    assert_eq!(found, ["20 recordings are of the plan \"arms\""]);
    differs(|plan| plan.plan_digest = "0".to_string(), "20 recordings are of another version of the plan");
    let running = FrozenPlan { participants: [&plan.participants[..], &["P99".to_string()]].concat(), ..plan.clone() };
    let words = PreregistrationCheck::new("0".to_string(), &running, &all, &PlanVersions::default(), 0).words();
    assert!(words.starts_with("So far as preregistered: ") && words.ends_with("no recording so far: P99."), "{words}");
    let ended = PreregistrationCheck::new("0".to_string(), &plan, &all, &PlanVersions::default(), 3).differences;
    assert_eq!(ended, ["the wizard ended 3 trials that count early"]);
    differs(|plan| drop(plan.participants.pop()), "1 participant is not in the frozen plan: P20");
    let alone = [&all[..], &[alone("P01")]].concat();
    assert_eq!(differences(&plan, &alone), ["1 recording is of no plan"]);
}

/// A recording of a participant, by index in the plan, and its trial; `None` for practice. `periods` trials are planned.
/// Every second participant has the order of the plan turned round.
fn recording(plan: &str, participant: u32, period: Option<u32>, periods: u32) -> RecordedPlan {
    let group = if participant.is_multiple_of(2) { "AB" } else { "BA" }.to_string();
    let is_first = |period: u32| (period == 1) == participant.is_multiple_of(2);
    let arm = period.map(|period| if is_first(period) { StudyArm::None } else { StudyArm::Wizard });
    RecordedPlan {
        participant: format!("P{:02}", participant + 1),
        recorded_as: None,
        plan: Some((plan.to_string(), format!("digest of {plan}"))),
        place: Some(PlaceInPlan { participant, group, period, periods, arm }),
    }
}

fn planned_trials(participants: std::ops::Range<u32>) -> Vec<RecordedPlan> {
    participants.flat_map(|index| (1..=2).map(move |period| recording("short", index, Some(period), 2))).collect()
}

#[test]
fn a_whole_study_misses_nothing_and_a_lost_recording_is_named() {
    let mut all = planned_trials(0..4);
    assert_eq!((missing_trials(&all), in_words(&[], &[])), (Vec::new(), None));
    all.remove(3);
    let missing = missing_trials(&all);
    let second = |trials: &[u32]| MissingTrials {
        plan: "short".to_string(),
        participant: Some(2),
        code: Some("P02".to_string()),
        trials: trials.to_vec(),
    };
    assert_eq!(missing, [second(&[2])]);
    assert_eq!(in_words(&missing, &[]).as_deref(), Some("1 trial of the plan \"short\" has no recording: P02 trial 2"));
    // Practice is no trial; a trial that was done twice is one.
    all.retain(|one| one.participant != "P02");
    all.push(recording("short", 1, None, 2));
    all.extend(planned_trials(3..4));
    assert_eq!(missing_trials(&all), [second(&[1, 2])]);
}

#[test]
fn participants_without_a_recording_are_found_before_the_last_and_plans_are_told_apart() {
    let mut all = planned_trials(2..3);
    all.push(recording("other", 0, Some(3), 3));
    all.push(alone("P01"));
    // A tutorial alone has no trials.
    all.push(recording("short-tutorial", 0, None, 0));
    let missing = missing_trials(&all);
    assert_eq!(
        in_words(&missing, &[]).as_deref(),
        Some(
            "2 trials of the plan \"other\" have no recording: P01 trials 1, 2; 4 trials of the plan \"short\" have no recording: \
             P01 trials 1, 2; P02 trials 1, 2"
        )
    );
    assert_eq!(
        (missing[0].plan.as_str(), missing[1].plan.as_str(), &missing[1].code),
        ("other", "short", &Some("P01".to_string()))
    );
    let words = in_words(&missing_trials(&planned_trials(20..21)), &[]).expect("missing");
    assert!(words.starts_with("40 trials of the plan \"short\" have no recording: P01 trials 1, 2; "), "{words}");
    assert!(words.ends_with("P08 trials 1, 2; and of 12 more participants"), "{words}");
    // Codes that are no numbers are known from recordings alone.
    let named = RecordedPlan { participant: "Anna".to_string(), ..recording("short", 1, Some(1), 2) };
    let words = in_words(&missing_trials(&[named]), &[]).expect("missing");
    assert!(words.ends_with("the plan's participant 1 trials 1, 2; Anna trial 2"), "{words}");
}

#[test]
fn a_recording_whose_code_was_corrected_is_of_the_participant_who_has_the_code() {
    // The second participant's first trial was that of the third one, whose second trial is there, too.
    let corrected = |code: &str, period: u32| corrected(code, 1, period);
    let mut all = planned_trials(0..1);
    all.extend([corrected("P03", 1), recording("short", 1, Some(2), 2), recording("short", 2, Some(2), 2)]);
    let missing = missing_trials(&all);
    let told = "1 trial of the plan \"short\" has no recording: P02 trial 1";
    assert_eq!(in_words(&missing, &[]).as_deref(), Some(told));
    all.push(corrected("P09", 2));
    let missing = missing_trials(&all);
    let told = "2 trials of the plan \"short\" have no recording: P02 trial 1; P09 (a corrected code, perhaps none of the plan) trial 1";
    assert_eq!(in_words(&missing, &[]).as_deref(), Some(told));
    assert_eq!(missing[1].participant, None, "its number in the plan is not known");
    let correction = |before: &str, after: &str| CorrectedRecording {
        recording: format!("short-{before}-1"),
        correction: CodeCorrection {
            before: before.to_string(),
            after: after.to_string(),
            why: String::new(),
            by: String::new(),
            at: String::new(),
        },
    };
    let words = in_words(&missing, &[correction("P02", "P03"), correction("P05", "P04")]).expect("missing");
    assert!(words.starts_with(told) && words.contains("short-P02-1 (P02 is P03); tomcom correct"), "{words}");
}

/// A recording of the second plan's participant by index that was found to be of `code`.
fn corrected(code: &str, begun_for: u32, period: u32) -> RecordedPlan {
    let begun = recording("short", begun_for, Some(period), 2);
    RecordedPlan { participant: code.to_string(), recorded_as: Some(begun.participant.clone()), ..begun }
}

#[test]
fn who_had_the_order_of_somebody_else_is_told_with_the_planned_one() {
    let orders = |all: &[RecordedPlan]| other_orders(all.iter().map(|one| (one, true)));
    assert_eq!(orders(&planned_trials(0..4)), Vec::<String>::new());
    // P03 and P04 took part with each other's codes, in both trials.
    let swapped = |code: &'static str, begun_for: u32| (1..=2).map(move |period| corrected(code, begun_for, period));
    let mut all: Vec<RecordedPlan> =
        planned_trials(0..2).into_iter().chain(swapped("P03", 3)).chain(swapped("P04", 2)).collect();
    let told =
        "P03, recorded as P04, had trial 1 wizard, trial 2 unassisted; planned: trial 1 unassisted, trial 2 wizard";
    assert_eq!(orders(&all)[0], told);
    assert!(orders(&all)[1].starts_with("P04, recorded as P03, had trial 1 unassisted, "), "{:?}", orders(&all));
    assert_eq!(orders(&all).len(), 2);
    // Both codes are those of the plan, though all recordings of both were corrected.
    assert!(missing_trials(&all).is_empty());
    all.retain(|one| one.participant != "P04");
    let words = in_words(&missing_trials(&all), &[]).expect("missing");
    assert_eq!(words, "2 trials of the plan \"short\" have no recording: P04 trials 1, 2");
    let told = "P03, recorded as P04, had trial 1 wizard, trial 2 unassisted; planned: not known, since ";
    assert!(orders(&all)[0].starts_with(told), "{:?}", orders(&all));
    // Of a trial that does not count nothing is told; nor of the order of one who has the same group.
    assert_eq!(other_orders(all.iter().map(|one| (one, one.recorded_as.is_none()))), Vec::<String>::new());
    let same: Vec<RecordedPlan> = planned_trials(2..3).into_iter().chain(swapped("P03", 0)).collect();
    assert_eq!(orders(&same), Vec::<String>::new());
}

#[test]
fn what_changed_in_a_plan_since_a_recording_is_named() {
    let files = session_file("study");
    let before = files.study().expect("a plan");
    let wanted = WantedRecording { participant: 0, slot: 1, attempt: 1, instructed: true };
    let (spec, trial) = before.settings(wanted);
    let header = LogHeader::new(spec, trial, files.kitchen.layout.clone(), files.kitchen.recipes.clone());
    let header = LogHeader { started: Some("2026-03-14T10:00:00Z".to_string()), ..header };
    let changed = |change: fn(&mut SessionSetup)| {
        let mut now = files.clone();
        change(&mut now);
        let study = now.study().expect("a plan");
        assert_ne!(study.digest, before.digest);
        listed(&study.changed_since(&header, [&now.kitchen.layout, &now.kitchen.recipes]))
    };
    assert!(changed(|now| now.kitchen.recipes.text.push_str("# a dish")).ends_with("recipes/sushi.toml"));
    let presses = files.spec.trial.presses;
    assert_eq!(changed(|now| now.spec.trial.presses = 100), format!("trial.presses from {presses} to 100"));
    let asked = &files.questionnaires[0];
    assert_eq!(
        changed(|now| now.questionnaires[0].title.push('!')),
        format!("questionnaire {}.title from \"{}\" to \"{}!\"", asked.name, asked.title, asked.title)
    );
    assert_eq!(
        changed(|now| now.spec.plan.as_mut().expect("a plan").aims.margin = 1.5),
        "plan.aims.margin from 1.25 to 1.5"
    );
    // What a recording does not have.
    assert!(changed(|now| now.spec.plan.as_mut().expect("a plan").block = Some(4)).contains("block, consent"));
}

#[test]
fn a_frozen_plan_names_file_and_item_of_another_question() {
    let (files, file) = (session_file("study"), empty_folder("study/frozen-question").join("study.frozen"));
    let mut frozen = files.clone();
    let item = &mut frozen.questionnaires[0].items[1];
    let (id, now) = (item.id.clone(), item.text.clone());
    item.text = "Another question".to_string();
    let texts = [&*files.kitchen.layout.text, &*files.kitchen.recipes.text];
    freeze(&file, &FrozenPlan::new(&frozen.study().expect("a plan"), texts, 0)).expect("frozen");
    let session = Path::new("sessions/study.toml");
    let error = check_frozen(session, &files, &file).expect_err("another question");
    let path = "sessions/questionnaires/acceptance.toml";
    let text = fs::read_to_string(path).expect("a questionnaire");
    let line = text.lines().position(|line| line.contains(&now)).expect("a line") + 1;
    let told = error.to_string();
    assert!(told.starts_with(&format!("{path}:{line}: found questionnaire acceptance.item.{id}.text from ")), "{told}");
    assert!(told.contains("\"Another question\" to "), "{told}");
    assert!(error.remedy().starts_with("text = \"Another question\", as it was frozen in "), "{}", error.remedy());
    // Beside another change it is named, too.
    let mut both = files.clone();
    both.spec.seed += 1;
    let error = check_frozen(session, &both, &file).expect_err("another seed");
    let told = format!("\nchanged, too: questionnaire acceptance.item.{id}.text from ");
    assert!(error.remedy().starts_with("seed = ") && error.remedy().contains(&told), "{}", error.remedy());
    assert!(error.remedy().ends_with("tomcom plan sessions/study.toml --freeze NEW"), "{}", error.remedy());
}

/// Three conditions made of a plan that asks after its two trials: the last questionnaire would be lost without a word.
#[test]
fn a_plan_tells_what_it_does_not_ask_and_what_is_in_another_language() {
    let mut files = session_file("study");
    assert_eq!(files.study().expect("a plan").remarks(), Vec::<String>::new());
    let plan = files.spec.plan.as_mut().expect("a plan");
    plan.conditions.push(StudyArm::TomCom);
    plan.questionnaire[0].after = Some(vec![1, 2]);
    files.spec.display.language = "fr".to_string();
    files.spec.participant.kind = ParticipantKind::Keyboard;
    let remarks = files.study().expect("a plan").remarks();
    assert_eq!(remarks[0], "the questionnaire \"acceptance\" is asked after trial 1 and 2 of 3 trials only");
    assert!(
        remarks[1]
            .starts_with("the display's language is \"fr\", but not that of the questionnaire \"acceptance\" (en)")
    );
    assert_eq!(remarks[2], "the tutorial is left out, since only the participant's display shows it");
}
