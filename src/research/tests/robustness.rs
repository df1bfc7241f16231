//! The robustness table: its trials are paired, what is in memory is what a recording gives, and threads change nothing.

use tomcom_core::measures::flags::ThresholdSource;
use tomcom_people::participant::population::Population;
use tomcom_research::beliefs;
use tomcom_research::robustness::battery::{CohortBattery, CohortSpec, read_battery};
use tomcom_research::robustness::report::{chart, describe_end, describe_row, name_width};
use tomcom_research::robustness::table::{CohortRow, RobustnessTable};
use tomcom_research::robustness::{RobustnessRequest, measure};
use tomcom_session::files::read_session;
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::{ArmKind, Condition};
use tomcom_study::analysis::trial_summary::TrialSummary;
use tomcom_study::gathered::GatheredRecordings;

use crate::files::place;
use crate::{folder, recorded};

/// Judged trials of each cohort in these tests, and presses of a trial.
const TRIALS: u64 = 3;
const PRESSES: u32 = 90;

/// Two cohorts with short trials and few rollouts.
fn battery() -> CohortBattery {
    let mut battery = read_battery(&place("sessions/people/robustness.toml")).expect("the battery");
    battery.cohorts.retain(|cohort| ["base", "confident wrong recipes"].contains(&cohort.name.get_ref().as_str()));
    let spec = &mut battery.session.spec;
    (spec.trial.presses, spec.robot.arm) = (PRESSES, ArmKind::Timed);
    (spec.assistant.rollout.rollouts, spec.assistant.rollout.least_rollouts) = (8, 8);
    battery
}

fn table(battery: &CohortBattery, seed: u64) -> RobustnessTable {
    let request = RobustnessRequest { battery: battery.clone(), trials: TRIALS, seed, choose_seed: 51 };
    let mut finished: Vec<CohortRow> = Vec::new();
    let table = measure(&request, || (), |row| finished.push(row.clone()));
    assert_eq!(finished, table.cohorts, "each row is told when it is finished");
    table
}

#[test]
fn the_table_follows_from_its_seeds_on_any_number_of_threads() {
    let battery = battery();
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| table(&battery, 41))
    };
    let (one, several) = (with_threads(1), with_threads(3));
    assert_eq!(one, several);
    assert_ne!(one.cohorts[0].unassisted, one.cohorts[1].unassisted, "cohorts differ");
    assert_ne!(one.cohorts[0].unassisted, table(&battery, 42).cohorts[0].unassisted, "seeds differ");
    let width = name_width(one.cohorts.iter().map(|row| row.cohort.as_str()));
    let text = describe_row(&one.cohorts[1], width);
    assert!(text.starts_with("confident wrong recipes ") && text.lines().count() == 1, "{text}");
    let end = describe_end(&one);
    assert!(end.contains("3 trials of seed 41"), "{end}");
    assert!(text.chars().count() <= 126, "{text}");
    assert!(one.cohorts.iter().all(|row| row.assisted.signals_per_100 > 0.0), "{text}");
    let picture = chart(&one);
    assert!(picture.starts_with("<svg ") && picture.contains("ROC, recipes"), "{picture}");
    assert_eq!(picture.matches("<circle").count(), 2 * 3, "a point for each value");
}

#[test]
fn an_assistant_that_says_nothing_saves_nothing() {
    let mut battery = battery();
    battery.session.spec.assistant.cost_of_communication = 1000.0;
    for row in table(&battery, 43).cohorts {
        assert!(row.unassisted.related_per_100 > 0.0, "{}: nothing to save", row.cohort);
        assert_eq!(row.unassisted, row.assisted, "{}: pairs are of the same trials", row.cohort);
        assert_eq!((row.saved, row.saved_interval), (Some(0.0), Some([0.0, 0.0])), "{}", row.cohort);
    }
}

#[test]
fn the_table_has_what_recordings_of_the_same_trials_give() {
    let battery = battery();
    let row = &table(&battery, 44).cohorts[0];
    let mut files = battery.session.clone();
    files.spec.trial.condition = Condition::None;
    let [judged, chosen_on] = [44, 51].map(|seed| {
        files.spec.seed = seed;
        let recordings = recorded(&files, TRIALS, &folder(&format!("robustness-{seed}")));
        GatheredRecordings::find(&recordings).expect("recordings")
    });
    let related_of = |recording| {
        let mut replay = RecordingReplay::open(recording).expect("a recording");
        replay.run().expect("a recording");
        TrialSummary::from_follower(&replay.follower).beliefs.expect("known of simulated people").related
    };
    let related: u64 = judged.paths.iter().map(|recording| related_of(recording)).sum();
    let check = beliefs::check(&judged, &chosen_on, || ()).expect("recordings");
    assert_eq!(row.detection, check.detection);
    assert_eq!(row.detection.flags.thresholds_from, Some(ThresholdSource::OtherRecordings));
    assert_eq!(row.log_likelihood, check.log_likelihood);
    let counted = row.unassisted.related_per_100 * check.human_actions as f64 / 100.0;
    assert!((counted - related as f64).abs() < 1e-6, "{counted} and {related}");
    for (value, interval) in
        [(row.detection.auc_locations, row.auc_locations_interval), (row.detection.ece, row.ece_interval)]
    {
        let (value, [from, to]) = (value.expect("known"), interval.expect("known"));
        assert!(from < to && (0.0..=1.0).contains(&from) && value <= to, "{value} ({from} to {to})");
    }
}

#[test]
fn the_battery_that_comes_with_the_program_has_its_cohorts() {
    let battery = read_battery(&place("sessions/people/robustness.toml")).expect("a battery");
    assert_eq!(battery.cohorts.len(), 18);
    let defaults = battery.cohorts.iter().filter(|cohort| cohort.population == Some(Population::default())).count();
    assert_eq!(defaults, 0, "a cohort names a population that is the default");
    let named = |cohort: &&CohortSpec| cohort.name.get_ref() == "as in sessions/paper.toml";
    let of_paper = battery.cohorts.iter().find(named).and_then(|cohort| cohort.population.clone());
    let paper = read_session(&place("sessions/paper.toml"), None).expect("the paper's session").spec;
    // A cohort's people have one trial each, so what trials teach is left out.
    let Population { recipes_gained, practice_kept, .. } = Population::default();
    let paper = paper.participant.population.map(|paper| Population { recipes_gained, practice_kept, ..paper });
    assert_eq!(of_paper, paper, "the cohort is as in sessions/paper.toml");
}
