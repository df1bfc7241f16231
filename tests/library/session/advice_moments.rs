//! When the assistant is asked besides presses and changes of the task: once in every unusual silence.

use tomcom_session::Event;
use tomcom_session::engine::SessionEngine;

use super::{at, check, engine, press};

/// A trial with presses in these intervals; the time of the last.
fn pressed(engine: &mut SessionEngine, intervals_s: &[f64]) -> (Vec<(&'static str, f64)>, f64) {
    let mut inputs = vec![(0.0, Event::TrialStarted), (2.0, press("take rice"))];
    let mut now_s = 2.0;
    for interval_s in intervals_s {
        now_s += interval_s;
        inputs.push((now_s, press("take rice")));
    }
    (check(engine, &inputs), now_s)
}

fn later(seconds: f64) -> (f64, Event) {
    (seconds, Event::Marker { note: "later".to_string() })
}

fn waits(kinds: &[(&str, f64)]) -> Vec<f64> {
    kinds.iter().filter(|(kind, _)| *kind == "human_waits").map(|(_, seconds)| *seconds).collect()
}

/// The silences after the last press are noted at these seconds since then, and the assistant is asked at each.
fn check_silences(engine: &mut SessionEngine, last_s: f64, until_s: f64, expected_s: &[f64]) {
    engine.take_questions();
    let found = waits(&check(engine, &[later(last_s + until_s)]));
    assert_eq!(found.len(), expected_s.len(), "{found:?} after {last_s}");
    let asked = engine.take_questions();
    for (found, expected) in found.iter().zip(expected_s) {
        assert!((found - last_s - expected).abs() < 1e-6, "{found} after {last_s}, {expected}");
        assert!(asked.iter().any(|request| request.time == at(*found)), "the assistant is asked then");
    }
}

#[test]
fn a_silence_is_unusual_after_three_usual_intervals_and_again_after_each_three() {
    let mut slow = engine(|_| ());
    let (kinds, last_s) = pressed(&mut slow, &[4.0, 5.0, 3.0, 9.0, 4.5]);
    assert!(waits(&kinds).is_empty(), "{kinds:?}");
    check_silences(&mut slow, last_s, 41.0, &[13.5, 27.0, 40.5]);
}

#[test]
fn a_silence_of_six_seconds_is_unusual_whoever_presses_faster_or_not_at_all() {
    let mut fast = engine(|_| ());
    let (_, last_s) = pressed(&mut fast, &[1.0, 1.2, 0.9]);
    check_silences(&mut fast, last_s, 13.0, &[6.0, 12.0]);
    let mut passive = engine(|_| ());
    check(&mut passive, &[(0.0, Event::TrialStarted)]);
    check_silences(&mut passive, 0.0, 13.0, &[6.0, 12.0]);
}

#[test]
fn a_press_ends_the_silence_and_a_pause_is_none() {
    let mut engine = engine(|_| ());
    let (_, last_s) = pressed(&mut engine, &[1.0, 1.0, 1.0]);
    let kinds = check(&mut engine, &[later(last_s + 5.0), (last_s + 5.5, press("trash")), later(last_s + 11.0)]);
    assert!(waits(&kinds).is_empty(), "{kinds:?}");
    let now_s = last_s + 11.0;
    let kinds =
        check(&mut engine, &[(now_s, Event::TrialPaused), (now_s + 10.0, Event::TrialResumed), later(now_s + 12.0)]);
    let found = waits(&kinds);
    assert!(found.len() == 1 && (found[0] - last_s - 5.5 - 16.0).abs() < 1e-6, "{found:?} after {last_s}");
}

#[test]
fn the_silence_that_is_recorded_is_the_time_since_the_last_press() {
    let mut engine = engine(|_| ());
    let (_, last_s) = pressed(&mut engine, &[1.0]);
    let events = engine.input(at(last_s + 13.0), Event::Marker { note: String::new() }).events;
    let silences = events.iter().filter_map(|stamped| match stamped.event {
        Event::HumanWaits { silent_ns } => Some(silent_ns),
        _ => None,
    });
    assert_eq!(silences.collect::<Vec<_>>(), [at(6.0), at(12.0)]);
}
