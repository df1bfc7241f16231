//! Recordings with freeze probes: they verify whole and cut, whatever is pressed in a probe, and go on in the probe in which they were cut.

use std::collections::HashSet;

use tomcom::run::resume::resume;
use tomcom_session::probes::ProbeEndReason;
use tomcom_session::settings::ProbeSpec;

use super::{anything, folder, session};
use crate::support::*;

/// Many probes in a short time.
fn often() -> ProbeSpec {
    ProbeSpec { per_trial: 10, apart_s: 15.0, ..ProbeSpec::default() }
}

#[test]
fn a_simulated_recording_with_probes_verifies_whole_and_cut_at_each_kind_of_event_of_a_probe() {
    let mut files = session("probes.toml");
    (files.spec.trial.seconds, files.spec.robot.arm) = (90.0, ArmKind::Physics);
    files.spec.probes =
        Some(ProbeSpec { per_trial: 2, apart_s: 20.0, confidence: true, level_2: true, ..ProbeSpec::default() });
    let log = simulate_into(files, 1, &folder("probes"))[0].join(LOG_NAME);
    let found = verify(&log).expect("a recording");
    assert!(found.verified && !found.cut, "{found:?}");
    let text = fs::read_to_string(&log).expect("a log");
    let lines: Vec<&str> = text.lines().collect();
    let of_probes: Vec<usize> = (0..lines.len()).filter(|&index| lines[index].contains("\"kind\":\"probe\"")).collect();
    assert!(of_probes.len() >= 16, "{}", of_probes.len());
    // To run it again takes seconds: one cut after each kind of event, and one at the very end of the last probe.
    let mut kinds = HashSet::new();
    let firsts = of_probes.iter().copied().filter(|&index| kinds.insert(did(lines[index])));
    for index in firsts.chain(of_probes.last().copied()) {
        let cut = folder("probes-cut").join(LOG_NAME);
        fs::write(&cut, lines[..=index].join("\n") + "\n").expect("the folder can be written");
        let found = verify(&cut).expect("a recording");
        assert!(found.verified && found.cut, "cut after line {index}: {found:?}");
    }
}

/// What a probe did, by its line in the log.
fn did(line: &str) -> String {
    let (_, rest) = line.split_once("\"did\":\"").unwrap_or_else(|| panic!("no event of a probe: {line}"));
    rest.chars().take_while(|&letter| letter != '"').collect()
}

#[test]
fn a_changed_question_or_time_of_a_probe_does_not_verify() {
    let mut files = session("probes.toml");
    files.spec.trial.seconds = 90.0;
    files.spec.probes = Some(ProbeSpec { per_trial: 1, apart_s: 20.0, ..ProbeSpec::default() });
    let log = simulate_into(files, 1, &folder("probes-changed"))[0].join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a log");
    for (from, to) in [("\"inclusion\":0.", "\"inclusion\":0.9"), ("\"uses_estimate\":true", "\"uses_estimate\":false")]
    {
        let begun = text.lines().find(|line| line.contains("\"did\":\"begun\"")).expect("a probe");
        let (from, to) = if begun.contains(from) { (from, to) } else { (to, from) };
        assert!(begun.contains(from), "{begun}");
        fs::write(&log, text.replace(begun, &begun.replacen(from, to, 1))).expect("the folder can be written");
        assert!(!verify(&log).expect("a recording").verified, "{to}");
    }
}

/// Files of a session with somebody at keyboard and mouse.
fn by_hand(seed: u64) -> SessionSetup {
    let mut files = session("probes.toml");
    files.spec.robot.arm = ArmKind::Timed;
    files.spec.trial.condition = Condition::Wizard;
    files.spec.participant.kind = ParticipantKind::Keyboard;
    files.spec.participant.gaze = GazeSource::Mouse;
    (files.spec.seed, files.spec.probes) = (seed, Some(often()));
    // Hands press and signal all the time: neither must end the trial early, or keep every probe waiting.
    (files.spec.trial.presses, files.spec.trial.seconds) = (5_000, 2_000.0);
    files.spec.probes.as_mut().expect("probes").after_signal_s = 1.0;
    files
}

/// What may happen around probes, as a seeded mess.
fn around_probes(engine: &SessionEngine, random: &mut impl RngExt) -> Event {
    let open = engine.session().probes.open.as_ref();
    let probe = open.map_or(1, |open| open.number);
    let shown = open.and_then(|open| open.question());
    Event::Probe(match (random.random_range(0..12), shown) {
        (0, _) => ProbeEvent::Requested,
        (1, _) => ProbeEvent::Skipped { probe, reason: "phone".to_string() },
        (2..=6, Some((index, question))) => ProbeEvent::Answered {
            probe,
            question: index as u32 + 1,
            answer: random.random_bool(0.8).then(|| question.choices[0].clone()),
            confidence: None,
            on: AnswerDevice::Console,
        },
        _ => return anything(&engine.session().kitchen, random),
    })
}

