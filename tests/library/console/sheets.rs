//! The sheets around and in a trial: instruction, questionnaire, debriefing, tutorial, freeze probes.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::form::{FormContent, sheet};
use tomcom::console::lists::ReasonFor;
use tomcom::console::preflight::{ParticipantDisplayHealth, checks};
use tomcom::console::probe_keys::status;
use tomcom::console::text_input::TextInput;
use tomcom::console::{ConsoleCommand, KeyBindings, KeyFileBindings};
use tomcom_session::files::parse::parse;
use tomcom_session::plan::{PhaseSpec, QuestionnaireSpec, TutorialStepKind};
use tomcom_session::preflight_checks::PreflightVerdict;
use tomcom_session::probes::{ProbeEndReason, ProbeOrigin, ProbeQuestion, ProbeSubject};
use tomcom_session::protocol::StudyPhase;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};

use super::{SIZES, Stage, input};
use crate::support::*;

/// The console of a recording of the study's first participant.
fn planned(slot: usize, instructed: bool) -> Stage {
    let study = session_file("study").study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed });
    Stage::of_session(spec)
}

impl Stage {
    /// The console of a session of the study, in its first phase.
    fn of_session(spec: SessionSpec) -> Stage {
        let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
        stage.session = Session::new(kitchen("sushi"), spec, 0);
        stage.next_phase();
        stage
    }

    fn next_phase(&mut self) {
        let (phase, number) = (self.session.next_phase(), self.session.protocol.as_ref().map(|it| it.number + 1));
        let (phase, number) = phase.zip(number).expect("one more phase");
        let now_s = self.session.time.as_secs_f64();
        self.at(now_s, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
    }
}

#[test]
fn the_sheets_around_a_trial_fit_every_size() {
    for size in SIZES {
        let mut stage = planned(0, false);
        stage.model.size = size;
        stage.shows(size, &["INSTRUCTION", "P01 practice", "Ask for questions.", "tick this step as done"]);
        let mut stage = planned(2, true);
        stage.model.size = size;
        stage.shows(size, &["P01 trial 2/2 wizard"]);
        stage.at(0.0, Event::TrialStarted);
        stage.shows(size, &["P01 trial 2/2 wizard"]);
        stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
        stage.shows(size, &[". next phase: questionnaire"]);
        stage.at(9.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 }));
        let item = "too_often".to_string();
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemAnswered { item: item.clone(), answer: 6_u8.into() }));
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemShown { item }));
        let item = ["The signals were given too often.", "[6]", "strongly agree", "0 no answer", "enter next item"];
        stage.shows(size, &item);
        stage.shows(size, &["QUESTIONNAIRE"]);
        stage.at(9.0, Event::Protocol(ProtocolEvent::AnswersShown));
        stage.shows(size, &["6 The signals were given too often.", "to the item without an answer"]);
    }
}

