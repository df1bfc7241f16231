//! Gaze: the tags on the wall display, the mapping from a tracker's surface, and what comes of samples.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;
use rmpv::Value;
use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::edge::files::{read_kitchen, read_session};
use tomcom::edge::gaze_file;
use tomcom::edge::pupil::message::{self, PupilMessage};
use tomcom::edge::pupil::zmtp::FrameAssembler;
use tomcom::gaze::GazeSample;
use tomcom::gaze::calibration::{TARGETS, ViewingGeometry, measure};
use tomcom::gaze::device_clock::DeviceClock;
use tomcom::gaze::quality::{GazeFault, RateLimit};
use tomcom::gaze::surface::SurfaceMap;
use tomcom::gaze::tags::{CELLS, DisplayTags};
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{DisplayArea, Kitchen};
use tomcom::run::engine::Engine;
use tomcom::session::admit::is_external;
use tomcom::session::calibration::{CalibrationEvent, RunningGazeCheck};
use tomcom::session::settings::{GazeSource, ParticipantKind};
use tomcom::session::{Event, SessionSpec, Stamped};

fn load(layout: &str) -> Kitchen {
    match read_kitchen(Path::new(layout)) {
        Ok(files) => files.kitchen,
        Err(error) => panic!("{error}"),
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
    let map = SurfaceMap::new(hull).expect("a surface");
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
    let map = SurfaceMap::new(corners).expect("a surface");
    let [x, y] = map.to_display([0.5, 0.5]).expect("a point");
    let off_line = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    assert!(off_line(corners[0], corners[2]).abs() < 1e-12 && off_line(corners[1], corners[3]).abs() < 1e-12);
    assert_eq!(map.to_display([f64::NAN, 0.5]), None);
}

#[test]
fn corners_that_are_no_surface_are_none() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert!(SurfaceMap::new(square).is_some());
    let reversed = [square[3], square[2], square[1], square[0]];
    let crossed = [square[0], square[2], square[1], square[3]];
    let flat = [[0.0, 0.5], [1.0, 0.5], [1.0, 0.5], [0.0, 0.5]];
    let endless = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for corners in [reversed, crossed, flat, endless] {
        assert_eq!(SurfaceMap::new(corners), None, "{corners:?}");
    }
}

/// A session of the sushi kitchen with these settings.
fn engine(change: impl Fn(&mut SessionSpec)) -> Engine {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    change(&mut files.spec);
    let kitchen = Arc::new(files.kitchen.kitchen);
    Engine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen))
}

/// Checks the calibration as the live session does, from `from_s` on; all events of the check.
fn check_calibration(engine: &mut Engine, from_s: f64, accept: CalibrationEvent) -> Vec<Stamped> {
    let at = SessionTime::from_secs_f64;
    let mut events = Vec::new();
    let mut input = |engine: &mut Engine, time, event| {
        let outcome = engine.input(time, event);
        events.extend(outcome.events);
        outcome.refused
    };
    assert_eq!(input(engine, at(from_s), Event::Calibration(CalibrationEvent::begin())), None);
    while let Some((time, event)) = engine.session().calibration.as_ref().and_then(RunningGazeCheck::next) {
        let now = engine.session().time;
        let refused = input(engine, now, Event::TrialStarted);
        assert_eq!(refused.as_deref(), Some("the calibration is being checked"));
        assert_eq!(input(engine, time, Event::Calibration(event)), None);
    }
    let now = engine.session().time;
    assert_eq!(input(engine, now, Event::Calibration(accept)), None);
    events
}

