//! The participant's tutorial: what its steps ask for, what the page is told meanwhile, and that it is no part of the trial.

use tomcom::run::leaving::TutorialProgress;
use tomcom_core::kitchen::IngredientStorage;
use tomcom_devices::sight::{DisplayStage, ShownContent, scene, sight};
use tomcom_session::plan::{PhaseSpec, Tutorial, TutorialStep, TutorialStepKind};
use tomcom_session::preflight_checks::participant;
use tomcom_session::protocol::StudyPhase;
use tomcom_session::settings::ProbeSpec;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};

use super::{Run, files, folder, study};
use crate::support::*;

const BY_PARTICIPANT: TutorialPageTurner = TutorialPageTurner::Participant;

/// A tutorial of the project, with all its steps.
fn tutorial(name: &str) -> Tutorial {
    let text = fs::read_to_string(Path::new("sessions/tutorials").join(name)).expect("the project's file");
    toml::from_str(&text).expect("a tutorial")
}

#[test]
fn a_probe_is_practised_only_where_the_session_has_probes() {
    assert!(tutorial("sushi.toml").position("probe").is_some());
    assert_eq!(files().tutorial.expect("a tutorial").position("probe"), None, "sessions/study.toml has none");
}

/// A recording of the tutorial alone.
impl Run {
    fn lesson(out: &Path) -> Run {
        let mut files = files();
        files.spec.probes = Some(ProbeSpec::default());
        files.tutorial = Some(tutorial("sushi.toml"));
        files.spec = files.study().and_then(|study| study.tutorial_alone("P07")).expect("a tutorial");
        let mut lesson = Run::begin(files, 0, out);
        let begun = ProtocolEvent::PhaseStarted { phase: StudyPhase::Tutorial, number: 1 };
        assert_eq!(lesson.input(Event::Protocol(begun)), None);
        lesson
    }

    fn tell(&mut self, event: TutorialEvent) -> Option<String> {
        self.input(Event::Protocol(ProtocolEvent::Tutorial(event)))
    }

    fn press(&mut self, button: &str) -> Option<String> {
        self.tell(TutorialEvent::Pressed { button: button.to_string() })
    }

    fn turn(&mut self, by: TutorialPageTurner) -> Option<String> {
        let (tutorial, state) = self.session().tutorial().expect("a tutorial");
        let event = match tutorial.steps.get(state.step + 1) {
            Some(step) => TutorialEvent::Shown { step: step.id.clone(), by },
            None => TutorialEvent::Ended { by },
        };
        self.tell(event)
    }

    /// Ends the session, and verifies its recording.
    fn check_recording(mut self) {
        assert_eq!(self.input(Event::SessionEnded), None);
        self.log.flush().expect("the log can be written");
        let found = verify(self.log.folder()).expect("a recording");
        assert!(found.verified, "{found:?}");
    }

    /// The wizard turns pages until this step.
    fn turn_to(&mut self, id: &str) {
        while self.session().tutorial_step().expect("a step").0.id != id {
            assert_eq!(self.turn(TutorialPageTurner::Wizard), None);
        }
    }
}

