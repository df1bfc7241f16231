//! Streams of samples: faults, delays, the device's clock, and floods.

use tomcom::base::time::SessionTime;
use tomcom::gaze::GazeSample;
use tomcom::gaze::device_clock::DeviceClock;
use tomcom::gaze::quality::{GazeFault, GazeFaultDetector, GazeRateLimiter};
use tomcom::run::engine::SessionEngine;
use tomcom::session::Event;
use tomcom::session::settings::{GazeSource, ParticipantKind};

use super::engine;

#[test]
fn what_is_wrong_with_a_stream_is_counted_by_kind_and_not_read() {
    let mut engine = engine(|spec| {
        (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
    });
    let at = |ms: u64| SessionTime(ms * 1_000_000);
    assert_eq!(engine.input(at(0), Event::TrialStarted).refused, None);
    let send = |engine: &mut SessionEngine, arrived: u64, taken: u64, x: f64| {
        let sample = GazeSample {
            device_ns: Some(taken as i64 + 5),
            taken_ns: Some(at(taken)),
            ..GazeSample::new(x, 0.35, 0.9)
        };
        let before = engine.belief().clone();
        assert_eq!(engine.input(at(arrived), Event::Gaze(sample)).refused, None);
        (*engine.belief() != before, engine.session().gaze.fault)
    };
    assert_eq!(send(&mut engine, 1000, 990, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1000, 998, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1002, 998, 0.40), (false, Some(GazeFault::Duplicate)));
    assert_eq!(send(&mut engine, 1003, 910, 0.40), (false, Some(GazeFault::OutOfOrder)));
    assert_eq!(send(&mut engine, 1600, 1010, 0.40), (false, Some(GazeFault::TooOld)));
    // One from the future counts as taken now; the stream goes on after it.
    assert_eq!(send(&mut engine, 1610, 9000, 0.40), (true, None));
    assert_eq!(send(&mut engine, 1620, 1618, 0.40), (true, None));
    let counts = engine.session().gaze.judge.counts;
    assert_eq!((counts.duplicate, counts.out_of_order, counts.too_old, counts.sum()), (1, 1, 1, 3));
    assert_eq!(engine.session().gaze.samples, 7);
}

#[test]
fn what_is_read_is_what_the_display_showed_when_the_sample_was_taken() {
    let at = |ms: u64| SessionTime(ms * 1_000_000);
    // Salmon is put down on the counter at 1000 ms; gaze of before and after arrives at 1100 ms.
    let p_salmon = |taken_ms: u64| {
        let mut engine = engine(|spec| {
            (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
            // Before the samples the gaze is unknown, and nothing is looked at.
            (spec.human.looking.looks_hz, spec.human.looking.other_looks_hz) = (0.0, 0.0);
            spec.human.looking.capture = 0.0;
        });
        let kitchen = engine.session().kitchen.clone();
        let counter = kitchen.location_named("counter").expect("a counter");
        let [x, y] = kitchen.location(counter).display.centre();
        let input = |engine: &mut SessionEngine, ms: u64, event: Event| {
            assert_eq!(engine.input(at(ms), event).refused, None);
        };
        input(&mut engine, 0, Event::TrialStarted);
        let (location, content) = ("counter".to_string(), "salmon raw".to_string());
        input(&mut engine, 1000, Event::KitchenCorrected { location, content });
        for sample in 0..8 {
            let taken_ns = Some(at(taken_ms + 5 * sample));
            input(&mut engine, 1100, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 0.9) }));
        }
        let salmon = kitchen.content_named("salmon raw").expect("salmon").0;
        let value = kitchen.aspects[counter.index()].index_of(salmon).expect("a value");
        engine.belief().aspects[counter.index()].mean()[value]
    };
    let (before, after) = (p_salmon(940), p_salmon(1040));
    assert!(before < 0.05, "salmon was not there yet: {before}");
    assert!(after > 0.15, "salmon lay there: {after}");
}

#[test]
fn device_time_is_told_from_the_samples_that_took_the_shortest_way() {
    let mut clock = DeviceClock::default();
    let ms = |ms: u64| SessionTime(ms * 1_000_000);
    // The device's clock is 5 s behind; samples take 3 ms at least, some of them longer.
    for step in 0..200u64 {
        let late = 3 + [0, 9, 4, 30][step as usize % 4];
        let taken = clock.session_time(ms(1000 + 10 * step).0 as i64, ms(6000 + 10 * step + late));
        assert_eq!(taken, (ms(6000 + 10 * step + 3), None), "step {step}");
    }
}

