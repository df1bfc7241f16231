//! Recordings: the same seed gives the same recording, a recording gives the same session, and what is broken is told.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rand::RngExt;
use tomcom::analysis::watcher::{CompareRequest, ComparisonFollower};
use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::communication::concept::ConceptName;
use tomcom::communication::recommendation::Recommendation;
use tomcom::communication::settings::Shadow;
use tomcom::communication::{Sender, Signal, signals};
use tomcom::edge::files::{SessionFiles, read_session};
use tomcom::edge::log::{LOG_NAME, LogReader, LogWriter};
use tomcom::gaze::GazeSample;
use tomcom::history::comparison::CommunicationContext;
use tomcom::history::landmark::ReplayLandmark;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, Kitchen, LocationId};
use tomcom::measures::matching::CommunicationTarget;
use tomcom::run::engine::Engine;
use tomcom::run::headless;
use tomcom::run::replay::Replay;
use tomcom::run::seekable_replay::SeekableReplay;
use tomcom::run::simulate::{Shard, SimulationRequest, simulate};
use tomcom::run::verify::verify;
use tomcom::scene::{DerivedData, EntityData, EntityUpdate, SceneUpdate, SessionScene};
use tomcom::session::event::{EndReason, SignalEnd};
use tomcom::session::header::VERSION;
use tomcom::session::settings::{ArmKind, Condition, GazeSource, ParticipantKind};
use tomcom::session::{Event, Header, Phase, Session, Stamped};

use crate::check_snapshot;

/// One session for each kitchen.
const SESSIONS: [&str; 2] = ["default.toml", "burger.toml"];

/// A session file of the project, with an inference that is coarse and quick: what is held against each other here has the
/// same fineness.
fn session(name: &str) -> SessionFiles {
    let mut files = read_session(&Path::new("sessions").join(name)).expect("a session file of the project");
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    files
}

/// An empty folder for the test of this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replay").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn simulated(name: &str, arm: ArmKind, out: &str, trials: u64, seed: u64) -> PathBuf {
    let mut files = session(name);
    files.spec.robot.arm = arm;
    files.spec.seed = seed;
    files.spec.trial.seconds = 120.0;
    let out = folder(out);
    simulate(&SimulationRequest { files, trials, shard: Shard::WHOLE, out: out.clone() }, || ())
        .expect("the folder can be written");
    out
}

/// Whatever wizard, participant and tracker may do, as a seeded mess.
fn anything(kitchen: &Kitchen, random: &mut impl RngExt) -> Event {
    let signals = signals(kitchen, true);
    let buttons = &kitchen.buttons[Agent::Human.index()];
    match random.random_range(0..40) {
        0 => Event::TrialPaused,
        1 | 2 => Event::TrialResumed,
        3 => Event::RobotStopped,
        4 | 5 => Event::RobotResumed,
        6 => Event::Marker { note: "note 1".to_string() },
        7 => Event::SignalEnded { reason: SignalEnd::TakenBack },
        8 => {
            let button = &kitchen.buttons[Agent::Robot.index()];
            let button = button[random.random_range(0..button.len())].name.clone();
            Event::RobotDriven { by: Sender::Wizard, button }
        }
        9 => match random.random_range(0..3) {
            0 => Event::RobotHeld { by: Sender::Wizard },
            1 => Event::RobotReleased { by: Sender::Wizard },
            _ => Event::RobotSkipped { by: Sender::Wizard },
        },
        10 => {
            let location = &kitchen.locations[random.random_range(0..kitchen.locations.len())];
            let content = &kitchen.contents[random.random_range(0..kitchen.contents.len())];
            Event::KitchenCorrected { location: location.name.clone(), content: content.name.clone() }
        }
        11..14 => {
            let (_, signal) = &signals[random.random_range(0..signals.len())];
            Event::SignalShown { by: Sender::Wizard, signal: signal.clone(), accepted: None }
        }
        14..24 => {
            let [x, y, confidence] = [1.2, 1.2, 1.0].map(|scale| scale * random.random::<f64>());
            Event::Gaze(GazeSample::new(x, y, confidence))
        }
        _ => {
            let button = buttons[random.random_range(0..buttons.len())].name.clone();
            Event::Press { agent: Agent::Human, button, at_ns: None }
        }
    }
}