#[test]
fn a_participant_goes_through_the_whole_tutorial() {
    let out = folder("tutorial_whole");
    let mut lesson = Run::lesson(&out);
    while let Some((step, _)) = lesson.session().tutorial_step() {
        let step = step.clone();
        match step.kind {
            TutorialStepKind::Press | TutorialStepKind::Order => {
                assert!(lesson.turn(BY_PARTICIPANT).is_some(), "{}: left before it is done", step.id);
                for button in &step.presses {
                    assert_eq!(lesson.press(button), None);
                    assert_eq!(sight(lesson.session()).presses[0].map(|press| press.effective), Some(true));
                }
            }
            TutorialStepKind::Question => {
                let right = step.right.expect("a right choice");
                let wrong = if right == 1 { 2 } else { 1 };
                for (choice, is_done) in [(wrong, false), (right, true)] {
                    assert_eq!(lesson.tell(TutorialEvent::Answered { step: step.id.clone(), choice }), None);
                    let page = sight(lesson.session()).tutorial.expect("a page");
                    assert_eq!(page.done, is_done);
                    let asked = page.question.expect("a question");
                    assert_eq!((asked.explanation.is_some(), asked.right.is_some()), (!is_done, is_done));
                }
            }
            TutorialStepKind::Recipes => {
                assert!(lesson.turn(BY_PARTICIPANT).is_some(), "the cards are left before their time");
                assert_eq!(lesson.tell(TutorialEvent::CardsHidden { step: step.id.clone() }), None);
            }
            TutorialStepKind::Probe => {
                let probe = sight(lesson.session()).tutorial.and_then(|page| page.probe).expect("a question");
                let right = probe.choices.iter().find(|choice| choice.words == "cut salmon").expect("what lies there");
                for (choice, is_done) in [(0, false), (right.number as u8, true)] {
                    assert_eq!(lesson.tell(TutorialEvent::Answered { step: step.id.clone(), choice }), None);
                    let page = sight(lesson.session()).tutorial.expect("a page");
                    assert_eq!((page.done, page.missed, page.probe.is_some()), (is_done, !is_done, !is_done));
                }
            }
            TutorialStepKind::Robot => {
                let page = sight(lesson.session());
                let shown = page.tutorial.expect("a page").robot;
                assert_eq!(shown.len(), step.presses.len());
                assert!(shown.iter().all(|press| press.contents != page.contents), "{shown:?}");
            }
            TutorialStepKind::Text | TutorialStepKind::Signal | TutorialStepKind::RobotSays => {}
        }
        assert_eq!(lesson.turn(BY_PARTICIPANT), None, "{}", step.id);
    }
    let session = lesson.session();
    assert_eq!(session.phase_lacks(), None);
    assert_eq!((session.presses, session.state), ([0, 0], session.kitchen.empty_state()), "a trial has nothing of it");
    assert!(session.timeline.is_empty() && session.served.is_empty());
    let wrong = session.tutorial().expect("a tutorial").1.wrong_answers.iter().sum::<u32>();
    assert_eq!(wrong, 4, "each question was answered wrongly once");
    assert_eq!(sight(session).stage, DisplayStage::TutorialOver);
    let reached = TutorialProgress::from_session(session).expect("a tutorial");
    let steps = session.tutorial().expect("a tutorial").0.steps.iter().filter(|step| step.has_presses());
    let presses = steps.map(|step| step.presses.len() as u64).sum();
    assert_eq!((reached.done, reached.presses, reached.wrong_answers), (reached.steps, presses, 4));
    lesson.check_recording();
}

#[test]
fn only_the_button_that_is_asked_for_moves_the_kitchen_on() {
    let mut lesson = Run::lesson(&folder("tutorial_presses"));
    assert!(lesson.press("take rice").is_some(), "a text has no presses");
    lesson.turn_to("take");
    let empty = sight(lesson.session()).contents;
    assert_eq!(lesson.press("take nori"), None);
    let page = sight(lesson.session());
    assert_eq!(page.contents, empty);
    assert!(page.tutorial.as_ref().is_some_and(|page| page.missed && page.presses == Some([0, 2])));
    assert_eq!(page.presses[0].map(|press| press.effective), Some(false));
    assert_eq!(lesson.press("take rice"), None);
    assert_ne!(sight(lesson.session()).contents, empty);
    // The page before and back again: the step begins anew.
    let back = TutorialEvent::Shown { step: "robot_says".to_string(), by: BY_PARTICIPANT };
    assert_eq!(lesson.tell(back), None);
    assert_eq!(sight(lesson.session()).contents, empty);
}

#[test]
fn what_the_robot_shows_is_asked_of_nobody_and_framed_where_the_robot_does_it() {
    let mut lesson = Run::lesson(&folder("tutorial_robot"));
    lesson.turn_to("robot");
    let page = sight(lesson.session()).tutorial.expect("a page");
    assert_eq!(page.hint, None, "the participant has nori, too, and is not to take it");
    let kitchen = lesson.session().kitchen.clone();
    let is_nori = |shelf: &IngredientStorage| shelf.agent == Agent::Robot && kitchen.content(shelf.item).name == "nori";
    let shelf = kitchen.storages.iter().position(is_nori).expect("a shelf");
    let board = kitchen.location_named("assembly_board").expect("a location").index();
    let spots = json!([{"place": {"storage": shelf}}, {"place": {"location": board}}]);
    assert_eq!(serde_json::to_value(&page.frames).expect("JSON"), spots);
}

