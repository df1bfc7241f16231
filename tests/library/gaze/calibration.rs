//! The check of the gaze with targets in a session.

use tomcom_core::gaze::calibration::{TARGETS, ViewingGeometry, measure, mistaken_coordinates};
use tomcom_session::admit::is_external;
use tomcom_session::gaze_check::{GazeCheckEvent, RunningGazeCheck};

use super::engine;
use crate::support::*;

/// Checks the calibration as the live session does, from `from_s` on; all events of the check.
fn check_calibration(engine: &mut SessionEngine, from_s: f64, accept: GazeCheckEvent) -> Vec<TimestampedEvent> {
    let mut events = Vec::new();
    let mut input = |engine: &mut SessionEngine, time, event| {
        let outcome = engine.input(time, event);
        events.extend(outcome.events);
        outcome.refused
    };
    assert_eq!(input(engine, at(from_s), Event::Calibration(GazeCheckEvent::begin())), None);
    while let Some((time, event)) = engine.session().calibration.as_ref().and_then(RunningGazeCheck::next) {
        let now = engine.session().time;
        let refused = input(engine, now, Event::TrialStarted);
        assert_eq!(refused.as_deref(), Some("a gaze accuracy check is running"));
        assert_eq!(input(engine, time, Event::Calibration(event)), None);
    }
    let now = engine.session().time;
    assert_eq!(input(engine, now, Event::Calibration(accept)), None);
    events
}

#[test]
fn simulated_gaze_is_checked_by_targets_corrected_and_comes_out_the_same_again() {
    let mut checked = engine(|spec| spec.seed = 4);
    let events = check_calibration(&mut checked, 2.0, GazeCheckEvent::Accepted { corrected: true });
    let calibrated = checked.session().calibrated.clone().expect("accepted");
    let found = &calibrated.found;
    assert!(found.targets.iter().all(|target| (100..=140).contains(&target.samples)), "{found:?}");
    // The simulated tracker has an offset of about a degree, and tremor of 4 mm around it, 2 m away.
    assert!(found.corrected_deg < found.accuracy_deg && found.accuracy_deg < 3.0, "{found:?}");
    assert!((0.1..0.3).contains(&found.precision_deg), "{found:?}");
    let sample = GazeSample::new(0.4, 0.4, 1.0);
    let corrected = checked.session().corrected(sample);
    assert_eq!([corrected.x - sample.x, corrected.y - sample.y].map(|by| (by * 1e5).round() / 1e5), found.offset);
    // The events from outside alone give all the others again: samples and result.
    let mut again = engine(|spec| spec.seed = 4);
    let mut produced = Vec::new();
    for stamped in &events {
        if is_external(again.session(), &stamped.event) {
            produced.extend(again.input(stamped.time, stamped.event.clone()).events);
        }
    }
    assert!(produced == events, "{} events and {} again", events.len(), produced.len());
    assert_eq!(again.session().calibrated, Some(calibrated));
}

#[test]
fn a_check_changes_nothing_in_the_trial_but_the_offset_of_the_gaze() {
    let trial = |checks: bool| {
        let mut engine = engine(|spec| (spec.seed, spec.trial.presses) = (4, 12));
        if checks {
            check_calibration(&mut engine, 0.0, GazeCheckEvent::Dismissed);
        }
        let start = at(60.0);
        let mut events = engine.input(start, Event::TrialStarted).events;
        while let Some(due) = engine.next_due() {
            assert!(due >= start);
            events.extend(engine.fire());
        }
        let told = |stamped: TimestampedEvent| match stamped.event {
            Event::BeliefEstimated(_) | Event::Advised(_) => None,
            event => Some((stamped.time, event)),
        };
        events.into_iter().filter_map(told).collect::<Vec<_>>()
    };
    let unchecked = trial(false);
    assert!(unchecked.len() > 1000, "{} events", unchecked.len());
    assert!(trial(true) == unchecked, "the trial is another one");
}