/// A session as somebody at keyboard and mouse might have it, recorded; with its log and the engine at its end.
fn by_hand(name: &str, arm: ArmKind, out: &str, seed: u64) -> (PathBuf, Engine) {
    let mut files = session(name);
    files.spec.robot.arm = arm;
    files.spec.participant.kind = ParticipantKind::Keyboard;
    files.spec.participant.gaze = GazeSource::Mouse;
    files.spec.seed = seed;
    let kitchen = Arc::new(files.kitchen.kitchen);
    let header = Header::new(files.spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
    let mut log = LogWriter::create_live(&folder(out), "2026-03-14", &header).expect("the folder can be written");
    let mut engine = Engine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen.clone()));
    let mut random = stream(seed, "hand", 0);
    let mut inputs = vec![(0.5, Event::TrialStarted)];
    inputs.extend((0..2000).map(|_| (random.random_range(0.0..0.4), anything(&kitchen, &mut random))));
    inputs.push((1.0, Event::TrialEnded { reason: EndReason::Wizard }));
    inputs.push((1.0, Event::SessionEnded));
    let mut now_s = 0.0;
    for (after_s, event) in inputs {
        now_s += after_s;
        let outcome = engine.input(SessionTime::from_secs_f64(now_s), event);
        outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    }
    (log.folder().join(LOG_NAME), engine)
}

/// The two files hold the same bytes.
fn same(a: &Path, b: &Path) {
    let [a_text, b_text] = [a, b].map(|path| fs::read(path).expect("a recording"));
    assert!(a_text == b_text, "{} and {} differ", a.display(), b.display());
}

/// The recording's text, changed, is refused with a message that names `line` and says all of `says`.
fn refused(log: &Path, line: usize, says: &[&str], change: impl Fn(&str) -> String) {
    let broken = log.with_file_name("broken.jsonl");
    fs::write(&broken, change(&fs::read_to_string(log).expect("a recording"))).expect("the folder can be written");
    let error = Replay::open(&broken).and_then(|mut replay| replay.run()).expect_err("a broken recording");
    let told = format!("{:?}", miette::Report::new(error));
    let place = format!("broken.jsonl:{line}:");
    for text in std::iter::once(place.as_str()).chain(says.iter().copied()) {
        assert!(told.contains(text), "{text:?} is not in\n{told}");
    }
}

#[test]
fn the_same_seed_gives_the_same_recording_and_it_verifies() {
    for name in SESSIONS {
        let [a, b] = ["same-a", "same-b"].map(|out| simulated(name, ArmKind::Physics, out, 2, 7));
        for trial in ["seed7-S001", "seed7-S002"] {
            same(&a.join(trial).join(LOG_NAME), &b.join(trial).join(LOG_NAME));
            let found = verify(&a.join(trial)).expect("a recording");
            assert!(found.verified && !found.cut, "{name}: {found:?}");
        }
    }
}

#[test]
fn a_trial_does_not_depend_on_how_many_there_are() {
    let two = simulated("default.toml", ArmKind::Timed, "two", 2, 3);
    let five = simulated("default.toml", ArmKind::Timed, "five", 5, 3);
    for trial in ["seed3-S001", "seed3-S002"] {
        same(&two.join(trial).join(LOG_NAME), &five.join(trial).join(LOG_NAME));
    }
}

#[test]
fn whatever_hands_do_the_recording_verifies_and_replays_to_the_same_session() {
    for (name, seed) in SESSIONS.into_iter().zip(0..).flat_map(|(name, first)| [(name, first), (name, first + 2)]) {
        let arm = if seed < 2 { ArmKind::Physics } else { ArmKind::Timed };
        let (log, engine) = by_hand(name, arm, &format!("hand-{seed}"), seed);
        let found = verify(&log).expect("a recording");
        assert!(found.verified && !found.cut, "seed {seed}: {found:?}");
        let mut replay = Replay::open(&log).expect("a recording");
        replay.run().expect("a recording");
        let (live, again) = (engine.session(), replay.session());
        assert_eq!((live.state, live.presses, live.phase), (again.state, again.presses, Phase::Closed), "seed {seed}");
        assert_eq!(live.timeline, again.timeline, "seed {seed}");
        assert_eq!(engine.judged(), replay.follower.judged, "seed {seed}");
    }
}

