//! Freeze probes: when they begin and end, which questions they ask, and that they change nothing else.

use tomcom_session::headless;
use tomcom_session::probe_sampling::{SOMETHING_ELSE, aspect, questions};
use tomcom_session::probes::{ProbeDelayReason, ProbeEndReason, ProbeOrigin, ProbeSubject, StartedProbe};
use tomcom_session::settings::ProbeSpec;

use super::{at, check, corrected, engine, kitchen, mark, press, refused};
use crate::support::*;

/// A session in which nothing is scheduled in the first minutes, so that the wizard asks for probes.
pub fn on_request(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    engine(|spec| {
        spec.trial.condition = Condition::Wizard;
        spec.probes = Some(ProbeSpec { per_trial: 0, ..ProbeSpec::default() });
        change(spec);
    })
}

fn requested() -> Event {
    Event::Probe(ProbeEvent::Requested)
}

/// The wizard skips the questions of a probe.
fn skipped(reason: &str) -> Event {
    Event::Probe(ProbeEvent::Skipped { probe: 1, reason: reason.to_string() })
}

fn open(engine: &SessionEngine) -> Option<&StartedProbe> {
    engine.session().probes.open.as_ref()
}

/// The first choice as the answer to a question.
fn answered(engine: &SessionEngine, question: u32) -> Event {
    let open = open(engine).expect("a probe is held");
    let answer = Some(open.questions[question as usize - 1].choices[0].clone());
    let (probe, on) = (open.number, AnswerDevice::Display);
    Event::Probe(ProbeEvent::Answered { probe, question, answer, confidence: None, on })
}

/// What probes did, with their times.
pub fn probes_of(events: &[TimestampedEvent]) -> Vec<(SessionTime, ProbeEvent)> {
    let probe = |stamped: &TimestampedEvent| match &stamped.event {
        Event::Probe(event) => Some((stamped.time, event.clone())),
        _ => None,
    };
    events.iter().filter_map(probe).collect()
}

/// Lets the session go on until this time.
fn until(engine: &mut SessionEngine, seconds: f64) -> Vec<TimestampedEvent> {
    engine.input(at(seconds), mark()).events
}

#[test]
fn a_probe_freezes_the_task_asks_one_question_after_another_and_counts_down() {
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, press("take rice"))]);
    check(&mut engine, &[(20.0, requested())]);
    assert_eq!((engine.session().phase, engine.session().is_frozen()), (TrialPhase::Paused, true));
    assert!(open(&engine).is_some_and(|open| open.question().is_none()), "blank first");
    let before = engine.session().state;
    until(&mut engine, 22.0);
    let number = open(&engine).map_or(0, |open| open.questions.len());
    assert!((2..=4).contains(&number), "{number} questions");
    let mut seconds = 22.0;
    for question in 1..=number as u32 {
        let answer = answered(&engine, question);
        check(&mut engine, &[(seconds, press("counter")), (seconds, answer)]);
        seconds += 1.0;
    }
    let last = seconds - 1.0;
    assert_eq!(open(&engine).and_then(|open| open.closed), Some((ProbeEndReason::Answered, at(last))));
    until(&mut engine, last + 2.9);
    assert_eq!(engine.session().trial_clock(at(last + 2.9)), at(20.0), "the trial's clock stands still");
    let now = (engine.session().state, engine.session().presses[0]);
    assert_eq!(now, (before, 1), "presses in it have no effect");
    until(&mut engine, last + 3.1);
    assert_eq!((engine.session().phase, engine.session().is_frozen()), (TrialPhase::Running, false));
    assert_eq!(engine.session().trial_clock(at(last + 3.1)), at(20.1));
    let over = &engine.session().probes.over[0];
    assert!(over.answers.iter().all(Option::is_some));
    assert_eq!(over.answers[0].as_ref().map(|answer| answer.took), Some(at(1.0)), "the question came at 21 s");
}