#[test]
fn simulated_gaze_is_checked_by_targets_corrected_and_comes_out_the_same_again() {
    let mut checked = engine(|spec| spec.seed = 4);
    let events = check_calibration(&mut checked, 2.0, CalibrationEvent::Accepted { corrected: true });
    let calibrated = checked.session().calibrated.clone().expect("accepted");
    let found = &calibrated.found;
    println!("{found:?}");
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
            check_calibration(&mut engine, 0.0, CalibrationEvent::Dismissed);
        }
        let start = SessionTime::from_secs_f64(60.0);
        let mut events = engine.input(start, Event::TrialStarted).events;
        while let Some(due) = engine.next_due() {
            assert!(due >= start);
            events.extend(engine.fire());
        }
        let told = |stamped: Stamped| match stamped.event {
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
fn a_check_is_refused_where_it_cannot_be() {
    let mut engine = engine(|_| {});
    let refused = |engine: &mut Engine, event: Event| {
        let now = engine.session().time;
        engine.input(now, event).refused.unwrap_or_default()
    };
    let calibration = Event::Calibration;
    assert!(refused(&mut engine, calibration(CalibrationEvent::TargetsHidden)).contains("no target is shown"));
    assert!(refused(&mut engine, calibration(CalibrationEvent::Accepted { corrected: true })).contains("nothing was"));
    assert_eq!(refused(&mut engine, Event::TrialStarted), "");
    assert!(refused(&mut engine, calibration(CalibrationEvent::begin())).contains("pause the trial first"));
    assert_eq!(refused(&mut engine, Event::TrialPaused), "");
    assert_eq!(refused(&mut engine, calibration(CalibrationEvent::begin())), "");
    assert!(refused(&mut engine, Event::TrialResumed).contains("being checked"));
    assert_eq!(refused(&mut engine, calibration(CalibrationEvent::Dismissed)), "");
    assert_eq!(refused(&mut engine, Event::TrialResumed), "");
}

#[test]
fn what_is_wrong_with_a_stream_is_counted_by_kind_and_not_read() {
    let mut engine = engine(|spec| {
        (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::Json);
    });
    let at = |ms: u64| SessionTime(ms * 1_000_000);
    assert_eq!(engine.input(at(0), Event::TrialStarted).refused, None);
    let send = |engine: &mut Engine, arrived: u64, taken: u64, x: f64| {
        let sample =
            GazeSample { device_ns: Some(taken + 5), taken_ns: Some(at(taken)), ..GazeSample::new(x, 0.35, 0.9) };
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
        });
        let kitchen = engine.session().kitchen.clone();
        let counter = kitchen.location_named("counter").expect("a counter");
        let [x, y] = kitchen.location(counter).display.centre();
        let input = |engine: &mut Engine, ms: u64, event: Event| {
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
        let taken = clock.session_time(ms(1000 + 10 * step).0, ms(6000 + 10 * step + late));
        assert_eq!(taken, ms(6000 + 10 * step + 3), "step {step}");
    }
    // It begins anew at zero: the old offset does not hold for it.
    assert_eq!(clock.session_time(0, ms(9000)), ms(9000));
    assert_eq!(clock.session_time(ms(10).0, ms(9015)), ms(9010));
}

#[test]
fn a_flood_is_let_through_at_the_rate_of_the_fastest_tracker() {
    let mut limit = RateLimit::default();
    let passed = |limit: &mut RateLimit, hz: u64, from_s: u64, seconds: u64| {
        let times = (0..hz * seconds).map(|n| SessionTime(from_s * 1_000_000_000 + n * 1_000_000_000 / hz));
        times.filter(|&time| limit.admits(time)).count() as u64
    };
    assert_eq!(passed(&mut limit, 1000, 0, 20), 20_000, "a fast tracker loses nothing");
    let flood = passed(&mut limit, 50_000, 20, 10);
    assert!((20_000..=21_001).contains(&flood), "{flood} of a flood");
}

const DATUM: &[u8] = include_bytes!("../pupil/surfaces_wall.msgpack");

#[test]
fn a_real_datum_of_pupil_is_read_in_full() {
    let told = message::read(b"surfaces.wall", DATUM, "wall");
    assert!(told.sees_surface && told.malformed == 0 && told.fixations.is_empty() && told.blink.is_none());
    assert_eq!(told.gaze.len(), 8);
    let first = told.gaze[0];
    assert_eq!(first.norm_pos, [0.515_122_294_425_964_4, 0.587_292_253_971_099_9]);
    assert_eq!((first.confidence, first.timestamp), (0.97, 5.113_798_565_000_025));
    assert!(told.gaze.windows(2).all(|pair| pair[0].timestamp <= pair[1].timestamp));
    // Other surfaces and topics are not ours, also where their names begin alike.
    for topic in [b"surfaces.wall2".as_slice(), b"surfaces.wal", b"gaze.3d.01.", b"", b"notify.x"] {
        assert_eq!(message::read(topic, DATUM, "wall"), PupilMessage::default());
    }
}

