//! What assistants advise and send comes out the same again, beside the wizard too.

use std::sync::atomic::{AtomicU64, Ordering};

use tomcom::run::comparison_thread::ComparisonThreadHandle;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::measures::matching::ComparedContent;
use tomcom_core::mind::model::PAPER_2021;
use tomcom_people::participant::population::{Population, TraitSpread};
use tomcom_session::advisor::Advisor;
use tomcom_session::headless;
use tomcom_session::history::comparison::CommunicationContext;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};

use super::{SESSIONS, folder, session, simulated};
use crate::support::*;

/// Simulates trials of `seconds` in which the assistant acts, quickly, with these further settings; returns the folder.
fn with_assistant(name: &str, out: &str, (trials, seconds): (u64, f64), further: impl Fn(&mut SessionSpec)) -> PathBuf {
    let mut files = session(name);
    files.spec.robot.arm = ArmKind::Timed;
    (files.spec.trial.condition, files.spec.trial.seconds) = (Condition::Assistant, seconds);
    (files.spec.assistant.rollout.rollouts, files.spec.assistant.rollout.states) = (8, 8);
    further(&mut files.spec);
    let out = folder(out);
    simulate_into(files, trials, &out);
    out
}

/// Two trials in which the assistant acts by this concept, for little reason.
fn assisted(name: &str, out: &str, by: ConceptName) -> PathBuf {
    with_assistant(name, out, (2, 45.0), |spec| {
        (spec.assistant.concept, spec.assistant.cost_of_communication) = (by.into(), 0.3);
    })
}