#[test]
fn after_its_time_a_question_is_missed_and_late_answers_are_refused() {
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
    until(&mut engine, 24.0);
    let late = answered(&engine, 1);
    let number = open(&engine).map_or(0, |open| open.questions.len()) as u32;
    // The first question came at 21 s; each has 12 s.
    let events = probes_of(&until(&mut engine, 33.5));
    assert_eq!(events, [(at(33.0), ProbeEvent::Asked { probe: 1, question: 2 })]);
    assert!(refused(&mut engine, 34.0, late.clone()).contains("another question"), "late answers");
    let answer = answered(&engine, 2);
    check(&mut engine, &[(35.0, answer)]);
    let end_s = if number == 2 { 35.0 } else { 35.0 + 12.0 * f64::from(number - 2) };
    let events = probes_of(&until(&mut engine, end_s + 0.5));
    let closed = ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver };
    assert!(number == 2 || events.last() == Some(&(at(end_s), closed)), "{events:?}");
    assert!(refused(&mut engine, end_s + 1.0, late).contains("questions are over"), "late answers");
    let answers = &open(&engine).expect("a probe").answers;
    assert_eq!((answers[0].is_none(), answers[1].is_some()), (true, true));
    let events = probes_of(&until(&mut engine, end_s + 5.0));
    assert_eq!(events, [(at(end_s + 3.0), ProbeEvent::Ended { probe: 1 })]);
}

#[test]
fn answers_are_taken_for_the_shown_question_and_from_its_choices_only() {
    let mut engine = on_request(|_| ());
    assert!(refused(&mut engine, 0.0, requested()).contains("while the trial runs"));
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
    let early = answered(&engine, 1);
    assert!(refused(&mut engine, 20.5, early).contains("no question"), "the display is blank");
    until(&mut engine, 22.0);
    let second = answered(&engine, 2);
    assert!(refused(&mut engine, 22.0, second).contains("another question"));
    let answer = |answer: &str, confidence| {
        let answer = Some(answer.to_string());
        Event::Probe(ProbeEvent::Answered { probe: 1, question: 1, answer, confidence, on: AnswerDevice::Console })
    };
    assert!(refused(&mut engine, 22.0, answer("a violin", None)).contains("no such choice"));
    let choice = open(&engine).expect("a probe").questions[0].choices[0].clone();
    assert!(refused(&mut engine, 22.0, answer(&choice, Some(2))).contains("confidence"), "it is not asked");
    assert!(refused(&mut engine, 22.0, requested()).contains("already"));
    assert!(refused(&mut engine, 22.0, corrected("counter", "nori")).contains("after the freeze probe"));
    let (answer, on) = (None, AnswerDevice::Display);
    let unknown = ProbeEvent::Answered { probe: 1, question: 1, answer, confidence: None, on };
    check(&mut engine, &[(23.0, Event::Probe(unknown))]);
    assert!(refused(&mut engine, 23.0, skipped(" ")).contains("reason"));
    check(&mut engine, &[(24.0, skipped("phone"))]);
    let closed = open(&engine).and_then(|open| open.closed);
    assert_eq!(closed, Some((ProbeEndReason::Skipped, at(24.0))));
}

#[test]
fn a_pause_in_a_probe_stops_its_time_and_the_trial_goes_on_after_the_probe_only() {
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
    assert!(refused(&mut engine, 21.5, Event::TrialResumed).contains("after the freeze probe"));
    check(&mut engine, &[(22.0, Event::TrialPaused)]);
    assert!(refused(&mut engine, 30.0, Event::TrialPaused).contains("no trial runs"));
    let answer = answered(&engine, 1);
    assert!(refused(&mut engine, 60.0, answer.clone()).contains("paused"));
    assert!(probes_of(&until(&mut engine, 100.0)).is_empty(), "nothing is due in a pause");
    check(&mut engine, &[(102.0, Event::TrialResumed), (103.0, answer)]);
    assert!(engine.session().is_frozen(), "the probe is held still");
    let took = open(&engine).and_then(|open| Some(open.answers[0].as_ref()?.took));
    assert_eq!(took, Some(at(2.0)), "1 s before the pause and 1 s after it");
    // The second question is shown since 103 s; a pause of it does not count.
    check(&mut engine, &[(104.0, Event::TrialPaused), (114.0, Event::TrialResumed)]);
    let events = probes_of(&until(&mut engine, 200.0));
    let (time, next) = &events[0];
    let is_next = matches!(next, ProbeEvent::Asked { question: 3, .. } | ProbeEvent::Closed { .. });
    assert!(*time == at(125.0) && is_next, "{events:?}");
    let (ended, last) = events.last().expect("events");
    assert_eq!(last, &ProbeEvent::Ended { probe: 1 });
    assert_eq!(engine.session().trial_clock(*ended), at(20.0));
}