#[test]
fn broken_messages_of_pupil_are_counted_and_nothing_more() {
    let read = |bytes: &[u8]| message::read(b"surfaces.wall", bytes, "wall");
    for length in 0..DATUM.len() {
        assert_eq!(read(&DATUM[..length]).malformed, 1, "cut after {length} bytes");
    }
    let mut random = stream(1, "broken messages", 0);
    let mut bytes = DATUM.to_vec();
    for _ in 0..20_000 {
        let at = random.random_range(0..bytes.len());
        let before = std::mem::replace(&mut bytes[at], random.random());
        let told = read(&bytes);
        assert!(told.gaze.len() <= 8);
        let is_number = |gaze: &message::SurfaceGaze| {
            gaze.norm_pos.iter().all(|v| v.is_finite())
                && (0.0..=1.0).contains(&gaze.confidence)
                && gaze.timestamp >= 0.0
        };
        assert!(told.gaze.iter().all(is_number), "{told:?}");
        if random.random::<bool>() {
            bytes[at] = before;
        }
        if random.random_range(0..50) == 0 {
            bytes = DATUM.to_vec();
        }
    }
    // What claims to be longer than it is: a list, a map, a text of four thousand million.
    for head in [[0xdd, 0xff, 0xff, 0xff, 0xff], [0xdf, 0xff, 0xff, 0xff, 0xff], [0xdb, 0xff, 0xff, 0xff, 0xff]] {
        assert_eq!(read(&head).malformed, 1);
    }
    assert_eq!(read(&[0x91; 100_000]).malformed, 1, "lists in lists in lists");
    // One item that is none does not cost the others.
    let item = |x: f64| {
        let text = Value::from;
        let place = Value::Array(vec![Value::from(x), Value::from(0.5)]);
        let time = (text("timestamp"), Value::from(7));
        Value::Map(vec![(text("norm_pos"), place), (text("confidence"), Value::from(1.0)), time])
    };
    let items = vec![item(0.1), item(f64::NAN), Value::Nil, item(f64::INFINITY), item(0.2)];
    let mut bytes = Vec::new();
    let datum = Value::Map(vec![(Value::from("gaze_on_surfaces"), Value::Array(items))]);
    rmpv::encode::write_value(&mut bytes, &datum).expect("written");
    let told = read(&bytes);
    assert_eq!((told.gaze.len(), told.malformed), (2, 3));
    assert_eq!(told.gaze[0].timestamp, 7.0);
}

#[test]
fn frames_are_put_together_from_any_pieces_and_claims_are_not_believed() {
    let long = vec![7u8; 300];
    let mut bytes = vec![1, 8];
    bytes.extend(b"surfaces");
    bytes.push(2);
    bytes.extend(300u64.to_be_bytes());
    bytes.extend(&long);
    // A command in between, then a message of one empty frame.
    bytes.extend([4, 2, b'o', b'k', 0, 0]);
    for piece in [1, 2, 3, 7, 64, 1000] {
        let mut inbox = FrameAssembler::default();
        let mut found = Vec::new();
        for part in bytes.chunks(piece) {
            inbox.push(part);
            while let Some(message) = inbox.next_message().expect("messages") {
                found.push(message);
            }
        }
        assert_eq!(found, [vec![b"surfaces".to_vec(), long.clone()], vec![Vec::new()]], "pieces of {piece}");
    }
    let refused = |bytes: &[u8]| {
        let mut inbox = FrameAssembler::default();
        inbox.push(bytes);
        inbox.next_message().is_err()
    };
    assert!(refused(&[2, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]), "a frame of 8 EB");
    assert!(refused(&[0x10, 1, 1]), "flags that there are not");
    assert!(refused(&[1, 0].repeat(17)), "a message of very many frames");
}

#[test]
fn exports_of_pupil_player_and_own_recordings_are_replayed() {
    let hull = [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]];
    let map = SurfaceMap::new(hull).expect("a surface");
    let found = gaze_file::read(Path::new("tests/pupil/gaze_positions_on_surface_wall.csv"), &map).expect("an export");
    assert_eq!((found.samples.len(), found.malformed), (3, 2));
    let (at_s, sample) = found.samples[1];
    assert!((at_s - 0.004_124_045).abs() < 1e-9, "{at_s}");
    assert!((sample.x - 0.3).abs() < 1e-9 && (sample.y - 0.1).abs() < 1e-9, "{sample:?}");
    assert_eq!((sample.device_ns, sample.confidence), (Some(5_117_922_610), 0.91));
    let error = gaze_file::read(Path::new("layouts/sushi.toml"), &map).expect_err("no export");
    assert!(error.to_string().contains("no column gaze_timestamp"), "{error}");
    let recording = std::fs::read_dir("tests/golden").expect("recordings").map(|entry| entry.expect("an entry").path());
    let recording = recording.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    let counts: Vec<usize> = recording.map(|path| gaze_file::read(&path, &map).expect("gaze").samples.len()).collect();
    assert!(counts.iter().any(|count| *count > 1000), "{counts:?}");
}

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
    let kitchen = load("layouts/sushi.toml");
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
