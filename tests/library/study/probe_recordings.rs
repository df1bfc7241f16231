//! Probes as they are read from sessions of simulated participants.

use std::convert::Infallible;

use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectKind, LocationId};
use tomcom_core::mind::RecordedBelief;
use tomcom_session::engine::SessionEngine;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless;
use tomcom_session::probes::{ProbeEvent, ProbeOrigin, ProbeSubject};
use tomcom_session::{Event, Session, SessionSpec, TimestampedEvent};
use tomcom_study::analysis::probe_figures::ProbeSummary;
use tomcom_study::analysis::probe_record::ProbeCollector;
use tomcom_study::analysis::probe_record::{ProbeResponse, ProbedQuestion, ProbedTrial};

use super::near;
use crate::kitchen;

/// A trial with probes, of a participant with this share of wrong answers.
fn settings(answers_wrong: f64) -> SessionSpec {
    let text = format!(
        "layout = \"\"\nseed = 5\n[trial]\ncondition = \"none\"\nseconds = 300.0\n[assistant]\nshadow = \"off\"\n\
         [participant.population]\nanswers_wrong = {{ median = {answers_wrong}, sigma = 0.4 }}\n[probes]\napart_s = 50.0\nper_trial = 5\n"
    );
    toml::from_str(&text).expect("settings of a session")
}

/// A question as it follows from the events alone.
struct Expected {
    truth: String,
    /// Seconds since the last change, and who made it.
    changed: Option<(f64, Option<Agent>)>,
    believed: String,
    estimate_p_truth: f64,
}

/// Runs a trial and reads its probes, beside what is expected of each drawn question.
fn probed(spec: &SessionSpec, trial: u64) -> (ProbedTrial, Vec<(u32, Vec<Expected>)>) {
    let kitchen = kitchen("sushi");
    let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), trial, CostToGo::new(kitchen.clone()));
    let session = Session::new(kitchen.clone(), spec.clone(), trial);
    let mut follower = SessionFollower::new(session, CostToGo::new(kitchen.clone()));
    let (mut collector, mut expected) = (ProbeCollector::default(), Vec::new());
    let mut changes: Vec<(LocationId, f64, Option<Agent>)> = Vec::new();
    let mut witness: Option<RecordedBelief> = None;
    let keep = |stamped: &TimestampedEvent| {
        let change = follower.apply(stamped).expect("what was recorded can be replayed").change;
        collector.note(stamped, &change, &follower);
        let session = &follower.session;
        let now = session.trial_clock(stamped.time).as_secs_f64();
        if let Some((before, after)) = change.states() {
            let changed = (0..kitchen.locations.len() as u8).map(LocationId);
            let changed = changed.filter(|&location| before.code(location) != after.code(location));
            changes.extend(changed.map(|location| (location, now, change.press().map(|press| press.agent))));
        }
        match &stamped.event {
            Event::ParticipantBelieves(told) => witness = Some(told.clone()),
            Event::Probe(ProbeEvent::Begun { probe, questions, .. }) => {
                let believed = witness.as_ref().expect("beliefs are recorded before the probe");
                let of = |about: &str| {
                    let aspect = kitchen.aspect_named(about).expect("an aspect of the kitchen");
                    let told = &kitchen.aspects[aspect.index()];
                    let location = match told.kind {
                        AspectKind::Location(location) => Some(location),
                        AspectKind::Recipe(_) => None,
                    };
                    let last = changes.iter().rfind(|(other, ..)| Some(*other) == location);
                    Expected {
                        truth: told.labels[kitchen.true_value(session.state, aspect)].clone(),
                        changed: last.map(|(_, at, who)| (now - at, *who)),
                        believed: believed.aspects[aspect.index()].believes.clone(),
                        estimate_p_truth: follower.probed.as_ref().unwrap().belief.p_truth(
                            &kitchen,
                            session.state,
                            aspect,
                        ),
                    }
                };
                let names = questions.iter().map(|question| match &question.about {
                    ProbeSubject::Recipe { dish } => format!("recipe of {dish}"),
                    ProbeSubject::Location { location } => location.clone(),
                    next => panic!("{next:?} was not asked for"),
                });
                expected.push((*probe, names.map(|name| of(&name)).collect()));
            }
            _ => {}
        }
        Ok::<(), Infallible>(())
    };
    headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
    (collector.finish(engine.session()), expected)
}