#[test]
fn a_cut_recording_opens_says_so_and_verifies_up_to_its_cut() {
    let (log, _) = by_hand("default.toml", ArmKind::Physics, "cut", 5);
    let text = fs::read(&log).expect("a recording");
    for cut in [text.len() - 1, text.len() - 30, text.len() / 2, text.len() * 3 / 4] {
        let path = log.with_file_name("cut.jsonl");
        fs::write(&path, &text[..cut]).expect("the folder can be written");
        let found = verify(&path).expect("a cut recording");
        assert!(found.verified && found.cut, "cut at {cut}: {found:?}");
    }
}

#[test]
fn a_session_that_is_still_recorded_can_be_followed() {
    let (log, engine) = by_hand("default.toml", ArmKind::Timed, "followed", 9);
    let text = fs::read(&log).expect("a recording");
    let growing = log.with_file_name("growing.jsonl");
    fs::write(&growing, &text[..text.len() / 2]).expect("the folder can be written");
    let mut replay = Replay::open(&growing).expect("the header is there");
    replay.run().expect("the first half");
    assert!(replay.log().is_cut());
    fs::write(&growing, &text).expect("the folder can be written");
    replay.run().expect("the second half");
    assert!(!replay.log().is_cut());
    assert_eq!(replay.session().timeline, engine.session().timeline);
}

#[test]
fn what_is_appended_to_a_live_recording_is_there_at_once_and_nothing_is_lost_silently() {
    let files = session("default.toml");
    let kitchen = Arc::new(files.kitchen.kitchen);
    let header = Header::new(files.spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
    let root = folder("prompt");
    let [mut log, second] =
        [1, 2].map(|_| LogWriter::create_live(&root, "2026-03-14", &header).expect("the folder can be written"));
    let names = [&log, &second].map(|log| log.folder().file_name().map(|name| name.to_string_lossy().into_owned()));
    assert_eq!(names, [1, 2].map(|n| Some(format!("2026-03-14-P01-{n}"))));
    let mut engine = Engine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen));
    let events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    let written = fs::read_to_string(log.folder().join(LOG_NAME)).expect("a recording");
    assert_eq!(written.lines().count(), events.len() + 1);
    let no_folder = LogWriter::create_live(&log.folder().join(LOG_NAME), "2026-03-14", &header);
    assert!(no_folder.expect_err("a file is no folder").to_string().contains("cannot be written"));
}

#[test]
fn a_changed_recording_does_not_verify_and_the_first_difference_is_named() {
    let (log, _) = by_hand("default.toml", ArmKind::Timed, "changed", 6);
    let text = fs::read_to_string(&log).expect("a recording");
    let (number, line) =
        text.lines().enumerate().find(|(_, line)| line.contains("robot_intends")).expect("the robot does something");
    let changed = log.with_file_name("changed.jsonl");
    let later = line.replace("\"until_ns\":", "\"until_ns\":1");
    fs::write(&changed, text.replace(line, &later)).expect("the folder can be written");
    let found = verify(&changed).expect("a recording");
    assert_eq!(found.difference.map(|difference| difference.line), Some(number + 1));
    assert!(!found.verified);
}

#[test]
fn no_broken_byte_makes_the_reader_panic() {
    let (log, _) = by_hand("burger.toml", ArmKind::Timed, "bytes", 11);
    let text = fs::read(&log).expect("a recording");
    let path = log.with_file_name("bytes.jsonl");
    let mut random = stream(11, "bytes", 0);
    for _ in 0..150 {
        let mut broken = text.clone();
        for _ in 0..random.random_range(1..4) {
            // Half of the changes are in the header and the first events, where more depends on them.
            let within = if random.random() { broken.len() } else { 12_000 };
            broken[random.random_range(0..within)] = random.random_range(9..128);
        }
        fs::write(&path, &broken).expect("the folder can be written");
        let _ = verify(&path).map_err(|error| format!("{:?}", miette::Report::new(error)));
    }
}

