//! Freeze probes by hand: when they begin, how they end, and what is refused.

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::gaze::GazeSample;
use tomcom_session::engine::SessionEngine;
use tomcom_session::event::TrialEndReason;
use tomcom_session::probe_sampling::aspect;
use tomcom_session::probes::{ProbeDelayReason, ProbeEndReason, ProbeEvent, ProbeOrigin};
use tomcom_session::settings::{Condition, GazeSource, ProbeSpec, SessionSpec};
use tomcom_session::wall_display::AnswerDevice;
use tomcom_session::{Event, TimestampedEvent, TrialPhase};

use super::{at, check, engine, kitchen, press, refused};

/// A session in which nothing is scheduled in the first minutes, so that the wizard asks for probes.
pub fn on_request(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    engine(|spec| {
        spec.trial.condition = Condition::Wizard;
        spec.probes = Some(ProbeSpec { per_trial: 0, ..ProbeSpec::default() });
        change(spec);
    })
}

fn probe(event: ProbeEvent) -> Event {
    Event::Probe(event)
}

fn requested() -> Event {
    probe(ProbeEvent::Requested)
}

/// The first choice as the answer to a question.
fn answered(engine: &SessionEngine, question: u32) -> Event {
    let open = engine.session().probes.open.as_ref().expect("a probe is held");
    let answer = Some(open.questions[question as usize - 1].choices[0].clone());
    probe(ProbeEvent::Answered { probe: open.number, question, answer, confidence: None, on: AnswerDevice::Display })
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
    engine.input(at(seconds), Event::Marker { note: "now".to_string() }).events
}

#[test]
fn a_probe_freezes_the_task_asks_one_question_after_another_and_counts_down() {
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, press("take rice"))]);
    let state = engine.session().state;
    check(&mut engine, &[(20.0, requested())]);
    assert_eq!((engine.session().phase, engine.session().is_frozen()), (TrialPhase::Paused, true));
    assert!(engine.session().probes.open.as_ref().is_some_and(|open| open.question().is_none()), "blank first");
    let before = engine.session().state;
    until(&mut engine, 22.0);
    let number = engine.session().probes.open.as_ref().map_or(0, |open| open.questions.len());
    assert!((2..=4).contains(&number), "{number} questions");
    let mut seconds = 22.0;
    for question in 1..=number as u32 {
        let answer = answered(&engine, question);
        check(&mut engine, &[(seconds, press("counter")), (seconds, answer)]);
        seconds += 1.0;
    }
    let last = seconds - 1.0;
    assert_eq!(
        engine.session().probes.open.as_ref().and_then(|open| open.closed),
        Some((ProbeEndReason::Answered, at(last)))
    );
    until(&mut engine, last + 2.9);
    assert_eq!(engine.session().trial_clock(at(last + 2.9)), at(20.0), "the trial's clock stands still");
    assert_eq!(
        (engine.session().state, engine.session().presses[0]),
        (before, 1),
        "presses in it have no effect: {state:?}"
    );
    until(&mut engine, last + 3.1);
    assert_eq!((engine.session().phase, engine.session().is_frozen()), (TrialPhase::Running, false));
    assert_eq!(engine.session().trial_clock(at(last + 3.1)), at(20.1));
    let over = &engine.session().probes.over[0];
    assert!(over.answers.iter().all(Option::is_some));
    assert_eq!(over.answers[0].as_ref().map(|answer| answer.took), Some(at(1.0)), "the question came at 21 s");
}

#[test]
fn after_its_time_a_probe_closes_and_late_answers_are_refused() {
    let mut engine = on_request(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (20.0, requested())]);
    until(&mut engine, 24.0);
    let late = answered(&engine, 1);
    let events = probes_of(&until(&mut engine, 45.5));
    assert_eq!(events, [(at(45.0), ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver })]);
    assert!(refused(&mut engine, 46.0, late).contains("questions are over"), "late answers");
    let events = probes_of(&until(&mut engine, 50.0));
    assert_eq!(events, [(at(48.0), ProbeEvent::Ended { probe: 1 })]);
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
        probe(ProbeEvent::Answered { probe: 1, question: 1, answer, confidence, on: AnswerDevice::Console })
    };
    assert!(refused(&mut engine, 22.0, answer("a violin", None)).contains("no such choice"));
    let choice = engine.session().probes.open.as_ref().expect("a probe").questions[0].choices[0].clone();
    assert!(refused(&mut engine, 22.0, answer(&choice, Some(2))).contains("confidence"), "it is not asked");
    assert!(refused(&mut engine, 22.0, requested()).contains("already"));
    let corrected = Event::KitchenCorrected { location: "counter".to_string(), content: "nori".to_string() };
    assert!(refused(&mut engine, 22.0, corrected).contains("after the freeze probe"));
    let unknown = probe(ProbeEvent::Answered {
        probe: 1,
        question: 1,
        answer: None,
        confidence: None,
        on: AnswerDevice::Display,
    });
    check(&mut engine, &[(23.0, unknown)]);
    let no_reason = probe(ProbeEvent::Skipped { probe: 1, reason: " ".to_string() });
    assert!(refused(&mut engine, 23.0, no_reason).contains("reason"));
    check(&mut engine, &[(24.0, probe(ProbeEvent::Skipped { probe: 1, reason: "phone".to_string() }))]);
    let closed = engine.session().probes.open.as_ref().and_then(|open| open.closed);
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
    let took =
        engine.session().probes.open.as_ref().and_then(|open| open.answers[0].as_ref().map(|answer| answer.took));
    assert_eq!(took, Some(at(2.0)), "1 s before the pause and 1 s after it");
    let events = probes_of(&until(&mut engine, 200.0));
    assert!(
        events.contains(&(at(125.0), ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver })),
        "{events:?}"
    );
    assert_eq!(events.last(), Some(&(at(128.0), ProbeEvent::Ended { probe: 1 })));
    assert_eq!(engine.session().trial_clock(at(128.0)), at(20.0));
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
    assert!(
        matches!(events[..], [(time, ProbeEvent::Begun { origin: ProbeOrigin::Wizard, .. })] if time == at(30.0)),
        "{events:?}"
    );
    check(&mut engine, &[(31.0, probe(ProbeEvent::Skipped { probe: 1, reason: "phone".to_string() }))]);
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
    assert_eq!(engine.session().probes.open.as_ref().map(|open| open.number), Some(2), "numbers are not used again");
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
        // Nobody answers: one question is asked.
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
    check(&mut engine, &[(12.0, probe(ProbeEvent::Skipped { probe: 1, reason: "phone".to_string() }))]);
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
