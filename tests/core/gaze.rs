//! The tracker's clock over simulated schedules of samples, the tags on the wall display, and the map from a tracker's surface to it.

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_core::gaze::device_clock::{ClockNews, DeviceClock};
use tomcom_core::gaze::quality::{GazeFaultDetector, TOO_OLD_S};
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_core::gaze::tags::{CELLS, DisplayTags};
use tomcom_core::kitchen::DisplayArea;

use crate::files::load;

/// Arrival of the first sample, in seconds: session time cannot be negative.
const BEGUN_S: f64 = 1000.0;
/// Number of schedules of each kind.
const SEEDS: u64 = 20;

/// How a network delays samples, beyond 3 ms.
#[derive(Clone, Copy, Debug)]
enum Network {
    /// By up to 60 ms.
    Uneven,
    /// By 20 ms on the average, and sometimes by much more.
    LongTailed,
    /// Not at all.
    Even,
    /// Everything is held up for 0.3 s once a second.
    HoldsUp,
}

use Network::{Even, HoldsUp, LongTailed, Uneven};

/// A sender of gaze whose stamps are `t`, as a function of the time at which a sample was taken.
struct Schedule<'a> {
    hz: f64,
    seconds: f64,
    network: Network,
    t: &'a dyn Fn(f64) -> f64,
}

/// What came of a schedule.
#[derive(Default)]
struct Outcome {
    /// News about the clock, with the seconds since the first sample.
    news: Vec<(f64, ClockNews)>,
    /// Number of seconds' worth of samples that were not read.
    unread_s: f64,
    /// Largest time in seconds by which a sample of the last five seconds counts as older than it was when it arrived.
    lag_s: f64,
}

impl Outcome {
    fn steps(&self) -> Vec<f64> {
        let step = |(_, news): &(f64, ClockNews)| match news {
            ClockNews::Set(step) => Some(step.by_ns as f64 / 1e9),
            ClockNews::Stamps(_) => None,
        };
        self.news.iter().filter_map(step).collect()
    }

    fn fault(&self) -> Option<(f64, StampFault)> {
        self.news.iter().find_map(|(at_s, news)| match news {
            ClockNews::Stamps(Err(fault)) => Some((*at_s, *fault)),
            ClockNews::Set(_) | ClockNews::Stamps(Ok(())) => None,
        })
    }
}

impl Schedule<'_> {
    /// Runs the schedule with delays drawn by this seed; those of even seeds keep the order of samples, as TCP does.
    fn run(&self, seed: u64) -> Outcome {
        let mut random = stream(seed, "network", 0);
        let mut arrivals = Vec::new();
        let mut last_s = 0.0f64;
        for number in 0..(self.seconds * self.hz) as u64 {
            let taken_s = number as f64 / self.hz;
            let delay_s = match self.network {
                Even => 0.0,
                Uneven => 0.06 * random.random::<f64>(),
                LongTailed => -0.02 * (1.0 - random.random::<f64>()).ln(),
                HoldsUp => (0.3 - taken_s % 1.0).max(0.0),
            };
            let arrived_s = taken_s + 0.003 + delay_s;
            last_s = if seed.is_multiple_of(2) { last_s.max(arrived_s) } else { arrived_s };
            arrivals.push((last_s, taken_s));
        }
        arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut clock, mut detector, mut outcome) =
            (DeviceClock::default(), GazeFaultDetector::default(), Outcome::default());
        let mut unread = 0u32;
        for (number, (arrived_s, taken_s)) in arrivals.into_iter().enumerate() {
            let arrived = SessionTime::from_secs_f64(BEGUN_S + arrived_s);
            let device_ns = ((self.t)(taken_s) * 1e9).round() as i64;
            outcome.news.extend(clock.learn(device_ns, arrived).map(|news| (arrived_s, news)));
            let taken = clock.session_time(device_ns, arrived).unwrap_or(arrived);
            assert!(taken <= arrived, "no sample is from the future");
            let x = 0.3 + number as f64 * 1e-6;
            let sample =
                GazeSample { device_ns: Some(device_ns), taken_ns: Some(taken), ..GazeSample::new(x, 0.5, 0.9) };
            // The order of samples that a network mixed up is another matter.
            let is_old = detector.judge(&sample, arrived).is_some() && arrived.secs_since(taken) > TOO_OLD_S;
            unread += u32::from(is_old);
            if arrived_s > self.seconds - 5.0 {
                outcome.lag_s = outcome.lag_s.max(arrived.secs_since(taken) - (arrived_s - taken_s));
            }
        }
        outcome.unread_s = f64::from(unread) / self.hz;
        outcome
    }
}