#[test]
fn what_is_broken_is_named_with_its_line_and_what_would_be_right() {
    let (log, _) = by_hand("default.toml", ArmKind::Timed, "broken", 8);
    let line = |number: usize, from: &'static str, to: &'static str| {
        move |text: &str| {
            let lines = text.lines().enumerate();
            let changed = lines.map(|(at, line)| if at + 1 == number { line.replace(from, to) } else { line.into() });
            changed.collect::<Vec<String>>().join("\n") + "\n"
        }
    };
    refused(&log, 1, &["format version 9", "format version 1"], line(1, "\"version\":1", "\"version\":9"));
    refused(&log, 1, &["no header"], |text| text.split_once('\n').map_or(String::new(), |(_, rest)| rest.to_string()));
    refused(&log, 1, &["press_s = -2.4", "above 0"], line(1, "\"press_s\":2.4", "\"press_s\":-2.4"));
    refused(&log, 3, &["\"order_9\"", "a location of the layout"], line(3, "order_1", "order_9"));
    refused(&log, 3, &["seq 7", "without gaps"], line(3, "\"seq\":1,", "\"seq\":7,"));
    refused(&log, 3, &["order_hidden"], line(3, "order_shown", "order_hidden"));
    refused(&log, 3, &["after 500000000", "never decrease"], line(3, "\"t_ns\":500000000", "\"t_ns\":4"));
    refused(&log, 3, &["the trial was started already"], line(3, "order_shown", "trial_started"));
}

/// What a replay came to, in lines.
fn summary(replay: &Replay) -> String {
    let (session, kitchen) = (replay.session(), &replay.log().kitchen);
    let mut lines = vec![
        format!("{:?} at {:.3} s", session.phase, session.time.as_secs_f64()),
        format!("presses {:?}, errors {}", session.presses, replay.follower.errors()),
        format!("served {}, on the timeline {}", session.served.len(), session.timeline.len()),
        format!("gaze {}, unusable {}", session.gaze.samples, session.gaze.unusable),
    ];
    let places = kitchen.locations.iter().enumerate();
    lines.extend(places.map(|(index, location)| {
        format!("{}: {}", location.name, kitchen.content_label(session.state, LocationId(index as u8)))
    }));
    lines.join("\n")
}

#[test]
fn recordings_of_every_format_replay_to_what_they_replayed_to() {
    let entries = fs::read_dir("tests/golden").expect("the golden recordings");
    let mut logs: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    logs.sort();
    for version in 1..=VERSION {
        let format = format!("format-{version}-");
        let is_there = logs.iter().any(|log| log.display().to_string().contains(&format));
        assert!(is_there, "a golden recording of format version {version}");
    }
    for log in logs {
        let mut replay = Replay::open(&log).expect("a golden recording");
        replay.run().unwrap_or_else(|error| panic!("{error}"));
        let name = log.file_stem().expect("a name").to_string_lossy().into_owned();
        check_snapshot("replay", name, summary(&replay));
    }
}

#[test]
fn a_recording_can_be_wound_forward_and_back() {
    for name in SESSIONS {
        let out = simulated(name, ArmKind::Physics, &format!("film-{name}"), 1, 3);
        let recording = fs::read_dir(&out).expect("the folder").next().expect("a recording").expect("readable").path();
        let mut film = SeekableReplay::open(&recording).expect("it opens");
        let (length, events) = film.length();
        let mut straight = SeekableReplay::open(&recording).expect("it opens");
        let mut random = stream(5, "places of a film", 0);
        for _ in 0..20 {
            let position = random.random_range(0..=events);
            film.wind(position);
            straight = match straight.position <= position {
                true => straight,
                false => SeekableReplay::open(&recording).expect("it opens"),
            };
            while straight.position < position {
                straight.forward().expect("an event");
            }
            assert_eq!(film.position, position);
            assert_eq!(film.session.state, straight.session.state, "{name}: at {position} of {events}");
            assert_eq!(film.session.timeline, straight.session.timeline);
            assert_eq!(film.session.gaze, straight.session.gaze);
        }
        film.wind(0);
        let mut steps = 0;
        while film.position < events {
            film.wind(film.next_step());
            steps += 1;
        }
        assert_eq!(film.time(), length);
        for _ in 0..steps {
            film.wind(film.last_step());
        }
        assert_eq!(film.position, 0, "as many steps back as forward");
    }
}

/// Two trials in which the assistant acts by this concept, quickly and for little reason.
fn assisted(name: &str, out: &str, by: ConceptName) -> PathBuf {
    let mut files = session(name);
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.trial.condition = Condition::Assistant;
    files.spec.assistant.concept = by;
    files.spec.trial.seconds = 45.0;
    files.spec.assistant.cost_of_communication = 0.3;
    files.spec.assistant.rollout.rollouts = 8;
    files.spec.assistant.rollout.states = 8;
    let out = folder(out);
    simulate(&SimulationRequest { files, trials: 2, shard: Shard::WHOLE, out: out.clone() }, || ())
        .expect("the folder can be written");
    out
}