#[test]
fn a_check_measures_what_the_gaze_is_off_by() {
    let viewing = ViewingGeometry { display_m: [1.5, 0.84375], distance_m: 2.0 };
    // At 2 m, a degree is 35 mm.
    assert!((viewing.angle_deg([0.5, 0.5], [0.5 + 0.0349 / 1.5, 0.5]) - 1.0).abs() < 0.001);
    let off = [0.03, -0.02];
    let at = |target: [f64; 2], n: usize| vec![GazeSample::new(target[0] + off[0], target[1] + off[1], 0.9); n];
    let samples: Vec<Vec<GazeSample>> = TARGETS.iter().map(|&target| at(target, 20)).collect();
    let found = measure(&viewing, &TARGETS, &samples).expect("enough samples");
    assert_eq!(found.offset, [-0.03, 0.02]);
    assert_eq!((found.corrected_deg, found.precision_deg), (0.0, 0.0));
    let straight = viewing.angle_deg(TARGETS[0], [TARGETS[0][0] + off[0], TARGETS[0][1] + off[1]]);
    assert!((found.accuracy_deg - straight).abs() < 0.15, "{} and {straight}", found.accuracy_deg);
    // Targets that were not looked at are left out, and without three of them nothing is known.
    let seen =
        |count: usize| TARGETS.iter().enumerate().map(move |(i, &target)| at(target, if i < count { 20 } else { 3 }));
    let three = measure(&viewing, &TARGETS, &seen(3).collect::<Vec<_>>()).expect("three targets");
    assert_eq!(three.targets.iter().filter(|target| target.accuracy_deg.is_none()).count(), 2);
    assert_eq!(measure(&viewing, &TARGETS, &seen(2).collect::<Vec<_>>()), None);
}

#[test]
fn coordinates_that_are_meant_otherwise_are_told_by_the_targets() {
    let viewing = ViewingGeometry { display_m: [1.5, 0.84375], distance_m: 2.0 };
    type Sent = fn([f64; 2]) -> [f64; 2];
    let cases: [(Sent, Option<&str>); 8] = [
        (|[x, y]| [x, y], None),
        (|[x, y]| [x + 0.05, y], None),
        (|[x, y]| [y, x], Some("x and y are swapped")),
        (|[x, y]| [x, 1.0 - y], Some("y counts from the bottom")),
        (|[x, y]| [1.0 - x, y], Some("x counts from the right")),
        (|[x, y]| [x - 0.5, y - 0.5], Some("x and y count from the centre")),
        (|[x, y]| [100.0 * x, 100.0 * y], Some("x and y are in percent")),
        // What fits in no way is not explained.
        (|[x, y]| [0.4 * x, 0.3 * y], None),
    ];
    for (number, (sent, told)) in cases.into_iter().enumerate() {
        let at = |target: [f64; 2]| {
            let [x, y] = sent(target);
            vec![GazeSample::new(x, y, 0.9); 20]
        };
        let samples: Vec<Vec<GazeSample>> = TARGETS.iter().map(|&target| at(target)).collect();
        assert_eq!(mistaken_coordinates(&viewing, &TARGETS, &samples), told, "case {number}");
    }
}

#[test]
fn a_check_is_refused_where_it_cannot_be() {
    let mut engine = engine(|_| {});
    let refused = |engine: &mut SessionEngine, event: Event| {
        let now = engine.session().time;
        engine.input(now, event).refused.unwrap_or_default()
    };
    let calibration = Event::Calibration;
    assert!(refused(&mut engine, calibration(GazeCheckEvent::TargetsHidden)).contains("no gaze target is shown"));
    assert!(
        refused(&mut engine, calibration(GazeCheckEvent::Accepted { corrected: true }))
            .contains("no gaze accuracy was")
    );
    assert_eq!(refused(&mut engine, Event::TrialStarted), "");
    assert!(refused(&mut engine, calibration(GazeCheckEvent::begin())).contains("pause the trial first"));
    assert_eq!(refused(&mut engine, Event::TrialPaused), "");
    assert_eq!(refused(&mut engine, calibration(GazeCheckEvent::begin())), "");
    assert!(refused(&mut engine, Event::TrialResumed).contains("accuracy check is running"));
    assert_eq!(refused(&mut engine, calibration(GazeCheckEvent::Dismissed)), "");
    assert_eq!(refused(&mut engine, Event::TrialResumed), "");
}
