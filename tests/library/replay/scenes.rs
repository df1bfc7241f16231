//! The scene that Rerun shows of a session.

use tomcom_devices::scene::{EntityData, EntityUpdate, SceneInputs, SceneUpdate, SessionScene};
use tomcom_session::history::wording;

use super::{folder, session, simulated};
use crate::support::*;

/// Everything that a recording shows, and its events.
fn shown(recording: &Path) -> (Vec<SceneUpdate>, Vec<TimestampedEvent>) {
    let mut replay = RecordingReplay::open(recording).expect("a recording");
    let mut scene = SessionScene::new(replay.session(), 0);
    let mut moments = vec![scene.opening()];
    let mut events = Vec::new();
    while let Some(line) = replay.step().expect("events of a session") {
        let (judged, belief) = (&replay.follower.judged[..], Some(replay.follower.filter.belief()));
        moments.extend(scene.see(&line.stamped, SceneInputs { judged, belief }));
        events.push(line.stamped);
    }
    (moments, events)
}

#[test]
fn a_scene_shows_every_press_signal_and_sample_once_at_its_time() {
    for name in ["format-3-hand.jsonl", "format-3-simulated.jsonl"] {
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
    let recording = only_recording(&out);
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
fn a_scene_shows_answers_of_probes_beside_the_estimate() {
    let (files, out) = (session("probes.toml"), folder("scene-probes"));
    simulate_into(files, 1, &out);
    let recording = only_recording(&out);
    let (moments, events) = shown(&recording);
    let state = |moment: &SceneUpdate, lane: &str| -> Option<String> {
        moment.rows.iter().find(|row| row.entity == lane).map(|row| match &row.shown {
            EntityData::State(text) => text.clone(),
            other => panic!("{other:?}"),
        })
    };
    let mut asked = Vec::new();
    let (mut answers, mut lanes) = (0, Vec::new());
    for stamped in &events {
        let Event::Probe(event) = &stamped.event else { continue };
        let moment = moments.iter().find(|moment| moment.step == stamped.seq && !moment.rows.is_empty());
        match event {
            ProbeEvent::Begun { questions, .. } => {
                // The answers of the probe before vanish.
                let cleared = |lane: &String| moment.and_then(|moment| state(moment, lane)).as_deref() == Some("");
                assert!(lanes.iter().all(cleared), "{lanes:?}");
                lanes.clear();
                asked.clone_from(questions);
            }
            ProbeEvent::Asked { question, .. } => {
                let about = wording::probe_subject(&asked[*question as usize - 1].about);
                assert_eq!(state(moment.expect("a moment"), "human/probes/asked"), Some(about));
            }
            ProbeEvent::Answered { question, answer, .. } => {
                answers += 1;
                let (moment, about) =
                    (moment.expect("a moment"), wording::probe_subject(&asked[*question as usize - 1].about));
                let lane = |kind: &str| {
                    format!("human/probes/{}_{kind}", about.replace(|letter: char| !letter.is_alphanumeric(), "_"))
                };
                let said = state(moment, &lane("answer")).expect("an answer");
                assert_eq!(answer.is_none(), said == "does not know", "{said}");
                let estimate = state(moment, &lane("estimate")).expect("an estimate");
                assert!(estimate.ends_with(" %"), "{estimate}");
                let line = format!("human answers, {about}: {said} (estimate: {estimate})");
                let is_line = |row: &EntityUpdate| {
                    row.entity == "happened" && matches!(&row.shown, EntityData::Words { text, .. } if *text == line)
                };
                assert!(moment.rows.iter().any(is_line), "{line}");
                lanes.extend([lane("answer"), lane("estimate")]);
            }
            ProbeEvent::Closed { .. } => {
                assert_eq!(state(moment.expect("a moment"), "human/probes/asked").as_deref(), Some(""));
            }
            _ => {}
        }
    }
    assert!(answers > 3, "{answers} answers");
}