#[test]
fn what_the_assistant_does_comes_out_the_same_again() {
    for name in SESSIONS {
        let [a, b] = ["assisted", "assisted-again"].map(|out| assisted(name, out, ConceptName::TomCom));
        let mut signals = 0;
        for trial in ["seed1-S001", "seed1-S002"] {
            let [log, other] = [&a, &b].map(|out| out.join(trial).join(LOG_NAME));
            same(&log, &other);
            let found = verify(&log).expect("a recording");
            assert!(found.verified, "{name}: {:?}", found.difference);
            let text = fs::read_to_string(&log).expect("a recording");
            signals += text.lines().filter(|line| line.contains(r#""signal_shown","by":"assistant""#)).count();
        }
        assert!(signals > 0, "{name}: the assistant said nothing");
    }
}

#[test]
fn each_concept_acts_by_itself_and_comes_out_the_same_again() {
    for name in SESSIONS {
        for (by, acts, proposes) in
            [(ConceptName::Tom, true, false), (ConceptName::Dev, false, true), (ConceptName::None, false, false)]
        {
            let out = assisted(name, &format!("acts-{}-{name}", by.name()), by);
            let mut log = String::new();
            for trial in ["seed1-S001", "seed1-S002"] {
                let found = verify(&out.join(trial)).expect("a recording");
                assert!(found.verified, "{name}, {by:?}: {:?}", found.difference);
                log += &fs::read_to_string(out.join(trial).join(LOG_NAME)).expect("a recording");
            }
            assert!(log.contains(r#""kind":"advised""#), "{name}, {by:?}");
            assert_eq!(log.contains(r#""signal_shown","by":"assistant""#), acts, "{name}, {by:?}: signals");
            assert_eq!(log.contains(r#""proposal":{"error":"#), proposes, "{name}, {by:?}: proposals");
        }
    }
}

#[test]
fn advice_that_was_not_given_is_no_verified_advice() {
    let log = assisted("default.toml", "assisted-changed", ConceptName::TomCom).join("seed1-S001").join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a recording");
    let number = 1 + text.lines().position(|line| line.contains(r#""kind":"advised""#)).expect("advice");
    let change = |(index, line): (usize, &str)| match index + 1 == number {
        true => line.replacen(r#""rollouts":8"#, r#""rollouts":9"#, 1) + "\n",
        false => line.to_string() + "\n",
    };
    fs::write(&log, text.lines().enumerate().map(change).collect::<String>()).expect("the folder can be written");
    let found = verify(&log).expect("a recording");
    assert_eq!(found.difference.map(|difference| difference.line), Some(number));
}

/// The events of a trial in which somebody presses buttons every two seconds, whatever is shown, and a wizard sends these
/// signals, each so many seconds after the beginning.
fn pressed_on(name: &str, sent: &[(f64, Signal)]) -> (SessionFiles, Vec<Stamped>) {
    let mut files = session(name);
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    files.spec.assistant.concept = ConceptName::Tom;
    let kitchen = Arc::new(files.kitchen.kitchen.clone());
    let mut engine = Engine::new(kitchen.clone(), files.spec.clone(), 0, CostToGo::new(kitchen.clone()));
    let mut random = stream(4, "presses", 0);
    let mut inputs = vec![(0.0, Event::TrialStarted)];
    let buttons = &kitchen.buttons[Agent::Human.index()];
    inputs.extend((1..40).map(|number| {
        let button = buttons[random.random_range(0..buttons.len())].name.clone();
        (2.0 * f64::from(number), Event::Press { agent: Agent::Human, button, at_ns: None })
    }));
    inputs.extend(sent.iter().map(|(time_s, signal)| {
        (*time_s, Event::SignalShown { by: Sender::Wizard, signal: signal.clone(), accepted: None })
    }));
    inputs.push((80.0, Event::TrialEnded { reason: EndReason::Wizard }));
    inputs.push((81.0, Event::SessionEnded));
    inputs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let take = |(time_s, event): (f64, Event)| {
        let outcome = engine.input(SessionTime::from_secs_f64(time_s), event);
        assert_eq!(outcome.refused, None);
        outcome.events
    };
    let events = inputs.into_iter().flat_map(take).collect();
    (files, events)
}

#[test]
fn advice_that_nobody_sees_changes_nothing_else() {
    let told = |shadow: Shadow| {
        let mut files = session("default.toml");
        (files.spec.robot.arm, files.spec.assistant.shadow) = (ArmKind::Timed, shadow);
        (files.spec.trial.condition, files.spec.trial.seconds) = (Condition::None, 60.0);
        let kitchen = Arc::new(files.kitchen.kitchen);
        let mut engine = Engine::new(kitchen.clone(), files.spec, 3, CostToGo::new(kitchen));
        let (mut told, mut advised) = (Vec::new(), 0);
        let noted: Result<(), ()> = headless::run(&mut engine, |stamped| {
            match &stamped.event {
                Event::Advised(_) => advised += 1,
                // The number of the press in the log counts the advice, too.
                Event::BeliefEstimated(witness) => told.push(format!("{:?} {:?}", witness.log_p, witness.aspects)),
                event => told.push(format!("{:?} {event:?}", stamped.time)),
            }
            Ok(())
        });
        assert_eq!(noted, Ok(()));
        (told, advised)
    };
    let ((told_beside, advised), (told_alone, none)) = (told(Shadow::On), told(Shadow::Off));
    assert!(advised > 20 && none == 0, "{advised} answers, and {none}");
    assert_eq!(told_beside, told_alone);
}

/// What was known at every moment at which the concepts were asked, with the presses of the human until then.
fn asked(
    files: &SessionFiles,
    events: &[Stamped],
    window: u32,
) -> (Vec<(u32, Arc<CommunicationContext>)>, ComparisonFollower) {
    let request = CompareRequest { with: vec![ConceptName::Dev], window };
    let mut watcher =
        ComparisonFollower::new(Session::new(Arc::new(files.kitchen.kitchen.clone()), files.spec.clone(), 0), &request);
    let mut known: Vec<(u32, Arc<CommunicationContext>)> = Vec::new();
    for stamped in events {
        let press = watcher.presses();
        watcher.apply(stamped).expect("events of a session");
        let newest = watcher.known().filter(|newest| known.last().is_none_or(|(_, last)| last.seq != newest.seq));
        known.extend(newest.map(|newest| (press, newest.clone())));
    }
    watcher.finish();
    (known, watcher)
}

#[test]
fn what_the_wizard_said_is_left_out_of_the_estimate_for_the_window_and_no_longer() {
    for name in SESSIONS {
        let window = 3;
        let (files, silent) = pressed_on(name, &[]);
        let (known_silent, _) = asked(&files, &silent, window);
        let kitchen = &files.kitchen.kitchen;
        let place = |signal: &Signal| kitchen.location_named(signal.target()).expect("a location");
        // Nobody looks at the order, so what it wants stays unknown.
        let (press, signal) = (5, Signal::ShowRecipe(kitchen.location(kitchen.orders[0]).name.clone()));
        let (files, told) = pressed_on(name, &[(2.0 * f64::from(press) + 1.9, signal.clone())]);
        let (known_told, _) = asked(&files, &told, window);
        let thought = |known: &[(u32, Arc<CommunicationContext>)], until: u32| -> Vec<_> {
            let until = known.iter().filter(|(press, _)| *press <= until);
            // Numbers of events differ by the signal's own.
            let advice = |advice: &Recommendation| (advice.best.clone(), advice.options.clone());
            until
                .map(|(_, one)| (one.state, one.held.clone(), one.advice.iter().map(advice).collect::<Vec<_>>()))
                .collect()
        };
        let [with, without] = [&known_told, &known_silent].map(|known| thought(known, press - 1));
        assert!(with.len() > 4 && with == without, "{name}: until it was said");
        let p_truth = |known: &[(u32, Arc<CommunicationContext>)], at: u32| {
            let (_, known) = known.iter().rfind(|(press, _)| *press == at).expect("asked there");
            known.held[place(&signal).index()].p_truth
        };
        // Chances follow from the numbers of events, which differ by one: the estimates are alike, and no more.
        for at in press + 1..=press + window {
            let [with, without] = [&known_told, &known_silent].map(|known| p_truth(known, at));
            assert!(with < 0.6 && (with - without).abs() < 0.2, "{name}: at press {at}: {with} and {without}");
        }
        let later = p_truth(&known_told, press + window + 1);
        assert!(later > 0.9, "{name}: after the window it counts: {later}");
        let (known_at_once, _) = asked(&files, &told, 0);
        let at_once = p_truth(&known_at_once, press + 1);
        assert!(at_once > 0.9, "{name}: without a window it counts at once: {at_once}");
    }
}

#[test]
fn a_shadow_that_is_asked_again_says_the_same_also_on_a_thread() {
    let mut files = session("default.toml");
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.trial.condition = Condition::None;
    files.spec.trial.seconds = 45.0;
    files.spec.assistant.concept = ConceptName::Tom;
    let out = folder("shadow");
    simulate(&SimulationRequest { files, trials: 1, shard: Shard::WHOLE, out: out.clone() }, || ())
        .expect("the folder can be written");
    let mut log = LogReader::open(&out.join("seed1-S001")).expect("a recording");
    let request = CompareRequest { with: vec![ConceptName::Dev], window: 3 };
    let watcher = || ComparisonFollower::new(log.session(), &request);
    let (mut here, there) = (watcher(), watcher().on_thread());
    let mut compared = 0;
    while let Some(line) = log.next_line().expect("an event") {
        here.apply(&line.stamped).expect("an event of the session");
        there.tell(&line.stamped);
        let Event::Advised(recorded) = line.stamped.event else { continue };
        let known = here.known().expect("it was asked");
        assert_eq!((known.seq, known.advice[0].for_ns), (recorded.for_seq, recorded.for_ns));
        // In the session nobody shows its advice, so that it may say it again; here it is silent within the window.
        for option in &known.advice[0].options {
            assert!(recorded.options.contains(option), "{option:?} at event {}", line.stamped.seq);
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared} options");
    here.finish();
    let found = here.comparison(true);
    // With what lay there: who tells of something else says nothing again.
    let mut last: Vec<((CommunicationTarget, u8), u32)> = Vec::new();
    let mut again = 0;
    for spoken in &found.lanes[1].spoken {
        let (said, state) = (spoken.said, spoken.known.as_ref().expect("an answer").state);
        let what = (said.content, state.code(said.content.target.expect("a signal is about a place")));
        match last.iter_mut().find(|(other, _)| *other == what) {
            Some((_, press)) => {
                assert!(said.press > *press + request.window, "{said:?} after press {press}");
                (*press, again) = (said.press, again + 1);
            }
            None => last.push((what, said.press)),
        }
    }
    assert!(again > 0, "what nobody shows stays to be said");
    assert_eq!(there.last(), Some(found));
}

/// Everything that a recording shows, and its events.
fn shown(recording: &Path) -> (Vec<SceneUpdate>, Vec<Stamped>) {
    let mut replay = Replay::open(recording).expect("a recording");
    let mut scene = SessionScene::new(replay.session(), 0);
    let mut moments = vec![scene.opening()];
    let mut events = Vec::new();
    while let Some(line) = replay.step().expect("events of a session") {
        let (judged, belief) = (&replay.follower.judged[..], Some(replay.follower.filter.belief()));
        moments.extend(scene.see(&line.stamped, DerivedData { judged, belief }));
        events.push(line.stamped);
    }
    (moments, events)
}

#[test]
fn a_scene_shows_every_press_signal_and_sample_once_at_its_time() {
    for name in ["format-1-hand.jsonl", "format-1-simulated.jsonl"] {
        let (moments, events) = shown(&Path::new("tests/golden").join(name));
        let times: Vec<SessionTime> = moments.iter().map(|moment| moment.time).collect();
        assert!(times.is_sorted(), "{name}: moments come in the order of their times");
        let steps_of = |entity: &str| -> Vec<(u64, SessionTime)> {
            let rows = |moment: &SceneUpdate| moment.rows.iter().filter(|row| row.entity == entity).count();
            moments.iter().flat_map(|moment| vec![(moment.step, moment.time); rows(moment)]).collect()
        };
        let mut is_running = false;
        let mut presses = [Vec::new(), Vec::new()];
        let (mut gaze, mut signals, mut advice) = (Vec::new(), Vec::new(), Vec::new());
        for stamped in &events {
            let place = (stamped.seq, stamped.time);
            match &stamped.event {
                Event::TrialStarted | Event::TrialResumed => is_running = true,
                Event::TrialPaused | Event::TrialEnded { .. } | Event::TrialAborted { .. } => is_running = false,
                Event::Press { agent, .. } if is_running => presses[agent.index()].push(place),
                Event::Gaze(_) => gaze.push(place),
                Event::SignalShown { by: Sender::Wizard, .. } => signals.push(place),
                Event::Advised(_) => advice.push(place),
                _ => {}
            }
        }
        assert!(presses.iter().all(|presses| !presses.is_empty()), "{name} has presses of both");
        assert_eq!(steps_of("human/presses"), presses[Agent::Human.index()], "{name}");
        assert_eq!(steps_of("robot/presses"), presses[Agent::Robot.index()], "{name}");
        assert_eq!(steps_of("human/gaze"), gaze, "{name}");
        assert_eq!(steps_of("assistant/benefit/cost_line"), advice, "{name}");
        let sent = moments.iter().flat_map(|moment| &moment.rows).filter(|row| {
            row.entity == "wizard/signals"
                && matches!(&row.shown, EntityData::Words { text, .. } if !text.starts_with("wizard: took"))
        });
        assert_eq!(sent.count(), signals.len(), "{name}");
        assert!(moments.iter().map(|moment| moment.trial).is_sorted(), "{name}: the trial's clock never goes back");
        let started = events.iter().find(|stamped| stamped.event == Event::TrialStarted).expect("a trial").time;
        for moment in moments.iter().filter(|moment| moment.time <= started) {
            assert_eq!(moment.trial, SessionTime::ZERO, "{name}: before the trial its clock stands");
        }
        let lines = |entity: &str| -> Vec<String> {
            let text = |row: &EntityUpdate| match &row.shown {
                EntityData::Words { text, .. } if row.entity.starts_with(entity) => Some(text.clone()),
                _ => None,
            };
            moments.iter().flat_map(|moment| &moment.rows).filter_map(text).collect()
        };
        let happened = lines("happened");
        assert!(happened.len() > presses[0].len() + presses[1].len(), "{name}: more than presses happened");
        let [mut ordered, mut told] = [happened.clone(), lines("")];
        ordered.extend(happened);
        ordered.sort();
        told.sort();
        assert_eq!(ordered, told, "{name}: every line stands in the list of what happened once more");
    }
}

#[test]
fn a_scene_tells_a_belief_before_the_press_as_the_log_does() {
    let out = simulated("default.toml", ArmKind::Physics, "scene", 1, 3);
    let recording = fs::read_dir(out).expect("a folder").next().expect("a recording").expect("an entry").path();
    let (moments, events) = shown(&recording);
    let witnesses = events.iter().filter_map(|stamped| match &stamped.event {
        Event::BeliefEstimated(witness) => Some((stamped, witness)),
        _ => None,
    });
    let mut count = 0;
    for (stamped, witness) in witnesses {
        count += 1;
        let mut of_step = moments.iter().filter(|moment| moment.step == stamped.seq && moment.time == stamped.time);
        let moment = of_step.next().expect("a moment");
        for told in &witness.aspects {
            let entity = format!("human/belief/estimated/{}", told.aspect.replace(' ', "_"));
            let mut rows = moment.rows.iter().filter(|row| row.entity == entity);
            assert_eq!(rows.next().map(|row| &row.shown), Some(&EntityData::Value(told.p_truth)), "{entity}");
            assert!(rows.next().is_none(), "{entity} once");
        }
    }
    assert!(count > 20, "{count} presses");
}

#[test]
fn a_replay_goes_from_one_error_signal_or_false_belief_to_the_next_and_back() {
    let out = simulated("default.toml", ArmKind::Timed, "landmarks", 1, 3);
    let recording = fs::read_dir(out).expect("a folder").next().expect("a recording").expect("an entry").path();
    let mut film = SeekableReplay::open(&recording).expect("a recording");
    let mut errors = film.errors.clone();
    errors.dedup();
    assert!(errors.len() > 2, "{errors:?}");
    let mut visited = Vec::new();
    while let Some(position) = film.landmark(ReplayLandmark::Error, true) {
        film.wind(position);
        visited.push(film.time());
    }
    assert_eq!(visited, errors);
    let back = film.landmark(ReplayLandmark::Error, false).expect("the error before");
    film.wind(back);
    assert_eq!(film.time(), errors[errors.len() - 2]);
    assert_eq!(film.landmark(ReplayLandmark::Signal, true), None, "nobody sends signals");
    film.wind(0);
    let wrong = film.landmark(ReplayLandmark::FalseBelief, true).expect("something is believed wrong");
    film.wind(wrong);
    let moment = film.beliefs.until(film.time()).last().expect("an estimate");
    assert!(moment.held.iter().any(|held| held.is_false()), "{moment:?}");
}