#[test]
fn an_order_may_be_made_in_another_order_than_the_file_has_it() {
    let mut lesson = Run::lesson(&folder("tutorial_any_order"));
    lesson.turn_to("order");
    let step = lesson.session().tutorial_step().expect("a step").0.clone();
    let mut presses = 0;
    let mut press = |lesson: &mut Run, button: &str, is_right: bool| {
        assert_eq!(lesson.press(button), None);
        presses += usize::from(is_right);
        let page = sight(lesson.session()).tutorial.expect("a page");
        assert_eq!((page.missed, page.presses), (!is_right, Some([presses, step.presses.len()])), "{button}");
    };
    // Shrimp is no part of it, and what the robot's nori would need the trash for is none either.
    press(&mut lesson, "take shrimp", false);
    for button in ["take nori", "assembly_board", "take salmon", "cutting_board", "cut", "cutting_board"] {
        press(&mut lesson, button, true);
    }
    press(&mut lesson, "cooking_pot", false);
    for button in ["assembly_board", "take rice", "cooking_pot", "cook", "cooking_pot", "assembly_board"] {
        press(&mut lesson, button, true);
    }
    // The button that is marked is one that goes on from here.
    while let Some(button) = lesson.session().tutorial_step().and_then(|(_, state)| state.wanted().cloned()) {
        press(&mut lesson, &button, true);
    }
    assert!(sight(lesson.session()).tutorial.expect("a page").done);
}

#[test]
fn a_tutorial_in_another_language_than_the_page_is_told_before_it_begins() {
    for (language, is_told) in [("en", false), ("fr", true)] {
        let mut files = files();
        files.spec.display.language = language.to_string();
        files.spec = files.study().and_then(|study| study.tutorial_alone("P07")).expect("a tutorial");
        let engine = engine_of(files, 0);
        assert_eq!(scene(engine.session()).foreign_tutorial, is_told);
        let checks = participant(engine.session(), at(0.0), "g", None);
        assert_eq!(checks.iter().any(|check| check.name == "tutorial"), is_told, "{checks:?}");
    }
}

#[test]
fn a_press_after_the_last_one_is_no_mistake() {
    let mut lesson = Run::lesson(&folder("tutorial_more_presses"));
    lesson.turn_to("take");
    for button in ["take rice", "cooking_pot", "take nori"] {
        assert_eq!(lesson.press(button), None);
    }
    let page = sight(lesson.session()).tutorial.expect("a page");
    assert!(page.done && !page.missed && page.hint.is_none(), "{page:?}");
    assert_eq!(page.presses, Some([2, 2]));
}

#[test]
fn hints_of_the_guided_order_fade() {
    let mut lesson = Run::lesson(&folder("tutorial_hints"));
    lesson.turn_to("order");
    let after_s = |lesson: &Run| sight(lesson.session()).tutorial.and_then(|page| page.hint).map(|hint| hint.after_s);
    let step = lesson.session().tutorial_step().expect("a step").0.clone();
    let (hints, wait_s) = (step.hints.expect("hints"), step.hint_after_s.expect("a time"));
    for (nth, button) in step.presses.iter().enumerate() {
        assert_eq!(after_s(&lesson), Some(if nth < hints { 0.0 } else { wait_s }), "press {nth}");
        assert_eq!(lesson.press(button), None);
    }
    assert_eq!(after_s(&lesson), None);
}