#[test]
fn every_sheet_says_what_to_open_while_the_participants_page_is_missing() {
    for size in SIZES {
        for (slot, instructed) in [(0, false), (2, true)] {
            let mut stage = planned(slot, instructed);
            stage.session.spec.participant.kind = ParticipantKind::Display;
            let health = ParticipantDisplayHealth {
                url: "http://192.168.1.5:50022".to_string(),
                code: Some("481516".to_string()),
                ..ParticipantDisplayHealth::default()
            };
            stage.model.size = size;
            stage.model.display = Some(health.clone());
            let told = ["http://192.168.1.5:50022", "481516"];
            stage.shows(size, &told);
            if instructed {
                // The card before the trial, the one after it, and the questionnaire.
                stage.at(0.0, Event::TrialStarted);
                stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
                stage.shows(size, &told);
                let (phase, number) = (StudyPhase::Questionnaire, 2);
                stage.at(9.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
                stage.shows(size, &told);
            }
            stage.model.display = Some(ParticipantDisplayHealth { page: Some([1920, 1080]), ..health });
            assert!(!stage.screen(size).contains("481516"), "a page is connected");
        }
    }
}

#[test]
fn the_keys_of_a_sheet_make_events_and_a_held_one_answers_once() {
    let mut stage = planned(0, false);
    let told = |command: Option<ConsoleCommand>| match command {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    let first = told(stage.key(KeyCode::Enter));
    assert_eq!(first, ProtocolEvent::Ticked { step: 1, done: true });
    stage.at(0.0, Event::Protocol(first));
    // The key is still down: nothing more is ticked.
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.model.clock = at(2.0);
    for arrow in [KeyCode::Right, KeyCode::Left, KeyCode::Down, KeyCode::Up] {
        assert_eq!(stage.key(arrow), None, "arrows tick nothing");
        assert!(stage.notice().contains("enter ticks the step"), "{}", stage.notice());
    }
    assert_eq!(stage.key(KeyCode::Char('.')), None, "the start key leaves only what is complete");
    assert!(!stage.notice().is_empty());
    assert_eq!(told(stage.key(KeyCode::Backspace)), ProtocolEvent::Ticked { step: 1, done: false });
    // Signals, markers and the kitchen wait for the trial; the robot stop does not.
    assert_eq!(stage.key(KeyCode::Char('q')), None);
    assert_eq!(stage.key(KeyCode::Char('1')), None);
    assert_eq!(stage.key(KeyCode::Char(' ')), Some(ConsoleCommand::Input(Event::RobotStopped)));
}

#[test]
fn a_question_of_the_debriefing_is_answered_in_words_as_a_note() {
    let mut stage = planned(2, true);
    stage.at(0.0, Event::TrialStarted);
    stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    while stage.session.study_phase().map(PhaseSpec::phase) != Some(StudyPhase::Debriefing) {
        // As if the questionnaires were answered.
        stage.session.protocol.as_mut().expect("a plan").confirmed = true;
        stage.next_phase();
    }
    stage.shows_everywhere(&["a-z answer in words"]);
    "no".chars().for_each(|letter| assert_eq!(stage.key(KeyCode::Char(letter)), None));
    stage.shows_everywhere(&["Did you recognise the participant's mistakes in time?"]);
    let note = "Did you recognise the participant's mistakes in time? Note what you missed. no".to_string();
    let answered = stage.key(KeyCode::Enter);
    assert_eq!(answered, Some(ConsoleCommand::Input(Event::Marker { note, observer: None })));
    assert!(stage.notice().contains("enter ticks the step"), "{}", stage.notice());
}

#[test]
fn only_enter_confirms_answers_and_a_reason_to_go_on() {
    let mut stage = planned(2, true);
    stage.at(0.0, Event::TrialStarted);
    stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    let questionnaire = ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 };
    stage.at(9.0, Event::Protocol(questionnaire));
    let Some(FormContent::Questions(questionnaire)) = sheet(&stage.session) else { panic!("a questionnaire") };
    let items = questionnaire.items.len();
    for arrow in [KeyCode::Right, KeyCode::Left] {
        assert!(matches!(give(&mut stage, arrow), ProtocolEvent::ItemShown { .. }), "arrows go between items");
    }
    // A digit chooses, and only enter goes on: every item is answered once.
    for item in 0..items {
        stage.wait(1.0);
        assert_eq!(stage.key(KeyCode::Char('2')), None);
        assert_eq!(stage.key(KeyCode::Char('3')), None, "the choice changes until enter");
        assert_eq!(stage.session.protocol.as_ref().map(|protocol| protocol.item), Some(item));
        for size in SIZES {
            stage.shows(size, &["[3]"]);
        }
        let event = give(&mut stage, KeyCode::Enter);
        assert!(matches!(event, ProtocolEvent::ItemAnswered { answer: AnswerValue::Number(3), .. }), "{event:?}");
    }
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Right), None, "{}", stage.notice());
    assert!(stage.notice().contains("enter confirms"), "{}", stage.notice());
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::AnswersConfirmed);
}

