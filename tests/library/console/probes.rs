//! Freeze probes at the console: the sheet at three sizes, its keys, and what it does not show.

use crossterm::event::KeyCode;
use tomcom::console::preflight::ParticipantDisplayHealth;
use tomcom::console::preflight::checks;
use tomcom::console::probe_keys::status;
use tomcom::console::{ConsoleCommand, KeyBindings, KeyFileBindings};
use tomcom_core::kitchen::{AspectId, AspectKind};
use tomcom_session::Event;
use tomcom_session::preflight_checks::PreflightVerdict;
use tomcom_session::probes::{ProbeEndReason, ProbeEvent, ProbeOrigin, ProbeQuestion, ProbeSubject};
use tomcom_session::settings::{ParticipantKind, WizardVisibility};
use tomcom_session::wall_display::AnswerDevice;

use super::{SIZES, Stage, input};
use crate::check_snapshot;

/// A console in a trial with probes, of a participant at the display, whose page is connected or not.
fn probed(kitchen: &str, has_page: bool, confidence: bool) -> Stage {
    let mut stage = Stage::new(kitchen, ParticipantKind::Display);
    let settings = format!("confidence = {confidence}");
    stage.session.spec.probes = Some(toml::from_str(&settings).expect("settings of probes"));
    let (kitchen, spec) = (stage.session.kitchen.clone(), &stage.session.spec);
    stage.model.keys = KeyBindings::live(&kitchen, spec, &KeyFileBindings::default()).expect("the keys are free");
    let page = has_page.then_some([1920, 1080]);
    stage.model.display = Some(ParticipantDisplayHealth {
        url: "http://127.0.0.1:50022".to_string(),
        page,
        ..ParticipantDisplayHealth::default()
    });
    stage.at(3.0, Event::TrialStarted);
    stage
}

/// The questions about these aspects, with their choices from the last to the first.
fn questions(stage: &Stage, aspects: &[&str]) -> Vec<ProbeQuestion> {
    let kitchen = &stage.session.kitchen;
    let question = |name: &&str| {
        let AspectId(index) = kitchen.aspect_named(name).expect("an aspect");
        let aspect = &kitchen.aspects[usize::from(index)];
        let about = match aspect.kind {
            AspectKind::Location(id) => ProbeSubject::Location { location: kitchen.location(id).name.clone() },
            AspectKind::Recipe(dish) => ProbeSubject::Recipe { dish: kitchen.dish(dish).name.clone() },
        };
        ProbeQuestion { about, choices: aspect.labels.iter().rev().cloned().collect(), inclusion: 0.5 }
    };
    aspects.iter().map(question).collect()
}

impl Stage {
    fn probe(&mut self, seconds: f64, event: ProbeEvent) {
        self.at(seconds, Event::Probe(event));
    }

    /// A probe about these aspects, of which the first question is shown.
    fn begin(&mut self, aspects: &[&str]) {
        let (origin, uses_estimate, questions) = (ProbeOrigin::Schedule, true, questions(self, aspects));
        self.probe(60.0, ProbeEvent::Begun { probe: 1, origin, uses_estimate, questions });
        self.probe(61.0, ProbeEvent::Asked { probe: 1, question: 1 });
        self.wait(2.0);
    }

    /// Types keys on the sheet, each after a moment, and returns the event of the last one.
    fn type_keys(&mut self, keys: &[KeyCode]) -> Option<ProbeEvent> {
        let mut last = None;
        for key in keys {
            self.wait(1.0);
            last = match self.key(*key) {
                Some(ConsoleCommand::Input(Event::Probe(event))) => Some(event),
                None => None,
                other => panic!("{other:?}"),
            };
        }
        last
    }
}

fn digits(text: &str) -> Vec<KeyCode> {
    text.chars().map(|letter| if letter == '\n' { KeyCode::Enter } else { KeyCode::Char(letter) }).collect()
}

const ASPECTS: [&str; 3] = ["cooking_pot", "recipe of tuna maki", "robot_hand"];