#[test]
fn a_trial_that_ends_in_a_probe_closes_it() {
    let ended = Event::TrialEnded { reason: TrialEndReason::Wizard };
    for end in [ended, Event::TrialAborted { reason: "fire alarm".to_string() }] {
        for is_paused in [false, true] {
            let mut engine = on_request(|_| ());
            check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
            if is_paused {
                check(&mut engine, &[(21.0, Event::TrialPaused)]);
            }
            let events = engine.input(at(23.0), end.clone()).events;
            let closed = ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TrialEnded };
            assert_eq!(probes_of(&events).last(), Some(&(at(23.0), closed)));
            assert!(!engine.session().is_frozen() && engine.session().probes.over.len() == 1);
            assert_eq!(engine.next_due(), None, "nothing is due any more");
        }
    }
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested()), (22.0, Event::SessionEnded)]);
    let over = &engine.session().probes.over;
    assert_eq!(over.iter().map(|one| one.closed).collect::<Vec<_>>(), [Some((ProbeEndReason::TrialEnded, at(22.0)))]);
}

#[test]
fn no_probe_begins_soon_after_a_signal_or_a_probe_it_waits_and_is_dropped() {
    let signal =
        || Event::SignalShown { by: Sender::Wizard, signal: Signal::Highlight("counter".to_string()), offer: None };
    let delayed = ProbeEvent::Delayed { probe: 1, reason: ProbeDelayReason::Signal };
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, signal())]);
    let events = engine.input(at(23.0), requested()).events;
    assert_eq!(probes_of(&events)[1..], [(at(23.0), delayed.clone())]);
    assert!(refused(&mut engine, 24.0, requested()).contains("waiting"));
    let events = probes_of(&until(&mut engine, 30.0));
    let is_begun =
        matches!(events[..], [(time, ProbeEvent::Begun { origin: ProbeOrigin::Wizard, .. })] if time == at(30.0));
    assert!(is_begun, "{events:?}");
    check(&mut engine, &[(31.0, skipped("phone"))]);
    until(&mut engine, 35.0);
    let events = engine.input(at(36.0), requested()).events;
    assert_eq!(probes_of(&events)[1].1, ProbeEvent::Delayed { probe: 2, reason: ProbeDelayReason::Probe });
    let events = probes_of(&until(&mut engine, 44.5));
    assert!(matches!(events[..], [(time, ProbeEvent::Begun { probe: 2, .. })] if time == at(44.0)), "{events:?}");

    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, signal()), (21.0, requested()), (28.0, signal())]);
    let events = probes_of(&until(&mut engine, 37.0));
    assert_eq!(events, [(at(36.0), ProbeEvent::Dropped { probe: 1, reason: ProbeDelayReason::Signal })]);
    assert_eq!(engine.session().probes.dropped, [(1, ProbeDelayReason::Signal)]);
    check(&mut engine, &[(39.0, requested())]);
    assert_eq!(open(&engine).map(|open| open.number), Some(2), "numbers are not used again");
}

#[test]
fn what_questions_teach_changes_the_estimate_of_the_locations_asked_about() {
    let told = |teaches| {
        let kitchen = kitchen();
        let recipes = kitchen.aspects.iter().map(|aspect| aspect.name.clone());
        let leave_out: Vec<String> = recipes.filter(|name| name.starts_with("recipe of")).collect();
        let mut engine = on_request(|spec| {
            let leave_out = leave_out.clone();
            spec.probes = Some(ProbeSpec { per_trial: 0, teaches, leave_out, ..ProbeSpec::default() });
            // A press of the robot after the probe would change other aspects, too.
            spec.robot.initiative_s = 86_400.0;
        });
        check(&mut engine, &[(0.0, Event::TrialStarted), (30.0, requested())]);
        // The wizard skips all questions but the first.
        check(&mut engine, &[(32.0, skipped("phone"))]);
        until(&mut engine, 58.5);
        let over = &engine.session().probes.over[0];
        assert_eq!(over.shown, Some(0));
        (aspect(&kitchen, &over.questions[0].about).expect("a location"), engine.belief().clone())
    };
    let ((asked, taught), (_, untaught)) = (told(0.9), told(0.0));
    for index in 0..taught.aspects.len() {
        let is_same = taught.aspects[index] == untaught.aspects[index];
        assert_eq!(is_same, index != asked.index(), "aspect {index}, asked about {asked:?}");
    }
}