/// The sheet of a questionnaire about the person: an item of every kind.
#[test]
fn numbers_and_words_are_typed() {
    let mut stage = asked(&["demographics.toml"]);
    // A number is checked before it is sent.
    write(&mut stage, "7");
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("out of the item's range"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    write(&mut stage, "31");
    assert_eq!(answered(&mut stage, KeyCode::Enter), "age 31");
    // Words may have spaces and full stops, which are keys of the console elsewhere.
    write(&mut stage, "q. x y");
    look_at(&mut stage, &["What is your gender?", " q. x y ", "enter save the text", "letters type answer"]);
    assert_eq!(answered(&mut stage, KeyCode::Enter), r#"gender "q. x y""#);
}

#[test]
fn a_paste_is_typed_into_an_item_that_is_answered_by_typing_and_no_other() {
    let mut stage = asked(&["demographics.toml"]);
    assert_eq!(stage.paste(Some("7,5")), None);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("whole number"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    stage.key(KeyCode::Backspace);
    assert_eq!(stage.paste(Some("5\n")), None);
    assert_eq!(answered(&mut stage, KeyCode::Enter), "age 75");
    assert_eq!(stage.paste(Some("please call me")), None);
    assert_eq!(answered(&mut stage, KeyCode::Enter), r#"gender "please call me""#);
    assert_eq!(stage.paste(Some("2")), None);
    assert!(stage.notice().contains("paste only into a text field"), "{}", stage.notice());
}

#[test]
fn options_are_chosen_with_digits() {
    let mut stage = asked(&["demographics.toml"]);
    write(&mut stage, "31");
    give(&mut stage, KeyCode::Enter);
    write(&mut stage, "q. x y");
    give(&mut stage, KeyCode::Enter);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('4')), None, "the item has three options");
    assert_eq!(stage.key(KeyCode::Char('2')), None);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Left), None);
    assert!(stage.notice().contains("enter keeps the answer"), "{}", stage.notice());
    assert_eq!(answered(&mut stage, KeyCode::Enter), r#"handedness "left""#);
    // Of several, each key chooses one or takes it back; the item stays until enter.
    assert_eq!(answered(&mut stage, KeyCode::Char('3')), r#"vision_aids ["lenses"]"#);
    assert_eq!(answered(&mut stage, KeyCode::Char('2')), r#"vision_aids ["glasses","lenses"]"#);
    assert_eq!(answered(&mut stage, KeyCode::Char('3')), r#"vision_aids ["glasses"]"#);
    look_at(
        &mut stage,
        &["What do you wear today to see well?", "[2] glasses", " 3  contact lenses", "1-4 choose several"],
    );
    stage.model.size = (80, 24);
    check_snapshot("console", "item_choice_80x24", stage.screen((80, 24)));
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::ItemShown { item: "colour_vision".to_string() });
    stage.key(KeyCode::Delete);
    look_at(&mut stage, &["no answer"]);
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::ItemSkipped { item: "colour_vision".to_string() });
    for _ in 0..3 {
        stage.wait(1.0);
        assert_eq!(stage.key(KeyCode::Char('5')), None);
        give(&mut stage, KeyCode::Enter);
    }
    let screen = stage.screen((120, 40));
    assert!(screen.contains("31 years") && screen.contains("q. x y") && screen.contains("glasses"), "{screen}");
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::AnswersConfirmed);
}

#[test]
fn the_position_of_a_slider_is_typed_in_its_steps() {
    let mut stage = asked(&["nasa-tlx.toml"]);
    write(&mut stage, "42");
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("steps"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    write(&mut stage, "5");
    assert_eq!(answered(&mut stage, KeyCode::Enter), "mental 45");
    let steps = "from 0 (very low) to 100 (very high), in steps of 5";
    look_at(&mut stage, &["Mental demand: How mentally demanding was the task?", steps, " 45 ", "0-9 type position"]);
}

/// The event that a key sends, which then happens.
fn give(stage: &mut Stage, key: KeyCode) -> ProtocolEvent {
    stage.wait(1.0);
    let event = match stage.key(key) {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    stage.at(stage.model.now.as_secs_f64(), Event::Protocol(event.clone()));
    event
}

/// The item and the answer that a key gives.
fn answered(stage: &mut Stage, key: KeyCode) -> String {
    match give(stage, key) {
        ProtocolEvent::ItemAnswered { item, answer } => format!("{item} {}", serde_json::json!(answer)),
        other => panic!("{other:?}"),
    }
}

fn write(stage: &mut Stage, words: &str) {
    for letter in words.chars() {
        assert_eq!(stage.key(KeyCode::Char(letter)), None, "{letter}: {}", stage.notice());
    }
}

/// The sheet at every size has to say all of this.
fn look_at(stage: &mut Stage, words: &[&str]) {
    for size in SIZES {
        stage.model.size = size;
        stage.shows(size, words);
    }
}

#[test]
fn the_sheet_of_the_tutorial_tells_where_the_participant_is() {
    for size in SIZES {
        let study = session_file("study").study().expect("a plan");
        let mut stage = Stage::new("sushi", ParticipantKind::Display);
        let spec = study.tutorial_alone("P07").expect("a tutorial");
        stage.session = Session::new(kitchen("sushi"), spec, 0);
        stage.next_phase();
        let mut now_s = 0.0;
        let mut give = |stage: &mut Stage, event| {
            now_s += 1.0;
            stage.at(now_s, Event::Protocol(ProtocolEvent::Tutorial(event)));
        };
        while let Some((step, state)) = stage.session.tutorial_step() {
            let (step, index) = (step.clone(), state.step);
            if step.kind == TutorialStepKind::Question {
                // Wrong at first.
                let right = step.right.expect("a right choice");
                let wrong = right % step.choices.len() as u8 + 1;
                for choice in [wrong, right] {
                    give(&mut stage, TutorialEvent::Answered { step: step.id.clone(), choice });
                }
                break;
            }
            // What the robot presses in its step is shown, and no press of the participant's.
            for button in step.presses.iter().filter(|_| step.kind != TutorialStepKind::Robot) {
                give(&mut stage, TutorialEvent::Pressed { button: button.clone() });
            }
            let (tutorial, _) = stage.session.tutorial().expect("a tutorial");
            let next = tutorial.steps[index + 1].id.clone();
            give(&mut stage, TutorialEvent::Shown { step: next, by: TutorialPageTurner::Wizard });
        }
        stage.model.size = size;
        let screen = stage.shows(size, &["Tutorial of the participant", "wrong answers: 1", "0 ends the tutorial"]);
        if size == SIZES[0] {
            check_snapshot("console", "tutorial_80x24", screen);
        }
        // One key does not end it: what is left of it cannot be shown again.
        assert_eq!(stage.key(KeyCode::Char('0')), None);
        stage.shows(size, &["End the tutorial?", "The participant does not see its other pages,"]);
        let ended = TutorialEvent::Ended { by: TutorialPageTurner::Wizard };
        assert_eq!(input(stage.key(KeyCode::Char('y'))), Some(Event::Protocol(ProtocolEvent::Tutorial(ended))));
    }
}

/// The console of a recording that begins with these questionnaires.
fn asked(names: &[&str]) -> Stage {
    let mut files = session_file("study");
    let plan = files.spec.plan.as_mut().expect("a plan");
    (plan.questionnaire, files.questionnaires) = (Vec::new(), Vec::new());
    for name in names {
        let path = Path::new("sessions/questionnaires").join(name);
        let text = std::fs::read_to_string(&path).expect("a questionnaire");
        let file = path.display().to_string();
        plan.questionnaire.push(QuestionnaireSpec { file, after: None, before: true });
        files.questionnaires.push(parse(&path, &text).expect("a questionnaire"));
    }
    let study = files.study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot: 1, attempt: 1, instructed: true });
    Stage::of_session(spec)
}

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
        stage.shows(size, &["[76]", "does not know"]);
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
    stage.shows((80, 24), &["The participant answers on the display."]);
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
    stage.shows((120, 40), &["The probe is paused", "PROBE PAUSED"]);
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Char('.'))), Some(Event::TrialResumed));
    stage.at(72.0, Event::TrialResumed);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Delete), None);
    stage.shows((80, 24), &["Skip the rest of probe 1: why?"]);
    stage.wait(1.0);
    let reason = stage.session.spec.console.reasons[0].clone();
    assert_eq!(stage.key(KeyCode::Enter), None, "words can follow");
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(Event::Probe(ProbeEvent::Skipped { probe: 1, reason })));
    stage.probe(75.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::Skipped });
    stage.shows((80, 24), &["after the count-down"]);
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
    stage.shows((120, 40), &["Skip the rest of probe 1: why?"]);
    let (probe, field) = (stage.session.clone(), {
        let mut words = stage.model.clone();
        words.dialog = Some(Dialog::Reason(ReasonFor::SkipProbe(1), "interrupted".to_string(), TextInput::default()));
        words
    });
    stage.probe(90.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver });
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.hides((120, 40), &["why?"]);
    // So is the field for the words of a reason.
    (stage.session, stage.model) = (probe, field);
    stage.shows((120, 40), &["interrupted: in words"]);
    stage.probe(90.0, ProbeEvent::Closed { probe: 1, reason: ProbeEndReason::TimeOver });
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.hides((120, 40), &["in words"]);
}