fn at_rate(rate: f64) -> impl Fn(f64) -> f64 {
    move |taken_s| 100.0 + rate * taken_s
}

#[test]
fn a_clock_at_another_rate_is_told_within_five_seconds_and_never_sticks() {
    for rate in [0.5, 0.9, 0.92, 0.97, 1.03, 1.1, 2.0] {
        for network in [Even, Uneven, LongTailed] {
            for seed in 0..SEEDS {
                let found = Schedule { hz: 120.0, seconds: 60.0, network, t: &at_rate(rate) }.run(seed);
                let case = format!("rate {rate}, {network:?}, seed {seed}");
                let Some((at_s, StampFault::Rate(told))) = found.fault() else { panic!("{case}: {:?}", found.news) };
                assert!(at_s <= 5.0 && (told / rate - 1.0).abs() < 0.05, "{case}: {told} after {at_s} s");
                // From then on samples count as taken when they arrive.
                assert!(found.unread_s <= 1.0 && found.lag_s <= 0.0, "{case}: {} s, {} s", found.unread_s, found.lag_s);
                assert_eq!(found.news.len(), 1, "{case}: {:?}", found.news);
            }
        }
    }
}

#[test]
fn a_clock_that_drifts_as_clocks_do_is_followed_without_a_word() {
    for rate in [0.9998, 1.0, 1.0002] {
        for (network, hz) in [(Even, 30.0), (Uneven, 30.0), (Uneven, 120.0), (LongTailed, 60.0), (HoldsUp, 240.0)] {
            for seed in 0..SEEDS {
                let found = Schedule { hz, seconds: 120.0, network, t: &at_rate(rate) }.run(seed);
                let case = format!("rate {rate}, {network:?} at {hz} Hz, seed {seed}");
                let is_sound = found.news.iter().all(|(_, news)| *news == ClockNews::Stamps(Ok(())));
                assert!(is_sound && found.news.len() == 1, "{case}: {:?}", found.news);
                assert!(found.unread_s == 0.0 && found.lag_s < 0.01, "{case}: {} s", found.lag_s);
            }
        }
    }
}

#[test]
fn a_clock_that_was_set_costs_less_than_a_second_of_gaze_and_is_told() {
    for by_s in [-5.0, -0.7, -0.3, -0.2, 0.2, 0.3, 0.7, 5.0] {
        for (network, hz, exact_s) in
            [(Even, 30.0, 0.001), (Even, 200.0, 0.001), (Uneven, 120.0, 0.045), (LongTailed, 120.0, 0.045)]
        {
            let mut told = 0;
            for rate in [0.9998, 1.0002] {
                let t = |taken_s: f64| at_rate(rate)(taken_s) + if taken_s >= 15.3 { by_s } else { 0.0 };
                for seed in 0..SEEDS {
                    let found = Schedule { hz, seconds: 40.0, network, t: &t }.run(seed);
                    let case = format!("{by_s} s, {network:?} at {hz} Hz, seed {seed}");
                    assert!(
                        found.unread_s <= 1.0 && found.lag_s < 0.01,
                        "{case}: {} s, {} s",
                        found.unread_s,
                        found.lag_s
                    );
                    assert_eq!(found.fault(), None, "{case}");
                    let steps: Vec<&(f64, ClockNews)> =
                        found.news.iter().filter(|(_, news)| matches!(news, ClockNews::Set(_))).collect();
                    assert!(steps.len() <= 1 && steps.iter().all(|(at_s, _)| at_s - 15.3 < 1.0), "{case}: {steps:?}");
                    assert!(found.steps().iter().all(|step_s| (step_s - by_s).abs() <= exact_s), "{case}: {steps:?}");
                    told += steps.len() as u64;
                }
            }
            // Where delays of just then look like part of the step, it is followed without a word.
            let least = if matches!(network, Even) { 2 * SEEDS } else { 2 * SEEDS - 2 };
            assert!(told >= least, "{by_s} s, {network:?} at {hz} Hz: told {told} times of {}", 2 * SEEDS);
        }
    }
}

