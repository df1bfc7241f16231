//! When the assistant is asked besides presses and changes of the task: in unusual silence, and by gaze.

use std::collections::BTreeMap;

use tomcom::gaze::GazeSample;
use tomcom::run::engine::{InputResult, SessionEngine};
use tomcom::session::Event;
use tomcom::session::settings::{GazeSource, SessionSpec};

use super::{at, check, engine, press};

/// Seconds between the first presses: of eight intervals, seven are at most 1.6 s.
const INTERVALS_S: [f64; 8] = [1.3, 1.0, 1.7, 1.1, 1.6, 1.2, 1.5, 1.4];

fn asks_in_silence(spec: &mut SessionSpec) {
    spec.assistant.asks_in_silence = true;
}

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

fn waits(kinds: &[(&str, f64)]) -> Vec<f64> {
    kinds.iter().filter(|(kind, _)| *kind == "human_waits").map(|(_, seconds)| *seconds).collect()
}

#[test]
fn a_silence_is_unusual_once_it_is_longer_than_four_fifths_of_the_own_intervals() {
    let mut asking = engine(asks_in_silence);
    let (kinds, last_s) = pressed(&mut asking, &INTERVALS_S);
    assert!(waits(&kinds).is_empty(), "too few intervals: {kinds:?}");
    asking.take_questions();
    let kinds = check(&mut asking, &[(last_s + 60.0, Event::Marker { note: "later".to_string() })]);
    let found = waits(&kinds);
    assert_eq!(found.len(), 1, "once between two presses: {kinds:?}");
    assert!((found[0] - last_s - 1.6).abs() < 1e-6, "{found:?} after {last_s}");
    let asked = asking.take_questions();
    assert!(asked.iter().any(|request| request.time == at(last_s + 1.6)), "the assistant is asked then");
}

#[test]
fn with_fewer_intervals_or_without_the_setting_no_silence_is_unusual() {
    let later = |last_s: f64| (last_s + 60.0, Event::Marker { note: "later".to_string() });
    let mut few = engine(asks_in_silence);
    let (_, last_s) = pressed(&mut few, &INTERVALS_S[1..]);
    assert!(waits(&check(&mut few, &[later(last_s)])).is_empty());
    let mut off = engine(|_| ());
    let (_, last_s) = pressed(&mut off, &INTERVALS_S);
    assert!(waits(&check(&mut off, &[later(last_s)])).is_empty());
}

#[test]
fn a_pause_is_no_silence() {
    let mut asking = engine(asks_in_silence);
    let (_, last_s) = pressed(&mut asking, &INTERVALS_S);
    let kinds = check(
        &mut asking,
        &[
            (last_s + 1.0, Event::TrialPaused),
            (last_s + 11.0, Event::TrialResumed),
            (last_s + 20.0, Event::Marker { note: "later".to_string() }),
        ],
    );
    let found = waits(&kinds);
    assert!(found.len() == 1 && (found[0] - last_s - 11.6).abs() < 1e-6, "{found:?} after {last_s}");
}

/// Looks at one point of the display, 30 times a second, until a time; the events.
fn gazing(engine: &mut SessionEngine, point: [f64; 2], from_s: f64, until_s: f64) -> Vec<(f64, Event)> {
    let samples = ((until_s - from_s) * 30.0) as u32;
    let mut events = Vec::new();
    for number in 0..samples {
        let now = at(from_s + f64::from(number) / 30.0);
        let InputResult { events: new, refused } =
            engine.input(now, Event::Gaze(GazeSample::new(point[0], point[1], 1.0)));
        assert_eq!(refused, None);
        events.extend(new.into_iter().map(|stamped| (stamped.time.as_secs_f64(), stamped.event)));
    }
    events
}

#[test]
fn a_change_that_is_looked_past_for_a_second_leads_to_one_question() {
    let mut asking = engine(|spec| {
        spec.participant.gaze = GazeSource::Mouse;
        spec.assistant.asks_by_gaze = true;
    });
    let mut events: Vec<(f64, Event)> = Vec::new();
    let started = asking.input(at(0.0), Event::TrialStarted).events;
    events.extend(started.into_iter().map(|stamped| (stamped.time.as_secs_f64(), stamped.event)));
    events.extend(gazing(&mut asking, [0.001, 0.001], 0.01, 20.0));
    let mut presses_s = Vec::new();
    let mut told: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (time_s, event) in &events {
        match event {
            Event::Press { .. } => presses_s.push(*time_s),
            Event::SeemsUnaware { aspect } => told.entry(aspect.clone()).or_default().push(*time_s),
            _ => {}
        }
    }
    println!("robot presses at {presses_s:?}, seems unaware: {told:?}");
    assert!(!told.is_empty(), "the robot changed something, and nobody looked");
    for (aspect, times) in &told {
        // Between two questions about one aspect lies a press of the robot, which changed it, and a second of gaze after it.
        for (index, &time_s) in times.iter().enumerate() {
            let since = index.checked_sub(1).map_or(0.0, |before| times[before]);
            let is_between = |press_s: &&f64| **press_s > since && **press_s <= time_s - 1.0 + 0.04;
            assert!(presses_s.iter().any(|press_s| is_between(&press_s)), "{aspect}: {time_s} since {since}");
        }
    }
    let asked = asking.take_questions();
    let first = told.values().flatten().copied().fold(f64::INFINITY, f64::min);
    assert!(asked.iter().any(|request| (request.time.as_secs_f64() - first).abs() < 1e-6), "it is asked then");
}

#[test]
fn who_looks_at_what_changes_is_not_asked_about() {
    let mut asking = engine(|spec| {
        spec.participant.gaze = GazeSource::Mouse;
        spec.assistant.asks_by_gaze = true;
    });
    let kitchen = asking.session().kitchen.clone();
    let hand = kitchen.hands[tomcom::kitchen::Agent::Robot.index()];
    let point = kitchen.location(hand).display.centre();
    let _ = asking.input(at(0.0), Event::TrialStarted);
    let events = gazing(&mut asking, point, 0.01, 20.0);
    let name = &kitchen.location(hand).name;
    let told = events.iter().filter(|(_, event)| matches!(event, Event::SeemsUnaware { aspect } if aspect == name));
    assert_eq!(told.count(), 0);
}
