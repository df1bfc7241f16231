//! The estimate of beliefs does not depend on the tracker's sampling rate.

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_session::Event;
use tomcom_session::settings::{GazeSource, ParticipantKind};

use super::engine;
use crate::kitchen;

/// The estimate after a path of fixations, told at this rate; each a point and its length in seconds.
fn after_path(path: &[([f64; 2], f64)], hz: f64) -> Vec<Vec<f64>> {
    let mut engine = engine(|spec| {
        (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
    });
    let at = SessionTime::from_secs_f64;
    assert_eq!(engine.input(at(0.0), Event::TrialStarted).refused, None);
    let mut input = |time_s: f64, event: Event| assert_eq!(engine.input(at(time_s), event).refused, None);
    // What the robot's presses do to a belief is drawn, by the numbers of events, which are others at another rate.
    input(0.0, Event::RobotStopped);
    for (place, content) in [("counter", "salmon cut"), ("plate", "nori"), ("cutting_board", "tuna raw")] {
        input(0.5, Event::KitchenCorrected { location: place.to_string(), content: content.to_string() });
    }
    let total_s: f64 = path.iter().map(|(_, length_s)| length_s).sum();
    let samples = (total_s * hz).round() as usize;
    for sample in 0..samples {
        let time_s = (sample as f64 + 0.5) / hz;
        let mut until_s = 0.0;
        let here = path.iter().find(|(_, length_s)| {
            until_s += length_s;
            time_s < until_s - 1e-9
        });
        let [x, y] = here.unwrap_or(&path[path.len() - 1]).0;
        let taken_ns = Some(at(1.0 + time_s));
        input(1.0 + time_s, Event::Gaze(GazeSample { taken_ns, ..GazeSample::new(x, y, 0.95) }));
    }
    engine.belief().aspects.iter().map(|aspect| aspect.mean().to_vec()).collect()
}

fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// How far the estimates after random paths of so many fixations are apart between rates, at most: 120 and 200 Hz, and 30 Hz
/// from these. `length_s` makes the length of a fixation of a random number from 0 to 1.
fn apart_by_rate(name: &str, fixations: usize, length_s: fn(f64) -> f64) -> [f64; 2] {
    let kitchen = kitchen("sushi");
    let (mut fast, mut slow) = (Vec::new(), Vec::new());
    for number in 0..12 {
        let mut random = stream(3, "paths", number);
        let mut fixation = |_| {
            let location = &kitchen.locations[random.random_range(0..kitchen.locations.len())];
            (location.display.centre(), length_s(random.random::<f64>()))
        };
        let path: Vec<([f64; 2], f64)> = (0..fixations).map(&mut fixation).collect();
        let estimates = [30.0, 120.0, 200.0].map(|hz| after_path(&path, hz));
        fast.push(apart(&estimates[1], &estimates[2]));
        slow.push(apart(&estimates[0], &estimates[1]).max(apart(&estimates[0], &estimates[2])));
    }
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let within = slow.iter().filter(|difference| **difference <= 0.02).count();
    println!(
        "{fixations} fixations of {name}: 120 and 200 Hz at most {:.4} apart, 30 Hz {:.4},",
        most(&fast),
        most(&slow)
    );
    println!("  within 0.02 on {within} of {} paths", slow.len());
    [most(&fast), most(&slow)]
}

/// From 0.15 to 0.6 s.
fn of_any_length(share: f64) -> f64 {
    0.15 + 0.45 * share
}

#[test]
fn the_same_path_of_gaze_gives_the_same_estimate_at_every_rate() {
    let [fast, slow] = apart_by_rate("any length", 40, of_any_length);
    assert!(fast <= 0.02 && slow <= 0.02, "{fast} {slow}");
    // Where the samples of all rates tell when the eyes moved on, nothing else makes a difference, also after a few looks.
    let [fast, slow] = apart_by_rate("whole tenths of a second", 10, |share| (2.0 + (share * 5.0).floor()) / 10.0);
    assert!(fast <= 0.005 && slow <= 0.005, "{fast} {slow}");
}

/// Fixations of 0.15 and of 0.183 s give the same samples at 30 Hz. After one such look, at 5 readings a second, what was read
/// may differ by exp(-5 * 0.15) - exp(-5 * 0.183) = 0.07, which no estimate can know from the samples; more looks make it less.
#[test]
fn a_slow_tracker_leaves_open_when_the_eyes_moved_on() {
    let [fast, slow] = apart_by_rate("any length", 10, of_any_length);
    assert!(fast <= 0.02 && slow <= 0.07, "{fast} {slow}");
}