#[test]
fn a_clock_is_followed_through_many_steps_both_ways() {
    for seed in 0..SEEDS {
        // Every five seconds it is set, by up to a second.
        let mut random = stream(seed, "steps", 0);
        let set_s: Vec<f64> = (0..24).map(|_| random.random_range(-1.0..1.0)).collect();
        let t = |taken_s: f64| taken_s + set_s[..(taken_s / 5.0) as usize].iter().sum::<f64>();
        let found = Schedule { hz: 60.0, seconds: 120.0, network: Uneven, t: &t }.run(seed);
        assert!(found.unread_s <= 24.0 && found.lag_s < 1.1, "seed {seed}: {} s, {} s", found.unread_s, found.lag_s);
        // Then it is left alone.
        let t = |taken_s: f64| if taken_s < 120.0 { t(taken_s) } else { taken_s };
        let found = Schedule { hz: 60.0, seconds: 130.0, network: Uneven, t: &t }.run(seed);
        assert!(found.lag_s < 0.01, "seed {seed}: {} s", found.lag_s);
    }
}

#[test]
fn single_wrong_time_stamps_cost_those_samples_at_most() {
    for by_s in [-0.8, 0.8, 5.0, 3600.0] {
        for seed in 0..SEEDS {
            let is_wrong = |taken_s: f64| (taken_s * 100.0).round() as u64 % 700 == 350;
            let t = |taken_s: f64| 1.7e9 + taken_s + if is_wrong(taken_s) { by_s } else { 0.0 };
            let found = Schedule { hz: 100.0, seconds: 40.0, network: Uneven, t: &t }.run(seed);
            // One in seven seconds: five of them, or six.
            let case = format!("{by_s} s, seed {seed}");
            assert!(
                found.unread_s <= 0.06 && found.steps().is_empty(),
                "{case}: {} s, {:?}",
                found.unread_s,
                found.news
            );
            assert_eq!(found.fault(), None, "{case}");
            assert!(found.lag_s <= 0.8, "{case}: {} s", found.lag_s);
        }
    }
}

#[test]
fn stamps_that_are_no_time_in_seconds_are_told_for_what_they_are() {
    let milliseconds: &dyn Fn(f64) -> f64 = &|taken_s| 1e3 * taken_s;
    let microseconds: &dyn Fn(f64) -> f64 = &|taken_s| 1e6 * taken_s;
    let frames: &dyn Fn(f64) -> f64 = &|taken_s| (120.0 * taken_s).round();
    let falling: &dyn Fn(f64) -> f64 = &|taken_s| 500.0 - taken_s;
    let constant: &dyn Fn(f64) -> f64 = &|_| 7.5;
    let whole_seconds: &dyn Fn(f64) -> f64 = &|taken_s| taken_s.floor();
    let random: &dyn Fn(f64) -> f64 = &|taken_s| (taken_s * 12_345.678).fract() * 1000.0;
    let cases = [
        (milliseconds, "t runs 1000 times as fast as real time, like milliseconds"),
        (microseconds, "t runs 1000000 times as fast as real time, like microseconds"),
        (frames, "times as fast as real time, like counts of samples or frames"),
        (falling, "t goes back from sample to sample"),
        (constant, "t stands still"),
        (whole_seconds, "t stands still"),
        (random, "t goes back from sample to sample"),
    ];
    for (t, words) in cases {
        for network in [Even, Uneven] {
            for seed in 0..SEEDS {
                let found = Schedule { hz: 120.0, seconds: 30.0, network, t }.run(seed);
                let (at_s, fault) = found.fault().unwrap_or_else(|| panic!("{words}: {:?}", found.news));
                assert!(
                    fault.words().ends_with(words) && at_s < 3.0,
                    "{words}, seed {seed}: {} after {at_s} s",
                    fault.words()
                );
                assert!(found.steps().is_empty() && found.lag_s <= 0.0, "{words}, seed {seed}: {:?}", found.news);
            }
        }
    }
    assert_eq!(StampFault::Rate(0.9722).words(), "t runs at 97 % of real time");
    assert_eq!(StampFault::Rate(1.0151).words(), "t runs at 101.5 % of real time");
}

#[test]
fn stamps_that_are_mended_are_used_again() {
    // A program that counts samples is replaced by one that sends seconds, behind the same address.
    let t = |taken_s: f64| if taken_s < 20.0 { 1000.0 * taken_s } else { taken_s };
    for seed in 0..SEEDS {
        let found = Schedule { hz: 120.0, seconds: 40.0, network: Uneven, t: &t }.run(seed);
        let last = found.news.last().expect("news");
        assert!(last.1 == ClockNews::Stamps(Ok(())) && (20.0..30.0).contains(&last.0), "seed {seed}: {:?}", found.news);
        assert!(found.lag_s < 0.01, "seed {seed}: {}", found.lag_s);
    }
}