#[test]
fn advice_that_comes_in_a_probe_is_requested_again_after_it() {
    let mut engine = on_request(|spec| {
        spec.assistant.shadow = ShadowMode::On;
        (spec.assistant.rollout.rollouts, spec.assistant.rollout.least_rollouts) = (16, 8);
    });
    check(&mut engine, &[(0.0, Event::TrialStarted), (10.0, press("take rice")), (10.1, requested())]);
    let asked = engine.take_questions().pop().expect("the assistant is asked");
    let advice = engine.advisor().answer(&asked);
    assert!(refused(&mut engine, 11.0, Event::Advised(advice.clone())).contains("no trial runs"));
    check(&mut engine, &[(12.0, skipped("phone"))]);
    assert!(engine.take_questions().is_empty(), "the task stands still");
    until(&mut engine, 15.0);
    let again = engine.take_questions().into_iter().next().expect("it is asked again");
    assert_eq!(again.seq, asked.seq);
    assert_eq!(engine.advisor().answer(&again), advice, "nothing has changed");
}

#[test]
fn looks_during_a_probe_are_no_evidence() {
    let gaze = |engine: &SessionEngine| {
        let centre = engine.session().kitchen.locations[0].display.centre();
        Event::Gaze(GazeSample::new(centre[0], centre[1], 1.0))
    };
    let mut engine = on_request(|spec| spec.participant.gaze = GazeSource::Mouse);
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
    let (looked, belief) = (engine.session().gaze.looked_at, engine.belief().clone());
    let sample = gaze(&engine);
    check(&mut engine, &[(21.0, sample.clone()), (22.0, sample.clone()), (30.0, sample.clone())]);
    assert_eq!((engine.session().gaze.looked_at, engine.belief()), (looked, &belief));
    assert_eq!(engine.session().gaze.samples, 3, "they are recorded");
    until(&mut engine, 60.0);
    check(&mut engine, &[(60.1, sample)]);
    assert_ne!(engine.belief(), &belief, "after the probe they are evidence");
}

/// A simulated trial with these probes, from its events.
fn simulated(trial: u64, change: impl Fn(&mut SessionSpec)) -> (SessionEngine, Vec<TimestampedEvent>) {
    let mut files = session_file("probes");
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    change(&mut files.spec);
    let mut engine = engine_of(files, trial);
    let mut events = Vec::new();
    headless::run(&mut engine, |stamped| events.push(stamped.clone()));
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
                    let question = &asked[*question as usize - 1];
                    let chance = |choice: &String| -> f64 {
                        let values = held.values.iter().filter(|(value, _)| question.choice_for(value) == choice);
                        values.map(|(_, p)| p).sum()
                    };
                    let untold = 1.0 - held.values.values().sum::<f64>();
                    match answer {
                        Some(answer) => assert!(chance(answer) + untold >= 0.5, "{answer}: {held:?}"),
                        None => assert!(question.choices.iter().all(|choice| chance(choice) < 0.5), "{held:?}"),
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

/// A session in the middle of a trial.
fn midway() -> Session {
    let kitchen = kitchen();
    let mut spec = session_file("probes").spec;
    spec.participant.kind = ParticipantKind::Simulated;
    let mut engine = SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen));
    let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
    while engine.session().time < at(30.0) {
        engine.fire();
    }
    engine.session().clone()
}

