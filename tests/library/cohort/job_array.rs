//! Parts of a job array, folders that were begun before, and sweeps of a setting.

use tomcom::run::sweep::{ParameterSweepAxis, TABLE_NAME, sweep, trials};
use tomcom_study::analysis::sweep_row::ParameterSweepRow;

use super::{events, folder, paper, run};
use crate::support::*;

/// Every file below a folder, with what is in it, by its path there.
fn all_files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        match entry.is_dir() {
            true => found.extend(all_files(&entry)),
            false => found.push((entry.clone(), fs::read(&entry).expect("a file"))),
        }
    }
    found.sort();
    found
}

fn below(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let relative = |path: PathBuf| path.strip_prefix(folder).expect("below it").to_path_buf();
    all_files(folder).into_iter().map(|(path, bytes)| (relative(path), bytes)).collect()
}

#[test]
fn the_parts_of_a_job_array_are_the_whole_and_have_nothing_in_common() {
    let files = paper(30);
    let (whole, parts) = (folder("whole"), folder("parts"));
    let figures = run(&files, 5, SimulationShard::WHOLE, &whole);
    assert_eq!((figures.trials, figures.found), (5, 0));
    let mut made = Vec::new();
    for number in 1..=3 {
        let part = run(&files, 5, SimulationShard { number, of: 3 }, &parts);
        assert_eq!(part.found, 0, "no part makes what another one made");
        made.extend(part.recordings);
    }
    assert_eq!(made.len(), 5);
    assert!(below(&whole) == below(&parts), "the parts together are the whole, byte for byte");
    let empty = run(&files, 2, SimulationShard { number: 3, of: 3 }, &folder("none"));
    assert_eq!((empty.trials, empty.beliefs.mean_sequence_length), (0, None), "a part may have nothing to do");
    for text in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2"] {
        assert!(text.parse::<SimulationShard>().is_err(), "{text}");
    }
}

#[test]
fn a_folder_that_was_begun_is_gone_on_with() {
    let (files, out) = (paper(30), folder("begun"));
    let first = run(&files, 4, SimulationShard::WHOLE, &out);
    let before = below(&out);
    // A kill: one log without its end, one recording that is not there yet.
    let cut = Path::new(&first.recordings[1]).join(LOG_NAME);
    let text = fs::read_to_string(&cut).expect("a log");
    fs::write(&cut, &text[..text.len() * 2 / 3]).expect("written");
    fs::remove_dir_all(&first.recordings[3]).expect("removed");
    let again = run(&files, 4, SimulationShard::WHOLE, &out);
    assert_eq!(again.found, 2, "what is whole is read");
    assert!(below(&out) == before, "and the rest is made as it would have been");
    let bare = |figures: &tomcom_study::analysis::trial_summary::SimulationSummary| {
        tomcom_study::analysis::trial_summary::SimulationSummary { wall_s: 0.0, found: 0, ..figures.clone() }
    };
    assert_eq!(bare(&first), bare(&again), "what is read counts as what is made");
}

#[test]
fn a_sweep_has_a_line_for_every_combination_and_pairs_the_same_trials() {
    let mut files = paper(24);
    (files.spec.plan, files.spec.trial.condition) = (None, Condition::Assistant);
    // Rollouts so few that a debug build is quick.
    (files.spec.assistant.rollout.rollouts, files.spec.assistant.rollout.least_rollouts) = (2, 2);
    let out = folder("sweep");
    let simulation = SimulationRequest { files, trials: 2, shard: SimulationShard::WHOLE, out: out.clone() };
    let axes: Vec<ParameterSweepAxis> =
        ["cost=0.1,100", "gaze=on,off"].iter().map(|text| text.parse().expect("an axis")).collect();
    assert_eq!(trials(&simulation, &axes), 10);
    let figures = sweep(&simulation, &axes, || ()).expect("the folder can be written");
    let settings: Vec<String> =
        figures.rows.iter().map(|row| serde_json::to_string(&row.settings).expect("JSON")).collect();
    assert_eq!(settings.len(), 5);
    assert_eq!(settings[0], "{}");
    assert_eq!(settings[2], "{\"cost\":\"0.1\",\"gaze\":\"off\"}");
    for dear in &figures.rows[3..] {
        assert_eq!((dear.signals_per_100, dear.spared_per_100), (0.0, Some(0.0)), "who says nothing changes nothing");
    }
    assert_eq!(figures.rows[0].spared_per_100, None);
    let fewer = |row: &ParameterSweepRow| (row.fewer_than_first, row.related_fewer_than_first);
    assert!(figures.rows[..2].iter().all(|row| fewer(row) == (None, None)), "nothing to compare with");
    for row in &figures.rows[2..] {
        let (spared, first) = (row.spared_per_100.expect("paired"), figures.rows[1].spared_per_100.expect("paired"));
        assert!((row.fewer_than_first.expect("paired") - (spared - first)).abs() < 1e-9, "{row:?}");
        assert!(row.related_fewer_than_first.is_some() && row.related_per_100.is_some(), "{row:?}");
    }
    let table = fs::read_to_string(out.join(TABLE_NAME)).expect("a table");
    assert_eq!(table.lines().count(), 6, "{table}");
    assert!(table.starts_with("condition,trials,cost,gaze,errors_per_100,"), "{table}");
    // Without gaze the recording has none, and still comes out the same again.
    let blind = out.join("cost-0.1_gaze-off/seed1-S001");
    let (_, log) = events(&blind);
    assert!(log.iter().all(|stamped| !matches!(stamped.event, Event::Gaze(_))));
    assert!(verify(&blind).expect("readable").verified);
    assert_eq!(sweep(&simulation, &axes, || ()).expect("it is there"), figures, "what is there is read");
    for wrong in ["cost", "cost=", "cost=a", "cost=nan", "horizon=1.5", "gaze=maybe", "colour=red"] {
        assert!(wrong.parse::<ParameterSweepAxis>().is_err(), "{wrong}");
    }
    let axis = |text: &str| text.parse::<ParameterSweepAxis>().expect("an axis");
    let refused = |axes: &[ParameterSweepAxis]| sweep(&simulation, axes, || ()).expect_err("wrong").to_string();
    assert!(refused(&[axis("cost=1"), axis("cost=2")]).contains("cost twice"));
    assert!(refused(&[axis("radius=-1")]).contains("radius_deg = -1"));
}
