//! A sweep has a line for every combination of values, and pairs the same trials.

use std::fs;

use tomcom_research::sweep::{ParameterSweepAxis, ParameterSweepRow, TABLE_NAME, sweep, trials};
use tomcom_session::Event;
use tomcom_session::files::read_session;
use tomcom_session::log::LogReader;
use tomcom_session::settings::Condition;
use tomcom_session::headless::SimulationShard;
use tomcom_session::verify::verify;
use tomcom_study::files::simulated_trials::SimulationRequest;

use crate::files::place;
use crate::folder;

#[test]
fn a_sweep_has_a_line_for_every_combination_and_pairs_the_same_trials() {
    let mut files = read_session(&place("sessions/paper.toml"), None).expect("the paper's session");
    files.spec.trial.presses = 24;
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
    let mut log = LogReader::open(&blind).expect("a recording");
    while let Some(line) = log.next_line().expect("an event") {
        assert!(!matches!(line.stamped.event, Event::Gaze(_)));
    }
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
