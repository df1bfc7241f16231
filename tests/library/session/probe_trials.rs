//! Freeze probes in trials of simulated participants: their times, what is answered, and that nothing else changes.

use std::path::Path;
use std::sync::Arc;

use serde_json::Value;
use tomcom::edge::files::read_session;
use tomcom_core::kitchen::AspectKind;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::headless;
use tomcom_session::probe_sampling::aspect;
use tomcom_session::probes::{ProbeEvent, ProbeOrigin};
use tomcom_session::settings::{Condition, SessionSpec};
use tomcom_session::{Event, TimestampedEvent};

use super::probes::probes_of;

/// A simulated trial with these probes, from its events.
fn simulated(trial: u64, change: impl Fn(&mut SessionSpec)) -> (SessionEngine, Vec<TimestampedEvent>) {
    let mut files = read_session(Path::new("sessions/probes.toml")).expect("a session file of the project");
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    change(&mut files.spec);
    let kitchen = Arc::new(files.kitchen.kitchen);
    let mut engine = SessionEngine::new(kitchen.clone(), files.spec, trial, CostToGo::new(kitchen));
    let mut events = Vec::new();
    let kept: Result<(), ()> = headless::run(&mut engine, |stamped| {
        events.push(stamped.clone());
        Ok(())
    });
    kept.expect("events are kept");
    (engine, events)
}

#[test]
fn scheduled_probes_keep_their_distance_and_half_of_them_ignore_the_estimate() {
    let mut blind = 0;
    for trial in 0..4 {
        let (engine, events) = simulated(trial, |_| ());
        let schedule = &engine.session().probes.schedule;
        assert_eq!(schedule.len(), 3);
        let times: Vec<f64> = schedule.iter().map(|one| one.at.as_secs_f64()).collect();
        assert!(times[0] >= 40.0 && times.windows(2).all(|pair| pair[1] - pair[0] >= 40.0), "{times:?}");
        assert!(times[2] + 15.0 <= 240.0, "{times:?}");
        blind += schedule.iter().filter(|one| !one.uses_estimate).count();
        let begun: Vec<u32> = probes_of(&events)
            .iter()
            .filter_map(|(_, event)| match event {
                ProbeEvent::Begun { probe, origin: ProbeOrigin::Schedule, .. } => Some(*probe),
                _ => None,
            })
            .collect();
        assert_eq!(begun, [1, 2, 3], "trial {trial}");
        assert_eq!(engine.session().probes.over.len(), 3);
    }
    assert!((4..=8).contains(&blind), "{blind} of 12");
}

/// The events without those of probes, at the times of the trial's clock, without numbers that probes shift.
fn without_probes(events: &[TimestampedEvent]) -> Vec<(u64, Value)> {
    let (mut stood, mut frozen, mut told) = (0, None, Vec::new());
    for stamped in events {
        let clock = frozen.unwrap_or(stamped.time.0) - stood;
        match &stamped.event {
            Event::Probe(ProbeEvent::Begun { .. }) => frozen = Some(stamped.time.0),
            Event::Probe(ProbeEvent::Ended { .. }) => stood += stamped.time.0 - frozen.take().expect("it had begun"),
            Event::Probe(_) => {}
            Event::ParticipantBelieves(belief) if belief.cause == "asked by a probe" => {}
            other => {
                let mut value = serde_json::to_value(other).expect("JSON");
                let fields = value.as_object_mut().expect("an object");
                ["until_ns", "press", "for_seq", "for_ns", "offer"].iter().for_each(|name| {
                    fields.remove(*name);
                });
                told.push((clock, value));
            }
        }
    }
    told
}

#[test]
fn with_and_without_probes_a_trial_is_the_same_and_so_are_all_estimates() {
    for (trial, condition) in [(0, Condition::None), (1, Condition::None), (2, Condition::Assistant)] {
        let settings = |spec: &mut SessionSpec| {
            spec.trial.condition = condition;
            (spec.assistant.rollout.rollouts, spec.assistant.rollout.least_rollouts) = (16, 8);
        };
        let with = simulated(trial, settings);
        let without = simulated(trial, |spec| {
            settings(spec);
            spec.probes = None;
        });
        assert!(probes_of(&with.1).len() > 10 && probes_of(&without.1).is_empty());
        let [a, b] = [&with.1, &without.1].map(|events| without_probes(events));
        for (index, (one, other)) in a.iter().zip(&b).enumerate() {
            assert!(one == other, "trial {trial}, event {index}: {one:?} and {other:?}");
        }
        assert_eq!(a.len(), b.len());
        assert!(a.iter().filter(|(_, event)| event["kind"] == "belief_estimated").count() > 50);
        assert_eq!(with.0.belief(), without.0.belief(), "trial {trial}");
        let verdicts = |engine: &SessionEngine| engine.judged().iter().map(|press| press.verdict).collect::<Vec<_>>();
        assert_eq!(verdicts(&with.0), verdicts(&without.0));
    }
}

