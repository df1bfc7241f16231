//! The same seed gives the same recording, and a recording the same session, from the golden recordings on.

use tomcom::run::list_cache::{CachedRecordingNumbers, ClosedLogHeader, ListCache};
use tomcom_session::header::VERSION;
use tomcom_study::analysis::recording_summary::{RecordingKind, RecordingState};

use super::{SESSIONS, by_hand, folder, same, simulated};
use crate::support::*;

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
        let mut replay = RecordingReplay::open(&log).expect("a recording");
        replay.run().expect("a recording");
        let (live, again) = (engine.session(), replay.session());
        assert_eq!(
            (live.state, live.presses, live.phase),
            (again.state, again.presses, TrialPhase::Closed),
            "seed {seed}"
        );
        assert_eq!(live.timeline, again.timeline, "seed {seed}");
        assert_eq!(engine.judged(), replay.follower.judged, "seed {seed}");
    }
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

/// What a replay came to, in lines.
fn summary(replay: &RecordingReplay) -> String {
    let (session, kitchen) = (replay.session(), &replay.log().kitchen);
    let mut lines = vec![
        format!("{:?} at {:.3} s", session.phase, session.time.as_secs_f64()),
        format!("presses {:?}, errors {}", session.presses, replay.follower.errors()),
        format!("served {}, on the timeline {}", session.served.len(), session.timeline.len()),
        format!("gaze {}, unusable {}", session.gaze.samples, session.gaze.unusable),
    ];
    let places = kitchen.locations.iter().enumerate();
    lines.extend(places.map(|(index, location)| {
        let aspect = AspectId::of_location(LocationId(index as u8));
        let content = &kitchen.aspects[aspect.index()].labels[kitchen.true_value(session.state, aspect)];
        format!("{}: {content}", location.name)
    }));
    lines.join("\n")
}

#[test]
fn the_golden_recordings_replay_to_what_they_replayed_to() {
    let entries = fs::read_dir("tests/golden").expect("the golden recordings");
    let mut logs: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    logs.sort();
    let format = format!("format-{VERSION}-");
    assert!(logs.iter().any(|log| log.display().to_string().contains(&format)), "a golden recording of this format");
    for log in logs {
        let mut replay = RecordingReplay::open(&log).expect("a golden recording");
        replay.run().unwrap_or_else(|error| panic!("{error}"));
        let name = log.file_stem().expect("a name").to_string_lossy().into_owned();
        check_snapshot("replay", name, summary(&replay));
    }
}

/// Copies a log to the golden recordings.
fn keep(log: &Path, name: &str) {
    fs::copy(log, format!("tests/golden/format-{VERSION}-{name}.jsonl")).expect("a golden recording can be written");
}

/// Simulates a trial of a session file, changed by `change`, and keeps it.
fn keep_simulated(name: &str, session: &str, change: fn(&mut SessionSpec)) {
    let mut files = read_session(&Path::new("sessions").join(session)).expect("a session file");
    (files.spec.trial.condition, files.spec.robot.arm) = (Condition::None, ArmKind::Timed);
    change(&mut files.spec);
    let made = simulate_into(files, 1, &folder(&format!("golden-{name}")));
    keep(&made[0].join(LOG_NAME), name);
}

#[test]
#[ignore = "writes tests/golden"]
fn golden_recordings_are_written() {
    let (log, _) = by_hand("default.toml", ArmKind::Timed, "golden-hand", 2);
    keep(&log, "hand");
    keep_simulated("simulated", "default.toml", |spec| {
        (spec.seed, spec.trial.presses, spec.assistant.shadow) = (7, 8, ShadowMode::Off);
    });
    keep_simulated("offers", "default.toml", |spec| {
        (spec.seed, spec.trial.presses, spec.participant.gaze) = (11, 36, GazeSource::None);
    });
    keep_simulated("probes", "probes.toml", |spec| {
        (spec.seed, spec.trial.seconds, spec.participant.gaze) = (3, 75.0, GazeSource::None);
        let probes = spec.probes.as_mut().expect("the session has probes");
        (probes.per_trial, probes.apart_s) = (2, 20.0);
    });
}

#[test]
fn figures_are_found_again_by_the_log_and_not_after_it_was_changed() {
    let out = simulated("default.toml", ArmKind::Timed, "list-cache", 1, 9817);
    let recording = only_recording(&out);
    let glance = ClosedLogHeader::read(&recording).expect("a closed log");
    let header = LogReader::open(&recording).expect("a log").header;
    assert_eq!((&glance.code, glance.condition), (&header.session.participant.code, header.session.trial.condition));
    assert_eq!(glance.date, header.started);
    let caches = out.join("caches");
    let (kind, state) = (RecordingKind::Trial, RecordingState::EndedByWizard);
    let figures = CachedRecordingNumbers { arm: StudyArm::None, trial_s: 0.1 + 0.2, errors: 7, kind, state };
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), None);
    ListCache::in_folder(&caches).keep([(glance.digest.clone(), figures)]);
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), Some(figures));
    let file = caches.join("lists.jsonl");
    let kept = fs::read_to_string(&file).expect("a file");
    assert!(!kept.contains(&glance.code) && !kept.contains("seed"), "{kept}");
    // Lines of others, or half a line, are passed over; without the file nothing is known.
    fs::write(&file, format!("{{}}\nwhat\n{kept}{}", &kept[..20])).expect("written");
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), Some(figures));
    fs::remove_file(&file).expect("removed");
    assert_eq!(ListCache::in_folder(&caches).figures(&glance.digest), None);
    // Another byte at the end, and a log that is not closed.
    let log = recording.join("events.jsonl");
    let text = fs::read_to_string(&log).expect("a log");
    let end = text.trim_end().rfind("\"t_ns\":").expect("a time") + 7;
    fs::write(&log, format!("{}1{}", &text[..end], &text[end..])).expect("written");
    assert_ne!(ClosedLogHeader::read(&recording).expect("still closed").digest, glance.digest);
    fs::write(&log, &text[..text.len() - 1]).expect("written");
    assert_eq!(ClosedLogHeader::read(&recording), None, "the last line has no end");
}
