//! Streams of samples: faults, delays, sampling rates, and floods.

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::quality::{GazeFault, GazeRateLimiter};
use tomcom_session::Event;
use tomcom_session::engine::SessionEngine;
use tomcom_session::settings::{GazeSource, ParticipantKind};

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
fn a_flood_is_let_through_at_the_rate_of_the_fastest_tracker() {
    let mut limit = GazeRateLimiter::default();
    let passed = |limit: &mut GazeRateLimiter, hz: u64, from_s: u64, seconds: u64| {
        let times = (0..hz * seconds).map(|n| SessionTime(from_s * 1_000_000_000 + n * 1_000_000_000 / hz));
        times.filter(|&time| limit.admits(time)).count() as u64
    };
    assert_eq!(passed(&mut limit, 1000, 0, 20), 20_000, "a fast tracker loses nothing");
    let flood = passed(&mut limit, 50_000, 20, 20);
    assert!((59_000..=60_001).contains(&flood), "{flood} of a flood");
}

#[test]
fn what_waited_while_the_program_stood_still_is_no_flood() {
    for (hz, seconds) in [(200, 6), (1000, 10), (2000, 10)] {
        let mut limit = GazeRateLimiter::default();
        let steady = (0..hz).filter(|n| limit.admits(SessionTime(n * 1_000_000_000 / hz))).count() as u64;
        // The program stands still; then all samples of that time arrive at once.
        let at_once = (0..hz * seconds).filter(|_| limit.admits(SessionTime((1 + seconds) * 1_000_000_000))).count();
        assert_eq!((steady, at_once as u64), (hz, hz * seconds), "{hz} Hz");
    }
}

/// The sampling rates that are shown after samples that arrive and were taken at these times, in ms.
fn rates(samples: impl IntoIterator<Item = (u64, Option<u64>)>) -> Vec<f64> {
    let mut engine = engine(|spec| {
        (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
    });
    let at = |ms: u64| SessionTime(ms * 1_000_000);
    let mut shown = Vec::new();
    for (index, (arrived, taken)) in samples.into_iter().enumerate() {
        let x = 0.4 + index as f64 * 1e-5;
        let sample = GazeSample { taken_ns: taken.map(at), ..GazeSample::new(x, 0.35, 0.9) };
        assert_eq!(engine.input(at(arrived), Event::Gaze(sample)).refused, None);
        shown.extend(engine.session().gaze_hz(at(arrived)));
    }
    shown
}

#[test]
fn the_rate_of_samples_that_arrive_together_is_the_trackers() {
    let most = |rates: &[f64]| rates.iter().copied().fold(0.0, f64::max);
    let last = |rates: &[f64]| rates.last().copied().unwrap_or(f64::NAN);
    // 880 samples of a tracker with 120 Hz in one datagram, without and with their times.
    let at_once = rates((0..880).map(|_| (10_000, None)));
    assert!(most(&at_once) <= 880.0, "{} Hz", most(&at_once));
    let with_times = rates((0..880).map(|sample| (10_000, Some(2_000 + sample * 25 / 3))));
    assert!((last(&with_times) - 120.0).abs() < 2.0 && most(&with_times) < 130.0, "{} Hz", most(&with_times));
    // Packets of 24 samples, five times a second.
    let packets = rates((0..1200).map(|sample| (1000 + sample / 24 * 200, None)));
    assert!(
        (last(&packets) - 120.0).abs() < 15.0 && most(&packets) < 250.0,
        "{} to {} Hz",
        last(&packets),
        most(&packets)
    );
    // One at a time: the rate is known soon, and stays.
    let steady = rates((0..480).map(|sample| (1000 + sample * 25 / 3, None)));
    assert!(steady[8..].iter().all(|hz| (hz - 120.0).abs() < 15.0), "{steady:?}");
    assert!(steady[120..].iter().all(|hz| (hz - 120.0).abs() < 3.0), "{steady:?}");
}