#[test]
fn the_page_is_told_recipes_only_while_they_are_shown() {
    let mut lesson = Run::lesson(&folder("tutorial_recipes"));
    let dishes = lesson.session().kitchen.dishes.len();
    while let Some((step, _)) = lesson.session().tutorial_step() {
        let (id, kind, has_dish) = (step.id.clone(), step.kind, step.dish.is_some());
        let page = sight(lesson.session());
        assert_eq!(page.stage, DisplayStage::Tutorial);
        let told = serde_json::to_value(&page).expect("a message");
        let cards = told["tutorial"]["cards"].as_array().expect("cards").len();
        assert_eq!(cards, if kind == TutorialStepKind::Recipes { dishes } else { 0 }, "{id}");
        let shows_recipe = told["signal"].get("recipe").is_some();
        assert_eq!(shows_recipe, kind == TutorialStepKind::Signal && has_dish, "{id}");
        assert_eq!(told["tutorial"]["explains_buttons"], id == "take", "the first step with presses");
        assert_eq!(page.contents.contains(&ShownContent::Dish("salmon maki".to_string())), has_dish && !shows_recipe);
        assert!(told["tutorial"]["question"]["right"].is_null(), "{id}: the right answer is told before it was given");
        assert!(told["tutorial"]["question"]["explanation"].is_null(), "{id}");
        let room = told["tutorial"]["question"]["explanation_length"].as_u64().unwrap_or(0);
        assert_eq!(room > 0, kind == TutorialStepKind::Question, "{id}: the page keeps room for the explanation");
        if kind == TutorialStepKind::Recipes {
            assert_eq!(lesson.tell(TutorialEvent::CardsHidden { step: id }), None);
            assert!(sight(lesson.session()).tutorial.expect("a page").cards.is_empty());
        }
        assert_eq!(lesson.turn(TutorialPageTurner::Wizard), None);
    }
    assert_eq!(sight(lesson.session()).tutorial, None);
}

#[test]
fn the_wizard_can_skip_the_rest() {
    let mut lesson = Run::lesson(&folder("tutorial_skipped"));
    assert!(lesson.session().phase_lacks().is_some());
    assert!(lesson.tell(TutorialEvent::Ended { by: BY_PARTICIPANT }).is_some());
    assert_eq!(lesson.tell(TutorialEvent::Ended { by: TutorialPageTurner::Wizard }), None);
    assert_eq!(lesson.session().phase_lacks(), None);
    assert!(lesson.press("take rice").is_some(), "the tutorial is over");
}

#[test]
fn a_plan_has_the_tutorial_once_and_on_the_display_only() {
    let wanted = |instructed| WantedRecording { participant: 0, slot: 0, attempt: 1, instructed };
    let has_tutorial = |kind: ParticipantKind, instructed: bool| {
        let study = study(|files| files.spec.participant.kind = kind);
        let (spec, _) = study.settings(wanted(instructed));
        let phases = spec.step.expect("a step").phases;
        phases.iter().any(|phase| matches!(phase, PhaseSpec::Tutorial { .. }))
    };
    assert!(has_tutorial(ParticipantKind::Display, false));
    assert!(!has_tutorial(ParticipantKind::Display, true));
    assert!(!has_tutorial(ParticipantKind::Keyboard, false) && !has_tutorial(ParticipantKind::Simulated, false));
    let other = study(|files| files.tutorial.as_mut().expect("a tutorial").steps[0].text.push('!'));
    assert_ne!(study(|_| ()).digest, other.digest, "the digest covers the texts");
}

#[test]
fn german_and_english_ask_for_the_same_and_fit_their_kitchen() {
    for layout in ["sushi", "burger"] {
        let [english, german] = ["toml", "de.toml"].map(|ending| {
            let tutorial = tutorial(&format!("{layout}.{ending}"));
            tutorial.check().and_then(|()| tutorial.check_kitchen(&kitchen(layout))).expect("it fits the kitchen");
            tutorial
        });
        assert_eq!((english.language.as_str(), german.language.as_str()), ("en", "de"));
        assert_eq!(english.steps.len(), german.steps.len());
        for (one, other) in english.steps.iter().zip(&german.steps) {
            assert_ne!(one.text, other.text, "{}", one.id);
            let asked = |step: &TutorialStep| (step.id.clone(), step.kind, step.presses.clone(), step.right);
            assert_eq!(asked(one), asked(other), "{layout}");
            assert_eq!((&one.point_at, &one.dish, one.seconds), (&other.point_at, &other.dish, other.seconds));
            assert_eq!(one.about, other.about);
        }
    }
}