#[test]
fn each_concept_acts_by_itself_and_comes_out_the_same_again() {
    for name in SESSIONS {
        for (by, acts, proposes) in [
            (ConceptName::TomCom, true, false),
            (ConceptName::Tom, true, false),
            (ConceptName::Dev, true, true),
            (ConceptName::None, false, false),
        ] {
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
fn an_advisor_that_works_ahead_computes_less_in_its_answers_and_answers_the_same() {
    for name in SESSIONS {
        let out = simulated(name, ArmKind::Timed, "ahead", 1, 9);
        let mut replay = RecordingReplay::open(&out.join("seed9-S001")).expect("a recording");
        let new = || Advisor::new(replay.session(), CostToGo::new(replay.session().kitchen.clone()));
        let [mut plain, mut ahead, mut hurried] = [new(), new(), new()];
        // Nor do threads change an answer.
        hurried.use_threads(2);
        let mut computed = [0; 2];
        while let Some(question) = replay.next_question().expect("a line") {
            let before = [&plain, &ahead].map(Advisor::computed_decisions);
            let answer = plain.answer(&question);
            assert_eq!((ahead.answer(&question), hurried.answer(&question)), (answer.clone(), answer), "{name}");
            for (sum, (after, before)) in
                computed.iter_mut().zip([&plain, &ahead].map(Advisor::computed_decisions).into_iter().zip(before))
            {
                *sum += after - before;
            }
            ahead.work_ahead(&question, &|| true);
            // The next request may come at any time.
            let asked = AtomicU64::new(0);
            hurried.work_ahead(&question, &|| asked.fetch_add(1, Ordering::Relaxed) + 1 < question.seq % 40);
        }
        let [without, with] = computed;
        assert!(10 * with < 9 * without, "{name}: {with} decisions instead of {without}");
    }
}

/// With gaze and without, a replay asks at the events after which the running session asked.
#[test]
fn a_replay_asks_what_the_running_session_asked() {
    for name in SESSIONS {
        for gaze in [GazeSource::Simulated, GazeSource::None] {
            let out = with_assistant(name, &format!("asks-{gaze:?}"), (1, 60.0), |spec| spec.participant.gaze = gaze);
            let log = out.join("seed1-S001");
            let mut reader = LogReader::open(&log).expect("a recording");
            let mut asked = Vec::new();
            while let Some(line) = reader.next_line().expect("a line") {
                if let Event::Advised(advice) = line.stamped.event {
                    asked.push((advice.for_seq, advice));
                }
            }
            let mut replay = RecordingReplay::open(&log).expect("a recording");
            let mut advisor = Advisor::new(replay.session(), CostToGo::new(replay.session().kitchen.clone()));
            let mut again = Vec::new();
            while let Some(question) = replay.next_question().expect("a line") {
                again.push((question.seq, advisor.answer(&question)));
            }
            assert!(asked.len() > 10, "{name}, {gaze:?}: {} requests", asked.len());
            assert_eq!(again, asked, "{name}, {gaze:?}");
        }
    }
}

#[test]
fn what_is_asked_in_silence_comes_out_the_same_again() {
    for name in SESSIONS {
        let out = with_assistant(name, "other-moments", (2, 90.0), |spec| {
            let stuck = TraitSpread { median: 0.3, sigma: 0.0 };
            spec.participant.population = Some(Population { gets_stuck: stuck, ..Population::default() });
        });
        let mut counts = [0; 2];
        for trial in ["seed1-S001", "seed1-S002"] {
            let log = out.join(trial).join(LOG_NAME);
            let found = verify(&log).expect("a recording");
            assert!(found.verified, "{name}: {:?}", found.difference);
            let mut reader = LogReader::open(&log).expect("a recording");
            let mut asked = Vec::new();
            while let Some(line) = reader.next_line().expect("a line") {
                match line.stamped.event {
                    Event::HumanWaits { .. } => counts[0] += 1,
                    Event::Advised(advice) => counts[1] += usize::from(asked.contains(&advice.for_seq)),
                    _ => continue,
                }
                asked.push(line.stamped.seq);
            }
        }
        assert!(counts.iter().all(|&count| count > 0), "{name}: {counts:?}");
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
fn pressed_on(name: &str, sent: &[(f64, Signal)]) -> (SessionSetup, Vec<TimestampedEvent>) {
    let mut files = session(name);
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    files.spec.assistant.concept = ConceptName::Tom.into();
    // There is no tracker; they look at nothing, so that only signals tell them something.
    (files.spec.human.looking.looks_hz, files.spec.human.looking.other_looks_hz) = (0.0, 0.0);
    files.spec.human.looking.capture = 0.0;
    // A signal is believed at once: what is tried is from when on it counts.
    files.spec.human.signal = PAPER_2021.signal;
    let kitchen = Arc::new(files.kitchen.kitchen.clone());
    let mut engine = SessionEngine::new(kitchen.clone(), files.spec.clone(), 0, CostToGo::new(kitchen.clone()));
    let mut random = stream(4, "presses", 0);
    let mut inputs = vec![(0.0, Event::TrialStarted)];
    let buttons = &kitchen.buttons[Agent::Human.index()];
    inputs.extend((1..40).map(|number| {
        let button = buttons[random.random_range(0..buttons.len())].name.clone();
        (2.0 * f64::from(number), Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false })
    }));
    inputs.extend(sent.iter().map(|(time_s, signal)| {
        (*time_s, Event::SignalShown { by: Sender::Wizard, signal: signal.clone(), offer: None })
    }));
    inputs.push((80.0, Event::TrialEnded { reason: TrialEndReason::Wizard }));
    inputs.push((81.0, Event::SessionEnded));
    inputs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let take = |(time_s, event): (f64, Event)| {
        let outcome = engine.input(at(time_s), event);
        assert_eq!(outcome.refused, None);
        outcome.events
    };
    let events = inputs.into_iter().flat_map(take).collect();
    (files, events)
}

#[test]
fn advice_that_nobody_sees_changes_nothing_else() {
    let told = |shadow: ShadowMode| {
        let mut files = session("default.toml");
        (files.spec.robot.arm, files.spec.assistant.shadow) = (ArmKind::Timed, shadow);
        (files.spec.trial.condition, files.spec.trial.seconds) = (Condition::None, 60.0);
        let mut engine = engine_of(files, 3);
        let (mut told, mut advised) = (Vec::new(), 0);
        headless::run(&mut engine, |stamped| match &stamped.event {
            Event::Advised(_) => advised += 1,
            // Offers are that advice as a wizard would see it.
            Event::OfferOpened(_) | Event::OfferClosed { .. } => {}
            // The number of the press in the log counts the advice, too.
            Event::BeliefEstimated(witness) => told.push(format!("{:?} {:?}", witness.log_p, witness.aspects)),
            event => told.push(format!("{:?} {event:?}", stamped.time)),
        });
        (told, advised)
    };
    let ((told_beside, advised), (told_alone, none)) = (told(ShadowMode::On), told(ShadowMode::Off));
    assert!(advised > 20 && none == 0, "{advised} answers, and {none}");
    assert_eq!(told_beside, told_alone);
}

/// What was known at every moment at which the concepts were asked, with the presses of the human until then.
fn asked(
    files: &SessionSetup,
    events: &[TimestampedEvent],
    window: u32,
) -> (Vec<(u32, Arc<CommunicationContext>)>, SenderComparisonFollower) {
    let request = SenderComparisonSettings { with: vec![ConceptName::Dev], window };
    let kitchen = Arc::new(files.kitchen.kitchen.clone());
    let session = Session::new(kitchen.clone(), files.spec.clone(), 0);
    let mut watcher = SenderComparisonFollower::new(session, CostToGo::new(kitchen), &request);
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
        let place = |signal: &Signal| signal.location(kitchen).expect("a location");
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
    files.spec.assistant.concept = ConceptName::Tom.into();
    let out = folder("shadow");
    simulate_into(files, 1, &out);
    let mut log = LogReader::open(&out.join("seed1-S001")).expect("a recording");
    let request = SenderComparisonSettings { with: vec![ConceptName::Dev], window: 3 };
    let watcher = || SenderComparisonFollower::new(log.session(), CostToGo::new(log.kitchen.clone()), &request);
    let (mut here, there) = (watcher(), ComparisonThreadHandle::start(watcher()));
    let mut compared = 0;
    // Locations that were known or had just changed, each with the number of presses until then.
    let mut renewed: Vec<(u32, LocationId)> = Vec::new();
    let mut before = log.session().state;
    while let Some(line) = log.next_line().expect("an event") {
        here.apply(&line.stamped).expect("an event of the session");
        let (session, belief) = (&here.follower.session, here.follower.filter.belief());
        for location in (0..session.kitchen.locations.len()).map(|index| LocationId(index as u8)) {
            let p_truth = belief.p_truth(&session.kitchen, session.state, AspectId::of_location(location));
            if p_truth > 0.9 || session.state.code(location) != before.code(location) {
                renewed.push((here.presses(), location));
            }
        }
        before = session.state;
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
    let mut last: Vec<((ComparedContent, u8), u32)> = Vec::new();
    let mut again = 0;
    for spoken in &found.lanes[1].spoken {
        let (said, state) = (spoken.said, spoken.known.as_ref().expect("an answer").state);
        let place = said.content.target.expect("a signal is about a place");
        let what = (said.content, state.code(place));
        match last.iter_mut().find(|(other, _)| *other == what) {
            Some((_, press)) => {
                // It may be said again once something else lay there, or it was known and is not any more.
                let is_renewed =
                    renewed.iter().any(|(at, other)| *other == place && (*press..=said.press).contains(at));
                assert!(is_renewed || said.press > *press + request.window, "{said:?} after press {press}");
                (*press, again) = (said.press, again + 1);
            }
            None => last.push((what, said.press)),
        }
    }
    assert!(again > 0, "what nobody shows stays to be said");
    assert_eq!(there.last(), Some(found));
}
