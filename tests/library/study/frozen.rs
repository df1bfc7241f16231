//! Plans that are frozen before a study, and what is told where the study is another one.

use std::fs;
use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom_session::files::SessionSetup;
use tomcom_session::study_arm::StudyArm;
use tomcom_study::column::CsvTable;
use tomcom_study::facts::RecordingFacts;
use tomcom_study::figures::StudySummary;
use tomcom_study::files::pool_file::{freeze, read_frozen};
use tomcom_study::frozen_plan::{FrozenDefinition, FrozenPlan};
use tomcom_study::frozen_plan::{PreregistrationCheck, RecordedPlan};
use tomcom_study::report;
use tomcom_study::trial_statistics::DetailTotals;

use super::trials;

fn files() -> SessionSetup {
    read_session(Path::new("sessions/arms.toml")).expect("the study of arms")
}

fn frozen() -> FrozenPlan {
    let files = files();
    let study = files.study().expect("a plan");
    FrozenPlan::new(&study, [&files.kitchen.layout.text, &files.kitchen.recipes.text], 0)
}

/// A recording of every participant of the plan.
fn recordings(frozen: &FrozenPlan) -> Vec<RecordedPlan> {
    let plan = Some((frozen.plan.clone(), frozen.plan_digest.clone()));
    let recording = |code: &String| RecordedPlan { participant: code.clone(), plan: plan.clone(), place: None };
    frozen.participants.iter().map(recording).collect()
}

fn differences(frozen: &FrozenPlan, recordings: &[RecordedPlan]) -> Vec<String> {
    PreregistrationCheck::new("0".to_string(), frozen, recordings).differences
}

#[test]
fn a_frozen_plan_is_read_as_it_was_written_and_never_written_over() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("frozen");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
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
    differs(|plan| plan.plan = "other".to_string(), "20 recordings are of the plan \"arms\"");
    differs(|plan| plan.plan_digest = "0".to_string(), "20 recordings are of another version of the plan");
    differs(|plan| plan.participants.push("P99".to_string()), "1 participant is without a recording: P99");
    differs(|plan| drop(plan.participants.pop()), "1 participant is not in the frozen plan: P20");
    let alone = [&all[..], &[RecordedPlan { participant: "P01".to_string(), plan: None, place: None }]].concat();
    assert_eq!(differences(&plan, &alone), ["1 recording is of no plan"]);
}

#[test]
fn the_report_says_preregistered_with_the_digest_or_what_differs() {
    let plan = frozen();
    let trials = trials(&[[24, 12], [30, 16]], &[[20, 18], [16, 16]]);
    let page = |recordings: &[RecordedPlan]| {
        let found = PreregistrationCheck::new("abc123".to_string(), &plan, recordings);
        let summary = StudySummary {
            preregistration: Some(found),
            ..StudySummary::from_trials(&trials, DetailTotals::default(), &RecordingFacts::default(), 0)
        };
        report::page(&summary, &trials, &RecordingFacts::default(), &CsvTable::ALL)
    };
    let all = recordings(&plan);
    let same = page(&all);
    assert!(
        same.contains(
            "Preregistered: the plan &quot;arms&quot; was frozen when no recording of it was there, SHA-256 abc123"
        ),
        "{same}"
    );
    let fewer = page(&all[1..]);
    assert!(
        fewer.contains("Not as preregistered") && fewer.contains("1 participant is without a recording: P01"),
        "{fewer}"
    );
    let without = StudySummary::from_trials(&trials, DetailTotals::default(), &RecordingFacts::default(), 0);
    let json = serde_json::to_string(&without).expect("JSON");
    assert!(!json.contains("preregistration"), "nothing was frozen");
}