#[test]
fn samples_of_two_eyes_and_of_frames_have_stamps_of_a_clock() {
    // Every second sample is of the other eye, whose camera is 4 ms behind.
    let eyes = |taken_s: f64| taken_s - if (taken_s * 200.0).round() as u64 % 2 == 1 { 0.009 } else { 0.0 };
    // All samples of a frame of the scene camera have its stamp.
    let frames = |taken_s: f64| (taken_s * 30.0).floor() / 30.0;
    let cases: [&dyn Fn(f64) -> f64; 2] = [&eyes, &frames];
    for t in cases {
        for seed in 0..SEEDS {
            let found = Schedule { hz: 200.0, seconds: 30.0, network: Uneven, t }.run(seed);
            let news: Vec<ClockNews> = found.news.iter().map(|(_, news)| *news).collect();
            assert_eq!(news, [ClockNews::Stamps(Ok(()))], "seed {seed}");
        }
    }
}

#[test]
fn slow_trackers_and_gaps_do_not_hold_a_clock() {
    // Four samples a second, whose clock is set back; then nothing for two minutes, in which the clocks drift apart.
    let mut clock = DeviceClock::default();
    let mut taken_at = |taken_s: f64, by_s: f64| {
        let (device_ns, arrived) = (((taken_s + by_s) * 1e9) as i64, SessionTime::from_secs_f64(BEGUN_S + taken_s));
        clock.learn(device_ns, arrived);
        arrived.secs_since(clock.session_time(device_ns, arrived).unwrap_or(arrived))
    };
    let lags: Vec<f64> = (0..80).map(|n| taken_at(n as f64 / 4.0, if n < 40 { 0.0 } else { -0.7 })).collect();
    assert!(lags.iter().filter(|lag_s| **lag_s > TOO_OLD_S).count() <= 4, "{lags:?}");
    assert!(lags[50..].iter().all(|lag_s| *lag_s < 0.001), "{lags:?}");
    assert!(taken_at(140.0, -0.9) < 0.001, "nothing is known after a long gap");
}

#[test]
fn device_time_is_told_from_the_samples_that_took_the_shortest_way() {
    let mut clock = DeviceClock::default();
    let ms = |ms: u64| SessionTime(ms * 1_000_000);
    // The device's clock is 5 s behind; samples take 3 ms at least, some of them longer.
    for step in 0..200u64 {
        let (device_ns, arrived) =
            (ms(1000 + 10 * step).0 as i64, ms(6000 + 10 * step + 3 + [0, 9, 4, 30][step as usize % 4]));
        assert_eq!(clock.learn(device_ns, arrived), None, "step {step}");
        assert_eq!(clock.session_time(device_ns, arrived), Some(ms(6000 + 10 * step + 3)), "step {step}");
    }
}

#[test]
fn a_time_stamp_may_be_any_number_of_nanoseconds() {
    for device_ns in [i64::MIN, -3_500_000_000, 0, i64::MAX] {
        for arrived in [SessionTime(0), SessionTime(u64::MAX)] {
            let mut clock = DeviceClock::default();
            clock.learn(device_ns, arrived);
            assert_eq!(clock.session_time(device_ns, arrived), Some(arrived));
        }
    }
    let mut clock = DeviceClock::default();
    for (number, device_ns) in [i64::MIN, i64::MAX, 0, i64::MAX, i64::MIN].into_iter().cycle().take(5000).enumerate() {
        let arrived = SessionTime(number as u64 * 10_000_000);
        clock.learn(device_ns, arrived);
        assert!(clock.session_time(device_ns, arrived).is_none_or(|taken| taken <= arrived));
    }
}

fn overlap(a: DisplayArea, b: DisplayArea) -> bool {
    a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h
}

#[test]
fn tags_fit_the_corners_of_every_layout() {
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = load(layout);
        let tags = DisplayTags::place(&kitchen).expect("room for the tags");
        assert!((0.08..=0.10).contains(&tags.edge_m), "{layout}: {} m", tags.edge_m);
        let areas = kitchen.locations.iter().map(|location| location.display);
        let areas: Vec<DisplayArea> = areas.chain(kitchen.storages.iter().map(|storage| storage.display)).collect();
        for (index, tag) in tags.corners.iter().enumerate() {
            assert!(areas.iter().all(|area| !overlap(tag.area, *area)), "{layout}: tag {}", tag.id);
            assert!(tags.corners[..index].iter().all(|other| other.id != tag.id && !overlap(other.area, tag.area)));
            // The quiet zone is one cell of the ten on every side, and the tag is square in metres.
            let sides_m = [tag.black.w * kitchen.display_m[0], tag.black.h * kitchen.display_m[1]];
            assert!(sides_m.iter().all(|side_m| (side_m - tags.edge_m).abs() < 1e-12));
            assert!((tag.black.x - tag.area.x - tag.area.w / CELLS as f64).abs() < 1e-12);
            // A tracker asks for the corners of the black square, clockwise from the top left.
            let cell = |at: f64| [tag.area.x + tag.area.w * at / 10.0, tag.area.y + tag.area.h * at / 10.0];
            let ([left, top], [right, bottom]) = (cell(1.0), cell(9.0));
            for (corner, expected) in
                tag.black_corners().into_iter().zip([[left, top], [right, top], [right, bottom], [left, bottom]])
            {
                assert!(corner.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{layout}: {corner:?}");
            }
            let edges = [tag.area.x, tag.area.y, 1.0 - tag.area.x - tag.area.w, 1.0 - tag.area.y - tag.area.h];
            assert_eq!(
                edges.iter().filter(|gap| gap.abs() < 1e-12).count(),
                2,
                "{layout}: tag {} in its corner",
                tag.id
            );
        }
    }
}

