//! Recordings with offers: they verify, go on after a cut, and are measured.

use tomcom::run::resume::resume;
use tomcom_core::communication::offer::OfferCloseReason;
use tomcom_study::analysis::offer_summary::TimedOffer;

use super::{folder, session};
use crate::support::*;

/// Trials of an unassisted session with an assistant that advises unseen.
fn shadowed(out: &str) -> Vec<PathBuf> {
    let mut files = session("default.toml");
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::None, ShadowMode::On);
    files.spec.assistant.rollout.rollouts = 32;
    (files.spec.seed, files.spec.trial.seconds) = (7, 120.0);
    let request = SimulationRequest { files, trials: 2, shard: SimulationShard::WHOLE, out: folder(out) };
    let summary = simulate(&request, || ()).expect("the folder can be written");
    assert!(summary.offers.n > 0, "seed 7: {:?}", summary.offers);
    summary.recordings.iter().map(PathBuf::from).collect()
}

#[test]
fn a_recording_with_offers_verifies_whole_and_cut_at_every_offer() {
    let recordings = shadowed("offers");
    for recording in &recordings {
        let found = verify(recording).expect("a recording");
        assert!(found.verified && !found.cut, "{found:?}");
    }
    let text = fs::read_to_string(recordings[0].join(LOG_NAME)).expect("a log");
    let lines: Vec<&str> = text.lines().collect();
    let opened = (0..lines.len()).filter(|&index| lines[index].contains("\"kind\":\"offer_"));
    for index in opened {
        let cut = folder("offers-cut").join(LOG_NAME);
        fs::write(&cut, lines[..=index].join("\n") + "\n").expect("the folder can be written");
        let found = verify(&cut).expect("a recording");
        assert!(found.verified && found.cut, "cut after line {index}: {found:?}");
    }
}

#[test]
fn a_session_that_was_cut_goes_on_with_its_open_offer() {
    let mut files = session("default.toml");
    files.spec.participant.kind = ParticipantKind::Keyboard;
    files.spec.participant.gaze = GazeSource::None;
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::Wizard, ShadowMode::On);
    files.spec.assistant.rollout.rollouts = 32;
    // Nobody has seen the orders, and signals cost nothing: something is worth saying.
    files.spec.assistant.cost_of_communication = 0.0;
    let (mut log, mut engine) = live_recording(files, 0, &folder("offers-live"));
    let mut advisor = engine.advisor();
    let mut events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    while engine.session().offers.open().is_none() {
        for question in engine.take_questions() {
            events.extend(engine.input(question.time, Event::Advised(advisor.answer(&question))).events);
        }
        events.extend(engine.fire());
    }
    events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    let recording = log.folder().to_path_buf();
    drop(log);
    let offer = engine.session().offers.open().cloned();
    let resumed = resume(&recording).expect("it can be continued");
    assert_eq!(resumed.engine.session().offers.open().cloned(), offer);
    assert!(resumed.first.iter().any(|one| one.event == Event::TrialPaused));
}

#[test]
fn a_golden_recording_keeps_its_offers() {
    let golden = Path::new("tests/golden/format-3-offers.jsonl");
    let mut replay = RecordingReplay::open(golden).expect("a golden recording");
    replay.run().expect("a golden recording");
    let offers = TimedOffer::all(replay.session());
    let told: Vec<(Option<f64>, Option<OfferCloseReason>)> =
        offers.iter().map(|one| (one.stood_s, one.reason)).collect();
    assert!(!told.is_empty());
    assert!(told.iter().all(|(stood_s, reason)| stood_s.is_some_and(|s| s >= 1.5) && reason.is_some()), "{told:?}");
}