fn check(question: &ProbedQuestion, expected: &Expected) {
    let frozen = question.frozen.as_ref().expect("a question about what is");
    assert_eq!(question.truth.as_ref(), Some(&expected.truth));
    assert_eq!(frozen.believed.as_ref().expect("a simulated participant").believes, expected.believed);
    near(frozen.estimate_p_truth, expected.estimate_p_truth);
    near(frozen.estimate_p[&expected.truth], expected.estimate_p_truth);
    near(frozen.estimate_p.values().sum(), 1.0);
    match (frozen.changed_unseen, expected.changed) {
        (None, _) => assert_eq!((&frozen.usual, &frozen.last_seen), (&expected.truth, &expected.truth), "a recipe"),
        (Some(_), None) => assert_eq!((frozen.changed_s, frozen.changed_unseen), (None, Some(false))),
        (Some(is_unseen), Some((age_s, who))) => {
            near(frozen.changed_s.expect("it changed"), age_s);
            assert!(!is_unseen || who != Some(Agent::Human), "own presses are seen");
            if !is_unseen {
                assert_eq!(frozen.last_seen, expected.truth, "what was seen after the last change is there");
            }
        }
    }
}

#[test]
fn questions_have_what_was_true_known_and_estimated_at_the_freeze() {
    let spec = settings(0.0);
    let (mut unseen, mut changed, mut asked) = (0, 0, 0);
    for trial in 0..3 {
        let (found, expected) = probed(&spec, trial);
        assert_eq!(found.begun as usize, expected.len());
        assert!(found.begun > 0);
        for question in &found.questions {
            assert_eq!(question.origin, ProbeOrigin::Schedule);
            let of_probe = expected.iter().find(|(probe, _)| *probe == question.probe).expect("it began");
            check(question, &of_probe.1[question.question as usize - 1]);
            let frozen = question.frozen.as_ref().unwrap();
            unseen += u32::from(frozen.changed_unseen == Some(true));
            changed += u32::from(frozen.changed_s.is_some());
            asked += 1;
        }
    }
    assert!(asked > 20 && changed > 5 && unseen > 0, "{asked} questions, {changed} of changed places, {unseen} unseen");
}

#[test]
fn answers_of_simulated_participants_are_their_beliefs_unless_they_err() {
    let figures = |answers_wrong: f64| {
        let spec = settings(answers_wrong);
        let trials: Vec<(String, ProbedTrial)> =
            (0..5).map(|trial| (format!("S{trial}"), probed(&spec, trial).0)).collect();
        for question in trials.iter().flat_map(|(_, trial)| &trial.questions) {
            let took_s = question.took_s;
            assert_eq!(took_s.is_none(), question.response == ProbeResponse::Missing);
            assert!(took_s.is_none_or(|took_s| (0.2..25.0).contains(&took_s)), "{question:?}");
        }
        ProbeSummary::from_trials(trials.iter().map(|(code, trial)| (code.as_str(), trial))).expect("there are probes")
    };
    let exact = figures(0.0);
    let known = exact.by_true_beliefs.as_ref().expect("simulated");
    assert!(known.n > 30 && known.n == exact.counts.counted, "{:?}", exact.counts);
    near(known.agreement, 1.0);
    let both = [
        (exact.detection.wrong, known.detection.wrong),
        (exact.detection.auc, known.detection.auc),
        (exact.detection.ece, known.detection.ece),
    ];
    for (answered, believed) in both {
        near(answered.expect("some beliefs are false"), believed.expect("some beliefs are false"));
    }
    let wrong = figures(0.3);
    let known = wrong.by_true_beliefs.expect("simulated");
    assert!((0.5..0.9).contains(&known.agreement), "three of ten answers are wrong: {}", known.agreement);
    near(known.detection.auc.unwrap(), exact.detection.auc.unwrap());
}