/// A practice whose criterion is not met.
fn failed_practice() -> Stage {
    let mut stage = planned(0, true);
    stage.at(0.0, Event::TrialStarted);
    stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    let checked = ProtocolEvent::CriterionChecked { met: false, orders: 0, presses: 0, errors: 0 };
    stage.at(9.0, Event::Protocol(checked));
    stage
}

#[test]
fn a_practice_criterion_is_waived_for_a_preset_reason_or_in_words() {
    let waived = |command| match input(command) {
        Some(Event::Protocol(ProtocolEvent::CriterionWaived { reason })) => reason,
        other => panic!("{other:?}"),
    };
    let mut stage = failed_practice();
    stage.shows_everywhere(&["enter practise again", "1-4 choose a reason", "letters its words", "other reason"]);
    assert_eq!(stage.key(KeyCode::Enter), Some(ConsoleCommand::Next), "without a reason it is practised again");
    let mut stage = failed_practice();
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('2')), None);
    stage.shows_everywhere(&["[2] no time", "enter waive for this reason", "bksp none"]);
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.shows_everywhere(&["no time for more practice: in words"]);
    stage.wait(1.0);
    assert_eq!(waived(stage.key(KeyCode::Enter)), "no time for more practice");
    // Letters begin the words of another reason, which needs them.
    let mut stage = failed_practice();
    stage.wait(1.0);
    write(&mut stage, "He is a cook");
    stage.wait(1.0);
    assert_eq!(waived(stage.key(KeyCode::Enter)), "other reason: He is a cook");
    let mut stage = failed_practice();
    stage.wait(1.0);
    stage.key(KeyCode::Char('4'));
    stage.key(KeyCode::Enter);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("another reason needs words"), "{}", stage.notice());
    stage.key(KeyCode::Esc);
    stage.shows_everywhere(&["enter practise again"]);
}