/// A stream at 100 Hz with delays of 3 to 12 ms, whose clock does what it says. Gives the samples that are not read, the largest error
/// of the time of those that are, in ms, in the last second, and by how much the clock was set, in s.
fn stream(device_ms: impl Fn(u64) -> u64) -> (u64, f64, Vec<f64>) {
    let (mut clock, mut checker) = (DeviceClock::default(), GazeFaultDetector::default());
    let (mut unread, mut most_off, mut steps) = (0, 0.0f64, Vec::new());
    for sample in 0..2000u64 {
        let taken_ms = 20_000 + 10 * sample;
        let arrived = SessionTime((taken_ms + 3 + [0, 9, 4, 2, 7][sample as usize % 5]) * 1_000_000);
        let device_ns = 1_000_000 * device_ms(taken_ms) as i64;
        let (taken, step) = clock.session_time(device_ns, arrived);
        steps.extend(step.map(|step| step.by_ns as f64 / 1e9));
        let seen = GazeSample { device_ns: Some(device_ns), taken_ns: Some(taken), ..GazeSample::new(0.5, 0.5, 0.9) };
        unread += u64::from(checker.judge(&seen, arrived).is_some());
        if sample >= 1900 {
            most_off = most_off.max((taken.0 as f64 / 1e6 - taken_ms as f64).abs());
        }
    }
    (unread, most_off, steps)
}

#[test]
fn a_clock_that_was_set_costs_less_than_a_second_of_gaze_and_is_told() {
    for by_ms in [-5000i64, -700, -300, -200, 200, 300, 700, 5000] {
        let set = |ms: u64| if ms < 25_000 { ms } else { ms.saturating_add_signed(by_ms) };
        let (unread, most_off, steps) = stream(set);
        println!("{by_ms} ms: {unread} samples unread, {most_off:.1} ms off afterwards");
        assert!(unread <= 100 && most_off <= 5.0, "{by_ms} ms: {unread} samples unread, {most_off} ms off");
        assert_eq!(steps.len(), 1, "{by_ms} ms");
        assert!((steps[0] - by_ms as f64 / 1e3).abs() <= 0.005, "{by_ms} ms: {steps:?}");
    }
}

#[test]
fn a_single_wrong_time_stamp_costs_that_sample_at_most() {
    for by_ms in [-800i64, 800, 5000, 3_600_000] {
        let (unread, most_off, steps) = stream(|ms| if ms == 25_000 { ms.saturating_add_signed(by_ms) } else { ms });
        assert!(unread <= 1 && most_off <= 5.0 && steps.is_empty(), "{by_ms}: {unread}, {most_off}, {steps:?}");
    }
}

#[test]
fn samples_that_were_held_up_together_set_no_clock() {
    let mut clock = DeviceClock::default();
    let ms = |ms: u64| SessionTime(ms * 1_000_000);
    for sample in 0..1000u64 {
        let taken_ms = 5000 + 10 * sample;
        // Once a second the network holds everything up for 0.3 s.
        let arrived_ms = (taken_ms + 3).max(taken_ms / 1000 * 1000 + 303);
        let (taken, step) = clock.session_time(ms(taken_ms).0 as i64, ms(arrived_ms));
        assert_eq!(step, None, "sample {sample}");
        assert!(sample < 30 || taken.0.abs_diff(ms(taken_ms).0) <= 5_000_000, "sample {sample}: {taken}");
    }
}

#[test]
fn a_flood_is_let_through_at_the_rate_of_the_fastest_tracker() {
    let mut limit = GazeRateLimiter::default();
    let passed = |limit: &mut GazeRateLimiter, hz: u64, from_s: u64, seconds: u64| {
        let times = (0..hz * seconds).map(|n| SessionTime(from_s * 1_000_000_000 + n * 1_000_000_000 / hz));
        times.filter(|&time| limit.admits(time)).count() as u64
    };
    assert_eq!(passed(&mut limit, 1000, 0, 20), 20_000, "a fast tracker loses nothing");
    let flood = passed(&mut limit, 50_000, 20, 10);
    assert!((20_000..=21_001).contains(&flood), "{flood} of a flood");
}