#[test]
fn the_sheet_of_a_probe_fits_every_size() {
    for size in SIZES {
        let mut stage = probed("sushi", false, false);
        stage.model.size = size;
        stage.begin(&ASPECTS);
        assert_eq!(stage.type_keys(&digits("12")), None);
        let asked = ["question 1 of 3", "http://127.0.0.1:50022", "What is in the cooking pot?", "[12] shaped rice"];
        stage.shows(size, &asked);
        if size == SIZES[0] {
            check_snapshot("console", "probe_80x24", stage.screen(size));
        }

        let mut stage = probed("sushi", true, true);
        stage.model.size = size;
        stage.begin(&ASPECTS);
        let (answer, confidence, on) = (Some("rice cooked".to_string()), Some(2), AnswerDevice::Display);
        stage.probe(66.0, ProbeEvent::Answered { probe: 1, question: 1, answer, confidence, on });
        stage.probe(66.0, ProbeEvent::Asked { probe: 1, question: 2 });
        let answered = ["1 What is in the cooking pot? cooked rice (fairly sure)", "question 2 of 3"];
        stage.shows(size, &answered);
        stage.shows(size, &["What goes into tuna maki?", "The participant answers on the display."]);

        // The longest list of both kitchens: the chosen line is in sight.
        let mut stage = probed("burger", false, false);
        stage.model.size = size;
        stage.begin(&["board", "grill_plate"]);
        assert_eq!(stage.type_keys(&digits("76")), None);
        let screen = stage.screen(size);
        assert!(screen.contains("[76]") && screen.contains("does not know"), "{screen}");
    }
}

#[test]
fn an_answer_is_entered_where_no_page_is_connected() {
    let mut stage = probed("sushi", false, false);
    stage.begin(&ASPECTS);
    let choices = questions(&stage, &ASPECTS)[0].choices.clone();
    let answered = |answer: Option<&String>, confidence| ProbeEvent::Answered {
        probe: 1,
        question: 1,
        answer: answer.cloned(),
        confidence,
        on: AnswerDevice::Console,
    };
    assert_eq!(stage.type_keys(&[KeyCode::Enter]), None, "nothing is chosen yet");
    assert!(stage.notice().contains("the number of the choice first"), "{}", stage.notice());
    assert_eq!(stage.type_keys(&digits("3\n")), Some(answered(choices.get(2), None)));
    assert_eq!(stage.type_keys(&digits("0\n")), Some(answered(None, None)));
    assert_eq!(stage.type_keys(&digits("012\n")), Some(answered(choices.get(11), None)));
    let arrows = [KeyCode::Down, KeyCode::Up, KeyCode::Enter];
    assert_eq!(stage.type_keys(&arrows), Some(answered(choices.get(11), None)));
    // A digit that would make the number too large is refused, and a digit after arrows begins a number.
    assert_eq!(stage.type_keys(&digits("99")), None);
    assert!(stage.notice().contains("no choice 99"), "{}", stage.notice());
    assert_eq!(stage.type_keys(&[KeyCode::Enter]), Some(answered(choices.get(8), None)));
    assert_eq!(
        stage.type_keys(&[KeyCode::Up, KeyCode::Char('3'), KeyCode::Enter]),
        Some(answered(choices.get(2), None))
    );
    // 11 typed quickly is no held 1.
    stage.key(KeyCode::Char('1'));
    stage.key(KeyCode::Char('1'));
    assert_eq!(stage.type_keys(&[KeyCode::Enter]), Some(answered(choices.get(10), None)));
    assert_eq!(stage.type_keys(&[KeyCode::Up, KeyCode::Char('9')]), None);
    assert_eq!(stage.type_keys(&[KeyCode::Backspace, KeyCode::Enter]), None);

    let mut stage = probed("sushi", false, true);
    stage.begin(&ASPECTS);
    assert_eq!(stage.type_keys(&digits("5\n")), None, "how sure comes next");
    assert_eq!(stage.type_keys(&digits("4")), None);
    assert!(stage.notice().contains("1, 2 or 3"), "{}", stage.notice());
    assert_eq!(stage.type_keys(&digits("3\n")), Some(answered(choices.get(4), Some(3))));
    // Whoever does not know is not asked how sure.
    let mut stage = probed("sushi", false, true);
    stage.begin(&ASPECTS);
    assert_eq!(stage.type_keys(&digits("0\n")), Some(answered(None, None)));
}

#[test]
fn the_display_answers_where_a_page_is_connected() {
    let mut stage = probed("sushi", true, false);
    stage.begin(&ASPECTS);
    for keys in ["3", "\n", "0"] {
        assert_eq!(stage.type_keys(&digits(keys)), None);
        assert_eq!(stage.notice(), "the participant answers on the display");
    }
    assert!(stage.screen((80, 24)).contains("The participant answers on the display."));
}