#[test]
fn after_a_trial_of_a_plan_a_digit_is_no_note_and_the_keys_name_what_follows() {
    let mut stage = planned(2, true);
    stage.at(0.0, Event::TrialStarted);
    stage.wait(1.0);
    assert!(matches!(input(stage.key(KeyCode::Char('3'))), Some(Event::Marker { .. })), "in the trial it is one");
    let mut aborted = planned(2, true);
    aborted.at(0.0, Event::TrialStarted);
    stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.shows_everywhere(&[". next phase: questionnaire"]);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('3')), None);
    assert!(stage.notice().contains("a digit is no note"), "{}", stage.notice());
    assert!(!stage.screen((120, 40)).contains("1-5 note"));
    // The key that goes on repeats an aborted trial, which is left out already.
    aborted.at(9.0, Event::TrialPaused);
    aborted.at(9.0, Event::TrialAborted { reason: "interrupted".to_string() });
    let screen = aborted.shows((120, 40), &["left out of the analysis; . repeats the trial", ". repeat the trial"]);
    assert!(!screen.contains("^n") && !screen.contains("exclude the trial"), "{screen}");
    aborted.wait(1.0);
    assert_eq!(aborted.control('l'), None);
    assert!(aborted.notice().contains("left out already"), "{}", aborted.notice());
    // The last key of the series does not promise another recording.
    let mut practice = failed_practice();
    practice.at(9.0, Event::Protocol(ProtocolEvent::CriterionWaived { reason: "no time".to_string() }));
    practice.shows((120, 40), &[". next recording"]);
    practice.model.is_last_recording = true;
    practice.shows((120, 40), &[". end the series"]);
}

#[test]
fn a_console_names_the_arm_of_the_plan() {
    let mut files = session_file("study");
    let plan = files.spec.plan.as_mut().expect("a plan");
    plan.conditions = vec![StudyArm::None, StudyArm::WizardWithAdvice];
    let study = files.study().expect("a plan");
    let slot = study.slots(0).iter().position(|slot| slot.condition == StudyArm::WizardWithAdvice).expect("a trial");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed: true });
    let mut stage = Stage::of_session(spec);
    stage.shows((120, 40), &["/2, wizard with advice"]);
    stage.at(0.0, Event::TrialStarted);
    stage.shows((120, 40), &["/2 wizard with advice"]);
}

/// A repeated trial is that of which the display froze, so the head line keeps its state.
#[test]
fn a_repeated_trial_keeps_the_state_of_the_display_in_the_head_line() {
    let study = session_file("study").study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot: 1, attempt: 2, instructed: true });
    let mut stage = Stage::of_session(spec);
    stage.model.display = Some(ParticipantDisplayHealth {
        redraw_ms: Some(84.0),
        page: Some([1920, 1080]),
        ..ParticipantDisplayHealth::default()
    });
    stage.at(0.0, Event::TrialStarted);
    let head = |size| stage.screen(size).lines().next().expect("a line").to_string();
    let (told, wide) = (head((120, 40)), head((200, 60)));
    assert!(told.contains("trial 1/2") && told.contains("display 84 ms"), "{told}");
    assert!(wide.contains("trial 1/2 attempt 2") && wide.contains("display 84 ms"), "{wide}");
    // The question before its end says what is kept.
    stage.model.dialog = Some(Dialog::EndTrial);
    let presses = stage.session.spec.trial.presses;
    stage.shows_everywhere(&[
        &format!("It counts with 0 of {presses} presses"),
        "aborts it instead: then it does not count",
    ]);
    stage.at(1.0, Event::TrialExcluded { reason: "interrupted".to_string() });
    stage.shows_everywhere(&["It is excluded: interrupted."]);
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
    stage.shows((200, 60), &["PROBE"]);

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