#[test]
fn whatever_hands_do_around_probes_the_recording_verifies_and_replays_to_the_same_session() {
    for seed in 0..3 {
        let (mut log, mut engine) = live_recording(by_hand(seed), 0, &folder(&format!("probes-hand-{seed}")));
        let mut random = stream(seed, "hand at probes", 0);
        let mut now_s = 0.5;
        let mut give = |engine: &mut SessionEngine, now_s: f64, event: Event| {
            let events = engine.input(at(now_s), event).events;
            events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
        };
        give(&mut engine, now_s, Event::TrialStarted);
        for _ in 0..1500 {
            now_s += random.random_range(0.0..0.4);
            let event = around_probes(&engine, &mut random);
            give(&mut engine, now_s, event);
        }
        give(&mut engine, now_s, Event::TrialEnded { reason: TrialEndReason::Wizard });
        give(&mut engine, now_s, Event::SessionEnded);
        let ends: Vec<Option<ProbeEndReason>> =
            engine.session().probes.over.iter().map(|over| over.closed.map(|(end, _)| end)).collect();
        assert!(ends.len() >= 3, "seed {seed}: {ends:?}");
        let log = log.folder().join(LOG_NAME);
        let found = verify(&log).expect("a recording");
        assert!(found.verified && !found.cut, "seed {seed}: {found:?}");
        let mut replay = RecordingReplay::open(&log).expect("a recording");
        replay.run().expect("a recording");
        assert_eq!(engine.session(), replay.session(), "seed {seed}");
        assert_eq!((engine.belief(), engine.judged()), (replay.follower.filter.belief(), &replay.follower.judged[..]));
    }
}

#[test]
fn a_session_that_was_killed_in_a_probe_goes_on_in_it_where_it_was() {
    let (mut log, mut engine) = live_recording(by_hand(5), 0, &folder("probes-killed"));
    let mut events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    let asked =
        |engine: &SessionEngine| engine.session().probes.open.as_ref().and_then(|open| open.question()).is_some();
    while !asked(&engine) {
        events.extend(engine.fire());
    }
    let answer = |engine: &SessionEngine, after_s: f64| {
        let open = engine.session().probes.open.as_ref().expect("a probe");
        let (shown, asked) = open.question().expect("a question");
        let (question, answer) = (shown as u32 + 1, Some(asked.choices[0].clone()));
        let on = AnswerDevice::Display;
        let event = Event::Probe(ProbeEvent::Answered { probe: open.number, question, answer, confidence: None, on });
        (engine.session().time + at(after_s), event)
    };
    let (time, event) = answer(&engine, 2.0);
    events.extend(engine.input(time, event).events);
    events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    let recording = log.folder().to_path_buf();
    drop(log);

    let mut resumed = resume(&recording).expect("it can be continued");
    assert_eq!(resumed.first.last().map(|one| &one.event), Some(&Event::TrialPaused));
    let engine = &mut resumed.engine;
    let open = engine.session().probes.open.clone().expect("the probe is held");
    assert!(open.is_paused() && open.shown == Some(1) && open.answers[0].is_some(), "{open:?}");
    assert_eq!(engine.next_due(), None, "nothing is due until the participant is back");
    let hour = at(3600.0);
    assert_eq!(engine.input(resumed.time + hour, Event::TrialResumed).refused, None);
    while engine.session().is_frozen() && asked(engine) {
        let (time, event) = answer(engine, 1.0);
        assert_eq!(engine.input(time, event).refused, None);
    }
    let closed = engine.session().probes.open.as_ref().and_then(|open| open.closed).map(|(end, _)| end);
    assert_eq!(closed, Some(ProbeEndReason::Answered));
    engine.fire();
    assert!(engine.session().is_running(), "the task goes on");
}

#[test]
fn a_recording_of_format_2_keeps_its_probes() {
    let golden = std::path::Path::new("tests/golden/format-3-probes.jsonl");
    let mut replay = RecordingReplay::open(golden).expect("a golden recording");
    replay.run().expect("a golden recording");
    let over = &replay.session().probes.over;
    assert_eq!(over.iter().map(|one| one.number).collect::<Vec<_>>(), [1, 2]);
    for one in over {
        assert!(one.questions.len() >= 2 && one.answers.iter().all(Option::is_some), "{one:?}");
        assert!(one.questions.iter().all(|question| question.inclusion >= 0.05), "{one:?}");
        assert_eq!(one.closed.map(|(end, _)| end), Some(ProbeEndReason::Answered));
    }
}