#[test]
fn a_probe_is_asked_for_paused_and_skipped() {
    let mut stage = probed("sushi", true, false);
    stage.wait(1.0);
    assert_eq!(input(stage.control('a')), Some(Event::Probe(ProbeEvent::Requested)));
    stage.begin(&ASPECTS);
    assert_eq!(stage.control('a'), None);
    // Signals and buttons mean nothing now; the robot stop does.
    assert_eq!(stage.key(KeyCode::Char('q')), None);
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialPaused));
    stage.at(70.0, Event::TrialPaused);
    assert!(stage.screen((120, 40)).contains("The probe is paused"), "{}", stage.screen((120, 40)));
    assert!(stage.screen((120, 40)).contains("PROBE PAUSED"));
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialResumed));
    stage.at(72.0, Event::TrialResumed);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Delete), None);
    assert!(stage.screen((80, 24)).contains("Skip the rest of probe 1: why?"), "{}", stage.screen((80, 24)));
    stage.wait(1.0);
    let reason = stage.session.spec.console.reasons[0].clone();
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(Event::Probe(ProbeEvent::Skipped { probe: 1, reason })));
    stage.probe(75.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::Skipped });
    assert!(stage.screen((80, 24)).contains("after the count-down"), "{}", stage.screen((80, 24)));
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Delete), None);
    assert_eq!(stage.notice(), "no freeze probe is open");
}

/// Reasons that were asked for one probe must not skip the next one.
#[test]
fn a_list_of_reasons_is_closed_with_its_probe() {
    let mut stage = probed("sushi", true, false);
    stage.begin(&ASPECTS);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Delete), None);
    assert!(stage.screen((120, 40)).contains("Skip the rest of probe 1: why?"));
    stage.probe(90.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver });
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(!stage.screen((120, 40)).contains("why?"), "{}", stage.screen((120, 40)));
}

#[test]
fn answers_are_seen_where_beliefs_are_and_nothing_says_whether_they_are_right() {
    for (visibility, is_seen) in [(WizardVisibility::State, false), (WizardVisibility::Belief, true)] {
        let mut screens = Vec::new();
        // The pot is empty.
        for answer in ["empty", "crab cooked"] {
            let mut stage = probed("sushi", true, false);
            stage.session.spec.console.visibility = visibility;
            stage.begin(&["cooking_pot", "counter"]);
            let (answer, confidence, on) = (Some(answer.to_string()), None, AnswerDevice::Display);
            stage.probe(66.0, ProbeEvent::Answered { probe: 1, question: 1, answer, confidence, on });
            stage.probe(66.0, ProbeEvent::Asked { probe: 1, question: 2 });
            screens.push(stage.screen((200, 60)));
        }
        let said = ["What is in the cooking pot? nothing", "What is in the cooking pot? cooked crab"];
        for (screen, said) in screens.iter().zip(said) {
            assert_eq!(screen.contains(said), is_seen, "{screen}");
        }
        // Apart from the answer the screens are the same.
        let without = |screen: &String, said: &str| screen.replace(&format!("{said:<42}"), &" ".repeat(42));
        let [right, wrong] = [without(&screens[0], said[0]), without(&screens[1], said[1])];
        assert_eq!(right, wrong);
    }
}

#[test]
fn the_head_line_and_the_preflight_checks_tell_of_probes() {
    let mut stage = probed("sushi", true, false);
    stage.wait(1.0);
    let next = status(&stage.session, &stage.model).expect("probes are scheduled");
    assert!(next.starts_with("probe 1 of 4 in ") && next.ends_with(" s"), "{next}");
    assert!(stage.screen((200, 60)).contains(&next), "{}", stage.screen((200, 60)));
    stage.begin(&ASPECTS);
    assert_eq!(status(&stage.session, &stage.model).as_deref(), Some("probe 1 of 4 \u{b7} question 1 of 3"));
    assert!(stage.screen((200, 60)).contains("PROBE"), "{}", stage.screen((200, 60)));

    let probes = |stage: &Stage| {
        let all = checks(&stage.session, &stage.model);
        let check = all.into_iter().find(|check| check.name == "probes");
        check.map(|check| (check.verdict, check.found))
    };
    let found = |where_: &str| format!("4 freeze probes in 15 min, {where_}");
    assert_eq!(probes(&probed("sushi", true, false)), Some((PreflightVerdict::Ok, found("answered on the display"))));
    let lost = Some((PreflightVerdict::Warning, found("participant's page missing")));
    assert_eq!(probes(&probed("sushi", false, false)), lost);
    assert_eq!(probes(&Stage::new("sushi", ParticipantKind::Display)), None);
}