#[test]
fn a_wrong_tutorial_names_file_line_and_what_would_be_right() {
    let at = folder("tutorial_files");
    let root = fs::canonicalize(".").expect("the project");
    let session = fs::read_to_string("sessions/study.toml").expect("the file of the project");
    let session = session.replace("../layouts", &root.join("layouts").display().to_string());
    let session = session.replace("questionnaires/", &format!("{}/", root.join("sessions/questionnaires").display()));
    let session = session.replace("tutorials/sushi.toml", "tutorial.toml");
    fs::write(at.join("study.toml"), session).expect("a file");
    let right = fs::read_to_string("sessions/tutorials/sushi.toml").expect("the file of the project");
    let found = |text: &str| {
        fs::write(at.join("tutorial.toml"), text).expect("a file");
        let error = read_session(&at.join("study.toml")).expect_err("an error");
        let told = error.to_string();
        format!("{told}\n{:?}", miette::Report::new(error))
    };
    for (from, to, wanted) in [
        ("kind = \"press\"", "kind = \"push\"", "push"),
        ("presses = [\"take rice\", \"cooking_pot\"]", "presses = [\"take rice\", \"oven\"]", "oven"),
        ("presses = [\"cook\", \"cooking_pot\"]", "presses = [\"cut\"]", "does nothing"),
        ("dish = \"salmon maki\"", "dish = \"pizza\"", "pizza"),
        // Perhaps it is a tutorial of another kitchen than the session's.
        (
            "dish = \"salmon maki\"",
            "dish = \"pizza\"",
            "found a tutorial that does not fit the kitchen \"sushi\" of the session: step ",
        ),
        ("point_at = [\"order_1\", ", "point_at = [\"order_9\", ", "order_9"),
        ("right = 3", "right = 4", "right = 4"),
        ("about = \"cutting_board\"", "about = \"oven\"", "oven"),
        ("presses = [\"take nori\", \"assembly_board\"]", "presses = [\"take crab\"]", "take crab"),
        ("id = \"ask_crab\"", "id = \"ask_shape\"", "twice"),
        ("seconds = 60.0", "seconds = -1.0", "seconds = -1"),
        ("plate\", \"serve 1\"", "plate\"", "do not serve"),
    ] {
        let report = found(&right.replacen(from, to, 1));
        assert!(report.contains("tutorial.toml:") && report.contains(wanted), "{from} -> {to}:\n{report}");
    }
}

#[test]
fn cards_that_were_shown_for_their_time_do_not_come_back() {
    let mut lesson = Run::lesson(&folder("tutorial_cards"));
    lesson.turn_to("recipes");
    assert!(!sight(lesson.session()).tutorial.expect("a page").cards.is_empty());
    assert_eq!(lesson.tell(TutorialEvent::CardsHidden { step: "recipes".to_string() }), None);
    assert_eq!(lesson.turn(BY_PARTICIPANT), None);
    assert_eq!(lesson.tell(TutorialEvent::Shown { step: "recipes".to_string(), by: BY_PARTICIPANT }), None);
    let page = sight(lesson.session()).tutorial.expect("a page");
    assert!(page.done && page.cards.is_empty() && page.seconds.is_none(), "{page:?}");
}

#[test]
fn the_time_of_recipe_cards_continues_when_they_are_shown_again() {
    let out = folder("tutorial_cards_time");
    let mut lesson = Run::lesson(&out);
    lesson.turn_to("recipes");
    let left_s = |lesson: &Run| sight(lesson.session()).tutorial.and_then(|page| page.left_s);
    assert_eq!(left_s(&lesson), Some(60.0));
    for left in [59.5, 59.0] {
        // The lesson's clock goes on by half a second with every event.
        for step in ["signal_highlight", "recipes"] {
            assert_eq!(lesson.tell(TutorialEvent::Shown { step: step.to_string(), by: BY_PARTICIPANT }), None);
        }
        assert_eq!(left_s(&lesson), Some(left));
    }
    assert_eq!(lesson.tell(TutorialEvent::CardsHidden { step: "recipes".to_string() }), None);
    assert_eq!(left_s(&lesson), None);
    lesson.turn_to("order");
    assert_eq!(left_s(&lesson), None, "only recipe cards have a time");
    lesson.check_recording();
}