#[test]
fn a_simulated_participant_answers_what_it_believes() {
    let mut compared = (0, 0);
    for trial in 0..3 {
        let (engine, events) = simulated(trial, |spec| {
            let population = spec.participant.population.get_or_insert_default();
            population.answers_wrong.median = 0.0;
        });
        let kitchen = &engine.session().kitchen;
        let (mut believed, mut asked) = (None, Vec::new());
        for stamped in &events {
            match &stamped.event {
                Event::ParticipantBelieves(belief) if belief.cause == "asked by a probe" => {
                    believed = Some((stamped.time, belief))
                }
                Event::Probe(ProbeEvent::Begun { questions, .. }) => {
                    assert_eq!(believed.map(|(time, _)| time), Some(stamped.time), "recorded at the same time");
                    asked.clone_from(questions);
                }
                Event::Probe(ProbeEvent::Answered { question, answer, .. }) => {
                    let (_, belief) = believed.expect("it is recorded before");
                    let id = aspect(kitchen, &asked[*question as usize - 1].about).expect("an aspect");
                    let held = &belief.aspects[id.index()];
                    let most = held.values.values().copied().fold(0.0, f64::max);
                    match answer {
                        Some(answer) => assert_eq!((answer, most >= 0.5), (&held.believes, true)),
                        None => assert!(most < 0.5, "{held:?}"),
                    }
                    compared.0 += 1;
                    compared.1 += u32::from(held.p_truth < 0.5);
                }
                _ => {}
            }
        }
    }
    assert!(compared.0 >= 18 && compared.1 > 0, "{compared:?}");
}

#[test]
fn wrong_answers_come_at_their_rate() {
    let wrong = |median| {
        let mut wrong = 0;
        for trial in 0..3 {
            let (engine, _) = simulated(trial, |spec| {
                let population = spec.participant.population.get_or_insert_default();
                (population.answers_wrong.median, population.answers_wrong.sigma) = (median, 0.0);
                population.all_knowing = true;
            });
            let (session, kitchen) = (engine.session(), &engine.session().kitchen);
            for over in &session.probes.over {
                for (question, answer) in over.questions.iter().zip(&over.answers) {
                    let id = aspect(kitchen, &question.about).expect("an aspect");
                    let recipe = &kitchen.aspects[id.index()].labels[0];
                    if matches!(kitchen.aspects[id.index()].kind, AspectKind::Recipe(_)) {
                        let answer = answer.as_ref().and_then(|answer| answer.answer.as_ref());
                        wrong += u32::from(answer != Some(recipe));
                    }
                }
            }
        }
        wrong
    };
    assert_eq!(wrong(0.0), 0);
    assert!(wrong(0.99) > 3, "all but a few");
}

#[test]
fn one_further_question_can_be_about_what_happens_next() {
    let (engine, _) = simulated(2, |spec| {
        let probes = spec.probes.get_or_insert_default();
        (probes.level_2, probes.confidence) = (true, true);
    });
    let kitchen = &engine.session().kitchen;
    for over in &engine.session().probes.over {
        let next: Vec<_> = over.questions.iter().filter(|one| aspect(kitchen, &one.about).is_none()).collect();
        assert!(next.len() == 1 && next[0].inclusion >= 0.5 && next[0].choices.len() > 1, "{next:?}");
        let sure = over.questions.iter().zip(&over.answers).all(|(question, answer)| {
            let answer = answer.as_ref().expect("answered");
            let is_asked = answer.answer.is_some() && aspect(kitchen, &question.about).is_some();
            is_asked == answer.confidence.is_some()
        });
        assert!(sure, "{:?}", over.answers);
    }
}