#[test]
fn questions_come_as_often_as_their_recorded_probabilities_say() {
    const DRAWS: u32 = 20_000;
    let session = midway();
    let spec = ProbeSpec::default();
    let aspects = session.kitchen.aspects.len();
    let is_wrong: Vec<bool> = (0..aspects).map(|index| index % 7 == 3).collect();
    for is_wrong in [None, Some(&is_wrong[..])] {
        // By number of questions and aspect: how often it was drawn, and with which probability.
        let mut drawn: BTreeMap<(usize, AspectId), (u32, f64)> = BTreeMap::new();
        let mut probes = [0_u32; 5];
        let mut weights = 0.0;
        for probe in 1..=DRAWS {
            let asked = questions(&session, &spec, probe, is_wrong);
            probes[asked.len()] += 1;
            for question in &asked {
                let id = aspect(&session.kitchen, &question.about).expect("an aspect");
                let count = drawn.entry((asked.len(), id)).or_default();
                *count = (count.0 + 1, question.inclusion);
                weights += 1.0 / question.inclusion;
            }
        }
        assert_eq!(probes[..2], [0, 0]);
        let per_aspect = (2..=4).map(|number| drawn.keys().filter(|(of, _)| *of == number).count());
        assert!(per_aspect.into_iter().all(|count| count == aspects), "every aspect comes up");
        for ((number, id), (count, inclusion)) in drawn {
            let n = f64::from(probes[number]);
            let deviation = (inclusion * (1.0 - inclusion) / n).sqrt();
            let share = f64::from(count) / n;
            assert!((share - inclusion).abs() < 4.5 * deviation + 1e-6, "{number} {id:?}: {share} of {inclusion}");
            assert!(inclusion >= 0.05 - 1e-9, "{number} {id:?}: {inclusion}");
            if is_wrong.is_none() {
                assert!((inclusion - number as f64 / aspects as f64).abs() < 1e-6, "blind probes are uniform");
            }
        }
        // Weighted by their inverse, the drawn questions stand for all aspects.
        let stands_for = weights / f64::from(DRAWS);
        assert!((stands_for / aspects as f64 - 1.0).abs() < 0.02, "{stands_for} of {aspects}");
    }
}

#[test]
fn a_question_shows_nothing_first_and_at_most_twelve_answers_whatever_is_there() {
    let session = midway();
    let spec = ProbeSpec { leave_out: Vec::new(), level_2: true, ..ProbeSpec::default() };
    let mut other = session.clone();
    other.state.set_content(session.kitchen.board, session.kitchen.dishes[0].stack());
    let (mut cut, mut orders) = (0, BTreeSet::new());
    for probe in 1..=300 {
        let asked = questions(&session, &spec, probe, None);
        assert_eq!(asked, questions(&other, &spec, probe, None), "the truth changes nothing");
        for question in &asked {
            let choices = &question.choices;
            assert!(choices.len() <= 12, "{question:?}");
            let place = |name: &str| choices.iter().position(|choice| choice == name);
            let nothing = place("empty").or(place("none"));
            assert!(nothing.is_none_or(|place| place == 0), "{question:?}");
            let is_location = matches!(question.about, ProbeSubject::Location { .. });
            assert_eq!(nothing.is_some(), is_location, "{question:?}");
            if let Some(last) = place(SOMETHING_ELSE) {
                assert_eq!((last, choices.len()), (11, 12), "{question:?}");
                assert_eq!(question.choice_for("no such thing"), SOMETHING_ELSE);
                cut += 1;
            }
            if question.about == (ProbeSubject::Location { location: "order_1".to_string() }) {
                orders.insert(choices.clone());
            }
        }
    }
    assert!(cut > 100 && orders.len() > 3, "{cut} {orders:?}");
}

#[test]
fn what_is_believed_wrong_is_asked_more_often_than_what_is_not() {
    let session = midway();
    let spec = ProbeSpec::default();
    let is_wrong: Vec<bool> = (0..session.kitchen.aspects.len()).map(|index| index == 3).collect();
    let asked = |is_wrong: Option<&[bool]>| {
        let of_3 = |probe: &u32| {
            let asked = questions(&session, &spec, *probe, is_wrong);
            asked.iter().any(|question| aspect(&session.kitchen, &question.about) == Some(AspectId(3)))
        };
        (1..=500).filter(of_3).count()
    };
    assert!(asked(Some(&is_wrong)) > 2 * asked(None));
}