#[test]
fn tags_have_a_black_border_a_white_one_and_patterns_of_their_own() {
    let tags = DisplayTags::place(&load("layouts/sushi.toml")).expect("room for the tags");
    let cells = tags.corners.map(|tag| tag.cells());
    for (index, tag) in cells.iter().enumerate() {
        let last = CELLS - 1;
        let ring = |at: usize, far: usize| [tag[at][far], tag[far][at]];
        assert!((0..=last).all(|at| [ring(at, 0), ring(at, last)] == [[false; 2]; 2]), "the white border");
        assert!((1..last).all(|at| [ring(at, 1), ring(at, last - 1)] == [[true; 2]; 2]), "the black border");
        for other in &cells[..index] {
            let differing = tag.iter().flatten().zip(other.iter().flatten()).filter(|(a, b)| a != b).count();
            assert!(differing >= 11, "the family keeps eleven bits apart: {differing}");
        }
    }
    // The first row of data of id 0 is 0xd5d628584 >> 30 = 110101: white, white, black, white, black, white.
    assert_eq!(cells[0][2][2..8], [false, false, true, false, true, false]);
}

#[test]
fn a_location_in_a_corner_leaves_no_room_for_its_tag() {
    let mut kitchen = load("layouts/sushi.toml");
    kitchen.locations[0].display = DisplayArea { x: 0.90, y: 0.05, w: 0.08, h: 0.10 };
    let error = DisplayTags::place(&kitchen).expect_err("no room");
    assert_eq!(error.found, "\"order 1\" where the top right tag of the eye tracker has to be");
    assert_eq!(error.remedy, "0.10 m by 0.10 m free in each corner of the display");
}

#[test]
fn the_surface_maps_its_corners_and_straight_lines_to_the_display() {
    // The hull of the tags: what Pupil calls (0, 0) is the outer black corner of the bottom left tag.
    let hull = DisplayTags::place(&load("layouts/sushi.toml")).expect("room for the tags").hull();
    let map = SurfaceHomography::new(hull).expect("a surface");
    for (norm_pos, expected) in
        [([0.0, 1.0], hull[0]), ([1.0, 1.0], hull[1]), ([1.0, 0.0], hull[2]), ([0.0, 0.0], hull[3])]
    {
        let point = map.to_display(norm_pos).expect("a point");
        assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{norm_pos:?}: {point:?}");
    }
    let centre = map.to_display([0.5, 0.5]).expect("a point");
    assert!(centre.iter().all(|value| (value - 0.5).abs() < 1e-12), "{centre:?}");
    // A surface that was drawn by hand, seen askew: its diagonals still meet where its centre is, which no affine map does.
    let corners = [[0.1, 0.1], [0.9, 0.2], [0.8, 0.9], [0.2, 0.7]];
    let map = SurfaceHomography::new(corners).expect("a surface");
    let [x, y] = map.to_display([0.5, 0.5]).expect("a point");
    let off_line = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    assert!(off_line(corners[0], corners[2]).abs() < 1e-12 && off_line(corners[1], corners[3]).abs() < 1e-12);
    assert_eq!(map.to_display([f64::NAN, 0.5]), None);
}

#[test]
fn corners_that_are_no_surface_are_none() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert!(SurfaceHomography::new(square).is_some());
    let reversed = [square[3], square[2], square[1], square[0]];
    let crossed = [square[0], square[2], square[1], square[3]];
    let flat = [[0.0, 0.5], [1.0, 0.5], [1.0, 0.5], [0.0, 0.5]];
    let endless = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for corners in [reversed, crossed, flat, endless] {
        assert_eq!(SurfaceHomography::new(corners), None, "{corners:?}");
    }
}
